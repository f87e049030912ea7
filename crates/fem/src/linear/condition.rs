//! How ill-conditioned a symmetric matrix is.
//!
//! `kappa_1 = |B|_1 |B^-1|_1` of `B = D A D` with `D = |diag A|^(-1/2)`: scaled to a unit diagonal, so that neither units nor
//! rotations beside displacements count. `|B|_1` is exact. `|B^-1|_1` is Hager's estimate from below with Higham's
//! alternating vector (N. J. Higham, ACM Trans. Math. Softw. 14 (1988) 381, algorithm 4.1 for symmetric matrices): at most
//! eleven solves with the factors at hand, in practice within a factor of three.

use super::error::LinearError;
use super::pattern::{SparsePattern, Storage};

/// Most rounds of the estimate; two are the rule.
const ROUNDS: usize = 5;

/// Estimate of the condition number of a symmetric matrix; `solve` applies its inverse.
///
/// # Errors
/// What `solve` answers.
pub(super) fn condition(
    (pattern, values): (&SparsePattern, &[f64]),
    mut solve: impl FnMut(&[f64], &mut [f64]) -> Result<(), LinearError>,
) -> Result<f64, LinearError> {
    let n = pattern.n();
    if n == 0 {
        return Ok(1.0);
    }
    let root = diagonal_roots(pattern, values);
    let norm = scaled_norm(pattern, values, &root);
    let mut buffer = vec![0.0; n];
    // B^-1 = D^-1 A^-1 D^-1.
    let mut inverse = |x: &[f64], y: &mut [f64]| -> Result<(), LinearError> {
        buffer.iter_mut().zip(x).zip(&root).for_each(|((b, x), r)| *b = x * r);
        solve(&buffer, y)?;
        y.iter_mut().zip(&root).for_each(|(y, r)| *y *= r);
        Ok(())
    };
    Ok(norm * inverse_norm(n, &mut inverse)?)
}

/// Estimate of `|B^-1|_1` of a symmetric `B`.
fn inverse_norm(
    n: usize,
    inverse: &mut impl FnMut(&[f64], &mut [f64]) -> Result<(), LinearError>,
) -> Result<f64, LinearError> {
    let (mut x, mut y, mut z) = (vec![1.0 / n as f64; n], vec![0.0; n], vec![0.0; n]);
    let mut estimate = 0.0_f64;
    for round in 0..ROUNDS {
        inverse(&x, &mut y)?;
        let now = sum(&y);
        if round > 0 && now <= estimate {
            break;
        }
        estimate = now;
        y.iter_mut().for_each(|y| *y = 1.0_f64.copysign(*y));
        inverse(&y, &mut z)?;
        let along: f64 = z.iter().zip(&x).map(|(z, x)| z * x).sum();
        let largest = (0..n).max_by(|&a, &b| z[a].abs().total_cmp(&z[b].abs())).unwrap_or(0);
        if round > 0 && z[largest].abs() <= along {
            break;
        }
        x.fill(0.0);
        x[largest] = 1.0;
    }
    // A vector on which no cancellation can hide the norm.
    let step = 1.0 / (n.max(2) - 1) as f64;
    x.iter_mut().enumerate().for_each(|(i, x)| *x = if i % 2 == 0 { 1.0 } else { -1.0 } * (1.0 + i as f64 * step));
    inverse(&x, &mut y)?;
    Ok(estimate.max(2.0 * sum(&y) / (3.0 * n as f64)))
}

fn sum(vector: &[f64]) -> f64 {
    vector.iter().map(|v| v.abs()).sum()
}

/// `|a_ii|^(1/2)`; one where the diagonal vanishes.
fn diagonal_roots(pattern: &SparsePattern, values: &[f64]) -> Vec<f64> {
    let root = |i| pattern.slot(i, i).map_or(0.0, |slot| values[slot].abs().sqrt());
    (0..pattern.n()).map(root).map(|r| if r > 0.0 { r } else { 1.0 }).collect()
}

/// Largest sum of a column of `B`.
fn scaled_norm(pattern: &SparsePattern, values: &[f64], root: &[f64]) -> f64 {
    let mirror = pattern.storage() == Storage::Lower;
    let mut sums = vec![0.0; pattern.n()];
    for col in 0..pattern.n() {
        let start = pattern.column_pointers()[col];
        for (offset, &row) in pattern.column(col).iter().enumerate() {
            let row = row as usize;
            let size = values[start + offset].abs() / (root[row] * root[col]);
            sums[col] += size;
            if mirror && row != col {
                sums[row] += size;
            }
        }
    }
    sums.into_iter().fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::condition;
    use crate::linear::{LinearSolver, SolverOptions, SparsePattern, Storage};

    /// A chain of springs of which one is `soft`, held at its left end.
    fn chain(n: usize, soft: f64) -> f64 {
        let cliques: Vec<Vec<u32>> = (1..n as u32).map(|i| vec![i - 1, i]).collect();
        let pattern = SparsePattern::from_cliques(n, cliques.iter().map(Vec::as_slice), Storage::Lower)
            .unwrap_or_else(|e| panic!("{e}"));
        let mut values = vec![0.0; pattern.nnz()];
        let mut add = |row: usize, col: usize, v: f64| values[pattern.slot(row, col).unwrap_or(0)] += v;
        add(0, 0, 1.0);
        for i in 1..n {
            let k = if i == n / 2 { soft } else { 1.0 };
            add(i - 1, i - 1, k);
            add(i, i, k);
            add(i, i - 1, -k);
        }
        let mut solver = LinearSolver::analyse(&pattern, &SolverOptions::default()).unwrap_or_else(|e| panic!("{e}"));
        solver.factorise(&values).unwrap_or_else(|e| panic!("{e}"));
        let solve = |b: &[f64], x: &mut [f64]| solver.solve_once(&values, b, x);
        condition((&pattern, &values), solve).unwrap_or_else(|e| panic!("{e}"))
    }

    #[test]
    fn a_diagonal_matrix_is_of_condition_one_whatever_its_units() {
        let cliques: [&[u32]; 4] = [&[0], &[1], &[2], &[3]];
        let pattern = SparsePattern::from_cliques(4, cliques, Storage::Lower).unwrap_or_else(|e| panic!("{e}"));
        let values = [1e-6, 3.0, 1e9, 7.0];
        let solve = |b: &[f64], x: &mut [f64]| {
            x.iter_mut().zip(b).zip(values).for_each(|((x, b), v)| *x = b / v);
            Ok(())
        };
        let found = condition((&pattern, &values), solve).unwrap_or_else(|e| panic!("{e}"));
        assert!((found - 1.0).abs() < 1e-14, "{found}");
    }

    /// Of a uniform chain the inverse is known: `(A^-1)_ij = min(i, j)` from 1, its last column adds up to `n (n + 1)/2`.
    #[test]
    fn the_condition_of_a_chain_of_springs_is_met() {
        let n = 40;
        let exact_column = |col: usize| -> f64 {
            let root = |i: usize| if i == n { 1.0_f64 } else { 2.0_f64 }.sqrt();
            (1..=n).map(|i| i.min(col) as f64 * root(i) * root(col)).sum()
        };
        let inverse = (1..=n).map(exact_column).fold(0.0, f64::max);
        let norm = 1.0 + 0.5_f64.sqrt();
        let exact = inverse * norm.max(2.0);
        let found = chain(n, 1.0);
        assert!(found <= exact * 1.21 && found > exact / 3.0, "{found} against {exact}");
        let soft = chain(n, 1e-6);
        assert!(soft > 1e4 * found, "{soft} against {found}");
    }
}
