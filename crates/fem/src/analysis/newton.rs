//! One attempt at an increment: Newton-Raphson from the committed state.

use super::driver::Analysis;
use super::record::{IncrementRecord, Phase};
use super::step::{LoadBefore, Prescription, Step};
use super::workspace::{Iterate, Workspace};
use crate::assembly::{Evaluation, Jump};
use crate::contribution::{Configuration, Request, Verdict};
use crate::linear::LinearError;
use crate::{Equations, FemError};

/// Fractions of the step between which an attempt goes.
#[derive(Clone, Copy, Debug)]
pub struct Attempt {
    pub from: f64,
    /// On a path with arc lengths not known before it has been followed.
    pub to: f64,
    /// Length of the increment: the fraction it goes on by, or its arc.
    pub length: f64,
    /// Whether to iterate on while there is no headway: nothing shorter can be tried.
    pub last_resort: bool,
    /// Whether to minimise the incremental potential.
    pub minimise: bool,
    /// Whether Newton's method may try again on a softened model.
    pub may_soften: bool,
}

/// Rounding of the residual, over the norm of all element forces, or of stiffness times displacement.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Most new searches for touching surfaces in one attempt.
const SEARCHES: usize = 10;

/// A relative residual that is nothing but rounding.
const ROUNDED: f64 = 1e-13;

/// Times its size and the prescribed motion that a model may move. Beyond, forces are made of rounding and would pass for
/// balanced.
const RUNAWAY: f64 = 1e6;

/// Part of the norm of the element forces below which reactions do not count as a reference.
const SMALL_REACTION: f64 = 1e-6;

/// Part of the largest reference so far below which the present one does not count: a body that comes back to rest has
/// no reactions to compare with.
const REST: f64 = 1e-3;

impl Analysis {
    /// Solves for the state at the end of an attempt and commits it; answers the attempt as it ended. On an error nothing
    /// has changed.
    pub(super) fn attempt(
        &mut self,
        step: &Step,
        attempt: Attempt,
        record: &mut IncrementRecord,
    ) -> Result<Attempt, FemError> {
        self.search(None)?;
        let mut work = std::mem::take(&mut self.work);
        let mut outcome = self.find(&mut work, step, attempt, record);
        for _ in 0..SEARCHES {
            if !matches!(outcome, Err(FemError::SearchOutdated)) {
                break;
            }
            let at = std::mem::take(&mut self.outdated_at);
            outcome = self.search(Some(&at)).and_then(|()| self.find(&mut work, step, attempt, record));
        }
        self.totals.iterations += record.iterations;
        if let Ok(attempt) = outcome {
            record.end(attempt, self.time + step.duration * attempt.length);
            self.totals.note_inertia(record);
            let before = self.ledger(&work, attempt);
            // The way to a minimum, or to another branch at the same loads, is no direction to go on in.
            let aside = attempt.minimise || (record.switched && !self.is_along(step, attempt));
            self.commit(&mut work, attempt);
            if step.increments.are_arcs() && !aside {
                self.note_path(attempt, &work.base.energies, before.curvature());
            }
            self.totals.minimised += usize::from(attempt.minimise);
            self.totals.switched += usize::from(record.switched);
            self.totals.smoothed += usize::from(record.smoothed);
            if aside {
                self.last_length = 0.0;
            }
            self.settle_account(&before, record);
        }
        self.work = work;
        outcome
    }

    /// Finds the state at the end of an attempt, by Newton's method, along the path or as a minimum.
    fn find(
        &mut self,
        work: &mut Workspace,
        step: &Step,
        mut attempt: Attempt,
        record: &mut IncrementRecord,
    ) -> Result<Attempt, FemError> {
        work.target.fill(step, attempt, &self.step_start, &self.released, &self.before);
        (record.minimised, record.smoothed, record.switched) = (attempt.minimise, false, false);
        if attempt.minimise {
            self.minimise(work, attempt, record)?;
        } else if step.increments.are_arcs() {
            self.follow(work, step, &mut attempt, record)?;
        } else if let Err(cause) = self.iterate(work, attempt, record) {
            if !self.may_soften(attempt, &cause) {
                return Err(cause);
            }
            self.iterate_softened(work, attempt, record)?;
        }
        if !attempt.minimise {
            self.choose_branch(work, step, &mut attempt, record)?;
        }
        Ok(attempt)
    }

    /// Forgets all that an earlier attempt has left.
    pub(super) fn start_anew(&mut self, work: &mut Workspace) {
        self.model.contributions.iter_mut().for_each(|c| c.revert());
        work.factors.forget();
    }

    pub(super) fn iterate(
        &mut self,
        work: &mut Workspace,
        attempt: Attempt,
        record: &mut IncrementRecord,
    ) -> Result<(), FemError> {
        let spent = (record.iterations, record.residuals.len());
        self.start_anew(work);
        self.first_iterate(work, attempt, record)?;
        self.iterate_on(work, attempt, record, spent)
    }

    /// Newton's method from the base as it stands.
    pub(super) fn iterate_here(
        &mut self,
        work: &mut Workspace,
        attempt: Attempt,
        record: &mut IncrementRecord,
    ) -> Result<(), FemError> {
        self.evaluate(&mut work.base, &work.target, None, Request::Tangent)?;
        let spent = (record.iterations, record.residuals.len());
        self.iterate_on(work, attempt, record, spent)
    }

    /// Newton's method from the base, which is evaluated; `spent` and `seen` are the iterations and residuals before this
    /// round of multipliers.
    fn iterate_on(
        &mut self,
        work: &mut Workspace,
        attempt: Attempt,
        record: &mut IncrementRecord,
        (mut spent, mut seen): (usize, usize),
    ) -> Result<(), FemError> {
        let mut largest_energy = 0.0_f64;
        let mut energy = 0.0;
        loop {
            let tolerance = self.options.force_tolerance;
            let relative = relative_residual(&work.base);
            record.residuals.push(relative);
            if self.is_converged(relative, energy, largest_energy) {
                if !self.review()? {
                    return Ok(());
                }
                self.totals.augmentations += 1;
                self.evaluate(&mut work.base, &work.target, None, Request::Tangent)?;
                (spent, seen) = (record.iterations, record.residuals.len());
                if relative_residual(&work.base) <= tolerance {
                    continue;
                }
            }
            if record.iterations >= spent + self.options.max_iterations
                || hopeless(&record.residuals[seen..], attempt.last_resort)
            {
                // Nothing is left but rounding: the energy has no scale to fall below.
                if relative <= ROUNDED.min(tolerance) && !self.review()? {
                    return Ok(());
                }
                return Err(self.not_converged(work, record.iterations));
            }
            self.correct_cheaply(work, &record.residuals[seen..], &mut record.negative_pivots)?;
            record.iterations += 1;
            let slope = self.slope(work);
            largest_energy = largest_energy.max(slope.abs());
            self.advance(work, slope)?;
            // Energy of this correction in the new residual.
            energy = self.slope(work).abs();
        }
    }

    /// Whether a residual and the energy of the last correction are within the tolerances. Where the residual is nothing but
    /// rounding, so is the energy.
    pub(super) fn is_converged(&self, relative: f64, energy: f64, largest_energy: f64) -> bool {
        let settled = relative == 0.0 || energy <= self.options.energy_tolerance * largest_energy;
        relative <= self.options.force_tolerance && settled
    }

    /// The base is no answer after some iterations.
    pub(super) fn not_converged(&self, work: &Workspace, iterations: usize) -> FemError {
        let (residual, tolerance) = (relative_residual(&work.base), self.options.force_tolerance);
        FemError::NotConverged { iterations, residual, tolerance }
    }

    /// Whether a contribution has moved its multipliers, so that the iteration must go on.
    pub(super) fn review(&mut self) -> Result<bool, FemError> {
        let contributions = &mut self.model.contributions;
        contributions.iter_mut().try_fold(false, |moved, c| Ok(moved | (c.review()? == Verdict::Augmented)))
    }

    /// Continues the last increment, or goes along the committed tangent.
    pub(super) fn first_iterate(
        &mut self,
        work: &mut Workspace,
        attempt: Attempt,
        record: &mut IncrementRecord,
    ) -> Result<(), FemError> {
        if self.options.extrapolate && self.last_length > 0.0 {
            self.continue_last(&mut work.base, attempt.length / self.last_length);
            work.target.impose(&mut work.base.q);
            match self.evaluate(&mut work.base, &work.target, None, Request::Tangent) {
                Err(error) if !matches!(error, FemError::SearchOutdated) => {}
                done => return done,
            }
        }
        self.predict(work, record)
    }

    /// Puts an iterate where so many times the last increment leads.
    pub(super) fn continue_last(&self, iterate: &mut Iterate, times: f64) {
        for ((q, committed), change) in iterate.q.iter_mut().zip(&self.q).zip(&self.last_change) {
            *q = committed + times * change;
        }
    }

    /// Change of the coordinates from the committed state.
    pub(super) fn moved(&self, iterate: &Iterate) -> Vec<f64> {
        iterate.q.iter().zip(&self.q).map(|(new, old)| new - old).collect()
    }

    /// One linear step from the committed state with the motion of the prescribed coordinates linearised, so that
    /// the elements next to a moving section are not turned inside out.
    fn predict(&mut self, work: &mut Workspace, record: &mut IncrementRecord) -> Result<(), FemError> {
        work.trial.q.copy_from_slice(&self.q);
        work.target.impose(&mut work.trial.q);
        self.model.kinematics.displacements(&work.trial.q, &mut work.jump);
        for (jump, committed) in work.jump.iter_mut().zip(&self.displacement) {
            *jump -= committed;
        }
        work.base.q.copy_from_slice(&self.q);
        let jump = Jump { displacement: &work.jump };
        self.evaluate(&mut work.base, &work.target, Some(jump), Request::Tangent)?;
        record.negative_pivots = self.correct(work)?;
        record.iterations += 1;
        work.base.q.copy_from_slice(&work.trial.q);
        self.equations()?.scatter_add(1.0, &work.correction, &mut work.base.q);
        self.evaluate(&mut work.base, &work.target, None, Request::Tangent)
    }

    /// Solves for the correction with the factors at hand if they serve, with those of the base otherwise: then their
    /// negative pivots are told.
    fn correct_cheaply(
        &mut self,
        work: &mut Workspace,
        residuals: &[f64],
        negative_pivots: &mut Option<usize>,
    ) -> Result<(), FemError> {
        let limits = work.factors.limits(residuals, self.options.force_tolerance);
        if let (Some(limits), Some(system)) = (&limits, self.system.as_mut()) {
            work.aim(system.equations());
            let (rhs, x) = (&work.rhs, &mut work.correction);
            let solved = self.phases.measure(Phase::Solution, || system.solve_by_kept_factors(limits, rhs, x));
            match solved {
                Err(FemError::Linear(LinearError::Stalled { iterations, .. })) => {
                    self.totals.linear_iterations += iterations;
                }
                solved => {
                    self.totals.linear_iterations += solved?;
                    return Ok(());
                }
            }
        }
        *negative_pivots = self.correct(work)?;
        work.factors.renew(limits.is_some());
        Ok(())
    }

    /// Factorises at the base and solves for the correction.
    pub(super) fn correct(&mut self, work: &mut Workspace) -> Result<Option<usize>, FemError> {
        self.totals.factorisations += 1;
        let Some(system) = self.system.as_mut() else { return Ok(None) };
        let pivots = self.phases.measure(Phase::Factorisation, || system.factorise())?;
        work.aim(system.equations());
        self.solve_by_factors(&work.rhs, &mut work.correction)?;
        Ok(pivots)
    }

    pub(super) fn equations(&self) -> Result<&Equations, FemError> {
        self.system.as_ref().map(crate::System::equations).ok_or(FemError::NonFiniteResidual)
    }

    /// `r . correction` at the base: the slope of the potential along the correction.
    pub(super) fn slope(&self, work: &Workspace) -> f64 {
        self.slope_of(&work.base, &work.correction)
    }

    pub(super) fn slope_of(&self, iterate: &Iterate, correction: &[f64]) -> f64 {
        let Some(system) = &self.system else { return 0.0 };
        let coordinates = system.equations().coordinates();
        coordinates.iter().zip(correction).map(|(&c, d)| iterate.residual[c as usize] * d).sum()
    }

    /// Evaluates residual, energies and norms at `iterate.q`, and the tangent if asked.
    pub(super) fn evaluate(
        &mut self,
        iterate: &mut Iterate,
        target: &super::workspace::Target,
        jump: Option<Jump<'_>>,
        request: Request,
    ) -> Result<(), FemError> {
        let kinematics = &self.model.kinematics;
        kinematics.displacements(&iterate.q, &mut iterate.displacement);
        self.check_reach(&iterate.displacement, target)?;
        let at = Evaluation {
            q: &iterate.q,
            configuration: Configuration {
                displacement: &iterate.displacement,
                committed: &self.displacement,
                time_increment: target.time_increment,
                time: self.time + target.time_increment,
                temperature: self.options.temperature,
                predicting: jump.is_some(),
                parallel: self.threads > 1,
            },
            external: &target.nodal,
            jump,
            request,
        };
        let Some(system) = self.system.as_mut() else { return Ok(()) };
        let contributions = &mut self.model.contributions;
        let residual = &mut iterate.residual;
        let assembled =
            self.phases.measure(Phase::Assembly, || system.assemble(kinematics, contributions, &at, residual));
        if matches!(assembled, Err(FemError::SearchOutdated)) {
            self.outdated_at.clone_from(&iterate.displacement);
        }
        let assembled = assembled?;
        let work: f64 = target.nodal.iter().zip(&iterate.displacement).map(|(f, u)| f * u).sum();
        let point_work: f64 = target.coordinates.iter().zip(&iterate.q).map(|(f, q)| f * q).sum();
        iterate.residual.iter_mut().zip(&target.coordinates).for_each(|(r, f)| *r -= f);
        iterate.energies = assembled.energies;
        iterate.potential = assembled.energies.potential - work - point_work;
        self.stiffness_scale = assembled.stiffness_scale.unwrap_or(self.stiffness_scale);
        self.measure(iterate, target, assembled.force_scale);
        Ok(())
    }

    /// Whether the iterate is still about the model.
    fn check_reach(&self, displacements: &[f64], target: &super::workspace::Target) -> Result<(), FemError> {
        let prescribed = target.prescribed.iter().fold(0.0_f64, |most, (_, value)| most.max(value.abs()));
        let displacement = displacements.iter().fold(0.0_f64, |most, u| most.max(u.abs()));
        let extent = self.extent;
        let near = displacement <= RUNAWAY * extent.max(prescribed);
        if near { Ok(()) } else { Err(FemError::RunsAway { displacement, extent }) }
    }

    /// Norms of the residual and of what it is compared with; moments count over the lever.
    fn measure(&self, iterate: &mut Iterate, target: &super::workspace::Target, scale: f64) {
        let (mut free, mut held) = (0.0, 0.0);
        for (c, r) in iterate.residual.iter().enumerate() {
            let lever = self.lever_of(c);
            let value = (r / lever) * (r / lever);
            if self.prescribed[c] { held += value } else { free += value }
        }
        let loads = target.nodal.iter().chain(&target.coordinates).map(|f| f * f).sum::<f64>();
        iterate.norm = free.sqrt();
        iterate.reference =
            held.sqrt().max(loads.sqrt()).max(SMALL_REACTION * scale).max(REST * self.largest_reference);
        if iterate.norm <= ROUNDING * scale.max(self.stiffness_scale) {
            iterate.norm = 0.0;
        }
    }

    /// What turns a coordinate, or divides its force, into a length, or a force: the lever of a rotation \[mm\], else 1.
    pub(super) fn lever_of(&self, coordinate: usize) -> f64 {
        if self.model.kinematics.is_rotation(coordinate) { self.lever } else { 1.0 }
    }

    /// The trial becomes the committed state; the work of the increment by the trapezoidal rule.
    fn commit(&mut self, work: &mut Workspace, attempt: Attempt) {
        let (new, target) = (&work.base, &work.target);
        let mut external = 0.0;
        for c in 0..self.q.len() {
            let change = new.q[c] - self.q[c];
            let load = 0.5 * (self.coordinate_load[c] + target.coordinates[c]);
            external +=
                (load + if self.prescribed[c] { 0.5 * (self.reaction[c] + new.residual[c]) } else { 0.0 }) * change;
            self.last_change[c] = change;
            let acting = target.coordinates[c] + if self.prescribed[c] { new.residual[c] } else { 0.0 };
            if acting.abs() > self.peak[c].abs() {
                self.peak[c] = acting;
            }
        }
        for i in 0..self.displacement.len() {
            let load = 0.5 * (self.nodal_load[i] + target.nodal[i]);
            external += load * (new.displacement[i] - self.displacement[i]);
        }
        self.largest_reference = self.largest_reference.max(new.reference);
        self.totals.interference += new.energies.interference;
        self.totals.external_work += external + new.energies.interference;
        self.totals.work_scale = self.totals.work_scale.max(self.totals.external_work.abs());
        self.totals.stored = new.energies.stored;
        self.totals.stabilising += new.energies.stabilising;
        self.totals.contact_stored = new.energies.contact_stored;
        self.totals.contact_friction += new.energies.contact_friction;
        for mode in 0..2 {
            self.totals.dissipated_mid[mode] += new.energies.dissipated_mid[mode];
        }
        self.totals.increments += 1;
        self.last_length = attempt.length;
        self.q.copy_from_slice(&new.q);
        self.displacement.copy_from_slice(&new.displacement);
        self.reaction.copy_from_slice(&new.residual);
        self.nodal_load.copy_from_slice(&target.nodal);
        self.coordinate_load.copy_from_slice(&target.coordinates);
        if let Some(system) = &self.system {
            self.internal.copy_from_slice(system.nodal_forces());
        }
        self.totals.dissipated = [0.0; 2];
        for contribution in &mut self.model.contributions {
            contribution.commit();
            let [transverse, longitudinal] = contribution.dissipated();
            self.totals.dissipated[0] += transverse;
            self.totals.dissipated[1] += longitudinal;
        }
    }
}

pub(super) fn relative_residual(iterate: &Iterate) -> f64 {
    if iterate.norm == 0.0 { 0.0 } else { iterate.norm / iterate.reference }
}

/// Iterations after which an attempt that can be shortened must still make headway.
const PATIENCE: usize = 10;

/// Whether more iterations are wasted: no headway over the last six, or a residual beyond all bounds.
pub(super) fn hopeless(residuals: &[f64], last_resort: bool) -> bool {
    let n = residuals.len();
    let stalled = !last_resort && n > PATIENCE && residuals[n - 1] > 0.1 * residuals[n - 7];
    stalled || residuals.last().is_some_and(|r| *r > 1e12)
}

impl Workspace {
    /// Makes the residual of the base, turned round, the right-hand side.
    pub(super) fn aim(&mut self, equations: &Equations) {
        equations.gather(&self.base.residual, &mut self.rhs);
        self.rhs.iter_mut().for_each(|v| *v = -*v);
    }
}

impl super::workspace::Target {
    /// Loads and prescribed values at the end of an attempt.
    pub(super) fn fill(
        &mut self,
        step: &Step,
        attempt: Attempt,
        start: &[f64],
        released: &[(u32, f64)],
        before: &[LoadBefore],
    ) {
        self.prescribed.clear();
        let value = |p: &Prescription| (p.coordinate, (p.path)(attempt.to, start[p.coordinate as usize]));
        self.prescribed.extend(step.prescriptions.iter().map(value));
        self.nodal.fill(0.0);
        self.coordinates.fill(0.0);
        // What was held and is free now lets go over the step.
        for &(c, reaction) in released {
            self.coordinates[c as usize] += (1.0 - attempt.to) * reaction;
        }
        for load in &step.loads {
            let own = load.load.coordinates.first().map(|(c, _)| before[*c as usize]).unwrap_or_default();
            let factor = (load.path)(attempt.to, own);
            for (node, force) in &load.load.nodal {
                for k in 0..3 {
                    self.nodal[3 * *node as usize + k] += factor * force[k];
                }
            }
            for (c, force) in &load.load.coordinates {
                self.coordinates[*c as usize] += factor * force;
            }
        }
        self.time_increment = step.duration * attempt.length;
    }

    /// Sets the prescribed coordinates.
    pub(super) fn impose(&self, q: &mut [f64]) {
        for &(c, value) in &self.prescribed {
            q[c as usize] = value;
        }
    }
}
