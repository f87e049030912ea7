//! How a run reports to whoever watches it. The library never prints.

use std::fmt;

use crate::plan::Plan;

/// A step begins.
#[derive(Clone, Debug, PartialEq)]
pub struct StepStart {
    /// Position of the step, from 0.
    pub index: usize,
    /// Number of steps.
    pub count: usize,
    /// Name.
    pub name: String,
    /// Length of the step \[s\].
    pub duration: f64,
}

/// How an attempt at an increment ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Equilibrium was found.
    Converged,
    /// Equilibrium was found as a minimum of the incremental potential.
    Minimised,
    /// The increment is tried again, shorter or as a minimisation.
    CutBack,
}

/// An attempt at an increment.
#[derive(Clone, Debug, PartialEq)]
pub struct IncrementRecord {
    /// Position of the step, from 0.
    pub step: usize,
    /// Number of the increment within the step, from 1.
    pub increment: usize,
    /// Number of the attempt at this increment, from 1.
    pub attempt: usize,
    /// How it ended.
    pub outcome: Outcome,
    /// Newton iterations of this attempt.
    pub iterations: usize,
    /// Relative residual force at its end \[-\]; none when it failed before that was known.
    pub residual: Option<f64>,
    /// Fraction of the step reached, or tried \[-\].
    pub fraction: f64,
    /// Length of the increment as a fraction of the step \[-\].
    pub size: f64,
    /// Total time reached, or tried \[s\].
    pub time: f64,
    /// Wall-clock time of this attempt \[s\].
    pub seconds: f64,
}

/// The end of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Finish {
    /// Increments that converged.
    pub increments: usize,
    /// Newton iterations, those of failed attempts included.
    pub iterations: usize,
    /// Wall-clock time \[s\].
    pub seconds: f64,
    /// Whether it was interrupted by the user.
    pub interrupted: bool,
}

/// Watches a run. Every method does nothing unless it is overridden.
pub trait Observer: Send {
    /// A run is about to begin.
    fn on_plan(&mut self, _plan: &Plan) {}

    /// A run goes on from a checkpoint, after so many increments, at a time \[s\].
    fn on_restart(&mut self, _increments: usize, _time: f64) {}

    /// A step begins, or goes on.
    fn on_step(&mut self, _step: &StepStart) {}

    /// An attempt at an increment ended.
    fn on_increment(&mut self, _record: &IncrementRecord) {}

    /// Something a user should know, though the run goes on.
    fn on_warning(&mut self, _warning: &dyn fmt::Display) {}

    /// The run ended, completed or interrupted; not called after an error.
    fn on_finish(&mut self, _finish: &Finish) {}
}

/// Watches nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Observer for Silent {}
