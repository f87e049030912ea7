//! An element's sums over nodes, with a node in each lane of a vector.
//!
//! The stiffness of a group of points, `K_(ak)(bm) = g_j(a) A_kjml g_l(b)`, is summed in registers, four nodes `a` by two
//! vectors of nodes `b` at a time.

#![allow(clippy::needless_range_loop, reason = "tensors are written by their indices, as in the formulas")]

use pulp::{NullaryFnOnce, Simd};
use subrope_material::LaneResponse;
use subrope_material::lanes::MAX_LANES;

use super::geometry::{BrickGeometry, Group, OnLine, ZERO};
use super::wide::Wide;

/// Per-node numbers of an element by component: `[component][node]`.
pub type NodeVector<const N: usize> = [[f64; N]; 3];

/// Element matrix, component-major: `[k][a][m][b]`.
pub type NodeMatrix<const N: usize> = [[[[f64; N]; 3]; N]; 3];

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

/// Numbers per node of the points of a group.
type GroupVectors<const N: usize> = [OnLine<NodeVector<N>>; MAX_LANES];

/// First elasticity tensors of the points of a group times their volumes, `[k][m][j][l][point]`.
pub(super) type Elasticity = [[[[Group; 3]; 3]; 3]; 3];

/// What the stiffness of a group of points is made of.
pub struct GroupBuffers<const N: usize> {
    /// `A_kjml`.
    pub(super) elasticity: Elasticity,
    /// `g_j(a)`.
    gradient: GroupVectors<N>,
    /// `A_kjml g_l(b)` for one `k` and `m`.
    product: GroupVectors<N>,
}

/// Room for the points of an element, made once for many.
pub struct Buffers<S: Simd, const N: usize> {
    pub(super) group: GroupBuffers<N>,
    /// The law's answer.
    pub(super) response: LaneResponse<Wide<S>>,
}

impl<S: Simd, const N: usize> Buffers<S, N> {
    /// All zero.
    #[inline(always)]
    pub fn zero(simd: S) -> Self {
        let zero = [OnLine([[0.0; N]; 3]); MAX_LANES];
        let group = GroupBuffers { elasticity: [[[[ZERO; 3]; 3]; 3]; 3], gradient: zero, product: zero };
        Self { group, response: LaneResponse::zero(Wide::new(simd, 0.0)) }
    }
}

/// Adds the stiffness of the group of points from `first` on, or begins with it when that is the first, once the
/// elasticity of its points stands in the buffer. When `SYMMETRIC` only entries whose row comes before their column are
/// meaningful afterwards, see [`mirror`].
#[inline(always)]
pub(super) fn add_group<S: Simd, const N: usize, const SYMMETRIC: bool>(
    simd: S,
    (brick, first): (BrickGeometry<'_, N>, usize),
    buffers: &mut GroupBuffers<N>,
    matrix: &mut NodeMatrix<N>,
) {
    simd.vectorize(AddGroup::<S, N, SYMMETRIC> { simd, brick, first, buffers, matrix });
}

/// [`add_group`], a function of its own for every element and instruction set: much less to compile.
struct AddGroup<'a, S, const N: usize, const SYMMETRIC: bool> {
    simd: S,
    brick: BrickGeometry<'a, N>,
    first: usize,
    buffers: &'a mut GroupBuffers<N>,
    matrix: &'a mut NodeMatrix<N>,
}

impl<S: Simd, const N: usize, const SYMMETRIC: bool> NullaryFnOnce for AddGroup<'_, S, N, SYMMETRIC> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { simd, brick, first, buffers, matrix } = self;
        let GroupBuffers { elasticity, gradient, product } = buffers;
        let points = MAX_LANES.min(brick.points() - first);
        let (gradient, product) = (&mut gradient[..points], &mut product[..points]);
        let to_fibre = &brick.group(first).to_fibre;
        for (q, (map, out)) in brick.by_point(first, points).iter().zip(gradient.iter_mut()).enumerate() {
            for j in 0..3 {
                combine(simd, point_of(&to_fibre[j], q), &map.0, &mut out.0[j]);
            }
        }
        for m in 0..3 {
            for k in 0..if SYMMETRIC { m + 1 } else { 3 } {
                let elasticity = &elasticity[k][m];
                for (q, (gradient, out)) in gradient.iter().zip(product.iter_mut()).enumerate() {
                    for j in 0..3 {
                        combine(simd, point_of(&elasticity[j], q), &gradient.0, &mut out.0[j]);
                    }
                }
                let fresh = first == 0;
                let block = Block { upper: SYMMETRIC && k == m, fresh, column: m, rows: &mut matrix[k] };
                add_products(simd, gradient, product, block);
            }
        }
    }
}

/// The numbers of a point of a group.
#[inline(always)]
fn point_of(numbers: &[Group; 3], point: usize) -> [f64; 3] {
    [numbers[0].0[point], numbers[1].0[point], numbers[2].0[point]]
}

/// `out_k(a) += sum_(points, i) t_ki dN_a/dxi_i`, `t` by `[k][i][point]`.
#[inline(always)]
pub(super) fn add_forces<S: Simd, const N: usize>(
    simd: S,
    map: &[OnLine<NodeVector<N>>],
    t: &[[[f64; MAX_LANES]; 3]; 3],
    out: &mut NodeVector<N>,
) {
    for vector in 0..N / S::F64_LANES {
        let mut sums = [simd.splat_f64s(0.0); 3];
        for (lane, map) in map.iter().enumerate() {
            for i in 0..3 {
                let line = S::as_simd_f64s(&map.0[i]).0[vector];
                for k in 0..3 {
                    sums[k] = simd.mul_add_e_f64s(simd.splat_f64s(t[k][i][lane]), line, sums[k]);
                }
            }
        }
        for k in 0..3 {
            let entry = &mut S::as_mut_simd_f64s(&mut out[k]).0[vector];
            *entry = simd.add_f64s(*entry, sums[k]);
        }
    }
    for a in N - N % S::F64_LANES..N {
        for k in 0..3 {
            for (lane, map) in map.iter().enumerate() {
                out[k][a] += t[k][0][lane] * map.0[0][a] + t[k][1][lane] * map.0[1][a] + t[k][2][lane] * map.0[2][a];
            }
        }
    }
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

/// `out[a][b] += sum_(points, j) g_j(a) products[point][j][b]`.
#[inline(always)]
pub(super) fn add_products<S: Simd, const N: usize>(
    simd: S,
    gradients: &[OnLine<NodeVector<N>>],
    products: &[OnLine<NodeVector<N>>],
    mut out: Block<'_, N>,
) {
    let lanes = S::F64_LANES;
    let whole = N / lanes;
    for first in (0..N).step_by(ROWS) {
        let mut vector = if out.upper { first / lanes } else { 0 };
        if first + ROWS <= N {
            while vector + 2 <= whole {
                add_block::<S, N, ROWS, 2>(simd, gradients, products, (first, vector), &mut out);
                vector += 2;
            }
            while vector < whole {
                add_block::<S, N, ROWS, 1>(simd, gradients, products, (first, vector), &mut out);
                vector += 1;
            }
        } else {
            for a in first..N {
                for vector in vector..whole {
                    add_block::<S, N, 1, 1>(simd, gradients, products, (a, vector), &mut out);
                }
            }
        }
        add_rest(gradients, products, first..N.min(first + ROWS), whole * lanes, &mut out);
    }
}

/// A block of `R` rows and `C` vectors, summed in registers.
#[inline(always)]
fn add_block<S: Simd, const N: usize, const R: usize, const C: usize>(
    simd: S,
    gradients: &[OnLine<NodeVector<N>>],
    products: &[OnLine<NodeVector<N>>],
    (first, vector): (usize, usize),
    out: &mut Block<'_, N>,
) {
    let mut sums = [[simd.splat_f64s(0.0); C]; R];
    if C == 1 {
        // Few sums would wait for each other: those of every other point are kept apart.
        let mut others = sums;
        let (mut gradients, mut products) = (gradients.chunks_exact(2), products.chunks_exact(2));
        for (gradients, products) in (&mut gradients).zip(&mut products) {
            add_point(simd, (&gradients[0], &products[0]), (first, vector), &mut sums);
            add_point(simd, (&gradients[1], &products[1]), (first, vector), &mut others);
        }
        for point in gradients.remainder().iter().zip(products.remainder()) {
            add_point(simd, point, (first, vector), &mut sums);
        }
        for r in 0..R {
            sums[r][0] = simd.add_f64s(sums[r][0], others[r][0]);
        }
    } else {
        for point in gradients.iter().zip(products) {
            add_point(simd, point, (first, vector), &mut sums);
        }
    }
    for (r, sums) in sums.iter().enumerate() {
        let line = &mut S::as_mut_simd_f64s(&mut out.rows[first + r][out.column]).0[vector..vector + C];
        for (entry, &sum) in line.iter_mut().zip(sums) {
            *entry = if out.fresh { sum } else { simd.add_f64s(*entry, sum) };
        }
    }
}

/// What a point adds to a block.
#[inline(always)]
fn add_point<S: Simd, const N: usize, const R: usize, const C: usize>(
    simd: S,
    (gradient, product): (&OnLine<NodeVector<N>>, &OnLine<NodeVector<N>>),
    (first, vector): (usize, usize),
    sums: &mut [[S::f64s; C]; R],
) {
    for j in 0..3 {
        let line = &S::as_simd_f64s(&product.0[j]).0[vector..vector + C];
        let factors = &gradient.0[j][first..first + R];
        for r in 0..R {
            let factor = simd.splat_f64s(factors[r]);
            for c in 0..C {
                sums[r][c] = simd.mul_add_e_f64s(factor, line[c], sums[r][c]);
            }
        }
    }
}

/// The nodes that fill no vector.
#[inline(always)]
fn add_rest<const N: usize>(
    gradients: &[OnLine<NodeVector<N>>],
    products: &[OnLine<NodeVector<N>>],
    rows: std::ops::Range<usize>,
    first: usize,
    out: &mut Block<'_, N>,
) {
    for a in rows {
        for b in first..N {
            let entry = &mut out.rows[a][out.column][b];
            let mut sum = if out.fresh { 0.0 } else { *entry };
            for (g, t) in gradients.iter().zip(products) {
                sum += g.0[0][a] * t.0[0][b] + g.0[1][a] * t.0[1][b] + g.0[2][a] * t.0[2][b];
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

/// `out += factor from`.
#[inline(always)]
fn add_multiple<S: Simd, const N: usize>(simd: S, factor: f64, from: &[f64; N], out: &mut [f64; N]) {
    let ((from, from_rest), (out, out_rest)) = (S::as_simd_f64s(from), S::as_mut_simd_f64s(out));
    let vector = simd.splat_f64s(factor);
    for (out, &from) in out.iter_mut().zip(from) {
        *out = simd.mul_add_e_f64s(vector, from, *out);
    }
    for (out, from) in out_rest.iter_mut().zip(from_rest) {
        *out += factor * from;
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
