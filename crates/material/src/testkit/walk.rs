//! Steps of a path with the state chained through them.

use nalgebra::Matrix3;

use super::{Path, TestkitFailure};
use crate::LawError;
use crate::law::{Law, PointInput, Request, Response, StateKind};

/// One step: input, the state before it, the state after it and the answer.
#[derive(Clone, Debug)]
pub(super) struct Step {
    pub(super) index: usize,
    pub(super) input: PointInput,
    pub(super) old: Vec<f64>,
    pub(super) new: Vec<f64>,
    pub(super) out: Response,
}

/// Whether the transverse and the longitudinal mode slid: their accumulated sliding grew.
pub(super) fn slides(law: &dyn Law, old: &[f64], new: &[f64]) -> [bool; 2] {
    [StateKind::TransverseSliding, StateKind::LongitudinalSliding].map(|kind| {
        let found = law.state_variables().iter().find(|variable| variable.kind == kind);
        found.is_some_and(|variable| new.get(variable.offset) > old.get(variable.offset))
    })
}

/// Which branch of the law a step took: what slid, and whether there is compaction pressure (where it is kept).
pub(super) fn regime(law: &dyn Law, old: &[f64], new: &[f64]) -> ([bool; 2], bool) {
    let kept = law.state_variables().iter().find(|variable| variable.kind == StateKind::CompactionPressure);
    let pressed = kept.is_some_and(|variable| new.get(variable.offset) > Some(&0.0));
    (slides(law, old, new), pressed)
}

/// Answer and new state of a law.
pub(super) fn answer(law: &dyn Law, input: &PointInput, old: &[f64]) -> Result<(Response, Vec<f64>), LawError> {
    let mut out = Response::default();
    let mut new = old.to_vec();
    law.evaluate(input, old, &mut new, Request::Tangent, &mut out)?;
    Ok((out, new))
}

/// Visits every step of a path from the virgin state.
pub(super) fn walk(
    check: &'static str,
    law: &dyn Law,
    path: &Path,
    mut visit: impl FnMut(&Step) -> Result<(), TestkitFailure>,
) -> Result<(), TestkitFailure> {
    let mut old = vec![0.0; law.state_len()];
    for (index, gradient) in path.gradients().iter().enumerate() {
        let input = PointInput::new(*gradient);
        let (out, new) = answer(law, &input, &old).map_err(no_answer(check, index))?;
        let step = Step { index, input, old, new, out };
        visit(&step)?;
        old = step.new;
    }
    Ok(())
}

/// Wraps what the law said.
pub(super) fn no_answer(check: &'static str, step: usize) -> impl Fn(LawError) -> TestkitFailure {
    move |source| TestkitFailure::NoAnswer { check, step, source }
}

/// A rotation by Euler angles that are no special case.
pub(super) fn some_rotation() -> Matrix3<f64> {
    *nalgebra::Rotation3::from_euler_angles(0.7, -1.1, 2.3).matrix()
}

/// Rotation of the section by `angle`, leaving the fibre.
pub(super) fn section_rotation(angle: f64) -> Matrix3<f64> {
    let (s, c) = angle.sin_cos();
    Matrix3::new(1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c)
}
