//! Strain measures of a displacement gradient that keep their relative accuracy at small strain.

use nalgebra::Matrix3;

use crate::LawError;
use crate::lanes::{self, finite};
use crate::strain::{LogarithmFactors, rows};

/// Volume growth below which `ln J` is `log1p(J - 1)`.
const SMALL_GROWTH: f64 = 0.5;
/// Strain below which energies of second order are formed from second-order terms.
const SMALL_STRAIN: f64 = 0.1;
/// Arguments below which `exp(y) - 1 - y` is summed.
const SMALL_EXPONENT: f64 = 0.5;

/// Green-Lagrange strain, volume ratio and inverse right Cauchy-Green tensor of a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measures {
    /// `E = sym H + 1/2 H^T H`.
    pub(super) strain: Matrix3<f64>,
    /// `tr E`.
    pub(super) trace: f64,
    /// `J - 1`.
    pub(super) growth: f64,
    /// `ln J`.
    pub(super) log_volume: f64,
    /// `C^-1`.
    pub(super) inverse: Matrix3<f64>,
}

impl Measures {
    #[inline]
    pub(super) fn new(h: &Matrix3<f64>) -> Result<Self, LawError> {
        let growth = volume_growth(h)?;
        let f = h + Matrix3::identity();
        let small = growth.abs() < SMALL_GROWTH;
        let jacobian = if small { 1.0 + growth } else { f.determinant() };
        if jacobian <= 0.0 {
            return Err(LawError::Inverted { jacobian });
        }
        let log_volume = if small { growth.ln_1p() } else { jacobian.ln() };
        let inverse = cofactor(&f) / jacobian;
        let strain = 0.5 * (h + h.transpose() + h.tr_mul(h));
        // cofactor = J F^-T, so C^-1 = F^-1 F^-T.
        Ok(Self { strain, trace: strain.trace(), growth, log_volume, inverse: inverse.tr_mul(&inverse) })
    }

    /// `J^2 - 1`.
    #[inline]
    pub(super) fn square_growth(&self) -> f64 {
        self.growth * (2.0 + self.growth)
    }

    /// `tr E - ln J`, of second order in the strain.
    #[inline]
    pub(super) fn excess(&self) -> f64 {
        let e = &self.strain;
        if e.norm_squared() > SMALL_STRAIN * SMALL_STRAIN {
            return self.trace - self.log_volume;
        }
        let second = principal_minors(e);
        let third = e.determinant();
        // det C - 1 = 2 tr E + 4 II + 8 III = x and ln J = 1/2 log1p(x).
        let x = 2.0 * self.trace + 4.0 * second + 8.0 * third;
        0.5 * log_excess(x) - 2.0 * second - 4.0 * third
    }
}

/// `J - 1` as a polynomial in `H`: trace, sum of the principal minors, determinant.
///
/// # Errors
/// [`LawError::NonFiniteInput`], [`LawError::Inverted`].
#[inline]
pub(super) fn volume_growth(h: &Matrix3<f64>) -> Result<f64, LawError> {
    if !finite(h.as_slice()) {
        return Err(LawError::NonFiniteInput);
    }
    let growth = lanes::volume_growth(&rows(h));
    if !growth.is_finite() {
        return Err(LawError::NonFiniteResponse);
    }
    if growth <= -1.0 { Err(LawError::Inverted { jacobian: 1.0 + growth }) } else { Ok(growth) }
}

#[inline]
fn principal_minors(a: &Matrix3<f64>) -> f64 {
    a.m11 * a.m22 - a.m12 * a.m21 + a.m11 * a.m33 - a.m13 * a.m31 + a.m22 * a.m33 - a.m23 * a.m32
}

/// Matrix of cofactors, `J F^-T`.
#[inline]
fn cofactor(f: &Matrix3<f64>) -> Matrix3<f64> {
    Matrix3::new(
        f.m22 * f.m33 - f.m23 * f.m32,
        f.m23 * f.m31 - f.m21 * f.m33,
        f.m21 * f.m32 - f.m22 * f.m31,
        f.m13 * f.m32 - f.m12 * f.m33,
        f.m11 * f.m33 - f.m13 * f.m31,
        f.m12 * f.m31 - f.m11 * f.m32,
        f.m12 * f.m23 - f.m13 * f.m22,
        f.m13 * f.m21 - f.m11 * f.m23,
        f.m11 * f.m22 - f.m12 * f.m21,
    )
}

/// `x - ln(1 + x)` without cancellation: with `u = x/(2 + x)` it is `2u/(1 - u) - 2 atanh(u)`.
#[inline]
pub(super) fn log_excess(x: f64) -> f64 {
    let u = x / (2.0 + x);
    let square = u * u;
    let factors = LogarithmFactors::new(square, (1.0 - u) * (1.0 + u));
    2.0 * square * (1.0 / (1.0 - u) - u * factors.k)
}

/// `exp(y) - 1 - y` without cancellation.
#[inline]
pub(super) fn exp_excess(y: f64) -> f64 {
    if y.abs() > SMALL_EXPONENT {
        return y.exp_m1() - y;
    }
    let mut sum = 1.0;
    for n in (3..=16).rev() {
        sum = 1.0 + sum * y / f64::from(n);
    }
    0.5 * y * y * sum
}

#[cfg(test)]
mod tests {
    use super::{exp_excess, log_excess};

    #[test]
    fn excesses_match_their_series() {
        for x in [1e-9_f64, -1e-9, 1e-5, -1e-5] {
            let log = x * x * (0.5 - x / 3.0 + x * x / 4.0);
            let exp = x * x * (0.5 + x / 6.0 + x * x / 24.0);
            assert!((log_excess(x) / log - 1.0).abs() < 1e-15, "{x}");
            assert!((exp_excess(x) / exp - 1.0).abs() < 1e-15, "{x}");
        }
    }

    #[test]
    fn excesses_match_the_plain_forms() {
        for x in [0.3_f64, -0.45, 2.0, -0.9, 40.0] {
            assert!((log_excess(x) / (x - x.ln_1p()) - 1.0).abs() < 2e-15, "{x}");
            assert!((exp_excess(x) / (x.exp_m1() - x) - 1.0).abs() < 2e-15, "{x}");
        }
    }
}
