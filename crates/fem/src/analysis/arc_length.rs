//! Equilibrium paths on which the fraction of the step is an unknown: past limit points and snap-back.
//!
//! Motions and loads of a step are functions of its fraction `s`, so that `r(q, s) = 0` is a path. An increment of
//! length `a` goes on along it until
//!
//! ```text
//! sqrt((|dq|^2/U^2 + ds^2)/2) + dD/W = a,     U = |dq|/|ds|,  W = |sum dF dq|/(2 ds^2)  of the first increment,
//! ```
//!
//! with `|q|^2` the sum over the unknowns, rotations times the lever of the model, and `dD` the dissipation of the
//! increment. Where the structure is as stiff as at the start of the step and nothing slides, `a` is the fraction of
//! the step; where it gives way motions count instead (Riks, Int. J. Solids Struct. 15 (1979) 529; Crisfield, Comput.
//! Struct. 13 (1981) 55), and where all of it unloads but a few places, in which friction does its work, dissipation
//! does (Gutiérrez, Commun. Numer. Meth. Eng. 20 (2004) 19).
//!
//! The first iterate continues the last increment, which also says where forwards is. Corrections solve for both
//! right-hand sides with one factorisation,
//!
//! ```text
//! K da = -r,   K db = -dr/ds,   dq = da + ds db,
//! ```
//!
//! with `ds` from the linearised constraint. `dr/ds`, and `dD/ds` along `db`, are differences, with motions and loads
//! a little further on: they hold for rotations, arcs and whatever else a path may be, and their error changes the
//! rate of convergence by that little, not the result. The dissipation along `da`, which vanishes with the residual,
//! is left out of the linearised constraint.
//!
//! Where a structure unloads from one increment to the next, as a brittle one does, motions turn back and the arc
//! cannot tell that way from the one that it came. An increment that fails, or on which far less slides than on the
//! last (a tenth), is tried again with
//!
//! ```text
//! dD/W = a.
//! ```
//!
//! If that fails too, an increment on which far less slides is refused: it most likely goes back elastically. Where
//! nothing shorter can be tried it is taken, unless it turns back on the last one.
//!
//! The first increment of a step has a given fraction. The last one is cut back to `s = 1` once the path is known to
//! go beyond.

use super::driver::Analysis;
use super::line_search::ends_search;
use super::newton::{Attempt, hopeless, relative_residual};
use super::record::IncrementRecord;
use super::step::Step;
use super::workspace::{Iterate, Workspace};
use crate::contribution::Request;
use crate::{Energies, FemError};

/// Difference of fractions for derivatives, over the advance of the increment.
const AHEAD: f64 = 1e-6;

/// Part of its length by which an increment may be longer or shorter.
const ABOUT: f64 = 0.1;

/// Least difference of fractions for derivatives: its own rounding is `1e-7` of it.
const LEAST_AHEAD: f64 = 1e-9;

/// Part of the dissipation that the last increment leads one to expect, below which an increment unloads.
const UNLOADING: f64 = 0.1;

/// What the length of an increment is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// Motions, fraction and dissipation.
    Arc,
    /// Dissipation alone.
    Dissipation,
}

/// What the arc length of a step is measured in, and the last increment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PathScale {
    /// `U` \[mm\]; zero before the first increment.
    pub motion: f64,
    /// `W` \[mJ\].
    pub work: f64,
    /// Change of the fraction over the last increment.
    pub advance: f64,
    /// Dissipation of the last increment \[mJ\].
    pub dissipation: f64,
}

/// Derivatives along the path.
pub struct Sweep {
    /// `db`.
    pub along: Vec<f64>,
    /// `dD/ds` along it \[mJ\].
    dissipation: f64,
}

impl Sweep {
    /// For so many unknowns.
    pub fn new(unknowns: usize) -> Self {
        Self { along: vec![0.0; unknowns], dissipation: 0.0 }
    }
}

impl Analysis {
    /// Follows the path over an arc and says in the attempt where it ends.
    pub(super) fn follow(
        &mut self,
        work: &mut Workspace,
        step: &Step,
        attempt: &mut Attempt,
        record: &mut IncrementRecord,
    ) -> Result<(), FemError> {
        if self.last_length == 0.0 {
            return self.set_out(work, step, attempt, record);
        }
        let start = *attempt;
        let by_arc = self.follow_by(work, step, (attempt, record), Measure::Arc);
        let suspect = match &by_arc {
            Ok(()) => self.unloads(work, start, *attempt),
            Err(error) => !ends_search(error),
        };
        if !suspect || !self.dissipates(work) {
            return by_arc.and_then(|()| self.settle_path(work, step, attempt, record));
        }
        let unloading = FemError::TurnsBack { fraction: attempt.to };
        *attempt = start;
        match self.follow_by(work, step, (attempt, record), Measure::Dissipation) {
            Ok(()) => self.stretch(&work.base, attempt),
            Err(error) if ends_search(&error) => return Err(error),
            // Sliding has come to an end.
            Err(_) if by_arc.is_ok() && start.last_resort => {
                *attempt = start;
                self.follow_by(work, step, (attempt, record), Measure::Arc)?;
            }
            Err(_) => return Err(by_arc.err().unwrap_or(unloading)),
        }
        self.settle_path(work, step, attempt, record)
    }

    /// Whether the fraction of an attempt is an unknown.
    pub(super) fn is_along(&self, step: &Step, attempt: Attempt) -> bool {
        step.increments.are_arcs() && self.last_length != 0.0 && attempt.to != 1.0
    }

    /// An increment to a given fraction: the first of a step, or after a minimum.
    fn set_out(
        &mut self,
        work: &mut Workspace,
        step: &Step,
        attempt: &mut Attempt,
        record: &mut IncrementRecord,
    ) -> Result<(), FemError> {
        attempt.to = (attempt.from + attempt.length).min(1.0);
        attempt.length = attempt.to - attempt.from;
        self.aim_at(work, step, *attempt);
        self.iterate(work, *attempt, record)
    }

    /// Follows the path from where the last increment points to.
    fn follow_by(
        &mut self,
        work: &mut Workspace,
        step: &Step,
        (attempt, record): (&mut Attempt, &mut IncrementRecord),
        measure: Measure,
    ) -> Result<(), FemError> {
        self.start_anew(work);
        let ratio = attempt.length / self.last_length;
        attempt.to = attempt.from + ratio * self.path.advance;
        self.continue_last(&mut work.base, ratio);
        self.correct_along(work, step, (attempt, record), measure)
    }

    /// Refuses the way back, and ends at the end of the step.
    fn settle_path(
        &mut self,
        work: &mut Workspace,
        step: &Step,
        attempt: &mut Attempt,
        record: &mut IncrementRecord,
    ) -> Result<(), FemError> {
        if self.turns_back(work, *attempt) {
            return Err(FemError::TurnsBack { fraction: attempt.to });
        }
        if attempt.to > 1.0 { self.land(work, step, attempt, record) } else { Ok(()) }
    }

    /// Newton's method for coordinates and fraction together.
    pub(super) fn correct_along(
        &mut self,
        work: &mut Workspace,
        step: &Step,
        (attempt, record): (&mut Attempt, &mut IncrementRecord),
        measure: Measure,
    ) -> Result<(), FemError> {
        let mut sweep = Sweep::new(work.rhs.len());
        let (mut energy, mut largest_energy) = (0.0, 0.0_f64);
        // Iterations and residuals before this round of multipliers.
        let (mut spent, mut seen) = (record.iterations, record.residuals.len());
        loop {
            self.aim_at(work, step, *attempt);
            self.evaluate(&mut work.base, &work.target, None, Request::Tangent)?;
            if record.iterations > spent {
                energy = self.slope(work).abs();
            }
            let relative = relative_residual(&work.base);
            record.residuals.push(relative);
            if self.is_converged(relative, energy, largest_energy) && self.is_as_long(work, *attempt, measure) {
                if !self.review()? {
                    return Ok(());
                }
                self.totals.augmentations += 1;
                self.evaluate(&mut work.base, &work.target, None, Request::Tangent)?;
                (spent, seen) = (record.iterations, record.residuals.len());
            }
            if record.iterations >= spent + self.options.max_iterations || hopeless(&record.residuals[seen..], false) {
                return Err(self.not_converged(work, record.iterations));
            }
            record.negative_pivots = self.correct(work)?;
            record.iterations += 1;
            self.sweep(work, step, *attempt, &mut sweep)?;
            let change = self.go_along(work, *attempt, &sweep, measure)?;
            attempt.to += change;
            work.correction.iter_mut().zip(&sweep.along).for_each(|(a, b)| *a += change * b);
            largest_energy = largest_energy.max(self.slope(work).abs());
            self.equations()?.scatter_add(1.0, &work.correction, &mut work.base.q);
        }
    }

    /// Whether the base is about as far along the path as it shall be.
    fn is_as_long(&self, work: &Workspace, attempt: Attempt, measure: Measure) -> bool {
        (attempt.length - self.measured(&work.base, attempt, measure)).abs() <= ABOUT * attempt.length
    }

    /// The path goes beyond the end of the step: the increment ends there.
    fn land(
        &mut self,
        work: &mut Workspace,
        step: &Step,
        attempt: &mut Attempt,
        record: &mut IncrementRecord,
    ) -> Result<(), FemError> {
        let part = (1.0 - attempt.from) / (attempt.to - attempt.from);
        (attempt.to, attempt.length) = (1.0, part * attempt.length);
        self.start_anew(work);
        for (q, committed) in work.base.q.iter_mut().zip(&self.q) {
            *q = committed + part * (*q - committed);
        }
        self.aim_at(work, step, *attempt);
        self.iterate_here(work, *attempt, record)
    }

    /// Loads and motions at the end of an attempt, imposed on the base.
    pub(super) fn aim_at(&self, work: &mut Workspace, step: &Step, attempt: Attempt) {
        work.target.fill(step, attempt, &self.step_start, &self.released, &self.before);
        work.target.impose(&mut work.base.q);
    }

    /// `db` and `dD/ds` at the base, whose tangent is factorised. Leaves the target a little ahead.
    pub(super) fn sweep(
        &mut self,
        work: &mut Workspace,
        step: &Step,
        attempt: Attempt,
        sweep: &mut Sweep,
    ) -> Result<(), FemError> {
        let there = attempt.to + (AHEAD * attempt.length).max(LEAST_AHEAD);
        let ahead = there - attempt.to;
        let Workspace { base, trial, target, rhs, .. } = work;
        target.fill(step, Attempt { to: there, ..attempt }, &self.step_start, &self.released, &self.before);
        trial.q.copy_from_slice(&base.q);
        target.impose(&mut trial.q);
        self.evaluate(trial, target, None, Request::Residual)?;
        for (b, &c) in rhs.iter_mut().zip(self.equations()?.coordinates()) {
            *b = (base.residual[c as usize] - trial.residual[c as usize]) / ahead;
        }
        self.solve_by_factors(rhs, &mut sweep.along)?;
        let dissipated = dissipation(&base.energies);
        if dissipated > 0.0 && self.path.work > 0.0 {
            self.equations()?.scatter_add(ahead, &sweep.along, &mut trial.q);
            self.evaluate(trial, target, None, Request::Residual)?;
            sweep.dissipation = (dissipation(&trial.energies) - dissipated) / ahead;
        } else {
            sweep.dissipation = 0.0;
        }
        Ok(())
    }

    /// Makes the length of an attempt that of the arc to an iterate.
    pub(super) fn stretch(&self, iterate: &Iterate, attempt: &mut Attempt) {
        attempt.length = self.measured(iterate, *attempt, Measure::Arc);
    }

    /// How far an iterate is along the path.
    fn measured(&self, iterate: &Iterate, attempt: Attempt, measure: Measure) -> f64 {
        let motion = match measure {
            Measure::Arc => self.elastic_arc(&self.moved(iterate), attempt.to - attempt.from),
            Measure::Dissipation => 0.0,
        };
        motion + self.in_work(dissipation(&iterate.energies))
    }

    /// `sqrt((|dq|^2/U^2 + ds^2)/2)`.
    fn elastic_arc(&self, moved: &[f64], advance: f64) -> f64 {
        (0.5 * (self.path_product(moved, moved) + advance * advance)).sqrt()
    }

    /// The change of the fraction that brings the arc, linearised, to its length.
    fn go_along(&self, work: &Workspace, attempt: Attempt, sweep: &Sweep, measure: Measure) -> Result<f64, FemError> {
        let mut lacking = attempt.length - self.measured(&work.base, attempt, measure);
        let mut along = self.in_work(sweep.dissipation);
        if measure == Measure::Arc {
            let (by_correction, by_path) = self.motion_along(work, attempt, sweep)?;
            lacking -= by_correction;
            along += by_path;
        }
        let change = lacking / along;
        if change.is_finite() { Ok(change) } else { Err(FemError::NonFiniteResidual) }
    }

    /// The change by the correction of the part of the arc that motions and fraction make, and its derivative along
    /// the path.
    fn motion_along(&self, work: &Workspace, attempt: Attempt, sweep: &Sweep) -> Result<(f64, f64), FemError> {
        let moved = self.moved(&work.base);
        let advance = attempt.to - attempt.from;
        let elastic = self.elastic_arc(&moved, advance);
        let mut direction = vec![0.0; self.q.len()];
        let equations = self.equations()?;
        equations.scatter_add(1.0, &work.correction, &mut direction);
        let by_correction = 0.5 * self.path_product(&moved, &direction) / elastic;
        direction.fill(0.0);
        equations.scatter_add(1.0, &sweep.along, &mut direction);
        Ok((by_correction, 0.5 * (self.path_product(&moved, &direction) + advance) / elastic))
    }

    /// Whether sliding of the iterate, or of the last increment, gives a measure.
    fn dissipates(&self, work: &Workspace) -> bool {
        self.path.work > 0.0 && dissipation(&work.base.energies).max(self.path.dissipation) > 0.0
    }

    /// Whether an increment dissipates far less than the last one leads one to expect.
    fn unloads(&self, work: &Workspace, asked: Attempt, found: Attempt) -> bool {
        // The end of a step cuts increments short.
        found.to <= 1.0 && dissipation(&work.base.energies) < self.least_dissipation(asked.length)
    }

    /// Whether an increment that unloads goes back on the way that the last one came.
    fn turns_back(&self, work: &Workspace, attempt: Attempt) -> bool {
        let advance = attempt.to - attempt.from;
        let forward = self.path_product(&self.moved(&work.base), &self.last_change) + advance * self.path.advance;
        forward < 0.0 && dissipation(&work.base.energies) <= self.least_dissipation(attempt.length)
    }

    /// The dissipation below which an increment of some length unloads \[mJ\].
    fn least_dissipation(&self, length: f64) -> f64 {
        UNLOADING * length / self.last_length * self.path.dissipation
    }

    /// `a.b/U^2` over the unknowns.
    fn path_product(&self, a: &[f64], b: &[f64]) -> f64 {
        let unit = self.path.motion * self.path.motion;
        let free = (0..a.len()).filter(|&c| !self.prescribed[c]);
        free.map(|c| self.lever_of(c).powi(2) * a[c] * b[c]).sum::<f64>() / unit
    }

    /// A dissipation over `W`.
    fn in_work(&self, dissipation: f64) -> f64 {
        if self.path.work > 0.0 { dissipation / self.path.work } else { 0.0 }
    }

    /// Notes an increment that is committed, and the scales of the step after its first; `second_order` is its work
    /// of changes of forces over its length squared \[mJ\].
    pub(super) fn note_path(&mut self, attempt: Attempt, energies: &Energies, second_order: f64) {
        let advance = attempt.to - attempt.from;
        if self.path.motion == 0.0 {
            self.path.motion = 1.0;
            let length = self.path_product(&self.last_change, &self.last_change).sqrt();
            self.path.motion = if length > 0.0 { length / advance.abs() } else { 1.0 };
            self.path.work = 0.5 * second_order.abs();
        }
        self.path.advance = advance;
        self.path.dissipation = dissipation(energies);
    }
}

/// What an increment dissipates \[mJ\].
fn dissipation(energies: &Energies) -> f64 {
    energies.dissipated_mid.iter().sum::<f64>() + energies.contact_friction
}
