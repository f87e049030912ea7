//! Rest, idempotence, dissipation, symmetry and extremes.

use nalgebra::Matrix3;

use super::failure::{compare, largest};
use super::walk::{answer, no_answer, walk};
use super::{Path, TestkitFailure};
use crate::law::{Law, PointInput, Request, Response, StateKind};

/// An undeformed virgin point has no stress, no energy and a symmetric tangent; its state stays zero.
///
/// # Errors
/// [`TestkitFailure`].
pub fn rest(law: &dyn Law) -> Result<(), TestkitFailure> {
    const CHECK: &str = "rest";
    let old = vec![0.0; law.state_len()];
    let (out, new) = answer(law, &PointInput::new(Matrix3::zeros()), &old).map_err(no_answer(CHECK, 0))?;
    let label = (CHECK, 0);
    compare(label, out.second_piola.as_slice(), &[0.0; 6], 6, 0.0)?;
    compare(label, &[out.stored_energy, out.dissipated_mid[0], out.dissipated_mid[1]], &[0.0; 3], 1, 0.0)?;
    compare(label, &new, &old, 1, 0.0)?;
    symmetric(label, &out)
}

fn symmetric(label: (&'static str, usize), out: &Response) -> Result<(), TestkitFailure> {
    let tolerance = 1e-13 * largest(out.tangent.as_slice());
    compare(label, out.tangent.as_slice(), out.tangent.transpose().as_slice(), 6, tolerance)
}

/// A law that calls its tangent symmetric returns a symmetric one, and so does its fibre response.
///
/// # Errors
/// [`TestkitFailure`].
pub fn symmetry(law: &dyn Law, path: &Path) -> Result<(), TestkitFailure> {
    const CHECK: &str = "symmetry";
    walk(CHECK, law, path, |step| {
        if !law.is_symmetric() {
            return Ok(());
        }
        let label = (CHECK, step.index);
        symmetric(label, &step.out)?;
        if !law.has_fibre_term() {
            return Ok(());
        }
        let input = step.input.clone().with_mean_elongation(1e-3);
        let (out, _) = answer(law, &input, &step.old).map_err(no_answer(CHECK, step.index))?;
        symmetric(label, &out)?;
        let [found, expected] = [&out.fibre.stress_by_elongation, &out.fibre.fibre_stress_by_strain];
        compare(label, found.as_slice(), expected.as_slice(), 6, 1e-13 * largest(out.tangent.as_slice()))
    })
}

/// A second call gives the same bits, whatever the output held before; a call for the stress alone gives the same
/// stress.
///
/// # Errors
/// [`TestkitFailure`].
pub fn idempotence(law: &dyn Law, path: &Path) -> Result<(), TestkitFailure> {
    const CHECK: &str = "idempotence";
    walk(CHECK, law, path, |step| {
        let label = (CHECK, step.index);
        for request in [Request::Tangent, Request::Stress] {
            let mut out = step.out.clone();
            out.second_piola.fill(1e30);
            let mut new = vec![1e30; step.new.len()];
            law.evaluate(&step.input, &step.old, &mut new, request, &mut out).map_err(no_answer(CHECK, step.index))?;
            compare(label, &new, &step.new, 1, 0.0)?;
            compare(label, out.second_piola.as_slice(), step.out.second_piola.as_slice(), 6, 0.0)?;
            compare(label, out.tangent.as_slice(), step.out.tangent.as_slice(), 6, 0.0)?;
            compare(label, &[out.stored_energy], &[step.out.stored_energy], 1, 0.0)?;
        }
        Ok(())
    })
}

/// Both modes dissipate and accumulate, never the reverse; the stored energy is not negative.
///
/// # Errors
/// [`TestkitFailure`].
pub fn dissipation(law: &dyn Law, path: &Path) -> Result<(), TestkitFailure> {
    walk("dissipation", law, path, |step| {
        let fall = |value: f64| Err(TestkitFailure::Dissipation { step: step.index, value });
        let growing = [
            StateKind::TransverseSliding,
            StateKind::LongitudinalSliding,
            StateKind::TransverseDissipation,
            StateKind::LongitudinalDissipation,
        ];
        for variable in law.state_variables().iter().filter(|v| growing.contains(&v.kind)) {
            let (Some(old), Some(new)) = (step.old.get(variable.offset), step.new.get(variable.offset)) else {
                return Err(TestkitFailure::Contradiction { what: "state_variables" });
            };
            if new < old {
                return fall(new - old);
            }
        }
        let least = step.out.dissipated_mid[0].min(step.out.dissipated_mid[1]).min(step.out.stored_energy);
        if least < 0.0 { fall(least) } else { Ok(()) }
    })
}

/// Deformations that must be refused: not numbers, matter inside out or gone.
fn impossible() -> [Matrix3<f64>; 6] {
    let mut not_a_number = Matrix3::zeros();
    not_a_number[(1, 2)] = f64::NAN;
    let mut infinite = Matrix3::zeros();
    infinite[(0, 0)] = f64::INFINITY;
    [
        not_a_number,
        infinite,
        -Matrix3::identity(),
        Matrix3::from_diagonal(&[0.0, -2.0, 0.0].into()),
        Matrix3::from_diagonal(&[-2.0, 0.0, 0.0].into()),
        Matrix3::from_diagonal(&[-1.0, 0.3, 0.1].into()),
    ]
}

/// Deformations that are legal but far out: an error is fine, a number that is not finite is not.
fn far_out() -> Vec<Matrix3<f64>> {
    let shear = |size: f64| Matrix3::new(0.0, size, -size, 0.0, 0.0, size, 0.0, 0.0, 0.0);
    let stretch = |a: f64, b: f64, c: f64| Matrix3::from_diagonal(&[a - 1.0, b - 1.0, c - 1.0].into());
    let mut cases: Vec<_> = [1e-300, 1e-14, 1.0, 1e3, 1e8, 1e100, 1e300].map(shear).to_vec();
    for size in [1e-12, 1e-3, 1e3, 1e8, 1e60, 1e155, 1e300] {
        cases.extend([
            stretch(size, 1.0, 1.0),
            stretch(1.0, size, 1.0),
            stretch(1.0, size, 1.0 / size),
            stretch(size, size, size),
        ]);
    }
    cases
}

/// Impossible deformations, states and mean elongations give an error; far-out ones an error or finite numbers.
///
/// # Errors
/// [`TestkitFailure`].
pub fn extremes(law: &dyn Law) -> Result<(), TestkitFailure> {
    let old = vec![0.0; law.state_len()];
    for (case, gradient) in impossible().into_iter().enumerate() {
        if answer(law, &PointInput::new(gradient), &old).is_ok() {
            return Err(TestkitFailure::Accepted { case });
        }
    }
    for (case, gradient) in far_out().into_iter().enumerate() {
        let inputs = [PointInput::new(gradient), PointInput::new(gradient).with_mean_elongation(0.01)];
        for input in &inputs {
            if answer(law, input, &old).is_ok_and(|(out, new)| !is_finite(&out, &new)) {
                return Err(TestkitFailure::NotFinite { case });
            }
        }
    }
    refuses_bad_numbers(law, &old)
}

fn is_finite(out: &Response, new: &[f64]) -> bool {
    let fibre = &out.fibre;
    out.second_piola.iter().all(|x| x.is_finite())
        && out.tangent.iter().all(|x| x.is_finite())
        && fibre.stress_by_elongation.iter().all(|x| x.is_finite())
        && fibre.fibre_stress.is_finite()
        && fibre.fibre_stiffness.is_finite()
        && out.stored_energy.is_finite()
        && out.dissipated_mid.iter().all(|x| x.is_finite())
        && new.iter().all(|x| x.is_finite())
}

/// A mean elongation or a state that is not a number is refused; so is a mean elongation without a fibre term.
fn refuses_bad_numbers(law: &dyn Law, old: &[f64]) -> Result<(), TestkitFailure> {
    let rest = PointInput::new(Matrix3::zeros());
    let averaged = rest.clone().with_mean_elongation(f64::NAN);
    if answer(law, &averaged, old).is_ok() {
        return Err(TestkitFailure::Contradiction { what: "a mean elongation that is not a number was accepted" });
    }
    if answer(law, &rest.clone().with_mean_elongation(0.0), old).is_ok() != law.has_fibre_term() {
        return Err(TestkitFailure::Contradiction { what: "has_fibre_term" });
    }
    if !old.is_empty() && answer(law, &rest, &vec![f64::NAN; old.len()]).is_ok() {
        return Err(TestkitFailure::Contradiction { what: "a state that is not a number was accepted" });
    }
    Ok(())
}
