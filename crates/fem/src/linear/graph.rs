//! Adjacency graph of a pattern, compressed to supervariables.

use super::pattern::SparsePattern;

const UNASSIGNED: u32 = u32::MAX;

/// Undirected graph of supervariables: unknowns with the same adjacency (the components of a node) are one vertex.
///
/// Vertices are numbered by their smallest unknown; neighbours are sorted and exclude the vertex itself.
#[derive(Debug, Clone)]
pub(super) struct Graph {
    pub(super) start: Vec<usize>,
    pub(super) neighbour: Vec<u32>,
    /// Unknowns in each vertex.
    pub(super) weight: Vec<u32>,
    member_start: Vec<u32>,
    member: Vec<u32>,
}

impl Graph {
    /// Compresses the graph of `pattern`.
    ///
    /// Two unknowns are equal if they are adjacent and their closed neighbourhoods agree in size and in a 64-bit sum
    /// of hashes. A collision would only worsen the order: every permutation of the vertices is valid.
    pub(super) fn compress(pattern: &SparsePattern) -> Self {
        let (vertex, representative) = group(pattern);
        let (start, neighbour) = adjacency(pattern, &vertex, &representative);
        let (member_start, member) = members(&vertex, representative.len());
        let weight = member_start.windows(2).map(|span| span[1] - span[0]).collect();
        Self { start, neighbour, weight, member_start, member }
    }

    pub(super) fn len(&self) -> usize {
        self.weight.len()
    }

    pub(super) fn neighbours(&self, vertex: u32) -> &[u32] {
        &self.neighbour[self.start[vertex as usize]..self.start[vertex as usize + 1]]
    }

    /// Order of the unknowns (new to old) from an order of the vertices.
    pub(super) fn expand(&self, order: &[u32]) -> Vec<u32> {
        let mut unknowns = Vec::with_capacity(self.member.len());
        for &vertex in order {
            let span = self.member_start[vertex as usize] as usize..self.member_start[vertex as usize + 1] as usize;
            unknowns.extend_from_slice(&self.member[span]);
        }
        unknowns
    }
}

/// Vertex of every unknown, and the smallest unknown of every vertex.
fn group(pattern: &SparsePattern) -> (Vec<u32>, Vec<u32>) {
    let (hash, degree) = signatures(pattern);
    let mut vertex = vec![UNASSIGNED; pattern.n()];
    let mut representative = Vec::new();
    for col in 0..pattern.n() {
        if vertex[col] != UNASSIGNED {
            continue;
        }
        let number = representative.len() as u32;
        representative.push(col as u32);
        vertex[col] = number;
        for &row in pattern.column(col) {
            let row = row as usize;
            if row > col && vertex[row] == UNASSIGNED && hash[row] == hash[col] && degree[row] == degree[col] {
                vertex[row] = number;
            }
        }
    }
    (vertex, representative)
}

/// Sum of hashes over, and size of, the closed neighbourhood of every unknown.
fn signatures(pattern: &SparsePattern) -> (Vec<u64>, Vec<u32>) {
    let n = pattern.n();
    let mut hash: Vec<u64> = (0..n).map(|i| mix(i as u64)).collect();
    let mut degree = vec![1u32; n];
    for col in 0..n {
        for &row in pattern.column(col).iter().filter(|&&row| row as usize > col) {
            let row = row as usize;
            hash[col] = hash[col].wrapping_add(mix(row as u64));
            hash[row] = hash[row].wrapping_add(mix(col as u64));
            degree[col] += 1;
            degree[row] += 1;
        }
    }
    (hash, degree)
}

/// Finaliser of the SplitMix64 generator.
fn mix(key: u64) -> u64 {
    let mut z = key.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Neighbours of every vertex. Adjacent vertices are adjacent through their representatives, the smaller of which
/// stores the other in its column.
fn adjacency(pattern: &SparsePattern, vertex: &[u32], representative: &[u32]) -> (Vec<usize>, Vec<u32>) {
    let edges = |number: usize, visit: &mut dyn FnMut(usize)| {
        let col = representative[number];
        for &row in pattern.column(col as usize).iter().filter(|&&row| row > col) {
            let other = vertex[row as usize] as usize;
            if representative[other] == row {
                visit(other);
            }
        }
    };
    let count = representative.len();
    let mut start = vec![0usize; count + 1];
    for number in 0..count {
        edges(number, &mut |other| {
            start[number + 1] += 1;
            start[other + 1] += 1;
        });
    }
    for i in 0..count {
        start[i + 1] += start[i];
    }
    let mut next = start.clone();
    let mut neighbour = vec![0u32; start[count]];
    for number in 0..count {
        edges(number, &mut |other| {
            neighbour[next[number]] = other as u32;
            next[number] += 1;
            neighbour[next[other]] = number as u32;
            next[other] += 1;
        });
    }
    (start, neighbour)
}

fn members(vertex: &[u32], count: usize) -> (Vec<u32>, Vec<u32>) {
    let mut start = vec![0u32; count + 1];
    for &number in vertex {
        start[number as usize + 1] += 1;
    }
    for i in 0..count {
        start[i + 1] += start[i];
    }
    let mut next = start.clone();
    let mut member = vec![0u32; vertex.len()];
    for (unknown, &number) in vertex.iter().enumerate() {
        member[next[number as usize] as usize] = unknown as u32;
        next[number as usize] += 1;
    }
    (start, member)
}
