//! Packs of integration points, one point in each lane of a vector: kinematics, forces and stiffness.
//!
//! Everything is written for shape-function gradients by *fibre-frame* coordinates, `g_j(a) = dN_a/dX_j`, formed once
//! from the reference mesh. With `R` the fibre frame (columns e1 e2 e3) and `H = grad u`:
//! `HR_kj = sum_a u_k(a) g_j(a)`, `FR = R + HR` (spatial rows, fibre-frame columns), `H_f = R^T HR` for the law.
//! Then `dE_ij = sym(FR_ki g_j(a)) du_k(a)`, the force is `P_kj g_j` with `P = FR S`, and the stiffness is
//! `K_(ak)(bm) = g_j(a) A_kjml g_l(b)` with `A_kjml = FR_ki D_(ij)(pl) FR_mp + delta_km S_jl`.

#![allow(clippy::needless_range_loop, reason = "tensors are written by their indices, as in the formulas")]

use nalgebra::Matrix3;
use pulp::{NullaryFnOnce, Simd};
use subrope_material::lanes::{Lanes, MAX_LANES};

use super::kernel::{Block, NodeVector, PointGeometry, Stiffness, add_multiple, add_products, combine, dot};
use super::wide::Wide;

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
    /// The instruction set.
    pub simd: S,
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
    /// only entries whose row comes before their column are meaningful afterwards, see `kernel::mirror`.
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
