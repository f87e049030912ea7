//! Objectivity, rotated frames and transverse isotropy.

use nalgebra::{Matrix3, Matrix6};

use super::failure::{compare, largest};
use super::stencil::STEP;
use super::walk::{Step, answer, no_answer, regime, section_rotation, some_rotation, walk};
use super::{Path, TestkitFailure};
use crate::driver::{PointDriver, strained};
use crate::law::{Law, PointInput, Response, StateKind};
use crate::mandel;

/// Accepted error relative to the tangent: rotating `F` rounds the strain.
const TOLERANCE: f64 = 1e-12;

/// A rotation of the deformed body, `F -> Q F`, changes neither `S` nor the tangent nor the state.
///
/// # Errors
/// [`TestkitFailure`].
pub fn objectivity(law: &dyn Law, path: &Path) -> Result<(), TestkitFailure> {
    const CHECK: &str = "objectivity";
    let q = some_rotation();
    walk(CHECK, law, path, |step| {
        let f = step.input.displacement_gradient + Matrix3::identity();
        let rotated = PointInput::new(q * f - Matrix3::identity());
        let (out, new) = answer(law, &rotated, &step.old).map_err(no_answer(CHECK, step.index))?;
        let mut expected = (step.out.clone(), step.new.clone());
        expected.0.fibre = out.fibre.clone();
        same((CHECK, step.index), (&out, &new), (&expected.0, &expected.1))
    })
}

/// Stress, tangent, energy and state agree within rounding of the strain.
fn same(
    label: (&'static str, usize),
    found: (&Response, &[f64]),
    expected: (&Response, &[f64]),
) -> Result<(), TestkitFailure> {
    let modulus = largest(expected.0.tangent.as_slice());
    let tolerance = TOLERANCE * modulus;
    compare(label, found.0.second_piola.as_slice(), expected.0.second_piola.as_slice(), 6, tolerance)?;
    compare(label, &[found.0.stored_energy], &[expected.0.stored_energy], 1, tolerance)?;
    // A toe or a steep compaction makes the tangent itself sensitive to the strain's rounding.
    compare(label, found.0.tangent.as_slice(), expected.0.tangent.as_slice(), 6, 1e3 * tolerance)?;
    compare(label, found.1, expected.1, found.1.len().max(1), 1e-11)
}

/// The same motion seen from a frame that does not lie along the global axes: the rotated tangent is the derivative of
/// the rotated stress by the global strain.
///
/// # Errors
/// [`TestkitFailure`].
pub fn rotated_frame(law: &dyn Law, path: &Path) -> Result<(), TestkitFailure> {
    const CHECK: &str = "rotated frame";
    let frame = some_rotation();
    let driver = PointDriver::new(law, frame);
    let turn = mandel::rotation(&frame);
    walk(CHECK, law, path, |step| {
        let fail = no_answer(CHECK, step.index);
        let global = frame * step.input.displacement_gradient * frame.transpose();
        let here = driver.step(&step.old, &global).map_err(&fail)?;
        let stress = mandel::rotate(&step.out.second_piola, &frame);
        let modulus = largest(step.out.tangent.as_slice());
        let label = (CHECK, step.index);
        compare(label, here.second_piola_global.as_slice(), stress.as_slice(), 6, TOLERANCE * modulus)?;
        let expected = global_differences(law, &driver, step, &global).map_err(&fail)?;
        let found = turn * here.response.tangent * turn.transpose();
        // Columns across a kink are the business of the tangent's own check.
        let Some(expected) = expected else { return Ok(()) };
        compare(label, found.as_slice(), expected.as_slice(), 6, 1e-6 * modulus)
    })
}

/// Derivative of the global stress by the global strain; `None` when a mode starts or stops sliding in the stencil.
fn global_differences(
    law: &dyn Law,
    driver: &PointDriver<'_>,
    step: &Step,
    global: &Matrix3<f64>,
) -> Result<Option<Matrix6<f64>>, crate::LawError> {
    let pattern = |new: &[f64]| regime(law, &step.old, new);
    let mut tangent = Matrix6::zeros();
    for (entry, mut column) in tangent.column_iter_mut().enumerate() {
        let moved = |size: f64| {
            let input = strained(&PointInput::new(*global), entry, size)?;
            driver.step(&step.old, &input.displacement_gradient)
        };
        let (ahead, behind) = (moved(STEP)?, moved(-STEP)?);
        let here = pattern(&step.new);
        if pattern(&ahead.state) != here || pattern(&behind.state) != here {
            return Ok(None);
        }
        column.copy_from(&((ahead.second_piola_global - behind.second_piola_global) / (2.0 * STEP)));
    }
    Ok(Some(tangent))
}

/// A law of the norms does not see how the frame is turned about the fibre: stress and plastic strains turn along, the
/// distortion by twice the angle. Not part of [`super::check`], since an orthotropic law need not pass.
///
/// # Errors
/// [`TestkitFailure`].
pub fn transverse_isotropy(law: &dyn Law, path: &Path) -> Result<(), TestkitFailure> {
    const CHECK: &str = "transverse isotropy";
    let angle = 0.83;
    let turn = section_rotation(angle);
    walk(CHECK, law, path, |step| {
        let input = PointInput::new(turn * step.input.displacement_gradient * turn.transpose());
        let old = turn_state(law, &step.old, angle);
        let (out, new) = answer(law, &input, &old).map_err(no_answer(CHECK, step.index))?;
        let sixth = mandel::rotation(&turn);
        let mut expected = step.out.clone();
        expected.second_piola = sixth * step.out.second_piola;
        expected.tangent = sixth * step.out.tangent * sixth.transpose();
        same((CHECK, step.index), (&out, &new), (&expected, &turn_state(law, &step.new, angle)))
    })
}

/// The state seen from a frame turned about the fibre by `-angle`.
fn turn_state(law: &dyn Law, state: &[f64], angle: f64) -> Vec<f64> {
    let mut turned = state.to_vec();
    for variable in law.state_variables() {
        let angle = match variable.kind {
            StateKind::DistortionPlastic => 2.0 * angle,
            StateKind::LongitudinalShearPlastic => angle,
            _ => continue,
        };
        let (s, c) = angle.sin_cos();
        if let Some([x, y]) = turned.get_mut(variable.offset..variable.offset + variable.components) {
            (*x, *y) = (c * *x - s * *y, s * *x + c * *y);
        }
    }
    turned
}
