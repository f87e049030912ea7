//! Elimination tree, column counts and cost of a factorisation in a given order.

use super::graph::Graph;

pub(super) const NONE: u32 = u32::MAX;

/// Cost of an LDLᵀ factorisation in one order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FillEstimate {
    /// Entries of the triangular factor with the diagonal.
    pub nonzeros: f64,
    /// Floating-point operations of the factorisation, `Σ c²` over the columns with `c` entries.
    pub flops: f64,
}

/// Elimination tree of the vertices in a given order, with the heights of the factor's columns in unknowns.
#[derive(Debug, Clone)]
pub(super) struct Elimination {
    /// Parent of every position, [`NONE`] at a root.
    pub(super) parent: Vec<u32>,
    /// Entries of the first column of every position, with the diagonal.
    pub(super) count: Vec<u64>,
}

impl Elimination {
    /// Tree and counts of `graph` eliminated in `order` (position to vertex).
    ///
    /// Liu's tree with path compression, and the skeleton algorithm of Gilbert, Ng and Peyton (SIAM J. Matrix Anal.
    /// Appl. 15, 1994) with weighted rows: nearly linear in the edges of the graph.
    pub(super) fn new(graph: &Graph, order: &[u32]) -> Self {
        let position = invert(order);
        let parent = tree(graph, order, &position);
        let count = counts(graph, order, &position, &parent);
        Self { parent, count }
    }

    pub(super) fn estimate(&self, graph: &Graph, order: &[u32]) -> FillEstimate {
        let mut estimate = FillEstimate { nonzeros: 0.0, flops: 0.0 };
        for (&vertex, &count) in order.iter().zip(&self.count) {
            for removed in 0..u64::from(graph.weight[vertex as usize]) {
                let height = count.saturating_sub(removed) as f64;
                estimate.nonzeros += height;
                estimate.flops += height * height;
            }
        }
        estimate
    }
}

pub(super) fn invert(order: &[u32]) -> Vec<u32> {
    let mut position = vec![0u32; order.len()];
    for (place, &item) in order.iter().enumerate() {
        position[item as usize] = place as u32;
    }
    position
}

fn tree(graph: &Graph, order: &[u32], position: &[u32]) -> Vec<u32> {
    let mut parent = vec![NONE; order.len()];
    let mut ancestor = vec![NONE; order.len()];
    for (column, &vertex) in order.iter().enumerate() {
        let column = column as u32;
        for &neighbour in graph.neighbours(vertex) {
            let mut node = position[neighbour as usize];
            while node != NONE && node < column {
                let next = ancestor[node as usize];
                ancestor[node as usize] = column;
                if next == NONE {
                    parent[node as usize] = column;
                }
                node = next;
            }
        }
    }
    parent
}

/// Children-first order of a forest; siblings keep their order.
pub(super) fn postorder(parent: &[u32]) -> Vec<u32> {
    let n = parent.len();
    let (mut head, mut next) = (vec![NONE; n], vec![NONE; n]);
    for node in (0..n).rev() {
        if parent[node] != NONE {
            next[node] = head[parent[node] as usize];
            head[parent[node] as usize] = node as u32;
        }
    }
    let mut post = Vec::with_capacity(n);
    let mut stack = Vec::new();
    for root in (0..n).filter(|&node| parent[node] == NONE) {
        stack.push(root as u32);
        while let Some(&node) = stack.last() {
            let child = head[node as usize];
            if child == NONE {
                post.push(node);
                stack.pop();
            } else {
                head[node as usize] = next[child as usize];
                stack.push(child);
            }
        }
    }
    post
}

/// State of the skeleton algorithm.
struct Skeleton {
    /// Postorder rank of the first descendant of every position.
    first: Vec<u32>,
    max_first: Vec<u32>,
    previous_leaf: Vec<u32>,
    ancestor: Vec<u32>,
}

impl Skeleton {
    /// If `column` is a leaf of the row subtree of `row`: the least common ancestor with the previous leaf, or
    /// [`NONE`] for the first leaf.
    fn leaf(&mut self, row: u32, column: u32) -> Option<u32> {
        let (i, j) = (row as usize, column as usize);
        if self.max_first[i] != NONE && self.first[j] <= self.max_first[i] {
            return None;
        }
        self.max_first[i] = self.first[j];
        let previous = std::mem::replace(&mut self.previous_leaf[i], column);
        if previous == NONE {
            return Some(NONE);
        }
        let mut root = previous;
        while root != self.ancestor[root as usize] {
            root = self.ancestor[root as usize];
        }
        let mut node = previous;
        while node != root {
            node = std::mem::replace(&mut self.ancestor[node as usize], root);
        }
        Some(root)
    }
}

fn counts(graph: &Graph, order: &[u32], position: &[u32], parent: &[u32]) -> Vec<u64> {
    let n = order.len();
    let post = postorder(parent);
    let weight = |column: u32| i64::from(graph.weight[order[column as usize] as usize]);
    let (first, mut delta) = first_descendants(parent, &post, weight);
    let ancestor = (0..n as u32).collect();
    let mut skeleton = Skeleton { first, max_first: vec![NONE; n], previous_leaf: vec![NONE; n], ancestor };
    for &column in &post {
        if parent[column as usize] != NONE {
            delta[parent[column as usize] as usize] -= weight(column);
        }
        for &neighbour in graph.neighbours(order[column as usize]) {
            let row = position[neighbour as usize];
            if row <= column {
                continue;
            }
            if let Some(common) = skeleton.leaf(row, column) {
                delta[column as usize] += weight(row);
                if common != NONE {
                    delta[common as usize] -= weight(row);
                }
            }
        }
        if parent[column as usize] != NONE {
            skeleton.ancestor[column as usize] = parent[column as usize];
        }
    }
    for &column in &post {
        if parent[column as usize] != NONE {
            delta[parent[column as usize] as usize] += delta[column as usize];
        }
    }
    delta.into_iter().map(|count| count.max(0) as u64).collect()
}

/// Postorder rank of the first descendant of every position, and the weight of the leaves of the tree.
fn first_descendants(parent: &[u32], post: &[u32], weight: impl Fn(u32) -> i64) -> (Vec<u32>, Vec<i64>) {
    let mut first = vec![NONE; post.len()];
    let mut delta = vec![0i64; post.len()];
    for (rank, &column) in post.iter().enumerate() {
        if first[column as usize] == NONE {
            delta[column as usize] = weight(column);
        }
        let mut node = column;
        while node != NONE && first[node as usize] == NONE {
            first[node as usize] = rank as u32;
            node = parent[node as usize];
        }
    }
    (first, delta)
}
