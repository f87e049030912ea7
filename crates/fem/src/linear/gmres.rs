//! GMRES with a preconditioner on the right (Saad and Schultz 1986; Saad, "Iterative methods for sparse linear systems",
//! 2003, chapter 9): minimises `|b - A x|` over a Krylov space.

use super::error::LinearError;
use super::solver::{add, check_solution};

/// How far to iterate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GmresLimits {
    /// Relative residual that ends the iteration.
    pub target: f64,
    /// Largest relative residual that is still a useful correction.
    pub limit: f64,
    /// Most iterations.
    pub most: usize,
    /// Iterations after which their rate is believed: the iteration ends where it leads nowhere in time.
    pub trusted: usize,
}

impl Default for GmresLimits {
    /// Newton's residual falls by the target at best: two more of its iterations are cheaper than the digits.
    fn default() -> Self {
        Self { target: 1e-7, limit: 1e-2, most: 80, trusted: 80 }
    }
}

/// A linear map and an approximation of its inverse.
pub trait LinearOperator {
    /// `out = A x`.
    ///
    /// # Errors
    /// [`LinearError`].
    fn apply(&mut self, x: &[f64], out: &mut [f64]) -> Result<(), LinearError>;

    /// `out = P^-1 x`.
    ///
    /// # Errors
    /// [`LinearError`].
    fn precondition(&mut self, x: &[f64], out: &mut [f64]) -> Result<(), LinearError>;
}

/// What a solution took.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GmresReport {
    /// Iterations.
    pub iterations: usize,
    /// `|b - A x| / |b|`.
    pub residual: f64,
}

/// Buffers of repeated solutions.
#[derive(Default)]
pub struct Gmres {
    /// Orthonormal basis of the Krylov space.
    basis: Vec<Vec<f64>>,
    /// Its preconditioned vectors, whose combination is the solution.
    directions: Vec<Vec<f64>>,
    /// Triangular factor of the Hessenberg matrix, column by column.
    columns: Vec<Vec<f64>>,
    rotations: Vec<(f64, f64)>,
    /// Rotated right-hand side; its last entry is the norm of the residual.
    reduced: Vec<f64>,
}

impl Gmres {
    /// Solves `A x = b`.
    ///
    /// # Errors
    /// [`LinearError::Stalled`] when the residual stays above the limit; errors of the operator.
    pub fn solve(
        &mut self,
        operator: &mut dyn LinearOperator,
        limits: &GmresLimits,
        b: &[f64],
        x: &mut [f64],
    ) -> Result<GmresReport, LinearError> {
        x.fill(0.0);
        let norm = dot(b, b).sqrt();
        if norm == 0.0 {
            return Ok(GmresReport { iterations: 0, residual: 0.0 });
        }
        self.start(b, norm);
        let mut iterations = 0;
        while iterations < limits.most && self.residual() > limits.target * norm {
            self.extend(operator, iterations)?;
            iterations += 1;
            if hopeless(self.residual() / norm, iterations, limits) {
                break;
            }
            // The space is exhausted: the solution is exact.
            if self.reduced[iterations] == 0.0 {
                break;
            }
        }
        let residual = self.residual() / norm;
        if residual.is_nan() || residual > limits.limit {
            return Err(LinearError::Stalled { iterations, residual, limit: limits.limit });
        }
        self.combine(iterations, x);
        check_solution(x)?;
        Ok(GmresReport { iterations, residual })
    }

    fn start(&mut self, b: &[f64], norm: f64) {
        resize(&mut self.basis, 0, b.len());
        self.basis[0].iter_mut().zip(b).for_each(|(v, b)| *v = b / norm);
        self.rotations.clear();
        self.reduced.clear();
        self.reduced.push(norm);
    }

    fn residual(&self) -> f64 {
        self.reduced.last().map_or(0.0, |r| r.abs())
    }

    /// One step of Arnoldi's method, by modified Gram and Schmidt, and its rotation.
    fn extend(&mut self, operator: &mut dyn LinearOperator, k: usize) -> Result<(), LinearError> {
        let n = self.basis[k].len();
        resize(&mut self.directions, k, n);
        resize(&mut self.basis, k + 1, n);
        if self.columns.len() <= k {
            self.columns.push(Vec::with_capacity(k + 1));
        }
        operator.precondition(&self.basis[k], &mut self.directions[k])?;
        let (old, new) = self.basis.split_at_mut(k + 1);
        let vector = &mut new[0];
        operator.apply(&self.directions[k], vector)?;
        let column = &mut self.columns[k];
        column.clear();
        for v in old {
            let h = dot(v, vector);
            add(vector, v, -h);
            column.push(h);
        }
        let rest = dot(vector, vector).sqrt();
        if rest > 0.0 {
            vector.iter_mut().for_each(|w| *w /= rest);
        }
        for (i, &(c, s)) in self.rotations.iter().enumerate() {
            (column[i], column[i + 1]) = (c * column[i] + s * column[i + 1], c * column[i + 1] - s * column[i]);
        }
        let length = column[k].hypot(rest);
        let (c, s) = if length > 0.0 { (column[k] / length, rest / length) } else { (1.0, 0.0) };
        column[k] = length;
        self.rotations.push((c, s));
        let last = self.reduced[k];
        self.reduced[k] = c * last;
        self.reduced.push(-s * last);
        Ok(())
    }

    /// Solves the triangular system and combines the directions.
    fn combine(&mut self, k: usize, x: &mut [f64]) {
        for i in (0..k).rev() {
            let (head, tail) = self.reduced.split_at_mut(i);
            let factor = tail[0] / self.columns[i][i];
            tail[0] = factor;
            add(head, &self.columns[i], -factor);
            add(x, &self.directions[i], factor);
        }
    }
}

/// Whether at the rate so far a useful correction is out of reach, with a factor of two in favour of going on.
fn hopeless(residual: f64, iterations: usize, limits: &GmresLimits) -> bool {
    let reach = 2.0 * limits.most as f64 / iterations as f64;
    iterations >= limits.trusted && residual.powf(reach) > limits.limit
}

fn resize(vectors: &mut Vec<Vec<f64>>, at: usize, n: usize) {
    if vectors.len() <= at {
        vectors.resize_with(at + 1, Vec::new);
    }
    vectors[at].resize(n, 0.0);
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A symmetric part that the preconditioner inverts and products that it does not know.
    struct Shifted {
        diagonal: Vec<f64>,
        rows: Vec<Vec<f64>>,
        columns: Vec<Vec<f64>>,
    }

    impl LinearOperator for Shifted {
        fn apply(&mut self, x: &[f64], out: &mut [f64]) -> Result<(), LinearError> {
            out.iter_mut().zip(x).zip(&self.diagonal).for_each(|((o, x), d)| *o = d * x);
            for (row, column) in self.rows.iter().zip(&self.columns) {
                let factor = dot(column, x);
                out.iter_mut().zip(row).for_each(|(o, r)| *o += factor * r);
            }
            Ok(())
        }

        fn precondition(&mut self, x: &[f64], out: &mut [f64]) -> Result<(), LinearError> {
            out.iter_mut().zip(x).zip(&self.diagonal).for_each(|((o, x), d)| *o = x / d);
            Ok(())
        }
    }

    fn wave(n: usize, seed: f64) -> Vec<f64> {
        (0..n).map(|i| (seed * (i as f64 + 1.0)).sin()).collect()
    }

    #[test]
    fn products_of_rank_four_take_five_iterations() {
        let n = 60;
        let mut operator = Shifted {
            diagonal: (0..n).map(|i| 1.0 + i as f64).collect(),
            rows: (1..5).map(|k| wave(n, 0.7 * f64::from(k))).collect(),
            columns: (1..5).map(|k| wave(n, 1.3 * f64::from(k))).collect(),
        };
        let (b, mut x, mut back) = (wave(n, 0.3), vec![0.0; n], vec![0.0; n]);
        let mut gmres = Gmres::default();
        for _ in 0..2 {
            let report =
                gmres.solve(&mut operator, &GmresLimits::default(), &b, &mut x).unwrap_or_else(|e| unreachable!("{e}"));
            assert!(report.iterations <= 5, "{report:?}");
            operator.apply(&x, &mut back).unwrap_or_else(|e| unreachable!("{e}"));
            let error: f64 = b.iter().zip(&back).map(|(b, a)| (b - a) * (b - a)).sum();
            assert!((error.sqrt() / dot(&b, &b).sqrt() - report.residual).abs() < 1e-10, "{report:?} {error:e}");
        }
    }

    #[test]
    fn what_it_cannot_solve_is_an_error() {
        struct Zero;
        impl LinearOperator for Zero {
            fn apply(&mut self, _: &[f64], out: &mut [f64]) -> Result<(), LinearError> {
                out.fill(0.0);
                Ok(())
            }
            fn precondition(&mut self, x: &[f64], out: &mut [f64]) -> Result<(), LinearError> {
                out.copy_from_slice(x);
                Ok(())
            }
        }
        let outcome = Gmres::default().solve(&mut Zero, &GmresLimits::default(), &[1.0, 2.0], &mut [0.0, 0.0]);
        assert!(matches!(outcome, Err(LinearError::Stalled { .. } | LinearError::NonFinite { .. })), "{outcome:?}");
        let outcome = Gmres::default().solve(&mut Zero, &GmresLimits::default(), &[f64::NAN, 2.0], &mut [0.0, 0.0]);
        assert!(outcome.is_err());
    }
}
