//! Strain modes with what their derivatives need.
//!
//! The derivatives are taken in the *reduced* strain increment `A^T dE A`, `A = [e1, N2, N3]`, `N_a = e_a - g_a e1`,
//! in which `I_elong` depends on the 11 entry alone, `g_a` on 1a and `T` on the transverse entries:
//! `dI_elong = dE11/C11`, `dg_a = 2 dE1a/C11`, `dT_ab = 2 dE_ab` (all entries reduced).

use std::f64::consts::SQRT_2;

use super::StrainModes;
use super::logarithm::LogarithmFactors;
use crate::LawError;
use crate::lanes::{Lanes, branch, finite};

/// Strains below which the forms with `log1p` are used; beyond, those of Gram-Schmidt and `det F`.
const SMALL_STRAIN: f64 = 0.5;

/// Strain modes of a point and the numbers their first and second derivatives are made of.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Kinematics<V: Lanes> {
    pub(crate) modes: StrainModes<V>,
    /// Where there are strain modes: `det F > 0` and nothing overflows.
    pub(crate) valid: V::Mask,
    /// `1/C11`, `C11` the square of the fibre stretch.
    pub(crate) inverse_c11: V,
    /// `T22`, `T33`, `T23`.
    pub(crate) section: [V; 3],
    /// `det T = s^2`.
    pub(crate) section_det: V,
    /// `1/det T`.
    pub(crate) inverse_det: V,
    /// `1/m`, `m = (T22 + T33)/2`.
    pub(crate) inverse_mean: V,
    /// `v = ((T22 - T33)/2, T23)`, so that `I_dist = phi v`.
    pub(crate) deviator: [V; 2],
    /// `phi = h/(2m)`.
    pub(crate) phi: V,
    /// `c = k/(2 m^3)`: `d phi = -c v.dv - dI_comp/m`.
    pub(crate) c: V,
    /// `l/(2 m^5)`: `dc = -c_v v.dv - dI_comp/m^3`.
    pub(crate) c_v: V,
}

/// `C11`, the shears, and the columns of `F` behind them.
struct Columns<V> {
    f1: [V; 3],
    /// `n_a - e_a`: column `a` of `F` without its part along the fibre, less the unit vector.
    k2: [V; 3],
    k3: [V; 3],
    c11: V,
    inverse_c11: V,
    elongation: V,
    shear: [V; 2],
}

impl<V: Lanes> Columns<V> {
    #[inline(always)]
    fn new(h: &[[V; 3]; 3]) -> Self {
        let [h1, h2, h3] = [column(h, 0), column(h, 1), column(h, 2)];
        let f1 = [h1[0] + 1.0, h1[1], h1[2]];
        let [c11, elongation] = square_and_half_log(h1[0] + dot3(f1, h1), dot3(f1, f1));
        let inverse_c11 = c11.splat(1.0) / c11;
        let g = [(h1[1] + dot3(f1, h2)) * inverse_c11, (h1[2] + dot3(f1, h3)) * inverse_c11];
        Self { f1, k2: subtract(h2, g[0], f1), k3: subtract(h3, g[1], f1), c11, inverse_c11, elongation, shear: g }
    }

    /// `n2` and `n3`.
    #[inline(always)]
    fn normals(&self) -> [[V; 3]; 2] {
        let (k2, k3) = (self.k2, self.k3);
        [[k2[0], k2[1] + 1.0, k2[2]], [k3[0], k3[1], k3[2] + 1.0]]
    }

    /// `det F`.
    #[inline(always)]
    fn jacobian(&self) -> V {
        let [n2, n3] = self.normals();
        dot3(self.f1, cross(n2, n3))
    }

    /// `T22, T33, T23`, `det T`, `4 I_comp`, `v`.
    #[inline(always)]
    fn section(&self, jacobian: V) -> [V; 7] {
        let ([n2, n3], (k2, k3)) = (self.normals(), (self.k2, self.k3));
        // T - 1.
        let [t22, t33, t23] = [k2[1] + dot3(n2, k2), k3[2] + dot3(n3, k3), k3[1] + dot3(n3, k2)];
        let small = (t22.abs() + t33.abs() + t23.abs()).lt(t22.splat(SMALL_STRAIN));
        branch!(
            V,
            small,
            {
                let growth = t22 + t33 + t22 * t33 - t23 * t23;
                [t22 + 1.0, t33 + 1.0, t23, growth + 1.0, growth.ln_1p(), (t22 - t33) * 0.5, t23]
            },
            {
                let (t22, t33, t23) = (dot3(n2, n2), dot3(n3, n3), dot3(n2, n3));
                let det = jacobian * jacobian * self.inverse_c11;
                [t22, t33, t23, det, det.map(f64::ln), (t22 - t33) * 0.5, t23]
            }
        )
    }
}

impl<V: Lanes> Kinematics<V> {
    /// See [`StrainModes::from_displacement_gradient`]; `h[i][j] = H_ij`.
    #[inline(always)]
    pub(crate) fn new(h: &[[V; 3]; 3]) -> Self {
        let columns = Columns::new(h);
        let jacobian = columns.jacobian();
        let [t22, t33, t23, det, log_det, v0, v1] = columns.section(jacobian);
        // I_dist = v h(Y)/(2m), Y = |v|^2/m^2, 1 - Y = s^2/m^2.
        let inverse = det.splat(2.0) / (t22 + t33);
        let square = inverse * inverse;
        let factors = LogarithmFactors::new((v0 * v0 + v1 * v1) * square, det * square);
        let (phi, compaction) = (inverse * factors.h * 0.5, log_det * 0.25);
        let modes = StrainModes {
            elongation: columns.elongation,
            compaction,
            distortion: [phi * v0, phi * v1],
            longitudinal_shear: columns.shear,
        };
        let zero = det.splat(0.0);
        let positive = zero.lt(columns.c11) & zero.lt(jacobian);
        Self {
            valid: positive & finite(&[columns.elongation, compaction, modes.distortion[0], modes.distortion[1]]),
            modes,
            inverse_c11: columns.inverse_c11,
            section: [t22, t33, t23],
            section_det: det,
            inverse_det: det.splat(1.0) / det,
            inverse_mean: inverse,
            deviator: [v0, v1],
            phi,
            c: inverse * square * factors.k * 0.5,
            c_v: inverse * square * square * factors.l * 0.5,
        }
    }

    /// `dI_comp` in the transverse entries (22, 33, 23) of the reduced Mandel strain increment: `1/2 T^-1`.
    #[inline(always)]
    pub(crate) fn compaction_gradient(&self) -> [V; 3] {
        let factor = self.inverse_det * 0.5;
        [factor * self.section[1], factor * self.section[0], -(factor * self.section[2] * SQRT_2)]
    }

    /// `S = A S_reduced A^T` of a reduced Mandel vector.
    #[inline(always)]
    pub(crate) fn expand(&self, reduced: [V; 6]) -> [V; 6] {
        let [s11, s22, s33, s12, s13, s23] = reduced;
        let [g2, g3] = self.modes.longitudinal_shear;
        let [a, b] = [g2 * SQRT_2, g3 * SQRT_2];
        let x11 = s11 - a * s12 - b * s13 + g2 * g2 * s22 + g3 * g3 * s33 + a * g3 * s23;
        [x11, s22, s33, s12 - a * s22 - g3 * s23, s13 - b * s33 - g2 * s23, s23]
    }

    /// [`Kinematics::expand`] of the columns of a matrix given by its rows: six columns at a time.
    #[inline(always)]
    pub(crate) fn expand_columns(&self, rows: &mut [[V; 6]; 6]) {
        let [g2, g3] = self.modes.longitudinal_shear;
        let [a, b] = [-(g2 * SQRT_2), -(g3 * SQRT_2)];
        let [g22, g33, g23] = [g2 * g2, g3 * g3, -(a * g3)];
        let [minus_g2, minus_g3] = [-g2, -g3];
        let [r11, r22, r33, r12, r13, r23] = rows;
        for j in 0..6 {
            let section = g22.mul_add(r22[j], g33.mul_add(r33[j], g23 * r23[j]));
            r11[j] = a.mul_add(r12[j], b.mul_add(r13[j], r11[j] + section));
            r12[j] = a.mul_add(r22[j], minus_g3.mul_add(r23[j], r12[j]));
            r13[j] = b.mul_add(r33[j], minus_g2.mul_add(r23[j], r13[j]));
        }
    }
}

/// Why a displacement gradient has no strain modes.
pub(crate) fn failure(h: &[[f64; 3]; 3]) -> LawError {
    if !finite(h.as_flattened()) {
        return LawError::NonFiniteInput;
    }
    let columns = Columns::new(h);
    let jacobian = if columns.c11 <= 0.0 { 0.0 } else { columns.jacobian() };
    if jacobian <= 0.0 { LawError::Inverted { jacobian } } else { LawError::NonFiniteResponse }
}

/// `1 + growth` and `1/2 ln(1 + growth)`, from `square = 1 + growth` formed without cancellation when growth is large.
#[inline(always)]
fn square_and_half_log<V: Lanes>(growth: V, square: V) -> [V; 2] {
    let small = growth.abs().lt(growth.splat(SMALL_STRAIN));
    branch!(V, small, [growth + 1.0, growth.ln_1p() * 0.5], [square, square.map(f64::ln) * 0.5])
}

#[inline(always)]
fn column<V: Lanes>(h: &[[V; 3]; 3], j: usize) -> [V; 3] {
    [h[0][j], h[1][j], h[2][j]]
}

#[inline(always)]
fn dot3<V: Lanes>(a: [V; 3], b: [V; 3]) -> V {
    a[2].mul_add(b[2], a[1].mul_add(b[1], a[0] * b[0]))
}

#[inline(always)]
fn cross<V: Lanes>(a: [V; 3], b: [V; 3]) -> [V; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// `a - factor b`.
#[inline(always)]
fn subtract<V: Lanes>(a: [V; 3], factor: V, b: [V; 3]) -> [V; 3] {
    [a[0] - factor * b[0], a[1] - factor * b[1], a[2] - factor * b[2]]
}
