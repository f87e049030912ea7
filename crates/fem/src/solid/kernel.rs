//! An element's sums over nodes, with a node in each lane of a vector.
//!
//! The stiffness of a pack of points, `K_(ak)(bm) = g_j(a) A_kjml g_l(b)`, is summed in registers, four nodes `a` by two
//! vectors of nodes `b` at a time.

#![allow(clippy::needless_range_loop, reason = "tensors are written by their indices, as in the formulas")]

use nalgebra::Matrix3;
use pulp::Simd;
use subrope_material::lanes::MAX_LANES;

/// Per-node numbers of an element by component: `[component][node]`.
pub type NodeVector<const N: usize> = [[f64; N]; 3];

/// Element matrix, component-major: `[k][a][m][b]`.
pub type NodeMatrix<const N: usize> = [[[[f64; N]; 3]; N]; 3];

/// Geometry of an integration point, formed once.
#[derive(Clone, Debug)]
pub struct PointGeometry<const N: usize> {
    /// Gradients by fibre-frame coordinates \[1/mm\].
    pub gradient: NodeVector<N>,
    /// Fibre frame, columns e1 e2 e3.
    pub frame: Matrix3<f64>,
    /// Reference volume of the point \[mm^3\].
    pub volume: f64,
}

/// Scalar product of two lists.
#[inline(always)]
pub(super) fn dot<S: Simd, const N: usize>(simd: S, a: &[f64; N], b: &[f64; N]) -> f64 {
    let ((a, a_rest), (b, b_rest)) = (S::as_simd_f64s(a), S::as_simd_f64s(b));
    let mut products = simd.splat_f64s(0.0);
    for (&a, &b) in a.iter().zip(b) {
        products = simd.mul_add_e_f64s(a, b, products);
    }
    let mut sum = simd.reduce_sum_f64s(products);
    for (a, b) in a_rest.iter().zip(b_rest) {
        sum += a * b;
    }
    sum
}

/// `out += factor from`.
#[inline(always)]
pub(super) fn add_multiple<S: Simd, const N: usize>(simd: S, factor: f64, from: &[f64; N], out: &mut [f64; N]) {
    let ((from, from_rest), (out, out_rest)) = (S::as_simd_f64s(from), S::as_mut_simd_f64s(out));
    let vector = simd.splat_f64s(factor);
    for (out, &from) in out.iter_mut().zip(from) {
        *out = simd.mul_add_e_f64s(vector, from, *out);
    }
    for (out, from) in out_rest.iter_mut().zip(from_rest) {
        *out += factor * from;
    }
}

/// `out = sum_l factors[l] g_l`.
#[inline(always)]
pub(super) fn combine<S: Simd, const N: usize>(simd: S, factors: [f64; 3], g: &NodeVector<N>, out: &mut [f64; N]) {
    let [x, y, z] = [S::as_simd_f64s(&g[0]), S::as_simd_f64s(&g[1]), S::as_simd_f64s(&g[2])];
    let (whole, rest) = S::as_mut_simd_f64s(out);
    let [a, b, c] = [simd.splat_f64s(factors[0]), simd.splat_f64s(factors[1]), simd.splat_f64s(factors[2])];
    for (i, out) in whole.iter_mut().enumerate() {
        *out = simd.mul_add_e_f64s(c, z.0[i], simd.mul_add_e_f64s(b, y.0[i], simd.mul_f64s(a, x.0[i])));
    }
    for (i, out) in rest.iter_mut().enumerate() {
        *out = factors[0] * x.1[i] + factors[1] * y.1[i] + factors[2] * z.1[i];
    }
}

/// `A_kjml g_l(b)` of the points of a pack, for one `k` and `m`.
pub type PointProducts<const N: usize> = [NodeVector<N>; MAX_LANES];

/// The stiffness of an element while it is summed.
pub struct Stiffness<'a, const N: usize> {
    /// Sums.
    pub matrix: &'a mut NodeMatrix<N>,
    /// Buffer.
    pub product: &'a mut PointProducts<N>,
}

/// Entries of one row component and one column component.
pub(super) struct Block<'a, const N: usize> {
    /// Whether only `b >= a` matters.
    pub(super) upper: bool,
    /// Whether to begin.
    pub(super) fresh: bool,
    pub(super) column: usize,
    pub(super) rows: &'a mut [[[f64; N]; 3]; N],
}

/// Rows whose sums are in registers together.
const ROWS: usize = 4;

/// `out[a][b] += sum_(points, j) g_j(a) product[point][j][b]`.
#[inline(always)]
pub(super) fn add_products<S: Simd, const N: usize>(
    simd: S,
    points: &[PointGeometry<N>],
    product: &PointProducts<N>,
    mut out: Block<'_, N>,
) {
    let lanes = S::F64_LANES;
    let whole = N / lanes;
    for first in (0..N).step_by(ROWS) {
        let mut vector = if out.upper { first / lanes } else { 0 };
        if first + ROWS <= N {
            while vector + 2 <= whole {
                add_block::<S, N, ROWS, 2>(simd, points, product, (first, vector), &mut out);
                vector += 2;
            }
            while vector < whole {
                add_block::<S, N, ROWS, 1>(simd, points, product, (first, vector), &mut out);
                vector += 1;
            }
        } else {
            for a in first..N {
                for vector in vector..whole {
                    add_block::<S, N, 1, 1>(simd, points, product, (a, vector), &mut out);
                }
            }
        }
        add_rest(points, product, first..N.min(first + ROWS), whole * lanes, &mut out);
    }
}

/// A block of `R` rows and `C` vectors, summed in registers.
#[inline(always)]
fn add_block<S: Simd, const N: usize, const R: usize, const C: usize>(
    simd: S,
    points: &[PointGeometry<N>],
    product: &PointProducts<N>,
    (first, vector): (usize, usize),
    out: &mut Block<'_, N>,
) {
    let mut sums = [[simd.splat_f64s(0.0); C]; R];
    for (point, product) in points.iter().zip(product) {
        for j in 0..3 {
            let line = &S::as_simd_f64s(&product[j]).0[vector..vector + C];
            let factors = &point.gradient[j][first..first + R];
            for r in 0..R {
                let factor = simd.splat_f64s(factors[r]);
                for c in 0..C {
                    sums[r][c] = simd.mul_add_e_f64s(factor, line[c], sums[r][c]);
                }
            }
        }
    }
    for (r, sums) in sums.iter().enumerate() {
        let line = &mut S::as_mut_simd_f64s(&mut out.rows[first + r][out.column]).0[vector..vector + C];
        for (entry, &sum) in line.iter_mut().zip(sums) {
            *entry = if out.fresh { sum } else { simd.add_f64s(*entry, sum) };
        }
    }
}

/// The nodes that fill no vector.
#[inline(always)]
fn add_rest<const N: usize>(
    points: &[PointGeometry<N>],
    product: &PointProducts<N>,
    rows: std::ops::Range<usize>,
    first: usize,
    out: &mut Block<'_, N>,
) {
    for a in rows {
        for b in first..N {
            let entry = &mut out.rows[a][out.column][b];
            let mut sum = if out.fresh { 0.0 } else { *entry };
            for (point, t) in points.iter().zip(product) {
                let g = &point.gradient;
                sum += g[0][a] * t[0][b] + g[1][a] * t[1][b] + g[2][a] * t[2][b];
            }
            *entry = sum;
        }
    }
}

/// Completes the entries with row node <= column node of a symmetric matrix whose entries with row component > column
/// component have not been formed.
#[inline(always)]
pub fn mirror<const N: usize>(matrix: &mut NodeMatrix<N>) {
    for (k, m) in [(1, 0), (2, 0), (2, 1)] {
        for a in 0..N {
            for b in a..N {
                matrix[k][a][m][b] = matrix[m][b][k][a];
            }
        }
    }
}

/// Adds `left (x) right + (right (x) next)`, as one product per row: `left_k(a) right + right_k(a) next`. When `SYMMETRIC`
/// only `k <= m`.
#[inline(always)]
pub fn add_dyads<S: Simd, const N: usize, const SYMMETRIC: bool>(
    simd: S,
    left: &NodeVector<N>,
    right: &NodeVector<N>,
    next: &NodeVector<N>,
    out: &mut NodeMatrix<N>,
) {
    for k in 0..3 {
        for a in 0..N {
            for m in if SYMMETRIC { k } else { 0 }..3 {
                add_multiple(simd, left[k][a], &right[m], &mut out[k][a][m]);
                add_multiple(simd, right[k][a], &next[m], &mut out[k][a][m]);
            }
        }
    }
}
