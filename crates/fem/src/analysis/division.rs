//! How a step is divided into increments.

use super::step::{Increments, NewtonOptions, PathControl, Step};
use crate::FemError;

/// How far a step is and how long the next increment shall be.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Progress {
    /// Fraction of the step.
    pub done: f64,
    /// Fraction of the step.
    pub length: f64,
    /// Converged increments.
    pub count: usize,
}

impl Progress {
    /// A step begins.
    pub fn new(step: &Step) -> Self {
        let length = match step.increments {
            Increments::Fixed(n) => 1.0 / n as f64,
            Increments::Automatic { initial, .. } => initial,
        };
        Self { done: 0.0, length, count: 0 }
    }
}

/// The rules of a step.
pub struct Division<'a> {
    pub step: &'a Step,
    pub options: NewtonOptions,
}

impl Division<'_> {
    /// Where the next increment ends.
    pub fn next_end(&self, at: &Progress) -> f64 {
        match self.step.increments {
            Increments::Fixed(n) => (at.count + 1) as f64 / n as f64,
            Increments::Automatic { control: PathControl::ArcLength, .. } => at.done + at.length,
            Increments::Automatic { .. } => {
                let limit = self.step.knots.iter().copied().find(|k| *k > at.done * (1.0 + 1e-12)).unwrap_or(1.0);
                // No crumb before a knot or at the end of a step.
                if at.done + 1.001 * at.length >= limit { limit } else { at.done + at.length }
            }
        }
    }

    /// Length of the next increment.
    pub fn next_length(&self, at: &Progress) -> f64 {
        if self.step.increments.are_arcs() { at.length } else { self.next_end(at) - at.done }
    }

    /// After an increment to `to`, which may lie before where it began.
    pub fn advance(&self, at: &mut Progress, to: f64, iterations: usize) {
        at.done = to;
        at.count += 1;
        if let Increments::Automatic { maximum, .. } = self.step.increments
            && iterations <= self.options.easy_iterations
        {
            at.length = (at.length * self.options.growth).min(maximum);
        }
    }

    /// Whether the next increment has been cut as far as it may be.
    pub fn is_shortest(&self, at: &Progress) -> bool {
        match self.step.increments {
            Increments::Fixed(_) => false,
            Increments::Automatic { minimum, .. } => self.shorter(at) < minimum,
        }
    }

    /// A path that ends is left for the minimum at a fraction beyond, as far as the first increment of the step went.
    pub fn leave_path(&self, at: &mut Progress) {
        if let Increments::Automatic { control: PathControl::ArcLength, initial, .. } = self.step.increments {
            at.length = initial.min(1.0 - at.done);
        }
    }

    /// Neither the path nor a minimum beyond leads on: nothing shorter is tried.
    pub fn end_path(&self, at: &mut Progress) {
        if self.step.increments.are_arcs() {
            at.length = 0.0;
        }
    }

    /// Length of the next increment once it has been cut.
    fn shorter(&self, at: &Progress) -> f64 {
        self.next_length(at) * self.options.cutback
    }

    /// After a failed attempt.
    ///
    /// # Errors
    /// What ends the step.
    pub fn cut(&self, at: &mut Progress, cause: FemError) -> Result<(), FemError> {
        if !cause.is_recoverable() {
            return Err(cause);
        }
        let (step, cause) = (self.step.name.clone(), Box::new(cause));
        match self.step.increments {
            Increments::Fixed(_) => Err(FemError::FixedIncrementFailed { step, increment: at.count + 1, cause }),
            Increments::Automatic { minimum, .. } => {
                at.length = self.shorter(at);
                if at.length < minimum {
                    return Err(FemError::IncrementTooShort { step, fraction: at.done, minimum, cause });
                }
                Ok(())
            }
        }
    }

    /// # Errors
    /// [`FemError::TooManyIncrements`].
    pub fn check_count(&self, at: &Progress) -> Result<(), FemError> {
        match self.step.increments {
            Increments::Automatic { max_count, .. } if at.count >= max_count => {
                let step = self.step.name.clone();
                Err(FemError::TooManyIncrements { step, fraction: at.done, limit: max_count })
            }
            _ => Ok(()),
        }
    }
}
