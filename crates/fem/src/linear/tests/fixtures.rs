//! Matrices of slender elastic grids and random ones, with dense counterparts.

use nalgebra::{DMatrix, DVector, Matrix3, SMatrix, Vector3};

use crate::linear::{SparsePattern, Storage};

/// A reproducible stream of numbers (SplitMix64).
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in -1..1.
    pub fn signed(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    pub fn below(&mut self, limit: usize) -> usize {
        (self.next() % limit as u64) as usize
    }

    pub fn vector(&mut self, n: usize) -> Vec<f64> {
        (0..n).map(|_| self.signed()).collect()
    }

    pub fn permutation(&mut self, n: usize) -> Vec<u32> {
        let mut order: Vec<u32> = (0..n as u32).collect();
        for i in (1..n).rev() {
            order.swap(i, self.below(i + 1));
        }
        order
    }
}

/// Bricks of a grid of `nx` x `ny` x `nz` nodes, with the unknowns of their eight nodes.
pub struct Grid {
    pub n: usize,
    pub elements: Vec<Vec<u32>>,
}

impl Grid {
    pub fn new(nx: usize, ny: usize, nz: usize) -> Self {
        let node = |i: usize, j: usize, k: usize| i + nx * (j + ny * k);
        let mut elements = Vec::new();
        for k in 0..nz - 1 {
            for j in 0..ny - 1 {
                for i in 0..nx - 1 {
                    let corners = [(0, 0), (1, 0), (1, 1), (0, 1)];
                    let nodes = [k, k + 1].into_iter().flat_map(|k| corners.map(|(a, b)| node(i + a, j + b, k)));
                    elements.push(nodes.flat_map(|node| [0, 1, 2].map(|c| (3 * node + c) as u32)).collect());
                }
            }
        }
        Self { n: 3 * nx * ny * nz, elements }
    }

    /// The same grid with its unknowns renumbered: `new[old]`.
    pub fn renumbered(&self, new: &[u32]) -> Self {
        let rename = |dofs: &Vec<u32>| dofs.iter().map(|&dof| new[dof as usize]).collect();
        Self { n: self.n, elements: self.elements.iter().map(rename).collect() }
    }

    pub fn pattern(&self, storage: Storage) -> SparsePattern {
        SparsePattern::from_cliques(self.n, self.elements.iter().map(Vec::as_slice), storage).unwrap()
    }

    /// Sum of `element` over all bricks.
    pub fn assemble(&self, pattern: &SparsePattern, element: &SMatrix<f64, 24, 24>) -> Vec<f64> {
        let mut values = vec![0.0; pattern.nnz()];
        for dofs in &self.elements {
            for (i, &row) in dofs.iter().enumerate() {
                for (j, &col) in dofs.iter().enumerate() {
                    if let Some(slot) = pattern.slot(row as usize, col as usize) {
                        values[slot] += element[(i, j)];
                    }
                }
            }
        }
        values
    }
}

/// Stiffness of a unit cube of Young's modulus 1 and Poisson's ratio 0.3 with 2 x 2 x 2 points.
pub fn brick_stiffness() -> SMatrix<f64, 24, 24> {
    let (lambda, mu) = (0.3 / (1.3 * 0.4), 0.5 / 1.3);
    let corners = [(-1, -1), (1, -1), (1, 1), (-1, 1)];
    let nodes: Vec<Vector3<f64>> = [-1.0, 1.0]
        .into_iter()
        .flat_map(|z| corners.map(|(x, y)| Vector3::new(f64::from(x), f64::from(y), z)))
        .collect();
    let mut stiffness = SMatrix::<f64, 24, 24>::zeros();
    let point = 1.0 / 3f64.sqrt();
    for corner in &nodes {
        let at = corner * point;
        let gradient = |node: &Vector3<f64>| {
            let factor = |axis: usize| 1.0 + node[axis] * at[axis];
            0.25 * Vector3::new(
                node[0] * factor(1) * factor(2),
                node[1] * factor(0) * factor(2),
                node[2] * factor(0) * factor(1),
            )
        };
        for (a, first) in nodes.iter().map(gradient).enumerate() {
            for (b, second) in nodes.iter().map(gradient).enumerate() {
                let block = lambda * first * second.transpose()
                    + mu * second * first.transpose()
                    + mu * first.dot(&second) * Matrix3::identity();
                for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
                    stiffness[(3 * a + i, 3 * b + j)] += 0.125 * block[(i, j)];
                }
            }
        }
    }
    stiffness
}

/// Adds `stiffness` to the diagonal of the unknowns below `count`: an elastic foundation of one end.
pub fn hold(pattern: &SparsePattern, values: &mut [f64], count: usize, stiffness: f64) {
    for dof in 0..count {
        values[pattern.slot(dof, dof).unwrap()] += stiffness;
    }
}

/// Values of a clamped elastic strand of `nx` x `ny` x `nz` nodes.
pub fn strand(nx: usize, ny: usize, nz: usize, storage: Storage) -> (SparsePattern, Vec<f64>) {
    let grid = Grid::new(nx, ny, nz);
    let pattern = grid.pattern(storage);
    let mut values = grid.assemble(&pattern, &brick_stiffness());
    hold(&pattern, &mut values, 3 * nx * ny, 1.0);
    (pattern, values)
}

/// Random couplings of the unknowns of a clique list, symmetric with lower storage.
pub fn random_values(pattern: &SparsePattern, random: &mut Random, diagonal: f64) -> Vec<f64> {
    let mut values = random.vector(pattern.nnz());
    for dof in 0..pattern.n() {
        values[pattern.slot(dof, dof).unwrap()] += diagonal;
    }
    values
}

pub fn random_cliques(n: usize, count: usize, size: usize, random: &mut Random) -> Vec<Vec<u32>> {
    (0..count).map(|_| (0..size).map(|_| random.below(n) as u32).collect()).collect()
}

pub fn pattern_of(n: usize, cliques: &[Vec<u32>], storage: Storage) -> SparsePattern {
    SparsePattern::from_cliques(n, cliques.iter().map(Vec::as_slice), storage).unwrap()
}

pub fn dense(pattern: &SparsePattern, values: &[f64]) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(pattern.n(), pattern.n());
    for col in 0..pattern.n() {
        for &row in pattern.column(col) {
            let row = row as usize;
            let value = values[pattern.slot(row, col).unwrap()];
            matrix[(row, col)] = value;
            if pattern.storage() == Storage::Lower {
                matrix[(col, row)] = value;
            }
        }
    }
    matrix
}

pub fn dense_solution(pattern: &SparsePattern, values: &[f64], rhs: &[f64]) -> Vec<f64> {
    let solution = dense(pattern, values).full_piv_lu().solve(&DVector::from_column_slice(rhs)).unwrap();
    solution.as_slice().to_vec()
}

/// Largest difference relative to the largest entry of `expected`.
pub fn difference(actual: &[f64], expected: &[f64]) -> f64 {
    let largest = expected.iter().fold(0.0f64, |m, e| m.max(e.abs()));
    let worst = actual.iter().zip(expected).fold(0.0f64, |m, (a, e)| m.max((a - e).abs()));
    worst / largest.max(f64::MIN_POSITIVE)
}
