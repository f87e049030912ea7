//! Packs of integration points, one point in each lane of a vector: kinematics, forces and stiffness.
//!
//! Everything is written for shape-function gradients by *fibre-frame* coordinates, `g_j(a) = dN_a/dX_j = B_ji dN_a/dxi_i`
//! (see `geometry.rs`). With `R` the fibre frame (columns e1 e2 e3) and `H = grad u`:
//! `HR_kj = sum_a u_k(a) g_j(a)`, `FR = R + HR` (spatial rows, fibre-frame columns), `H_f = R^T HR` for the law.
//! Then `dE_ij = sym(FR_ki g_j(a)) du_k(a)`, the force is `P_kj g_j` with `P = FR S`, and the stiffness is
//! `K_(ak)(bm) = g_j(a) A_kjml g_l(b)` with `A_kjml = FR_ki D_(ij)(pl) FR_mp + delta_km S_jl`.

#![allow(clippy::needless_range_loop, reason = "tensors are written by their indices, as in the formulas")]

use pulp::{NullaryFnOnce, Simd};
use subrope_material::lanes::{Lanes, MAX_LANES};

use super::geometry::{BrickGeometry, OnLine};
use super::kernel::{Elasticity, GroupBuffers, NodeVector, add_forces};
use super::wide::Wide;

/// `1/sqrt(2)`: from a Mandel shear entry to the tensor's.
const HALF_ROOT: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Mandel index of a symmetric pair.
pub const MANDEL: [[usize; 3]; 3] = [[0, 3, 4], [3, 1, 5], [4, 5, 2]];

/// Factor from a Mandel entry to the tensor's.
const FACTOR: [f64; 6] = [1.0, 1.0, 1.0, HALF_ROOT, HALF_ROOT, HALF_ROOT];

/// A pack of integration points: one in each lane, the last repeated in lanes that are left over.
#[derive(Clone, Copy, Debug)]
pub struct Pack<'a, S: Simd, const N: usize> {
    /// The instruction set.
    pub simd: S,
    brick: BrickGeometry<'a, N>,
    /// Number of the first point.
    pub first: usize,
    /// How many points.
    pub points: usize,
    /// `FR = R + HR`.
    pub fr: [[Wide<S>; 3]; 3],
    /// `H_f = R^T HR`.
    pub gradient: [[Wide<S>; 3]; 3],
    /// Reference volumes \[mm^3\].
    pub volume: Wide<S>,
}

impl<'a, S: Simd, const N: usize> Pack<'a, S, N> {
    /// The pack of the points from `first` on, before [`Pack::deform`] has been called.
    #[inline(always)]
    pub fn at(simd: S, brick: BrickGeometry<'a, N>, first: usize) -> Self {
        let points = S::F64_LANES.min(brick.points() - first);
        let volume = Wide::of_group(simd, &brick.group(first).volume.0, first);
        let room = [[volume; 3]; 3];
        Self { simd, brick, first, points, fr: room, gradient: room, volume }
    }

    /// Kinematics under nodal displacements.
    #[inline(always)]
    pub fn deform(&mut self, displacement: &NodeVector<N>) {
        self.simd.vectorize(Deform { pack: self, displacement });
    }

    #[inline(always)]
    fn form_gradients(&mut self, u: &NodeVector<N>) {
        let Self { simd, first, .. } = *self;
        let map = self.brick.by_node(first);
        // Displacement gradient by the brick's own coordinates.
        let mut own = [[Wide::new(simd, 0.0); 3]; 3];
        for a in 0..N {
            for k in 0..3 {
                let displacement = Wide::new(simd, u[k][a]);
                for i in 0..3 {
                    own[k][i] = Wide::of_group(simd, &map[a][i].0, first).mul_add(displacement, own[k][i]);
                }
            }
        }
        let mut hr = own;
        for j in 0..3 {
            let to_fibre = self.fibre_row(j);
            for k in 0..3 {
                hr[k][j] = sum3(own[k], to_fibre);
            }
        }
        let group = self.brick.group(first);
        let mut frame = own;
        for k in 0..3 {
            for j in 0..3 {
                frame[k][j] = Wide::of_group(simd, &group.frame[k][j].0, first);
                self.fr[k][j] = frame[k][j] + hr[k][j];
            }
        }
        for i in 0..3 {
            for j in 0..3 {
                self.gradient[i][j] = sum3([frame[0][i], frame[1][i], frame[2][i]], [hr[0][j], hr[1][j], hr[2][j]]);
            }
        }
    }

    /// Row of `B`.
    #[inline(always)]
    fn fibre_row(&self, row: usize) -> [Wide<S>; 3] {
        let [OnLine(a), OnLine(b), OnLine(c)] = &self.brick.group(self.first).to_fibre[row];
        let of = |numbers| Wide::of_group(self.simd, numbers, self.first);
        [of(a), of(b), of(c)]
    }

    /// Adds the numbers of the points, weighted by their volumes, in the order of the points.
    #[inline(always)]
    pub fn integrate(&self, numbers: Wide<S>, sum: &mut f64) {
        let numbers = (numbers * self.volume).to_array();
        if self.points == S::F64_LANES {
            // A constant length.
            for number in &numbers[..S::F64_LANES] {
                *sum += number;
            }
        } else {
            for number in &numbers[..self.points] {
                *sum += number;
            }
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
        let to_fibre = [self.fibre_row(0), self.fibre_row(1), self.fibre_row(2)];
        let mut t = [[[0.0; MAX_LANES]; 3]; 3];
        for k in 0..3 {
            let mut p = self.fr[k];
            for j in 0..3 {
                p[j] = sum3(self.fr[k], column(&tensor, j));
            }
            for i in 0..3 {
                t[k][i] = sum3(p, [to_fibre[0][i], to_fibre[1][i], to_fibre[2][i]]).to_array();
            }
        }
        add_forces(self.simd, self.brick.by_point(self.first, self.points), &t, out);
    }

    /// Puts the first elasticity tensors of stresses and tangents (by columns) in their places for `kernel::add_group`;
    /// only `k <= m` when `SYMMETRIC`.
    #[inline(always)]
    pub fn put_elasticity<const SYMMETRIC: bool>(
        &self,
        stress: &[Wide<S>; 6],
        tangent: &[[Wide<S>; 6]; 6],
        buffers: &mut GroupBuffers<N>,
    ) {
        let out = &mut buffers.elasticity;
        self.simd.vectorize(PutElasticity::<S, N, SYMMETRIC> { pack: self, stress, tangent, out });
    }

    /// Whether the pack ends a group of points.
    #[inline(always)]
    pub fn ends_group(&self) -> bool {
        let end = self.first + self.points;
        end.is_multiple_of(MAX_LANES) || end == self.brick.points()
    }

    /// The first point of the pack's group.
    #[inline(always)]
    pub fn group_start(&self) -> usize {
        self.first / MAX_LANES * MAX_LANES
    }
}

/// First elasticity tensor times the points' volumes, `A_kjml = FR_ki D_(ij)(pl) FR_mp + delta_km S_jl`.
struct FirstElasticity<'a, S: Simd> {
    fr: &'a [[Wide<S>; 3]; 3],
    /// `S`, entries of the tensor times the volume.
    stress: [Wide<S>; 6],
    /// Columns of `D`, entries of the tensor times the volume.
    tangent: [[Wide<S>; 6]; 6],
}

impl<'a, S: Simd> FirstElasticity<'a, S> {
    #[inline(always)]
    fn new<const N: usize>(pack: &'a Pack<'_, S, N>, s: &[Wide<S>; 6], d: &[[Wide<S>; 6]; 6]) -> Self {
        let (mut stress, mut tangent) = (*s, *d);
        let (normal, shear) = (pack.volume, pack.volume * HALF_ROOT);
        for j in 0..6 {
            stress[j] = stress[j] * if j < 3 { normal } else { shear };
            for i in 0..6 {
                let weight = match (i < 3, j < 3) {
                    (true, true) => normal,
                    (false, false) => pack.volume * 0.5,
                    _ => shear,
                };
                tangent[j][i] = tangent[j][i] * weight;
            }
        }
        Self { fr: &pack.fr, stress, tangent }
    }

    /// `sum_p D_(I)(pl) FR_mp`: `[I][l]`, `I` a Mandel row.
    #[inline(always)]
    fn half(&self, m: usize) -> [[Wide<S>; 3]; 6] {
        let d = &self.tangent;
        let mut half = [self.fr[0]; 6];
        for i in 0..6 {
            for l in 0..3 {
                let [a, b, c] = [MANDEL[0][l], MANDEL[1][l], MANDEL[2][l]];
                half[i][l] = sum3(self.fr[m], [d[a][i], d[b][i], d[c][i]]);
            }
        }
        half
    }

    /// `A_kjml` over `l`.
    #[inline(always)]
    fn row(&self, half: &[[Wide<S>; 3]; 6], [k, j, m]: [usize; 3]) -> [Wide<S>; 3] {
        let [a, b, c] = MANDEL[j];
        let mut row = half[a];
        for l in 0..3 {
            row[l] = sum3(self.fr[k], [half[a][l], half[b][l], half[c][l]]);
            if k == m {
                row[l] += self.stress[MANDEL[j][l]];
            }
        }
        row
    }
}

// Functions of their own for every element and instruction set, whatever the law: much less to compile.

/// [`Pack::deform`].
struct Deform<'p, 'a, 'u, S: Simd, const N: usize> {
    pack: &'p mut Pack<'a, S, N>,
    displacement: &'u NodeVector<N>,
}

impl<S: Simd, const N: usize> NullaryFnOnce for Deform<'_, '_, '_, S, N> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.pack.form_gradients(self.displacement);
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

/// [`Pack::put_elasticity`].
struct PutElasticity<'a, S: Simd, const N: usize, const SYMMETRIC: bool> {
    pack: &'a Pack<'a, S, N>,
    stress: &'a [Wide<S>; 6],
    tangent: &'a [[Wide<S>; 6]; 6],
    out: &'a mut Elasticity,
}

impl<S: Simd, const N: usize, const SYMMETRIC: bool> NullaryFnOnce for PutElasticity<'_, S, N, SYMMETRIC> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { pack, stress, tangent, out } = self;
        let elasticity = FirstElasticity::new(pack, stress, tangent);
        for m in 0..3 {
            let half = elasticity.half(m);
            for k in 0..if SYMMETRIC { m + 1 } else { 3 } {
                for j in 0..3 {
                    let row = elasticity.row(&half, [k, j, m]);
                    for l in 0..3 {
                        row[l].put_into(&mut out[k][m][j][l].0, pack.first);
                    }
                }
            }
        }
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
