//! The element's inner loops: gradients, forces and stiffness of its integration points.
//!
//! Everything is written for shape-function gradients by *fibre-frame* coordinates, `g_j(a) = dN_a/dX_j`, formed once
//! from the reference mesh. With `R` the fibre frame (columns e1 e2 e3) and `H = grad u`:
//! `HR_kj = sum_a u_k(a) g_j(a)`, `FR = R + HR` (spatial rows, fibre-frame columns), `H_f = R^T HR` for the law.
//! Then `dE_ij = sym(FR_ki g_j(a)) du_k(a)`, the force is `P_kj g_j` with `P = FR S`, and the stiffness is
//! `K_(ak)(bm) = g_j(a) A_kjml g_l(b)` with `A_kjml = FR_ki D_(ij)(pl) FR_mp + delta_km S_jl`.
//!
//! Points go together in *packs*, one point in each lane of a vector, up to `A`; sums over nodes have a node in each
//! lane, and the stiffness of a pack is summed in registers, four nodes by two vectors at a time.

#![allow(clippy::needless_range_loop, reason = "tensors are written by their indices, as in the formulas")]

use nalgebra::Matrix3;
use pulp::{NullaryFnOnce, Simd};
use subrope_material::lanes::{Lanes, MAX_LANES};

use super::wide::Wide;

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

/// `1/sqrt(2)`: from a Mandel shear entry to the tensor's.
const HALF_ROOT: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Mandel index of a symmetric pair.
pub const MANDEL: [[usize; 3]; 3] = [[0, 3, 4], [3, 1, 5], [4, 5, 2]];

/// Factor from a Mandel entry to the tensor's.
const FACTOR: [f64; 6] = [1.0, 1.0, 1.0, HALF_ROOT, HALF_ROOT, HALF_ROOT];

/// `HR = sum_a u(a) g(a)^T`.
#[inline(always)]
pub fn mixed_gradient<const N: usize>(u: &NodeVector<N>, g: &NodeVector<N>) -> Matrix3<f64> {
    Matrix3::from_fn(|k, j| (0..N).map(|a| u[k][a] * g[j][a]).sum())
}

/// A pack of integration points: one in each lane, the last repeated in lanes that are left over.
#[derive(Clone, Copy, Debug)]
pub struct Pack<'a, S: Simd, const N: usize> {
    simd: S,
    /// The points.
    pub points: &'a [PointGeometry<N>],
    /// `FR = R + HR`.
    pub fr: [[Wide<S>; 3]; 3],
    /// `H_f = R^T HR`.
    pub gradient: [[Wide<S>; 3]; 3],
    /// Reference volumes \[mm^3\].
    pub volume: Wide<S>,
}

impl<'a, S: Simd, const N: usize> Pack<'a, S, N> {
    /// Kinematics of at most as many points as there are lanes.
    #[inline(always)]
    pub fn new(simd: S, points: &'a [PointGeometry<N>], displacement: &NodeVector<N>) -> Self {
        simd.vectorize(NewPack { simd, points, displacement })
    }

    #[inline(always)]
    fn form(simd: S, points: &'a [PointGeometry<N>], u: &NodeVector<N>) -> Self {
        let (zero, last) = (Wide::new(simd, 0.0), points.len() - 1);
        let mut numbers = [[[0.0; MAX_LANES]; 3]; 3];
        let mut frames = numbers;
        let mut volumes = [0.0; MAX_LANES];
        for lane in 0..S::F64_LANES {
            let point = &points[lane.min(last)];
            for k in 0..3 {
                for j in 0..3 {
                    numbers[k][j][lane] = dot(simd, &u[k], &point.gradient[j]);
                    frames[k][j][lane] = point.frame[(k, j)];
                }
            }
            volumes[lane] = point.volume;
        }
        let mut pack = Self { simd, points, fr: [[zero; 3]; 3], gradient: [[zero; 3]; 3], volume: zero.load(&volumes) };
        let mut hr = [[zero; 3]; 3];
        let mut frame = hr;
        for k in 0..3 {
            for j in 0..3 {
                hr[k][j] = zero.load(&numbers[k][j]);
                frame[k][j] = zero.load(&frames[k][j]);
                pack.fr[k][j] = frame[k][j] + hr[k][j];
            }
        }
        for i in 0..3 {
            for j in 0..3 {
                pack.gradient[i][j] = sum3([frame[0][i], frame[1][i], frame[2][i]], [hr[0][j], hr[1][j], hr[2][j]]);
            }
        }
        pack
    }

    /// Adds the numbers of the points, weighted by their volumes, in the order of the points.
    #[inline(always)]
    pub fn integrate(&self, numbers: Wide<S>, sum: &mut f64) {
        let numbers = (numbers * self.volume).to_array();
        for number in &numbers[..self.points.len()] {
            *sum += number;
        }
    }

    /// Adds `scale (FR V)_kj g_j(a)`: the nodal forces of a stress, or the nodal gradient of a strain measure, `V`.
    #[inline(always)]
    pub fn add_force(&self, v: &[Wide<S>; 6], scale: Wide<S>, out: &mut NodeVector<N>) {
        self.simd.vectorize(AddForce { pack: self, v, scale, out });
    }

    #[inline(always)]
    fn sum_force(&self, v: &[Wide<S>; 6], scale: Wide<S>, out: &mut NodeVector<N>) {
        let mut tensor = *v;
        for i in 0..6 {
            tensor[i] = v[i] * (scale * FACTOR[i]);
        }
        let mut p = [[[0.0; MAX_LANES]; 3]; 3];
        for k in 0..3 {
            for j in 0..3 {
                p[k][j] = sum3(self.fr[k], column(&tensor, j)).to_array();
            }
        }
        for (lane, point) in self.points.iter().enumerate() {
            for k in 0..3 {
                for j in 0..3 {
                    add_multiple(self.simd, p[k][j][lane], &point.gradient[j], &mut out[k]);
                }
            }
        }
    }

    /// Adds the stiffness of tangents `d` (by columns) and stresses `s`, or begins with it when `fresh`. When `SYMMETRIC`
    /// only entries whose row comes before their column are meaningful afterwards, see [`mirror`].
    #[inline(always)]
    pub fn add_stiffness<const SYMMETRIC: bool>(
        &self,
        stress: &[Wide<S>; 6],
        tangent: &[[Wide<S>; 6]; 6],
        fresh: bool,
        stiffness: Stiffness<'_, N>,
    ) {
        self.simd.vectorize(AddStiffness::<S, N, SYMMETRIC> { pack: self, stress, tangent, fresh, stiffness });
    }

    #[inline(always)]
    fn sum_stiffness<const SYMMETRIC: bool>(
        &self,
        s: &[Wide<S>; 6],
        d: &[[Wide<S>; 6]; 6],
        fresh: bool,
        Stiffness { matrix, product }: Stiffness<'_, N>,
    ) {
        let elasticity = self.first_elasticity::<SYMMETRIC>(s, d);
        for k in 0..3 {
            for m in if SYMMETRIC { k } else { 0 }..3 {
                for (lane, point) in self.points.iter().enumerate() {
                    for j in 0..3 {
                        let [a, b, c] = &elasticity[k][j][m];
                        let factors = [lanes_of::<S>(a)[lane], lanes_of::<S>(b)[lane], lanes_of::<S>(c)[lane]];
                        combine(self.simd, factors, &point.gradient, &mut product[lane][j]);
                    }
                }
                let block = Block { upper: SYMMETRIC && k == m, fresh, column: m, rows: &mut matrix[k] };
                add_products(self.simd, self.points, product, block);
            }
        }
    }

    /// First elasticity tensor times the points' volumes, `a[k][j][m][l]`; only `k <= m` when `SYMMETRIC`.
    #[inline(always)]
    fn first_elasticity<const SYMMETRIC: bool>(
        &self,
        s: &[Wide<S>; 6],
        d: &[[Wide<S>; 6]; 6],
    ) -> [[[[S::f64s; 3]; 3]; 3]; 3] {
        let fr = &self.fr;
        // half[I][m][l] = sum_p D_(I)(pl) FR_mp, I a Mandel row scaled to a tensor entry.
        let mut half = [[[self.volume; 3]; 3]; 6];
        for (i, half) in half.iter_mut().enumerate() {
            let mut row = [self.volume * FACTOR[i]; 6];
            for (j, entry) in row.iter_mut().enumerate() {
                *entry = d[j][i] * (*entry * FACTOR[j]);
            }
            for m in 0..3 {
                for l in 0..3 {
                    half[m][l] = sum3(fr[m], column(&row, l));
                }
            }
        }
        let mut out = [[[[self.simd.splat_f64s(0.0); 3]; 3]; 3]; 3];
        for k in 0..3 {
            for m in if SYMMETRIC { k } else { 0 }..3 {
                for j in 0..3 {
                    for l in 0..3 {
                        let [a, b, c] = MANDEL[j];
                        let mut entry = sum3(fr[k], [half[a][m][l], half[b][m][l], half[c][m][l]]);
                        if k == m {
                            entry += s[MANDEL[j][l]] * (self.volume * FACTOR[MANDEL[j][l]]);
                        }
                        out[k][j][m][l] = entry.lanes();
                    }
                }
            }
        }
        out
    }
}

// Functions of their own for every element and instruction set, whatever the law: much less to compile.

/// [`Pack::new`].
struct NewPack<'a, 'u, S: Simd, const N: usize> {
    simd: S,
    points: &'a [PointGeometry<N>],
    displacement: &'u NodeVector<N>,
}

impl<'a, S: Simd, const N: usize> NullaryFnOnce for NewPack<'a, '_, S, N> {
    type Output = Pack<'a, S, N>;

    #[inline(always)]
    fn call(self) -> Self::Output {
        Pack::form(self.simd, self.points, self.displacement)
    }
}

/// [`Pack::add_force`].
struct AddForce<'a, S: Simd, const N: usize> {
    pack: &'a Pack<'a, S, N>,
    v: &'a [Wide<S>; 6],
    scale: Wide<S>,
    out: &'a mut NodeVector<N>,
}

impl<S: Simd, const N: usize> NullaryFnOnce for AddForce<'_, S, N> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.pack.sum_force(self.v, self.scale, self.out);
    }
}

/// [`Pack::add_stiffness`].
struct AddStiffness<'a, S: Simd, const N: usize, const SYMMETRIC: bool> {
    pack: &'a Pack<'a, S, N>,
    stress: &'a [Wide<S>; 6],
    tangent: &'a [[Wide<S>; 6]; 6],
    fresh: bool,
    stiffness: Stiffness<'a, N>,
}

impl<S: Simd, const N: usize, const SYMMETRIC: bool> NullaryFnOnce for AddStiffness<'_, S, N, SYMMETRIC> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { pack, stress, tangent, fresh, stiffness } = self;
        pack.sum_stiffness::<SYMMETRIC>(stress, tangent, fresh, stiffness);
    }
}

/// `sum_i a(i) b(i)`.
#[inline(always)]
fn sum3<V: Lanes>(a: [V; 3], b: [V; 3]) -> V {
    a[2].mul_add(b[2], a[1].mul_add(b[1], a[0] * b[0]))
}

/// Column of the tensor of a Mandel vector whose entries are scaled already.
#[inline(always)]
fn column<V: Lanes>(v: &[V; 6], j: usize) -> [V; 3] {
    [v[MANDEL[0][j]], v[MANDEL[1][j]], v[MANDEL[2][j]]]
}

#[inline(always)]
fn lanes_of<S: Simd>(vector: &S::f64s) -> &[f64] {
    pulp::bytemuck::cast_slice(std::slice::from_ref(vector))
}

/// Scalar product of two lists.
#[inline(always)]
fn dot<S: Simd, const N: usize>(simd: S, a: &[f64; N], b: &[f64; N]) -> f64 {
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

/// `out = sum_l factors[l] g_l`.
#[inline(always)]
fn combine<S: Simd, const N: usize>(simd: S, factors: [f64; 3], g: &NodeVector<N>, out: &mut [f64; N]) {
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
struct Block<'a, const N: usize> {
    /// Whether only `b >= a` matters.
    upper: bool,
    /// Whether to begin.
    fresh: bool,
    column: usize,
    rows: &'a mut [[[f64; N]; 3]; N],
}

/// Rows whose sums are in registers together.
const ROWS: usize = 4;

/// `out[a][b] += sum_(points, j) g_j(a) product[point][j][b]`.
#[inline(always)]
fn add_products<S: Simd, const N: usize>(
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
