//! Symmetric tensors as Mandel vectors: order 11, 22, 33, 12, 13, 23, shear entries times sqrt(2).
//!
//! In this notation `a : b` is the dot product, a fourth-order tensor with minor symmetries is a plain 6x6 matrix and a
//! change of frame is an orthogonal matrix.

use std::f64::consts::SQRT_2;

use nalgebra::{Matrix3, Matrix6, Vector6};

use crate::lanes;
use crate::strain::rows;

/// Row and column of each entry.
pub const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];

/// Factors that take a tensor component to its Mandel entry.
pub const WEIGHTS: [f64; 6] = [1.0, 1.0, 1.0, SQRT_2, SQRT_2, SQRT_2];

/// Mandel vector of the symmetric part of a matrix.
#[must_use]
#[inline]
pub fn from_matrix(m: &Matrix3<f64>) -> Vector6<f64> {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    Vector6::new(m.m11, m.m22, m.m33, half * (m.m12 + m.m21), half * (m.m13 + m.m31), half * (m.m23 + m.m32))
}

/// Symmetric matrix of a Mandel vector.
#[must_use]
#[inline]
pub fn to_matrix(v: &Vector6<f64>) -> Matrix3<f64> {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let (s12, s13, s23) = (half * v[3], half * v[4], half * v[5]);
    Matrix3::new(v[0], s12, s13, s12, v[1], s23, s13, s23, v[2])
}

/// Green-Lagrange strain `E = sym H + 1/2 H^T H` \[-\] of a displacement gradient, without cancellation at small
/// strain.
#[must_use]
#[inline]
pub fn green_lagrange(displacement_gradient: &Matrix3<f64>) -> Vector6<f64> {
    lanes::green_lagrange(&rows(displacement_gradient)).into()
}

/// `R a R^T`: from the components in a frame with the columns of `R` to the components in the frame of `R`'s rows.
#[must_use]
pub fn rotate(a: &Vector6<f64>, rotation: &Matrix3<f64>) -> Vector6<f64> {
    from_matrix(&(rotation * to_matrix(a) * rotation.transpose()))
}

/// 6x6 matrix `Q` of [`rotate`], orthogonal: `Q a = R a R^T`; a tangent turns as `Q D Q^T`.
#[must_use]
pub fn rotation(rotation: &Matrix3<f64>) -> Matrix6<f64> {
    let mut q = Matrix6::zeros();
    for (j, mut column) in q.column_iter_mut().enumerate() {
        let mut unit = Vector6::zeros();
        unit[j] = 1.0;
        column.copy_from(&rotate(&unit, rotation));
    }
    q
}

/// Components 11, 22, 33, 12, 13, 23 of a stress.
#[must_use]
pub fn to_voigt_stress(stress: &Vector6<f64>) -> [f64; 6] {
    std::array::from_fn(|i| stress[i] / WEIGHTS[i])
}

/// Tangent `dS/dE` by engineering shear strains (`2 E12`, ...), order 11, 22, 33, 12, 13, 23.
#[must_use]
pub fn to_voigt_tangent(tangent: &Matrix6<f64>) -> Matrix6<f64> {
    Matrix6::from_fn(|i, j| tangent[(i, j)] / (WEIGHTS[i] * WEIGHTS[j]))
}

/// Matrix of `x -> a x a` for a symmetric `a`, `1/2 (a_ik a_jl + a_il a_jk)`.
#[must_use]
#[inline]
pub fn symmetric_product(a: &Matrix3<f64>) -> Matrix6<f64> {
    let mut product = Matrix6::zeros();
    for (p, &(i, j)) in PAIRS.iter().enumerate() {
        for (q, &(k, l)) in PAIRS.iter().enumerate().skip(p) {
            let entry = 0.5 * WEIGHTS[p] * WEIGHTS[q] * (a[(i, k)] * a[(j, l)] + a[(i, l)] * a[(j, k)]);
            product[(p, q)] = entry;
            product[(q, p)] = entry;
        }
    }
    product
}
