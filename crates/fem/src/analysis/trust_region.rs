//! Minimisation of the incremental potential within a trust region: the way on where Newton's method finds none.
//!
//! Where forces derive from an incremental potential `Pi(q)` a stable equilibrium is a minimum of it. From the iterate `q` with
//! gradient `g` (the residual) and tangent `K` a step `p` minimises the model
//!
//! ```text
//! m(p) = g.p + p.K p/2   within   |p| = sqrt(p.D p) <= radius,     D = |diag K| of the first iterate,
//! ```
//!
//! which is solved by `(K + s D) p = -g` with the least `s >= 0` for which `K + s D` is positive definite, as the pivots of
//! its factors tell, and the step is not too long (Moré and Sorensen, SIAM J. Sci. Stat. Comput. 4 (1983) 553). Where the
//! gradient has no part along the mode of least stiffness, as on the symmetric branch past a bifurcation, the step is
//! lengthened along that mode. The radius follows the ratio of the fall of `Pi` to that of the model (Conn, Gould and
//! Toint, Trust-Region Methods, SIAM 2000, algorithm 6.1.1). Near the end `s = 0`: the steps are Newton's.
//!
//! What it ends in satisfies the tolerances of Newton's method and has a positive definite tangent. That may be another
//! branch than the one the increment began on: the account of the increment tells the energy that left.

use super::driver::Analysis;
use super::line_search::{ENERGY_NOISE, ends_search};
use super::mode::Metric;
use super::newton::{Attempt, relative_residual};
use super::record::{IncrementRecord, Phase};
use super::workspace::Workspace;
use crate::FemError;
use crate::assembly::System;
use crate::contribution::Request;
use crate::linear::LinearError;

/// Most steps of an attempt, rejected ones included, over the iterations that Newton's method may take.
const MOST_STEPS: usize = 10;
/// Part of its first radius below which a region has shrunk to nothing.
const NOTHING: f64 = 1e-12;
/// Most factorisations for one step.
const MOST_SHIFTS: usize = 40;
/// First shift that is tried, over the diagonal of the tangent.
const FIRST_SHIFT: f64 = 1e-4;
/// Ratio of two shifts between which no better one is looked for.
const NARROW: f64 = 1.1;
/// Lengths over the radius that count as reaching it.
const REACHED: std::ops::RangeInclusive<f64> = 0.7..=1.1;
/// Ratio of the falls from which a step is taken, and those between which the radius stays.
const TAKEN: f64 = 1e-3;
const POOR: f64 = 0.25;
const GOOD: f64 = 0.75;
/// Fall of the model, over the rounding of the potential, from which differences of the potential are trusted.
const CLEAR: f64 = 1e4;

/// The region, and what does not change from step to step.
struct Region {
    /// Bound of the length of a step \[sqrt(mJ)\].
    radius: f64,
    /// Where it is given up.
    least: f64,
    /// The last shift that was not zero.
    shift: f64,
    metric: Metric,
    /// Diagonal of the tangent at the base.
    diagonal: Vec<f64>,
    /// A vector of unknowns.
    buffer: Vec<f64>,
    /// Another: the mode of least stiffness.
    mode: Vec<f64>,
}

impl Region {
    fn new(system: &System) -> Self {
        let zeros = vec![0.0; system.equations().len()];
        Self {
            radius: 0.0,
            least: 0.0,
            shift: FIRST_SHIFT,
            metric: Metric::of_stiffness(system),
            diagonal: zeros.clone(),
            buffer: zeros.clone(),
            mode: zeros,
        }
    }

    /// After a step of some length whose fall over that of the model is known.
    fn adapt(&mut self, ratio: f64, length: f64) {
        if ratio < POOR {
            self.radius = POOR * self.radius.min(length);
        } else if ratio > GOOD && length >= REACHED.start() * self.radius {
            self.radius *= 2.0;
        }
    }
}

/// Shifts known to be too small and large enough.
struct Bracket {
    low: f64,
    high: f64,
}

impl Bracket {
    /// The next shift where the tangent is not definite, or nothing better is known.
    fn inner(&self, first: f64) -> f64 {
        if self.high.is_finite() {
            (self.low.max(1e-3 * self.high) * self.high).sqrt()
        } else if self.low == 0.0 {
            first
        } else {
            10.0 * self.low
        }
    }

    /// A guess, if it lies well within.
    fn admit(&self, guess: f64) -> f64 {
        let inside = guess.is_finite() && guess > self.low && guess < self.high;
        if inside { guess } else { self.inner(FIRST_SHIFT) }
    }

    fn is_narrow(&self) -> bool {
        self.high <= NARROW * self.low
    }
}

impl Analysis {
    /// Finds a minimum of the incremental potential at the end of an attempt.
    pub(super) fn minimise(
        &mut self,
        work: &mut Workspace,
        attempt: Attempt,
        record: &mut IncrementRecord,
    ) -> Result<(), FemError> {
        self.start_anew(work);
        self.first_iterate(work, attempt, record)?;
        let mut region = self.region(work)?;
        let last = record.iterations + MOST_STEPS * self.options.max_iterations;
        let (mut energy, mut largest_energy) = (0.0, 0.0_f64);
        loop {
            let relative = relative_residual(&work.base);
            record.residuals.push(relative);
            if self.is_converged(relative, energy, largest_energy) && self.is_minimum(record)? {
                if !self.review()? {
                    return Ok(());
                }
                self.totals.augmentations += 1;
                self.evaluate(&mut work.base, &work.target, None, Request::Tangent)?;
            }
            if record.iterations >= last {
                return Err(self.not_converged(work, record.iterations));
            }
            largest_energy = largest_energy.max(self.descend(work, &mut region, record, last)?);
            energy = self.slope(work).abs();
        }
    }

    /// A region as wide as the increment has moved, or as one step of Jacobi's method.
    fn region(&self, work: &mut Workspace) -> Result<Region, FemError> {
        let system = self.system.as_ref().ok_or(FemError::NonFiniteResidual)?;
        let mut region = Region::new(system);
        system.equations().gather(&self.moved(&work.base), &mut region.buffer);
        work.aim(system.equations());
        let jacobi = work.rhs.iter().zip(&region.metric.weights).map(|(r, w)| r * r / w).sum::<f64>().sqrt();
        region.radius = region.metric.length(&region.buffer).max(jacobi);
        region.least = NOTHING * region.radius;
        Ok(region)
    }

    /// Whether the tangent at the base is positive definite; notes its pivots.
    fn is_minimum(&mut self, record: &mut IncrementRecord) -> Result<bool, FemError> {
        match self.count_negative_pivots() {
            Err(FemError::Linear(LinearError::Singular { .. })) => Ok(false),
            pivots => {
                record.negative_pivots = pivots?;
                Ok(record.negative_pivots == Some(0))
            }
        }
    }

    pub(super) fn count_negative_pivots(&mut self) -> Result<Option<usize>, FemError> {
        self.totals.factorisations += 1;
        let Some(system) = self.system.as_mut() else { return Ok(None) };
        self.phases.measure(Phase::Factorisation, || system.factorise())
    }

    /// Takes one step down and leaves the base evaluated there; answers the slope of the potential along it.
    fn descend(
        &mut self,
        work: &mut Workspace,
        region: &mut Region,
        record: &mut IncrementRecord,
        last: usize,
    ) -> Result<f64, FemError> {
        work.base.potential += self.freeze();
        let system = self.system.as_ref().ok_or(FemError::NonFiniteResidual)?;
        system.diagonal(&mut region.diagonal);
        work.aim(system.equations());
        while record.iterations < last && region.radius >= region.least {
            let predicted = self.step_within(work, region)?;
            record.iterations += 1;
            let length = region.metric.length(&work.correction);
            let downhill = predicted > 0.0 && length > 0.0;
            if !downhill {
                break;
            }
            match self.go(work, 1.0, Request::Residual) {
                Ok(()) => {
                    let ratio = self.fall(work, predicted) / predicted;
                    region.adapt(ratio, length);
                    if ratio > TAKEN {
                        let slope = self.slope(work).abs();
                        self.settle(work, 1.0, Request::Residual)?;
                        return Ok(slope);
                    }
                }
                Err(error) if ends_search(&error) => return Err(error),
                Err(_) => region.adapt(0.0, length),
            }
        }
        Err(self.not_converged(work, record.iterations))
    }

    /// Fall of the potential from the base to the trial. Where its difference would be rounding, the trapezoidal rule along
    /// the step is the better measure: `-(g_base + g_trial).p/2`.
    fn fall(&self, work: &Workspace, predicted: f64) -> f64 {
        let (base, trial) = (&work.base, &work.trial);
        let noise = ENERGY_NOISE * (base.potential.abs() + trial.potential.abs());
        if predicted > CLEAR * noise {
            base.potential - trial.potential
        } else {
            -0.5 * (self.slope_of(base, &work.correction) + self.slope_of(trial, &work.correction))
        }
    }

    /// Makes the step within the radius the correction; answers by how much the model falls.
    fn step_within(&mut self, work: &mut Workspace, region: &mut Region) -> Result<f64, FemError> {
        let mut bracket = Bracket { low: 0.0, high: f64::INFINITY };
        let mut shift = 0.0;
        for _ in 0..MOST_SHIFTS {
            if !self.is_definite(region, shift)? {
                bracket.low = shift;
                shift = bracket.inner(region.shift);
                continue;
            }
            self.solve_by_factors(&work.rhs, &mut work.correction)?;
            let ratio = region.metric.length(&work.correction) / region.radius;
            if shift > 0.0 {
                region.shift = shift;
            }
            if REACHED.contains(&ratio) || (shift == 0.0 && ratio < 1.0) {
                return self.model_fall(work, region, shift);
            }
            if ratio > 1.0 {
                bracket.low = shift
            } else {
                bracket.high = shift
            }
            if bracket.is_narrow() {
                self.finish_step(work, region, ratio, shift)?;
                return self.model_fall(work, region, shift);
            }
            shift = bracket.admit(self.secular(work, region, shift)?);
        }
        Err(self.not_converged(work, MOST_SHIFTS))
    }

    /// Factorises `K + shift D`; says whether it is positive definite.
    fn is_definite(&mut self, region: &Region, shift: f64) -> Result<bool, FemError> {
        if let Some(system) = self.system.as_mut() {
            let shifted = region.diagonal.iter().zip(&region.metric.weights).map(|(k, w)| k + shift * w);
            system.set_diagonal(shifted);
        }
        match self.count_negative_pivots() {
            Ok(pivots) => Ok(pivots == Some(0)),
            Err(FemError::Linear(LinearError::Singular { .. })) => Ok(false),
            Err(error) => Err(error),
        }
    }

    /// Newton's next shift for `1/|p(s)| = 1/radius`, with `d|p|^2/ds = -2 p.D (K + s D)^-1 D p`.
    fn secular(&mut self, work: &Workspace, region: &mut Region, shift: f64) -> Result<f64, FemError> {
        let p = &work.correction;
        let mut rhs = std::mem::take(&mut region.buffer);
        region.metric.weigh(p, &mut rhs);
        let solved = self.solve_by_factors(&rhs, &mut region.mode);
        let bend: f64 = rhs.iter().zip(&region.mode).map(|(a, b)| a * b).sum();
        region.buffer = rhs;
        solved?;
        let length = region.metric.length(p);
        Ok(shift + length * length / bend * (length / region.radius - 1.0))
    }

    /// Brings a step to the radius that no shift brings there: cuts one that is too long, and lengthens one that is too
    /// short along the mode of least stiffness, downhill.
    fn finish_step(
        &mut self,
        work: &mut Workspace,
        region: &mut Region,
        ratio: f64,
        shift: f64,
    ) -> Result<(), FemError> {
        if ratio > 1.0 {
            work.correction.iter_mut().for_each(|p| *p /= ratio);
            return Ok(());
        }
        self.least_mode(&region.metric, &work.correction, &mut region.mode, &mut region.buffer)?;
        let mode = &region.mode;
        let stiffness = self.quadratic(mode, &mut region.buffer)? - shift;
        if stiffness < 0.0 {
            let uphill: f64 = work.rhs.iter().zip(mode).map(|(r, m)| -r * m).sum();
            let amount = region.radius * (1.0 - ratio * ratio).sqrt();
            let amount = if uphill > 0.0 { -amount } else { amount };
            work.correction.iter_mut().zip(mode).for_each(|(p, m)| *p += amount * m);
        }
        Ok(())
    }

    /// `-m(p)` of the correction, whose tangent is shifted.
    fn model_fall(&self, work: &Workspace, region: &mut Region, shift: f64) -> Result<f64, FemError> {
        let p = &work.correction;
        let length = region.metric.length(p);
        let curved = self.quadratic(p, &mut region.buffer)? - shift * length * length;
        let along: f64 = work.rhs.iter().zip(p).map(|(r, p)| r * p).sum();
        Ok(along - 0.5 * curved)
    }

    /// `x.A x` of the matrix as it stands.
    fn quadratic(&self, x: &[f64], product: &mut [f64]) -> Result<f64, FemError> {
        let system = self.system.as_ref().ok_or(FemError::NonFiniteResidual)?;
        system.multiply(x, product)?;
        Ok(x.iter().zip(product).map(|(a, b)| a * *b).sum())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn region() -> Region {
        let two = vec![0.0; 2];
        Region {
            radius: 2.0,
            least: 0.0,
            shift: 1.0,
            metric: Metric { weights: vec![4.0, 1.0] },
            diagonal: two.clone(),
            buffer: two.clone(),
            mode: two,
        }
    }

    #[test]
    fn the_radius_follows_the_model() {
        let mut region = region();
        region.adapt(0.5, 2.0);
        assert_eq!(region.radius, 2.0);
        region.adapt(0.9, 1.0);
        assert_eq!(region.radius, 2.0, "the step was short by itself");
        region.adapt(0.9, 2.1);
        assert_eq!(region.radius, 4.0);
        region.adapt(-1.0, 2.0);
        assert_eq!(region.radius, 0.5);
        assert_eq!(region.metric.length(&[1.0, 2.0]), 8.0_f64.sqrt());
    }

    #[test]
    fn shifts_are_raised_until_enough_and_then_enclosed() {
        let mut bracket = Bracket { low: 0.0, high: f64::INFINITY };
        assert_eq!(bracket.inner(0.5), 0.5);
        bracket.low = 0.5;
        assert_eq!(bracket.inner(0.5), 5.0);
        bracket.high = 8.0;
        assert_eq!(bracket.inner(0.5), 2.0);
        assert_eq!((bracket.admit(3.0), bracket.admit(9.0), bracket.admit(f64::NAN)), (3.0, 2.0, 2.0));
        assert!(!bracket.is_narrow());
        bracket.low = 7.5;
        assert!(bracket.is_narrow());
    }
}
