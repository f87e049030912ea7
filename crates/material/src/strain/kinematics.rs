//! Strain modes with what their derivatives need.
//!
//! The derivatives are taken in the *reduced* strain increment `A^T dE A`, `A = [e1, N2, N3]`, `N_a = e_a - g_a e1`,
//! in which `I_elong` depends on the 11 entry alone, `g_a` on 1a and `T` on the transverse entries:
//! `dI_elong = dE11/C11`, `dg_a = 2 dE1a/C11`, `dT_ab = 2 dE_ab` (all entries reduced).

use std::f64::consts::SQRT_2;

use nalgebra::{Matrix3, Vector6};

use super::StrainModes;
use super::logarithm::LogarithmFactors;
use crate::LawError;

/// Strains below which the forms with `log1p` are used; beyond, those of Gram-Schmidt and `det F`.
const SMALL_STRAIN: f64 = 0.5;

/// Strain modes of a point and the numbers their first and second derivatives are made of.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Kinematics {
    pub(crate) modes: StrainModes,
    /// `1/C11`, `C11` the square of the fibre stretch.
    pub(crate) inverse_c11: f64,
    /// `T22`, `T33`, `T23`.
    pub(crate) section: [f64; 3],
    /// `det T = s^2`.
    pub(crate) section_det: f64,
    /// `1/det T`.
    pub(crate) inverse_det: f64,
    /// `1/m`, `m = (T22 + T33)/2`.
    pub(crate) inverse_mean: f64,
    /// `v = ((T22 - T33)/2, T23)`, so that `I_dist = phi v`.
    pub(crate) deviator: [f64; 2],
    /// `phi = h/(2m)`.
    pub(crate) phi: f64,
    /// `c = k/(2 m^3)`: `d phi = -c v.dv - dI_comp/m`.
    pub(crate) c: f64,
    /// `l/(2 m^5)`: `dc = -c_v v.dv - dI_comp/m^3`.
    pub(crate) c_v: f64,
}

impl Kinematics {
    /// See [`StrainModes::from_displacement_gradient`].
    #[inline]
    pub(crate) fn new(h: &Matrix3<f64>) -> Result<Self, LawError> {
        if !all_finite(h.as_slice()) {
            return Err(LawError::NonFiniteInput);
        }
        let columns = [[h.m11, h.m21, h.m31], [h.m12, h.m22, h.m32], [h.m13, h.m23, h.m33]];
        let [h1, h2, h3] = columns;
        let f1 = [1.0 + h1[0], h1[1], h1[2]];
        let (c11, elongation) = square_and_half_log(h1[0] + dot3(f1, h1), dot3(f1, f1));
        if c11 <= 0.0 {
            return Err(LawError::Inverted { jacobian: 0.0 });
        }
        let inverse_c11 = 1.0 / c11;
        let g = [(h1[1] + dot3(f1, h2)) * inverse_c11, (h1[2] + dot3(f1, h3)) * inverse_c11];
        let modes = StrainModes { elongation, longitudinal_shear: g, ..StrainModes::default() };
        // n_a = e_a + k_a is column a of F without its part along the fibre.
        let (k2, k3) = (subtract(h2, g[0], f1), subtract(h3, g[1], f1));
        Self { modes, inverse_c11, ..Self::default() }.with_section(f1, k2, k3)?.with_distortion()
    }

    /// `T_ab = n_a . n_b`, its determinant and `I_comp`.
    #[inline]
    fn with_section(mut self, f1: [f64; 3], k2: [f64; 3], k3: [f64; 3]) -> Result<Self, LawError> {
        let n2 = [k2[0], 1.0 + k2[1], k2[2]];
        let n3 = [k3[0], k3[1], 1.0 + k3[2]];
        let jacobian = dot3(f1, cross(n2, n3));
        if jacobian <= 0.0 {
            return Err(LawError::Inverted { jacobian });
        }
        // T - 1.
        let [t22, t33, t23] = [k2[1] + dot3(n2, k2), k3[2] + dot3(n3, k3), k3[1] + dot3(n3, k2)];
        if t22.abs() + t33.abs() + t23.abs() < SMALL_STRAIN {
            let growth = t22 + t33 + t22 * t33 - t23 * t23;
            self.section = [1.0 + t22, 1.0 + t33, t23];
            self.section_det = 1.0 + growth;
            self.modes.compaction = 0.25 * growth.ln_1p();
            self.deviator = [0.5 * (t22 - t33), t23];
        } else {
            self.section = [dot3(n2, n2), dot3(n3, n3), dot3(n2, n3)];
            self.section_det = jacobian * jacobian * self.inverse_c11;
            self.modes.compaction = 0.25 * self.section_det.ln();
            self.deviator = [0.5 * (self.section[0] - self.section[1]), self.section[2]];
        }
        Ok(self)
    }

    /// `I_dist = v h(Y)/(2m)`, `Y = |v|^2/m^2`, `1 - Y = s^2/m^2`.
    #[inline]
    fn with_distortion(mut self) -> Result<Self, LawError> {
        let v = self.deviator;
        let inverse = 2.0 / (self.section[0] + self.section[1]);
        let inverse_square = inverse * inverse;
        let factors =
            LogarithmFactors::new((v[0] * v[0] + v[1] * v[1]) * inverse_square, self.section_det * inverse_square);
        self.inverse_mean = inverse;
        self.inverse_det = 1.0 / self.section_det;
        self.phi = 0.5 * inverse * factors.h;
        self.c = 0.5 * inverse * inverse_square * factors.k;
        self.c_v = 0.5 * inverse * inverse_square * inverse_square * factors.l;
        self.modes.distortion = [self.phi * v[0], self.phi * v[1]];
        let sum = self.modes.elongation + self.modes.compaction + self.phi * (v[0] + v[1]);
        if sum.is_finite() { Ok(self) } else { Err(LawError::NonFiniteResponse) }
    }

    /// `dI_comp` in the transverse entries (22, 33, 23) of the reduced Mandel strain increment: `1/2 T^-1`.
    #[inline]
    pub(crate) fn compaction_gradient(&self) -> [f64; 3] {
        let factor = 0.5 * self.inverse_det;
        [factor * self.section[1], factor * self.section[0], -factor * SQRT_2 * self.section[2]]
    }

    /// `S = A S_reduced A^T` of a reduced Mandel vector.
    #[inline]
    pub(crate) fn expand(&self, reduced: [f64; 6]) -> [f64; 6] {
        let [s11, s22, s33, s12, s13, s23] = reduced;
        let [g2, g3] = self.modes.longitudinal_shear;
        let [a, b] = [SQRT_2 * g2, SQRT_2 * g3];
        let x11 = s11 - a * s12 - b * s13 + g2 * g2 * s22 + g3 * g3 * s33 + a * g3 * s23;
        [x11, s22, s33, s12 - a * s22 - g3 * s23, s13 - b * s33 - g2 * s23, s23]
    }

    /// [`Kinematics::expand`] of the columns of a matrix given by its rows: six columns at a time.
    #[inline]
    pub(crate) fn expand_columns(&self, rows: &mut [[f64; 6]; 6]) {
        let [g2, g3] = self.modes.longitudinal_shear;
        let [a, b] = [SQRT_2 * g2, SQRT_2 * g3];
        let [g22, g33, g23] = [g2 * g2, g3 * g3, a * g3];
        let [r11, r22, r33, r12, r13, r23] = rows;
        for j in 0..6 {
            r11[j] += g22 * r22[j] + g33 * r33[j] + g23 * r23[j] - a * r12[j] - b * r13[j];
            r12[j] -= a * r22[j] + g3 * r23[j];
            r13[j] -= b * r33[j] + g2 * r23[j];
        }
    }

    /// [`Kinematics::expand`] as an nalgebra vector.
    #[inline]
    pub(crate) fn expand_vector(&self, reduced: [f64; 6]) -> Vector6<f64> {
        Vector6::from(self.expand(reduced))
    }
}

/// Whether every number is finite, without a branch per number.
#[inline]
pub(crate) fn all_finite(numbers: &[f64]) -> bool {
    numbers.iter().fold(true, |finite, x| finite & x.is_finite())
}

/// `1 + growth` and `1/2 ln(1 + growth)`, from `square = 1 + growth` formed without cancellation when growth is large.
#[inline]
fn square_and_half_log(growth: f64, square: f64) -> (f64, f64) {
    if growth.abs() < SMALL_STRAIN { (1.0 + growth, 0.5 * growth.ln_1p()) } else { (square, 0.5 * square.ln()) }
}

#[inline]
fn dot3(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline]
fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// `a - factor b`.
#[inline]
fn subtract(a: [f64; 3], factor: f64, b: [f64; 3]) -> [f64; 3] {
    [a[0] - factor * b[0], a[1] - factor * b[1], a[2] - factor * b[2]]
}
