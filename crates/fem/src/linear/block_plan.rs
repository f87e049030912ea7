//! Blocks of a matrix over the levels of its graph: a block tridiagonal matrix per connected component.

use std::ops::Range;

use super::error::LinearError;
use super::fill::invert;
use super::graph::Graph;
use super::levels::{Levels, Origin, components};
use super::pattern::SparsePattern;

/// Rows of a coupling block multiplied at a time.
const STRIPE_ROWS: usize = 64;

/// Cost of a factorisation over the levels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BlockCost {
    /// Bytes of the factors and of the largest products.
    pub(super) bytes: f64,
    /// Floating-point operations.
    pub(super) flops: f64,
}

/// Levels and cost of the cheaper of the two ways to count levels.
pub(super) fn cheapest_levels(graph: &Graph) -> (Vec<Levels>, BlockCost) {
    let [section, vertex] = [Origin::Section, Origin::Vertex].map(|origin| {
        let levels = components(graph, origin);
        let cost = cost(graph, &levels);
        (levels, cost)
    });
    if section.1.flops <= vertex.1.flops { section } else { vertex }
}

fn cost(graph: &Graph, components: &[Levels]) -> BlockCost {
    let (mut entries, mut largest, mut flops) = (0.0f64, 0.0f64, 0.0f64);
    for levels in components {
        let mut previous = 0.0;
        for number in 0..levels.len() {
            let size: f64 = levels.level(number).iter().map(|&v| f64::from(graph.weight[v as usize])).sum();
            entries += size * size;
            largest = largest.max(size * previous);
            flops += size * size * size * 2.0 / 3.0 + 2.0 * size * size * previous;
            previous = size;
        }
    }
    BlockCost { bytes: (entries + 2.0 * largest) * size_of::<f64>() as f64, flops }
}

/// A value on or beside the block diagonal.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entry {
    pub(super) slot: u32,
    /// Row within its block.
    pub(super) row: u32,
    /// Column within its block.
    pub(super) col: u32,
}

/// Rows `rows` of a coupling block, whose entries lie in columns `cols`.
#[derive(Debug, Clone)]
pub(super) struct Stripe {
    pub(super) rows: Range<usize>,
    pub(super) cols: Range<usize>,
    pub(super) entries: Range<usize>,
}

/// A diagonal block and its couplings with the block its elimination updates.
#[derive(Debug, Clone, Default)]
pub(super) struct Block {
    /// First unknown in elimination order.
    pub(super) begin: usize,
    pub(super) size: usize,
    /// Block that the elimination of this one updates; a middle block names itself.
    pub(super) next: usize,
    /// First entry among the dense factors.
    pub(super) offset: usize,
    pub(super) diagonal: Vec<Entry>,
    /// Entries with rows here and columns in the next block.
    pub(super) to_next: Vec<Entry>,
    /// Entries with rows in the next block and columns here, by stripes of rows.
    pub(super) from_next: Vec<Entry>,
    pub(super) stripes: Vec<Stripe>,
}

/// A component: two chains of blocks that are eliminated towards the middle block.
#[derive(Debug, Clone)]
pub(super) struct Component {
    /// Blocks eliminated in ascending order.
    pub(super) front: Range<usize>,
    pub(super) middle: usize,
    /// Blocks eliminated in descending order.
    pub(super) back: Range<usize>,
}

#[derive(Debug, Clone)]
pub(super) struct BlockPlan {
    pub(super) blocks: Vec<Block>,
    pub(super) components: Vec<Component>,
    /// Unknown of the caller at every position.
    pub(super) order: Vec<u32>,
}

impl BlockPlan {
    /// # Errors
    /// [`LinearError::FactorTooLarge`] if the entries of the pattern exceed 32-bit indices.
    pub(super) fn new(pattern: &SparsePattern, graph: &Graph, levels: &[Levels]) -> Result<Self, LinearError> {
        let limit = u32::MAX as usize;
        if pattern.nnz() >= limit {
            return Err(LinearError::FactorTooLarge { entries: pattern.nnz() as f64, limit: limit as f64 });
        }
        let mut plan = Self { blocks: Vec::new(), components: Vec::new(), order: Vec::with_capacity(pattern.n()) };
        let (mut begin, mut offset) = (0, 0);
        for component in levels {
            let first = plan.blocks.len();
            for number in 0..component.len() {
                let unknowns = graph.expand(component.level(number));
                let size = unknowns.len();
                plan.order.extend(unknowns);
                plan.blocks.push(Block { begin, size, next: plan.blocks.len(), offset, ..Block::default() });
                begin += size;
                offset += size * size;
            }
            plan.components.push(halves(&plan.blocks, first));
        }
        plan.link();
        plan.distribute(pattern);
        Ok(plan)
    }

    /// Dense entries of all diagonal blocks.
    pub(super) fn values(&self) -> usize {
        self.blocks.last().map_or(0, |block| block.offset + block.size * block.size)
    }

    pub(super) fn bytes(&self) -> usize {
        let entries = |block: &Block| block.diagonal.len() + block.to_next.len() + block.from_next.len();
        let stripes: usize = self.blocks.iter().map(|block| block.stripes.len()).sum();
        self.blocks.iter().map(entries).sum::<usize>() * size_of::<Entry>()
            + stripes * size_of::<Stripe>()
            + self.blocks.len() * size_of::<Block>()
            + self.order.len() * size_of::<u32>()
    }

    fn link(&mut self) {
        for component in &self.components {
            component.front.clone().for_each(|block| self.blocks[block].next = block + 1);
            component.back.clone().for_each(|block| self.blocks[block].next = block - 1);
        }
    }

    /// Sorts the entries of the pattern into the blocks.
    fn distribute(&mut self, pattern: &SparsePattern) {
        let position = invert(&self.order);
        let mut block_of = vec![0u32; self.order.len()];
        for (number, block) in self.blocks.iter().enumerate() {
            block_of[block.begin..block.begin + block.size].fill(number as u32);
        }
        for (col, span) in pattern.column_pointers().windows(2).enumerate() {
            let col = position[col] as usize;
            let col_block = block_of[col] as usize;
            for slot in span[0]..span[1] {
                let row = position[pattern.row_indices()[slot] as usize] as usize;
                let row_block = block_of[row] as usize;
                let entry = Entry {
                    slot: slot as u32,
                    row: (row - self.blocks[row_block].begin) as u32,
                    col: (col - self.blocks[col_block].begin) as u32,
                };
                if row_block == col_block {
                    self.blocks[col_block].diagonal.push(entry);
                } else if self.blocks[col_block].next == row_block {
                    self.blocks[col_block].from_next.push(entry);
                } else {
                    self.blocks[row_block].to_next.push(entry);
                }
            }
        }
        for number in 0..self.blocks.len() {
            let rows = self.blocks[self.blocks[number].next].size;
            self.blocks[number].finish(rows);
        }
    }
}

impl Block {
    /// Sorts the entries for the traversal and cuts the coupling into stripes.
    fn finish(&mut self, next_rows: usize) {
        self.diagonal.sort_unstable_by_key(|entry| (entry.col, entry.row));
        self.to_next.sort_unstable_by_key(|entry| (entry.col, entry.row));
        self.from_next.sort_unstable_by_key(|entry| (entry.row as usize / STRIPE_ROWS, entry.col, entry.row));
        for entries in [&mut self.diagonal, &mut self.to_next, &mut self.from_next] {
            entries.shrink_to_fit();
        }
        let mut begin = 0;
        for first in (0..next_rows).step_by(STRIPE_ROWS) {
            let rows = first..(first + STRIPE_ROWS).min(next_rows);
            let count = self.from_next[begin..].partition_point(|entry| (entry.row as usize) < rows.end);
            let entries = begin..begin + count;
            if let (Some(left), Some(right)) =
                (self.from_next[entries.clone()].first(), self.from_next[entries.clone()].last())
            {
                let cols = left.col as usize..right.col as usize + 1;
                self.stripes.push(Stripe { rows, cols, entries: entries.clone() });
            }
            begin = entries.end;
        }
    }
}

/// Cuts the blocks from `first` on where the work on both sides is equal.
fn halves(blocks: &[Block], first: usize) -> Component {
    let cube = |block: &Block| (block.size as f64).powi(3);
    let half = 0.5 * blocks[first..].iter().map(cube).sum::<f64>();
    let mut sum = 0.0;
    let middle = blocks[first..].iter().position(|block| {
        sum += cube(block);
        sum >= half
    });
    let middle = first + middle.unwrap_or(0);
    Component { front: first..middle, middle, back: middle + 1..blocks.len() }
}
