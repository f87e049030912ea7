//! LU factorisation of a matrix that is block tridiagonal over the levels of its graph.
//!
//! `D_p ← D_p − A_pk D_k⁻¹ A_kp` from both ends of every component to its middle level, with partial pivoting inside
//! the diagonal blocks. Only the factors of the blocks `D_k` are kept; the couplings stay sparse. Both chains are
//! worked at the same time by the same sequential kernels, so that results do not depend on the threads.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::factor::{PartialPivLuParams, lu_in_place, lu_in_place_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{solve_unit_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::{Accum, ColMut, MatMut, MatRef, Par, Spec};

use super::block_plan::{Block, BlockPlan, Component, Entry};
use super::error::LinearError;
use super::parallel::join;

/// The factors and the buffers of repeated factorisations.
pub(super) struct BlockLu {
    plan: BlockPlan,
    values: Vec<f64>,
    /// Row of every block that pivoting brought to each place.
    rows: Vec<u32>,
    /// Place of every row of a block after pivoting.
    places: Vec<u32>,
    work: [Workspace; 2],
}

/// Buffers of one chain.
struct Workspace {
    /// `D_k⁻¹ A_kp`.
    product: Vec<f64>,
    /// A stripe of `A_pk`.
    stripe: Vec<f64>,
    /// Solution within one block.
    vector: Vec<f64>,
    stack: MemBuffer,
}

/// Factors and permutations of consecutive blocks, of which the first is `first`.
struct Factors<'a> {
    first: &'a Block,
    values: &'a mut [f64],
    rows: &'a mut [u32],
    places: &'a mut [u32],
}

impl Workspace {
    fn new(plan: &BlockPlan) -> Self {
        let widest = plan.blocks.iter().map(|block| block.size).max().unwrap_or(0);
        let pairs = plan.blocks.windows(2).map(|pair| pair[0].size * pair[1].size);
        let stripe = plan.blocks.iter().flat_map(|block| &block.stripes).map(|s| s.rows.len() * s.cols.len());
        let params = Spec::<PartialPivLuParams, f64>::default();
        Self {
            product: vec![0.0; pairs.max().unwrap_or(0)],
            stripe: vec![0.0; stripe.max().unwrap_or(0)],
            vector: vec![0.0; widest],
            stack: MemBuffer::new(lu_in_place_scratch::<u32, f64>(widest, widest, Par::Seq, params)),
        }
    }

    fn bytes(&self) -> usize {
        (self.product.len() + self.stripe.len() + self.vector.len()) * size_of::<f64>()
    }
}

impl BlockLu {
    /// # Errors
    /// [`LinearError::OutOfMemory`] if the factors cannot be allocated.
    pub(super) fn new(plan: BlockPlan) -> Result<Self, LinearError> {
        let entries = plan.values();
        let mut values = Vec::new();
        let bytes = entries.saturating_mul(size_of::<f64>());
        values.try_reserve_exact(entries).map_err(|_| LinearError::OutOfMemory { bytes })?;
        values.resize(entries, 0.0);
        let n = plan.order.len();
        let work = [Workspace::new(&plan), Workspace::new(&plan)];
        Ok(Self { values, rows: vec![0; n], places: vec![0; n], work, plan })
    }

    pub(super) fn order(&self) -> &[u32] {
        &self.plan.order
    }

    pub(super) fn bytes(&self) -> usize {
        let work: usize = self.work.iter().map(Workspace::bytes).sum();
        self.plan.bytes() + self.values.len() * size_of::<f64>() + (self.rows.len() + self.places.len()) * 4 + work
    }

    /// Factorises the matrix with `values` in the order of the pattern. Zero pivots leave entries that are not
    /// finite, see [`BlockLu::pivots`].
    pub(super) fn factorise(&mut self, values: &[f64]) {
        let Self { plan, values: factor, rows, places, work: [front_work, back_work] } = self;
        assemble(plan, values, factor);
        for component in &plan.components {
            let (mut front, mut middle, mut back) = split_component(plan, component, factor, rows, places);
            join(
                || eliminate(plan, component.front.clone(), values, &mut front, front_work),
                || eliminate(plan, component.back.clone().rev(), values, &mut back, back_work),
            );
            let target = &plan.blocks[component.middle];
            if let Some(last) = component.front.clone().last() {
                update(&plan.blocks[last], target, values, middle.block_mut(target), front_work);
            }
            if let Some(last) = component.back.clone().next() {
                update(&plan.blocks[last], target, values, middle.block_mut(target), back_work);
            }
            middle.decompose(target, front_work);
        }
    }

    /// Position in elimination order and value of every pivot.
    pub(super) fn pivots(&self) -> impl Iterator<Item = (usize, f64)> {
        self.plan.blocks.iter().flat_map(move |block| {
            let entry = move |i: usize| (block.begin + i, self.values[block.offset + i * (block.size + 1)]);
            (0..block.size).map(entry)
        })
    }

    /// Overwrites `x`, in elimination order, by the solution of `A x = x` with the same `values` as factorised.
    pub(super) fn solve_in_place(&mut self, values: &[f64], x: &mut [f64]) {
        let Self { plan, values: factor, rows, work: [front_work, back_work], .. } = self;
        let solver = Substitution { plan, values, factor, rows };
        for component in &plan.components {
            let target = &plan.blocks[component.middle];
            let (head, tail) = x.split_at_mut(target.begin);
            let (middle, tail) = tail.split_at_mut(target.size);
            join(
                || solver.forward(component.front.clone(), head, 0, front_work),
                || solver.forward(component.back.clone().rev(), tail, target.begin + target.size, back_work),
            );
            if let Some(last) = component.front.clone().last() {
                subtract_entries(&plan.blocks[last].from_next, values, &front_work.vector, middle);
            }
            if let Some(last) = component.back.clone().next() {
                subtract_entries(&plan.blocks[last].from_next, values, &back_work.vector, middle);
            }
            solver.block(target, middle, &mut front_work.vector);
            let middle = &*middle;
            join(
                || solver.backward(component.front.clone().rev(), middle, head, 0, front_work),
                || solver.backward(component.back.clone(), middle, tail, target.begin + target.size, back_work),
            );
        }
    }
}

impl Factors<'_> {
    fn block_mut(&mut self, block: &Block) -> MatMut<'_, f64> {
        let begin = block.offset - self.first.offset;
        let entries = &mut self.values[begin..begin + block.size * block.size];
        MatMut::from_column_major_slice_mut(entries, block.size, block.size)
    }

    fn decompose(&mut self, block: &Block, work: &mut Workspace) {
        let offset = block.offset - self.first.offset;
        let entries = &mut self.values[offset..offset + block.size * block.size];
        let matrix = MatMut::from_column_major_slice_mut(entries, block.size, block.size);
        let span = block.begin - self.first.begin..block.begin - self.first.begin + block.size;
        let (rows, places) = (&mut self.rows[span.clone()], &mut self.places[span]);
        let stack = MemStack::new(&mut work.stack);
        lu_in_place(matrix, rows, places, Par::Seq, stack, Spec::<PartialPivLuParams, f64>::default());
    }

    /// `D⁻¹ A_kp` into the workspace.
    fn solve_coupling(&mut self, block: &Block, columns: usize, values: &[f64], work: &mut Workspace) {
        let begin = block.begin - self.first.begin;
        let places = &self.places[begin..begin + block.size];
        let entries = &mut work.product[..block.size * columns];
        entries.fill(0.0);
        for entry in &block.to_next {
            entries[places[entry.row as usize] as usize + entry.col as usize * block.size] =
                values[entry.slot as usize];
        }
        let mut product = MatMut::from_column_major_slice_mut(entries, block.size, columns);
        let factors = self.block_mut(block);
        let factors = factors.as_ref();
        solve_unit_lower_triangular_in_place(factors, product.as_mut(), Par::Seq);
        solve_upper_triangular_in_place(factors, product, Par::Seq);
    }
}

fn assemble(plan: &BlockPlan, values: &[f64], factor: &mut [f64]) {
    factor.fill(0.0);
    for block in &plan.blocks {
        for entry in &block.diagonal {
            factor[block.offset + entry.row as usize + entry.col as usize * block.size] = values[entry.slot as usize];
        }
    }
}

/// Factors of the front chain, the middle block and the back chain.
fn split_component<'a>(
    plan: &'a BlockPlan,
    component: &Component,
    values: &'a mut [f64],
    rows: &'a mut [u32],
    places: &'a mut [u32],
) -> (Factors<'a>, Factors<'a>, Factors<'a>) {
    let first = &plan.blocks[component.front.start];
    let middle = &plan.blocks[component.middle];
    let entries = [middle.offset, middle.offset + middle.size * middle.size];
    let unknowns = [middle.begin, middle.begin + middle.size];
    let values = three(values, first.offset, entries);
    let rows = three(rows, first.begin, unknowns);
    let places = three(places, first.begin, unknowns);
    let back = plan.blocks.get(component.back.start).unwrap_or(middle);
    let [front_values, middle_values, back_values] = values;
    let [front_rows, middle_rows, back_rows] = rows;
    let [front_places, middle_places, back_places] = places;
    (
        Factors { first, values: front_values, rows: front_rows, places: front_places },
        Factors { first: middle, values: middle_values, rows: middle_rows, places: middle_places },
        Factors { first: back, values: back_values, rows: back_rows, places: back_places },
    )
}

/// The parts of `slice` from `begin` to the first cut, between the cuts, and after the second.
fn three<T>(slice: &mut [T], begin: usize, cuts: [usize; 2]) -> [&mut [T]; 3] {
    let (head, tail) = slice.split_at_mut(cuts[0]);
    let (middle, tail) = tail.split_at_mut(cuts[1] - cuts[0]);
    [&mut head[begin..], middle, tail]
}

/// Eliminates the blocks of a chain in turn; the product of the last one stays in the workspace.
fn eliminate(
    plan: &BlockPlan,
    chain: impl Iterator<Item = usize>,
    values: &[f64],
    factors: &mut Factors<'_>,
    work: &mut Workspace,
) {
    let mut previous: Option<&Block> = None;
    for number in chain {
        let block = &plan.blocks[number];
        if let Some(previous) = previous {
            update(previous, block, values, factors.block_mut(block), work);
        }
        factors.decompose(block, work);
        factors.solve_coupling(block, plan.blocks[block.next].size, values, work);
        previous = Some(block);
    }
}

/// `D_p -= A_pk (D_k⁻¹ A_kp)` with the product in the workspace.
fn update(source: &Block, target: &Block, values: &[f64], mut diagonal: MatMut<'_, f64>, work: &mut Workspace) {
    let product = MatRef::from_column_major_slice(&work.product[..source.size * target.size], source.size, target.size);
    for stripe in &source.stripes {
        let (height, width) = (stripe.rows.len(), stripe.cols.len());
        let entries = &mut work.stripe[..height * width];
        entries.fill(0.0);
        for entry in &source.from_next[stripe.entries.clone()] {
            let (row, col) = (entry.row as usize - stripe.rows.start, entry.col as usize - stripe.cols.start);
            entries[row + col * height] = values[entry.slot as usize];
        }
        matmul(
            diagonal.as_mut().subrows_mut(stripe.rows.start, height),
            Accum::Add,
            MatRef::from_column_major_slice(entries, height, width),
            product.subrows(stripe.cols.start, width),
            -1.0,
            Par::Seq,
        );
    }
}

/// `target -= A vector` with the entries of A.
fn subtract_entries(entries: &[Entry], values: &[f64], vector: &[f64], target: &mut [f64]) {
    for entry in entries {
        target[entry.row as usize] -= values[entry.slot as usize] * vector[entry.col as usize];
    }
}

struct Substitution<'a> {
    plan: &'a BlockPlan,
    values: &'a [f64],
    factor: &'a [f64],
    rows: &'a [u32],
}

impl Substitution<'_> {
    /// Solves with one diagonal block; the solution stands in `x` and at the start of `vector`.
    fn block(&self, block: &Block, x: &mut [f64], vector: &mut [f64]) {
        self.local(block, x, vector);
        x.copy_from_slice(&vector[..block.size]);
    }

    /// Reduces the right-hand side of a chain, whose unknowns `x` start at `base`. The right-hand sides of the
    /// blocks are kept for [`Substitution::backward`]; the last local solution stays in the workspace.
    fn forward(&self, chain: impl Iterator<Item = usize>, x: &mut [f64], base: usize, work: &mut Workspace) {
        let mut previous: Option<&Block> = None;
        for number in chain {
            let block = &self.plan.blocks[number];
            let own = &mut x[block.begin - base..block.begin - base + block.size];
            if let Some(previous) = previous {
                subtract_entries(&previous.from_next, self.values, &work.vector, own);
            }
            self.local(block, own, &mut work.vector);
            previous = Some(block);
        }
    }

    /// The solution with one diagonal block in `vector`, the right-hand side untouched.
    fn local(&self, block: &Block, x: &[f64], vector: &mut [f64]) {
        let rows = &self.rows[block.begin..block.begin + block.size];
        let vector = &mut vector[..block.size];
        for (value, &row) in vector.iter_mut().zip(rows) {
            *value = x[row as usize];
        }
        let entries = &self.factor[block.offset..block.offset + block.size * block.size];
        let factors = MatRef::from_column_major_slice(entries, block.size, block.size);
        solve_unit_lower_triangular_in_place(factors, ColMut::from_slice_mut(vector).as_mat_mut(), Par::Seq);
        solve_upper_triangular_in_place(factors, ColMut::from_slice_mut(vector).as_mat_mut(), Par::Seq);
    }

    /// Solves a chain from the block next to `middle` outwards.
    fn backward(
        &self,
        chain: impl Iterator<Item = usize>,
        middle: &[f64],
        x: &mut [f64],
        base: usize,
        work: &mut Workspace,
    ) {
        let mut solved = false;
        for number in chain {
            let block = &self.plan.blocks[number];
            let own = &mut x[block.begin - base..block.begin - base + block.size];
            let above = if solved { &work.vector[..] } else { middle };
            subtract_entries(&block.to_next, self.values, above, own);
            self.block(block, own, &mut work.vector);
            solved = true;
        }
    }
}
