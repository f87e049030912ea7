//! The yield edge: continuity across it, the tangent on either side, and no chattering.

use nalgebra::Matrix3;

use super::derivatives::tangent_of_step;
use super::failure::{compare, largest};
use super::walk::{Step, answer, no_answer, slides, walk};
use super::{Path, TestkitFailure};
use crate::law::{Law, PointInput, Response};

const CHECK: &str = "yield edge";
/// Bisections that locate the edge within a step, down to rounding.
const BISECTIONS: usize = 52;
/// Accepted error of a one-sided quotient relative to the largest entry of the tangent.
const ONE_SIDED_TOLERANCE: f64 = 1e-6;
/// Distances from the edge, as fractions of the step, at which the tangent is checked.
const DISTANCES: [f64; 4] = [-1e-3, 0.0, 1e-14, 1e-3];

/// Where a mode begins to slide within a step: the stress is continuous, the tangent is right on either side, and the
/// committed point does not slide again when it is evaluated a second time at the same deformation.
///
/// # Errors
/// [`TestkitFailure`].
pub fn yield_edge(law: &dyn Law, path: &Path) -> Result<(), TestkitFailure> {
    let mut before = Matrix3::zeros();
    walk(CHECK, law, path, |step| {
        settles(law, step)?;
        let segment = Segment { law, step, start: before, end: step.input.displacement_gradient };
        before = segment.end;
        (0..2).try_for_each(|mode| segment.check(mode))
    })
}

/// The new state at the same deformation is at rest, with the same stress.
fn settles(law: &dyn Law, step: &Step) -> Result<(), TestkitFailure> {
    let label = (CHECK, step.index);
    let (again, state) = answer(law, &step.input, &step.new).map_err(no_answer(CHECK, step.index))?;
    let tolerance = 1e-12 * largest(step.out.tangent.as_slice());
    compare(label, &again.dissipated_mid, &[0.0; 2], 1, 0.0)?;
    compare(label, again.second_piola.as_slice(), step.out.second_piola.as_slice(), 6, tolerance)?;
    compare(label, &state, &step.new, state.len().max(1), 0.0)
}

/// The straight line from the previous deformation to that of the step, at the old state.
struct Segment<'a> {
    law: &'a dyn Law,
    step: &'a Step,
    start: Matrix3<f64>,
    end: Matrix3<f64>,
}

impl Segment<'_> {
    fn at(&self, fraction: f64) -> Result<(PointInput, Response, Vec<f64>), TestkitFailure> {
        let input = PointInput::new(self.start + (self.end - self.start) * fraction);
        let (out, new) = answer(self.law, &input, &self.step.old).map_err(no_answer(CHECK, self.step.index))?;
        Ok((input, out, new))
    }

    fn slides(&self, mode: usize, fraction: f64) -> Result<bool, TestkitFailure> {
        let (_, _, new) = self.at(fraction)?;
        Ok(slides(self.law, &self.step.old, &new).get(mode) == Some(&true))
    }

    /// Checks the edge of a mode that slides at the end and not at the start.
    fn check(&self, mode: usize) -> Result<(), TestkitFailure> {
        if !self.slides(mode, 1.0)? || self.slides(mode, 0.0)? {
            return Ok(());
        }
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            *(if self.slides(mode, middle)? { &mut high } else { &mut low }) = middle;
        }
        self.continuity(low, high)?;
        DISTANCES.iter().try_for_each(|distance| self.tangent((high + distance).clamp(0.0, 1.0)))
    }

    fn continuity(&self, low: f64, high: f64) -> Result<(), TestkitFailure> {
        let ((_, below, _), (_, above, _)) = (self.at(low)?, self.at(high)?);
        let tolerance = 1e-12 * largest(below.tangent.as_slice());
        let label = (CHECK, self.step.index);
        compare(label, above.second_piola.as_slice(), below.second_piola.as_slice(), 6, tolerance)
    }

    fn tangent(&self, fraction: f64) -> Result<(), TestkitFailure> {
        let (input, out, new) = self.at(fraction)?;
        let step = Step { index: self.step.index, input, old: self.step.old.clone(), new, out };
        match tangent_of_step((CHECK, step.index), self.law, &step, ONE_SIDED_TOLERANCE) {
            // At the very edge every stencil may cross it.
            Err(TestkitFailure::NothingCompared { .. }) => Ok(()),
            other => other,
        }
    }
}
