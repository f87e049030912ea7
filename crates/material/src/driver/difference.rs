//! Difference quotients of a law.

use nalgebra::{Matrix3, Matrix6, Vector6};

use crate::LawError;
use crate::law::{Law, PointInput, Request, Response};
use crate::mandel;

/// Tangent `dS/dE` \[MPa\] by central differences of the stress, Mandel.
///
/// Each entry of `E` is moved by `+-step` through `dH = F^-T dE`. The old state and the mean elongation are held.
///
/// # Errors
/// [`LawError`] of any of the evaluations.
pub fn difference_tangent(law: &dyn Law, input: &PointInput, old: &[f64], step: f64) -> Result<Matrix6<f64>, LawError> {
    let mut tangent = Matrix6::zeros();
    let mut new = old.to_vec();
    for (j, mut column) in tangent.column_iter_mut().enumerate() {
        let mut stress_at = |step: f64| stress(law, &strained(input, j, step)?, old, &mut new);
        column.copy_from(&((stress_at(step)? - stress_at(-step)?) / (2.0 * step)));
    }
    Ok(tangent)
}

fn stress(law: &dyn Law, input: &PointInput, old: &[f64], new: &mut [f64]) -> Result<Vector6<f64>, LawError> {
    let mut out = Response::default();
    law.evaluate(input, old, new, Request::Stress, &mut out)?;
    Ok(out.second_piola)
}

/// The input with Mandel entry `entry` of the strain moved by `step` (to first order).
///
/// # Errors
/// [`LawError::Inverted`] where `F` has no inverse.
pub(crate) fn strained(input: &PointInput, entry: usize, step: f64) -> Result<PointInput, LawError> {
    let mut direction = Vector6::zeros();
    direction[entry] = step;
    let f = input.displacement_gradient + Matrix3::identity();
    let inverse = f.try_inverse().ok_or(LawError::Inverted { jacobian: f.determinant() })?;
    let mut moved = input.clone();
    moved.displacement_gradient += inverse.tr_mul(&mandel::to_matrix(&direction));
    Ok(moved)
}
