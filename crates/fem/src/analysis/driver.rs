//! A model and its state over steps and increments.

use nalgebra::Vector3;

use super::arc_length::PathScale;
use super::division::{Division, Progress};
use super::factors::KeptFactors;
use super::newton::Attempt;
use super::record::{Control, IncrementRecord, Observer, Phase, Phases, Totals};
use super::rigid::rigid_motions;
use super::step::{Increments, LoadBefore, NewtonOptions, Step, TrustRegion};
use super::workspace::Workspace;
use crate::FemError;
use crate::assembly::System;
use crate::contribution::Contribution;
use crate::kinematics::Kinematics;
use crate::linear::SolverOptions;

/// Attempts of Newton's method at one increment, each shorter than the last, before the potential is minimised instead.
const NEWTON_ATTEMPTS: usize = 6;

/// Nodes and what acts on them.
pub struct Model {
    /// Nodes, reference points, ties.
    pub kinematics: Kinematics,
    /// Everything that adds forces.
    pub contributions: Vec<Box<dyn Contribution>>,
}

impl Model {
    /// Whether the tangent is symmetric, so that its factors tell the number of negative pivots.
    #[must_use]
    pub fn is_symmetric(&self) -> bool {
        self.contributions.iter().all(|c| c.is_symmetric())
    }

    /// Whether all forces derive from an incremental potential with a symmetric tangent, so that it can be minimised.
    #[must_use]
    pub fn can_be_minimised(&self) -> bool {
        self.is_symmetric() && self.contributions.iter().all(|c| c.has_potential())
    }
}

/// A model with its committed state; runs steps.
pub struct Analysis {
    pub(super) model: Model,
    pub(super) options: NewtonOptions,
    pub(super) solver_options: SolverOptions,
    pub(super) threads: usize,
    pub(super) system: Option<System>,
    pub(super) prescribed: Vec<bool>,
    /// Prescribed coordinates of the last step that was run.
    pub(super) prescribed_before: Vec<bool>,
    /// Committed coordinates.
    pub(super) q: Vec<f64>,
    /// Reactions at the start of the step of coordinates that it sets free.
    pub(super) released: Vec<(u32, f64)>,
    /// Largest reference of a converged increment.
    pub(super) largest_reference: f64,
    /// Norm of diagonal stiffness times displacement at the last tangent \[N\].
    pub(super) stiffness_scale: f64,
    /// Largest load and reaction together of every coordinate so far.
    pub(super) peak: Vec<f64>,
    /// Loads and peaks of the coordinates at the start of the step.
    pub(super) before: Vec<LoadBefore>,
    /// Coordinates at the start of the step.
    pub(super) step_start: Vec<f64>,
    /// Change of the coordinates over the last increment and its length.
    pub(super) last_change: Vec<f64>,
    pub(super) last_length: f64,
    /// What arc lengths are measured in.
    pub(super) path: PathScale,
    /// Second-order work of the last increment over its length squared \[mJ\].
    pub(super) curvature: f64,
    /// Committed nodal displacements.
    pub(super) displacement: Vec<f64>,
    /// Generalised reactions at the committed state.
    pub(super) reaction: Vec<f64>,
    /// Dead loads at the committed state.
    pub(super) nodal_load: Vec<f64>,
    pub(super) coordinate_load: Vec<f64>,
    /// Internal nodal forces at the committed state.
    pub(super) internal: Vec<f64>,
    pub(super) totals: Totals,
    pub(super) phases: Phases,
    pub(super) time: f64,
    pub(super) steps_done: usize,
    /// How far the step that runs has come.
    pub(super) progress: Progress,
    /// Whether that step goes on from a state that was taken up.
    pub(super) restored: bool,
    pub(super) work: Workspace,
    /// Displacements at which surfaces touched outside the pattern.
    pub(super) outdated_at: Vec<f64>,
    /// Scale that turns moments into forces \[mm\].
    pub(super) lever: f64,
    /// Diagonal of the box around the nodes at rest \[mm\].
    pub(super) extent: f64,
}

/// The iterate at which an attempt ended.
#[derive(Clone, Copy, Debug)]
pub struct LastTrial<'a> {
    /// Nodal displacements \[mm\].
    pub displacement: &'a [f64],
    /// Residual of all coordinates, reactions of the prescribed ones included \[N, N mm\].
    pub residual: &'a [f64],
    /// Length of the increment that was tried \[s\].
    pub time_increment: f64,
}

impl Analysis {
    /// A model at rest.
    #[must_use]
    pub fn new(model: Model, options: NewtonOptions, solver_options: SolverOptions, threads: usize) -> Self {
        let (coordinates, nodes) = (model.kinematics.coordinate_count(), model.kinematics.node_count());
        Self {
            lever: model.kinematics.lever(),
            extent: subrope_geometry::extent(model.kinematics.positions()),
            model,
            options,
            solver_options,
            threads,
            system: None,
            prescribed: Vec::new(),
            prescribed_before: Vec::new(),
            q: vec![0.0; coordinates],
            released: Vec::new(),
            largest_reference: 0.0,
            stiffness_scale: 0.0,
            peak: vec![0.0; coordinates],
            before: vec![LoadBefore::default(); coordinates],
            step_start: vec![0.0; coordinates],
            last_change: vec![0.0; coordinates],
            last_length: 0.0,
            path: PathScale::default(),
            curvature: 0.0,
            displacement: vec![0.0; 3 * nodes],
            reaction: vec![0.0; coordinates],
            nodal_load: vec![0.0; 3 * nodes],
            coordinate_load: vec![0.0; coordinates],
            internal: vec![0.0; 3 * nodes],
            totals: Totals::default(),
            phases: Phases::default(),
            time: 0.0,
            steps_done: 0,
            progress: Progress::default(),
            restored: false,
            work: Workspace::default(),
            outdated_at: Vec::new(),
        }
    }

    /// The model.
    #[must_use]
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The model with what its contributions have committed; the rest of the state is dropped.
    #[must_use]
    pub fn into_model(self) -> Model {
        self.model
    }

    /// Committed coordinates.
    #[must_use]
    pub fn coordinates(&self) -> &[f64] {
        &self.q
    }

    /// Committed nodal displacements \[mm\], three per node.
    #[must_use]
    pub fn displacement(&self) -> &[f64] {
        &self.displacement
    }

    /// Internal nodal forces less dead loads \[N\], three per node: zero at free nodes, reactions elsewhere.
    #[must_use]
    pub fn nodal_reactions(&self) -> Vec<f64> {
        self.internal.iter().zip(&self.nodal_load).map(|(i, e)| i - e).collect()
    }

    /// Whether a coordinate is prescribed in the current step.
    #[must_use]
    pub fn is_prescribed(&self, coordinate: usize) -> bool {
        self.prescribed.get(coordinate).copied().unwrap_or(false)
    }

    /// Threads.
    #[must_use]
    pub fn threads(&self) -> usize {
        self.threads
    }

    /// Generalised reactions of all coordinates.
    #[must_use]
    pub fn reactions(&self) -> &[f64] {
        &self.reaction
    }

    /// Force \[N\] and moment about its current position \[N mm\] that act on the section of a reference point from
    /// outside: through prescribed motions and as loads on the point.
    #[must_use]
    pub fn point_reaction(&self, point: usize) -> (Vector3<f64>, Vector3<f64>) {
        self.model.kinematics.section_resultant(point, &self.q, &self.nodal_reactions())
    }

    /// Energies and counts.
    #[must_use]
    pub fn totals(&self) -> &Totals {
        &self.totals
    }

    /// Time per phase.
    #[must_use]
    pub fn phases(&self) -> &Phases {
        &self.phases
    }

    /// Time reached \[s\].
    #[must_use]
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Where the last attempt stood when it ended; of a committed one, the committed state.
    #[must_use]
    pub fn last_trial(&self) -> LastTrial<'_> {
        let base = &self.work.base;
        let time_increment = self.work.target.time_increment;
        LastTrial { displacement: &base.displacement, residual: &base.residual, time_increment }
    }

    /// Estimate of the condition number \[-\] of the last tangent that was factorised, scaled to a unit diagonal;
    /// that of its symmetric part where it is not symmetric, and none before the first factorisation.
    pub fn condition(&mut self) -> Option<f64> {
        self.system.as_mut()?.condition()
    }

    /// The sparse system of the current step.
    #[must_use]
    pub fn system(&self) -> Option<&System> {
        self.system.as_ref()
    }

    /// Whether factors of an iterate may serve later ones.
    #[must_use]
    pub fn keeps_factors(&self) -> bool {
        self.work.factors.any()
    }

    /// Steps that are done: the index of the step that runs, or of the next one.
    #[must_use]
    pub fn steps_done(&self) -> usize {
        self.steps_done
    }

    /// Runs one step, or the rest of it after [`Analysis::restore`]. On an error the state is that of the last
    /// committed increment.
    ///
    /// # Errors
    /// [`FemError`]; what an observer answers.
    pub fn run_step(&mut self, step: &Step, observer: &mut (dyn Observer + Send)) -> Result<(), FemError> {
        crate::parallel::with_threads(self.threads, || self.run_step_here(step, observer))?
    }

    fn run_step_here(&mut self, step: &Step, observer: &mut dyn Observer) -> Result<(), FemError> {
        if !std::mem::take(&mut self.restored) {
            self.begin(step)?;
        }
        let division = Division { step, options: self.options };
        let mut attempt = 1;
        // Why Newton's method ended, while a minimisation is tried in its place.
        let mut stalled: Option<FemError> = None;
        while self.progress.done < 1.0 {
            division.check_count(&self.progress)?;
            let from = self.progress.done;
            let to = division.next_end(&self.progress);
            let length = division.next_length(&self.progress);
            let mut record = self.record(step, to, attempt);
            let fixed = matches!(step.increments, Increments::Fixed(_));
            let minimise = stalled.is_some() || self.always_minimises(step);
            let shortest = fixed || division.is_shortest(&self.progress);
            let may_soften = self.options.smoothing && shortest;
            let last_resort = fixed || (shortest && self.has_only_the_path(step));
            let tried = Attempt { from, to, length, last_resort, minimise, may_soften };
            match self.attempt(step, tried, &mut record) {
                Ok(done) => {
                    self.time = record.time;
                    division.advance(&mut self.progress, done.to, record.iterations);
                    (attempt, stalled) = (1, None);
                    if observer.converged(self, &record)? == Control::Stop {
                        return Err(FemError::Interrupted);
                    }
                }
                Err(cause) => {
                    self.totals.cutbacks += 1;
                    observer.failed(&record, &cause);
                    let enough = attempt >= NEWTON_ATTEMPTS && !step.increments.are_arcs();
                    let last = enough || division.is_shortest(&self.progress);
                    if !minimise && last && self.may_minimise(step, &cause) {
                        division.leave_path(&mut self.progress);
                        stalled = Some(cause);
                    } else {
                        if minimise {
                            division.end_path(&mut self.progress);
                        }
                        let first = stalled.take().filter(|_| cause.is_recoverable());
                        division.cut(&mut self.progress, first.unwrap_or(cause))?;
                    }
                    attempt += 1;
                }
            }
        }
        self.steps_done += 1;
        Ok(())
    }

    /// Paths with arc lengths are followed whether they are stable or not.
    fn always_minimises(&self, step: &Step) -> bool {
        self.options.trust_region == TrustRegion::Always && !step.increments.are_arcs() && self.model.can_be_minimised()
    }

    /// Whether no minimum is looked for where a path with arc lengths ends.
    fn has_only_the_path(&self, step: &Step) -> bool {
        let minimum = self.options.trust_region == TrustRegion::Auto && self.model.can_be_minimised();
        step.increments.are_arcs() && !minimum
    }

    /// Whether a failure of Newton's method leads to a minimisation: where it found no way, not where a law had no
    /// answer, unless that was far from the path.
    fn may_minimise(&self, step: &Step, cause: &FemError) -> bool {
        let stalled = matches!(cause, FemError::NotConverged { .. } | FemError::RunsAway { .. } | FemError::Linear(_));
        self.options.trust_region == TrustRegion::Auto
            && matches!(step.increments, Increments::Automatic { .. })
            && (stalled || (step.increments.are_arcs() && cause.is_recoverable()))
            && self.model.can_be_minimised()
    }

    fn begin(&mut self, step: &Step) -> Result<(), FemError> {
        self.release(step);
        self.analyse(step)?;
        // A new step turns elsewhere: nothing to continue.
        self.last_length = 0.0;
        self.path = PathScale::default();
        self.step_start.copy_from_slice(&self.q);
        for ((before, &load), &peak) in self.before.iter_mut().zip(&self.coordinate_load).zip(&self.peak) {
            *before = LoadBefore { load, peak };
        }
        // They act as loads from now on, also in the work of the first increment.
        for &(c, reaction) in &self.released {
            self.coordinate_load[c as usize] += reaction;
        }
        self.progress = Progress::new(step);
        Ok(())
    }

    fn record(&self, step: &Step, to: f64, attempt: usize) -> IncrementRecord {
        let Progress { done, count, .. } = self.progress;
        IncrementRecord {
            step: step.name.clone(),
            step_index: self.steps_done + 1,
            increment: count + 1,
            attempt,
            fraction: to,
            length: to - done,
            time: self.time + step.duration * (to - done),
            iterations: 0,
            residuals: Vec::new(),
            negative_pivots: None,
            inertia_change: None,
            minimised: false,
            switched: false,
            smoothed: false,
            released: 0.0,
        }
    }

    /// Notes the reactions of coordinates that the step sets free: they are taken away over the step, not at once.
    fn release(&mut self, step: &Step) {
        let mut released = std::mem::take(&mut self.prescribed_before);
        step.prescriptions.iter().for_each(|p| {
            if let Some(held) = released.get_mut(p.coordinate as usize) {
                *held = false;
            }
        });
        self.released =
            released.iter().enumerate().filter(|(_, r)| **r).map(|(c, _)| (c as u32, self.reaction[c])).collect();
        self.prescribed_before = self.prescribed_by(step);
    }

    fn prescribed_by(&self, step: &Step) -> Vec<bool> {
        let mut prescribed = vec![false; self.q.len()];
        step.prescriptions.iter().for_each(|p| prescribed[p.coordinate as usize] = true);
        prescribed
    }

    /// Checks that a step leaves no rigid motion free.
    ///
    /// # Errors
    /// [`FemError::RigidModes`].
    pub fn check_held(&self, step: &Step) -> Result<(), FemError> {
        let prescribed = self.prescribed_by(step);
        let motions = rigid_motions(&self.model.kinematics, &self.model.contributions, &prescribed);
        if motions.is_empty() {
            return Ok(());
        }
        Err(FemError::RigidModes { step: step.name.clone(), count: motions.len(), motions: motions.join(", ") })
    }

    /// Makes the system of a step unless the last one serves: numbering, pattern, symbolic factorisation. A run does it
    /// by itself; alone it tells what a step will cost.
    ///
    /// # Errors
    /// [`FemError::RigidModes`], [`FemError::Linear`].
    pub fn analyse(&mut self, step: &Step) -> Result<(), FemError> {
        let prescribed = self.prescribed_by(step);
        if self.system.is_some() && prescribed == self.prescribed {
            return Ok(());
        }
        prepare(&mut self.model.contributions, &self.displacement)?;
        self.check_held(step)?;
        self.make_system(prescribed)
    }

    /// Makes the lists of elements of contacts fit for nodal displacements, and the system with them when they change.
    pub(super) fn search(&mut self, displacement: Option<&[f64]>) -> Result<(), FemError> {
        let displacement = displacement.unwrap_or(&self.displacement);
        let contributions = &mut self.model.contributions;
        if self.phases.measure(Phase::Search, || prepare(contributions, displacement))? {
            let prescribed = std::mem::take(&mut self.prescribed);
            self.totals.searches += 1;
            self.make_system(prescribed)?;
        }
        Ok(())
    }

    pub(super) fn make_system(&mut self, prescribed: Vec<bool>) -> Result<(), FemError> {
        self.system = None;
        let (model, options) = (&self.model, &self.solver_options);
        let system = self
            .phases
            .measure(Phase::Analysis, || System::new(&model.kinematics, &model.contributions, &prescribed, options))?;
        self.work = Workspace::new(self.q.len(), self.model.kinematics.node_count(), system.equations().len());
        if self.options.keep_factors {
            self.work.factors = KeptFactors::new(system.worth_of_factors());
        }
        self.system = Some(system);
        self.prescribed = prescribed;
        Ok(())
    }
}

/// Whether the elements of a contribution have changed.
fn prepare(contributions: &mut [Box<dyn Contribution>], displacement: &[f64]) -> Result<bool, FemError> {
    contributions.iter_mut().try_fold(false, |changed, c| Ok(c.prepare(displacement)? || changed))
}
