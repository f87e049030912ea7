//! Supernodes of the factor: panels of columns with one set of rows, stored as runs of consecutive unknowns.

use super::fill::{Elimination, NONE, invert};
use super::graph::Graph;

/// Two supernodes are merged if together they have at most `columns` columns and at most the fraction `zeros` of
/// their entries would be explicit zeros.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Relaxation {
    /// Columns of the merged supernode.
    pub columns: usize,
    /// Fraction of explicit zeros in the merged supernode \[-\].
    pub zeros: f64,
}

/// Consecutive rows of a panel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Run {
    /// First unknown (in elimination order).
    pub(super) begin: u32,
    /// One past the last unknown.
    pub(super) end: u32,
    /// Row of the first unknown within the panel.
    pub(super) local: u32,
}

/// A panel of columns `begin..end` with the rows of `runs` below its diagonal block.
#[derive(Debug, Clone, Copy)]
pub(super) struct Supernode {
    pub(super) begin: usize,
    pub(super) end: usize,
    /// Rows of the panel, with the diagonal block.
    pub(super) rows: usize,
    /// First entry among the values of the factor.
    pub(super) offset: usize,
    pub(super) parent: u32,
    run_begin: usize,
    run_end: usize,
}

impl Supernode {
    pub(super) fn columns(&self) -> usize {
        self.end - self.begin
    }

    /// Entries of the panel.
    pub(super) fn len(&self) -> usize {
        self.rows * self.columns()
    }

    /// Operations to factorise the panel and to update others with it.
    pub(super) fn flops(&self) -> f64 {
        let (rows, columns) = (self.rows as f64, self.columns() as f64);
        columns * rows * rows
    }
}

/// All supernodes, children before parents.
#[derive(Debug, Clone, Default)]
pub(super) struct Supernodes {
    pub(super) list: Vec<Supernode>,
    runs: Vec<Run>,
    /// Supernode of every unknown.
    pub(super) of_unknown: Vec<u32>,
}

impl Supernodes {
    pub(super) fn new(graph: &Graph, order: &[u32], elimination: &Elimination, limits: &Limits<'_>) -> Self {
        let offset = unknown_offsets(graph, order);
        let blocks = limits.partition(elimination, &offset);
        let mut supernodes = Self { of_unknown: vec![0; offset[order.len()]], ..Self::default() };
        Structure::new(graph, order, &offset).fill(&blocks, &elimination.parent, &mut supernodes);
        supernodes
    }

    pub(super) fn runs(&self, supernode: &Supernode) -> &[Run] {
        &self.runs[supernode.run_begin..supernode.run_end]
    }

    /// Entries of all panels.
    pub(super) fn values(&self) -> usize {
        self.list.last().map_or(0, |last| last.offset + last.len())
    }

    /// Row of `unknown` within the panel of `supernode`.
    pub(super) fn local_row(&self, supernode: &Supernode, unknown: usize) -> usize {
        if unknown < supernode.end {
            return unknown - supernode.begin;
        }
        let runs = self.runs(supernode);
        let place = runs.partition_point(|run| run.end as usize <= unknown);
        runs.get(place).map_or(0, |run| (run.local as usize) + unknown - run.begin as usize)
    }

    pub(super) fn bytes(&self) -> usize {
        self.list.capacity() * size_of::<Supernode>()
            + self.runs.capacity() * size_of::<Run>()
            + self.of_unknown.len() * 4
    }
}

/// First unknown of every position.
fn unknown_offsets(graph: &Graph, order: &[u32]) -> Vec<usize> {
    let mut offset = Vec::with_capacity(order.len() + 1);
    let mut total = 0;
    offset.push(0);
    for &vertex in order {
        total += graph.weight[vertex as usize] as usize;
        offset.push(total);
    }
    offset
}

/// Limits of the panels.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits<'a> {
    pub(super) relaxation: &'a [Relaxation],
    /// Widest panel: wider supernodes are cut.
    pub(super) widest: usize,
}

/// Positions `begin..end` merged into one supernode.
#[derive(Debug, Clone, Copy)]
struct Block {
    begin: usize,
    end: usize,
    zeros: f64,
}

impl Limits<'_> {
    fn partition(&self, elimination: &Elimination, offset: &[usize]) -> Vec<Block> {
        let mut stack: Vec<Block> = Vec::new();
        for block in fundamental(elimination, offset) {
            let mut merged = block;
            while let Some(&child) = stack.last() {
                let parent = elimination.parent[child.end - 1];
                let is_child = parent != NONE && (parent as usize) < merged.end;
                let Some(zeros) = self.merged_zeros(elimination, offset, child, merged).filter(|_| is_child) else {
                    break;
                };
                merged = Block { begin: child.begin, end: merged.end, zeros };
                stack.pop();
            }
            stack.push(merged);
        }
        self.cut(&stack, offset)
    }

    /// Explicit zeros of `child` and `parent` in one panel, if the limits allow it.
    fn merged_zeros(&self, elimination: &Elimination, offset: &[usize], child: Block, parent: Block) -> Option<f64> {
        let (first, middle, last) = (offset[child.begin], offset[parent.begin], offset[parent.end]);
        let below = |block: Block| {
            let vertex = block.end - 1;
            (elimination.count[vertex] as usize).saturating_sub(offset[block.end] - offset[vertex])
        };
        let columns = last - first;
        let height = (last - middle + below(parent)).saturating_sub(below(child));
        let fresh = (height * (middle - first)) as f64;
        let zeros = child.zeros + parent.zeros + fresh;
        let entries = 0.5 * (columns * (columns + 1)) as f64 + (below(parent) * columns) as f64;
        let allowed = |limit: &Relaxation| columns <= limit.columns && zeros <= limit.zeros * entries;
        let room = columns <= self.widest;
        (fresh == 0.0 && room || self.relaxation.iter().any(allowed)).then_some(zeros)
    }

    /// Cuts blocks wider than the limit into equal parts, as far as the vertices allow.
    fn cut(&self, blocks: &[Block], offset: &[usize]) -> Vec<Block> {
        let mut parts = Vec::with_capacity(blocks.len());
        for block in blocks {
            let columns = offset[block.end] - offset[block.begin];
            let share = columns.div_ceil(columns.div_ceil(self.widest).max(1));
            let mut begin = block.begin;
            while begin < block.end {
                let mut end = begin + 1;
                while end < block.end && offset[end + 1] - offset[begin] <= share {
                    end += 1;
                }
                parts.push(Block { begin, end, zeros: 0.0 });
                begin = end;
            }
        }
        parts
    }
}

/// Maximal chains of positions whose columns have the same rows.
fn fundamental(elimination: &Elimination, offset: &[usize]) -> Vec<Block> {
    let n = elimination.parent.len();
    let mut children = vec![0u32; n];
    for &parent in elimination.parent.iter().filter(|&&parent| parent != NONE) {
        children[parent as usize] += 1;
    }
    let mut blocks: Vec<Block> = Vec::new();
    for position in 0..n {
        let joins =
            position > 0 && elimination.parent[position - 1] as usize == position && children[position] == 1 && {
                let removed = (offset[position] - offset[position - 1]) as u64;
                elimination.count[position - 1] == elimination.count[position] + removed
            };
        match blocks.last_mut() {
            Some(last) if joins => last.end = position + 1,
            _ => blocks.push(Block { begin: position, end: position + 1, zeros: 0.0 }),
        }
    }
    blocks
}

/// Builds the rows of the supernodes bottom up.
struct Structure<'a> {
    graph: &'a Graph,
    order: &'a [u32],
    offset: &'a [usize],
    position: Vec<u32>,
    marker: Vec<u32>,
    rows: Vec<u32>,
    block_of: Vec<u32>,
}

impl<'a> Structure<'a> {
    fn new(graph: &'a Graph, order: &'a [u32], offset: &'a [usize]) -> Self {
        let n = order.len();
        Self {
            graph,
            order,
            offset,
            position: invert(order),
            marker: vec![NONE; n],
            rows: Vec::new(),
            block_of: vec![0; n],
        }
    }

    fn fill(&mut self, blocks: &[Block], parent: &[u32], supernodes: &mut Supernodes) {
        for (number, block) in blocks.iter().enumerate() {
            self.block_of[block.begin..block.end].fill(number as u32);
        }
        let mut children: Vec<Vec<u32>> = vec![Vec::new(); blocks.len()];
        // Rows as runs of positions, kept until the parent has taken them.
        let mut position_runs: Vec<Vec<(u32, u32)>> = vec![Vec::new(); blocks.len()];
        for (number, block) in blocks.iter().enumerate() {
            self.collect(number as u32, block, &children[number], &position_runs);
            for child in std::mem::take(&mut children[number]) {
                position_runs[child as usize] = Vec::new();
            }
            let runs = self.runs_of_positions();
            let above = parent[block.end - 1];
            let parent_block = if above == NONE { NONE } else { self.block_of[above as usize] };
            if parent_block != NONE {
                children[parent_block as usize].push(number as u32);
            }
            self.push(block, &runs, parent_block, supernodes);
            position_runs[number] = runs;
        }
    }

    /// Sorted positions below `block` that its matrix entries or its children reach.
    fn collect(&mut self, number: u32, block: &Block, children: &[u32], runs: &[Vec<(u32, u32)>]) {
        self.rows.clear();
        let end = block.end as u32;
        for &vertex in &self.order[block.begin..block.end] {
            for &neighbour in self.graph.neighbours(vertex) {
                let row = self.position[neighbour as usize];
                if row >= end && self.marker[row as usize] != number {
                    self.marker[row as usize] = number;
                    self.rows.push(row);
                }
            }
        }
        for &(first, last) in children.iter().flat_map(|&child| &runs[child as usize]) {
            for row in first.max(end)..last {
                if self.marker[row as usize] != number {
                    self.marker[row as usize] = number;
                    self.rows.push(row);
                }
            }
        }
        self.rows.sort_unstable();
    }

    fn runs_of_positions(&self) -> Vec<(u32, u32)> {
        let mut runs: Vec<(u32, u32)> = Vec::new();
        for &row in &self.rows {
            match runs.last_mut() {
                Some(run) if run.1 == row => run.1 += 1,
                _ => runs.push((row, row + 1)),
            }
        }
        runs
    }

    fn push(&self, block: &Block, runs: &[(u32, u32)], parent: u32, supernodes: &mut Supernodes) {
        let (begin, end) = (self.offset[block.begin], self.offset[block.end]);
        let run_begin = supernodes.runs.len();
        let mut local = end - begin;
        for &(first, last) in runs {
            let (first, last) = (self.offset[first as usize], self.offset[last as usize]);
            supernodes.runs.push(Run { begin: first as u32, end: last as u32, local: local as u32 });
            local += last - first;
        }
        supernodes.of_unknown[begin..end].fill(supernodes.list.len() as u32);
        let offset = supernodes.values();
        let run_end = supernodes.runs.len();
        supernodes.list.push(Supernode { begin, end, rows: local, offset, parent, run_begin, run_end });
    }
}
