//! The mode of least stiffness of a tangent whose factors are at hand.

use super::driver::Analysis;
use super::record::Phase;
use crate::FemError;
use crate::assembly::System;

/// Steps of inverse iteration.
const INVERSE_STEPS: usize = 8;
/// Part of the largest diagonal entry below which no weight lies.
const LEAST_WEIGHT: f64 = 1e-8;

/// The metric of steps and modes: `|x| = sqrt(x.D x)`.
pub struct Metric {
    /// `D`.
    pub weights: Vec<f64>,
}

impl Metric {
    /// `D = |diag K|` of the tangent as it stands \[sqrt(mJ)\].
    pub fn of_stiffness(system: &System) -> Self {
        let mut weights = vec![0.0; system.equations().len()];
        system.diagonal(&mut weights);
        let largest = weights.iter().fold(0.0_f64, |most, w| most.max(w.abs()));
        let least = if largest > 0.0 { LEAST_WEIGHT * largest } else { 1.0 };
        weights.iter_mut().for_each(|w| *w = w.abs().max(least));
        Self { weights }
    }

    /// `|x|`.
    pub fn length(&self, x: &[f64]) -> f64 {
        self.product(x, x).sqrt()
    }

    /// `a.D b`.
    pub fn product(&self, a: &[f64], b: &[f64]) -> f64 {
        self.weights.iter().zip(a).zip(b).map(|((w, a), b)| w * a * b).sum()
    }

    /// `D x`.
    pub fn weigh(&self, x: &[f64], out: &mut [f64]) {
        out.iter_mut().zip(&self.weights).zip(x).for_each(|((o, w), x)| *o = w * x);
    }
}

impl Analysis {
    /// The mode of least stiffness, of length one, by inverse iteration with the factors at hand from near a vector.
    pub(super) fn least_mode(
        &mut self,
        metric: &Metric,
        start: &[f64],
        mode: &mut [f64],
        buffer: &mut [f64],
    ) -> Result<(), FemError> {
        let scale = metric.length(start) / (start.len() as f64).sqrt();
        let scale = if scale > 0.0 { scale } else { 1.0 };
        // A start that shares no symmetry with the model.
        let entries = mode.iter_mut().zip(start).zip(&metric.weights).enumerate();
        entries.for_each(|(i, ((m, p), w))| *m = p + scale * irregular(i) / w.sqrt());
        for _ in 0..INVERSE_STEPS {
            metric.weigh(mode, buffer);
            self.solve_by_factors(buffer, mode)?;
            let length = metric.length(mode);
            mode.iter_mut().for_each(|m| *m /= length);
        }
        Ok(())
    }

    /// Solves with the factors at hand.
    pub(super) fn solve_by_factors(&mut self, rhs: &[f64], x: &mut [f64]) -> Result<(), FemError> {
        let Some(system) = self.system.as_mut() else { return Ok(()) };
        self.totals.linear_iterations += self.phases.measure(Phase::Solution, || system.solve(rhs, x))?;
        Ok(())
    }
}

/// A number between -1 and 1 that follows no pattern: multiples of the golden ratio, modulo one.
fn irregular(index: usize) -> f64 {
    2.0 * ((index + 1) as f64 * 0.618_033_988_749_894_9).fract() - 1.0
}
