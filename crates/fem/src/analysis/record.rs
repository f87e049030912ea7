//! What a run tells while it goes on.

use std::time::{Duration, Instant};

use super::Analysis;
use super::newton::Attempt;
use crate::FemError;

/// Parts of a run whose time is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Pattern, scatter maps, ordering, symbolic factorisation.
    Analysis,
    /// Laws, elements and assembly.
    Assembly,
    /// Numeric factorisation.
    Factorisation,
    /// Triangular solves and refinement.
    Solution,
    /// Search for faces that may touch.
    Search,
}

/// Time per phase.
#[derive(Clone, Copy, Debug, Default)]
pub struct Phases {
    /// By [`Phase`], in its order.
    pub times: [Duration; 5],
}

impl Phases {
    /// Runs `work` and adds its time to a phase.
    pub fn measure<T>(&mut self, phase: Phase, work: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let out = work();
        self.times[phase as usize] += start.elapsed();
        out
    }
}

/// Energies since the start \[mJ\] and counts.
#[derive(Clone, Copy, Debug, Default)]
pub struct Totals {
    /// Work of reactions and loads, trapezoidal rule.
    pub external_work: f64,
    /// Largest magnitude of the external work so far.
    pub work_scale: f64,
    /// Stored now.
    pub stored: f64,
    /// Dissipated by transverse and longitudinal sliding, end values (as in the fields).
    pub dissipated: [f64; 2],
    /// The same, mid-point values (second order in the increment: the energy balance).
    pub dissipated_mid: [f64; 2],
    /// Spent by viscous stabilisation.
    pub stabilising: f64,
    /// Stored now in the compliance of contacts.
    pub contact_stored: f64,
    /// Dissipated by friction of contacts, mid-point values.
    pub contact_friction: f64,
    /// Put in by pressing apart surfaces that overlapped at the start; part of `external_work`.
    pub interference: f64,
    /// Converged increments.
    pub increments: usize,
    /// Newton iterations, those of failed attempts included.
    pub iterations: usize,
    /// Failed attempts.
    pub cutbacks: usize,
    /// Factorisations.
    pub factorisations: usize,
    /// Iterations of GMRES in all solutions, where contact friction makes the tangent unsymmetric.
    pub linear_iterations: usize,
    /// Rounds in which an augmented Lagrangian moved its multipliers.
    pub augmentations: usize,
    /// Patterns made anew because surfaces touched elsewhere.
    pub searches: usize,
    /// Converged increments whose last tangent had negative pivots.
    pub unstable_increments: usize,
    /// Negative pivots at the last converged increment that knew them.
    pub negative_pivots: Option<usize>,
    /// Converged increments at which that number changed.
    pub inertia_changes: usize,
    /// Converged increments that were found by minimising the incremental potential.
    pub minimised: usize,
    /// Converged increments that left an unstable branch for one that forks off it.
    pub switched: usize,
    /// Converged increments that Newton's method found by way of a softened model.
    pub smoothed: usize,
    /// Converged increments with a snap: energy left, or came, that forces and dissipation do not account for.
    pub jumps: usize,
    /// Energy released in them; negative where states of higher energy were jumped to.
    pub released: f64,
    /// What the balances of all other increments leave open, each within what its work can be known to \[mJ\].
    pub open: f64,
}

impl Totals {
    /// `external work - stored - dissipated - stabilising`, contacts included, over the largest external work so far,
    /// with mid-point dissipation.
    #[must_use]
    pub fn energy_error(&self) -> f64 {
        if self.work_scale == 0.0 { 0.0 } else { self.missing() / self.work_scale }
    }
}

/// One attempt at an increment.
#[derive(Clone, Debug)]
pub struct IncrementRecord {
    /// Name of the step.
    pub step: String,
    /// Index of the step, from 1.
    pub step_index: usize,
    /// Number of the increment in the step, from 1.
    pub increment: usize,
    /// Attempt at this increment, from 1.
    pub attempt: usize,
    /// Fraction of the step at its end.
    pub fraction: f64,
    /// Length as a fraction of the step, or of the path where that has arc lengths.
    pub length: f64,
    /// Time at its end \[s\].
    pub time: f64,
    /// Newton iterations.
    pub iterations: usize,
    /// Relative residual at every iterate.
    pub residuals: Vec<f64>,
    /// Negative pivots of the last tangent: more than zero past a limit or bifurcation point.
    pub negative_pivots: Option<usize>,
    /// Negative pivots before and after, where a converged increment has changed their number.
    pub inertia_change: Option<(usize, usize)>,
    /// Whether the attempt minimised the incremental potential.
    pub minimised: bool,
    /// Whether it left an unstable branch for one that forks off it.
    pub switched: bool,
    /// Whether Newton's method went by way of a softened model.
    pub smoothed: bool,
    /// Energy released by a snap in a converged increment \[mJ\]; zero where there was none, negative where the state has
    /// more energy than was put in.
    pub released: f64,
}

impl IncrementRecord {
    /// Notes where a converged attempt has ended.
    pub(super) fn end(&mut self, attempt: Attempt, time: f64) {
        (self.fraction, self.length, self.time) = (attempt.to, attempt.length, time);
    }

    /// Last relative residual; none when the attempt failed before its first iterate.
    #[must_use]
    pub fn residual(&self) -> Option<f64> {
        self.residuals.last().copied()
    }
}

/// Whether to go on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Control {
    /// Next increment.
    Continue,
    /// Stop here: the committed state is kept.
    Stop,
}

/// Watches a run.
pub trait Observer {
    /// An increment has converged and is committed.
    ///
    /// # Errors
    /// What stops the run, such as results that cannot be written ([`FemError::Observer`]).
    fn converged(&mut self, analysis: &Analysis, record: &IncrementRecord) -> Result<Control, FemError>;

    /// An attempt has failed; the run goes on with a shorter increment, or minimises the potential.
    fn failed(&mut self, record: &IncrementRecord, cause: &FemError) {
        let _ = (record, cause);
    }
}

/// Watches nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Observer for Silent {
    fn converged(&mut self, _: &Analysis, _: &IncrementRecord) -> Result<Control, FemError> {
        Ok(Control::Continue)
    }
}
