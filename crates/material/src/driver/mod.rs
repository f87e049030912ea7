//! The point driver: a law along a path of displacement gradients, in a frame of its own.

mod difference;

use nalgebra::{Matrix3, Matrix6, Vector6};

use crate::law::{Law, PointInput, Request, Response};
use crate::{ConjugateForces, LawError, StrainModes, mandel};
pub use difference::difference_tangent;
pub(crate) use difference::strained;

/// A step of a path at which the law gave no answer.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("step {step} of the path")]
pub struct DriverError {
    /// Index of the step.
    pub step: usize,
    /// What the law said.
    #[source]
    pub source: LawError,
}

/// A law at one material point whose fibre frame is not the global one.
#[derive(Clone, Debug)]
pub struct PointDriver<'law> {
    law: &'law dyn Law,
    frame: Matrix3<f64>,
    time_increment: f64,
    temperature: f64,
    difference_step: Option<f64>,
}

/// What a step of the path gave.
#[derive(Clone, Debug, PartialEq)]
pub struct PointStep {
    /// Strain modes \[-\].
    pub modes: StrainModes,
    /// Conjugate forces, compaction pressure and slip flags \[MPa\]; `None` for a law not written in the modes.
    pub forces: Option<ConjugateForces>,
    /// Everything the law answered, in the fibre frame.
    pub response: Response,
    /// Second Piola-Kirchhoff stress in the global frame \[MPa\], Mandel.
    pub second_piola_global: Vector6<f64>,
    /// Tangent by difference quotients \[MPa\], Mandel, fibre frame, when asked for.
    pub difference_tangent: Option<Matrix6<f64>>,
    /// State after the step.
    pub state: Vec<f64>,
}

impl<'law> PointDriver<'law> {
    /// A driver of a law in the frame with the columns e1, e2, e3 (global components).
    #[must_use]
    pub fn new(law: &'law dyn Law, frame: Matrix3<f64>) -> Self {
        Self { law, frame, time_increment: 1.0, temperature: 293.15, difference_step: None }
    }

    /// The same with a time increment \[s\] per step and a temperature \[K\].
    #[must_use]
    pub fn with_conditions(mut self, time_increment: f64, temperature: f64) -> Self {
        self.time_increment = time_increment;
        self.temperature = temperature;
        self
    }

    /// The same, also forming the tangent by difference quotients of the given step in strain, say 1e-6 \[-\].
    #[must_use]
    pub fn with_difference_tangent(mut self, step: f64) -> Self {
        self.difference_step = Some(step);
        self
    }

    /// Input of the law at a global displacement gradient: `H` in the fibre frame, `R^T H R`.
    #[must_use]
    pub fn input(&self, displacement_gradient: &Matrix3<f64>) -> PointInput {
        PointInput {
            displacement_gradient: self.frame.tr_mul(displacement_gradient) * self.frame,
            mean_elongation: None,
            time_increment: self.time_increment,
            temperature: self.temperature,
        }
    }

    /// Runs from a virgin state through global displacement gradients `H = F - 1`.
    ///
    /// # Errors
    /// [`DriverError`] at the first step without an answer.
    pub fn run(&self, path: &[Matrix3<f64>]) -> Result<Vec<PointStep>, DriverError> {
        self.run_from(&vec![0.0; self.law.state_len()], path)
    }

    /// Runs from a given state.
    ///
    /// # Errors
    /// As [`PointDriver::run`].
    pub fn run_from(&self, state: &[f64], path: &[Matrix3<f64>]) -> Result<Vec<PointStep>, DriverError> {
        let mut old = state.to_vec();
        let mut steps = Vec::with_capacity(path.len());
        for (step, gradient) in path.iter().enumerate() {
            let answer = self.step(&old, gradient).map_err(|source| DriverError { step, source })?;
            old.clone_from(&answer.state);
            steps.push(answer);
        }
        Ok(steps)
    }

    /// Runs through deformation gradients `F`. Their strain is known to `eps` only: `F - 1` loses the digits below.
    ///
    /// # Errors
    /// As [`PointDriver::run`].
    pub fn run_deformation_gradients(&self, path: &[Matrix3<f64>]) -> Result<Vec<PointStep>, DriverError> {
        let gradients: Vec<_> = path.iter().map(|f| f - Matrix3::identity()).collect();
        self.run(&gradients)
    }

    /// One step from a state.
    ///
    /// # Errors
    /// [`LawError`].
    pub fn step(&self, old: &[f64], displacement_gradient: &Matrix3<f64>) -> Result<PointStep, LawError> {
        let input = self.input(displacement_gradient);
        let mut response = Response::default();
        let mut state = old.to_vec();
        self.law.evaluate(&input, old, &mut state, Request::Tangent, &mut response)?;
        let difference_tangent = match self.difference_step {
            Some(step) => Some(difference_tangent(self.law, &input, old, step)?),
            None => None,
        };
        Ok(PointStep {
            modes: StrainModes::from_displacement_gradient(&input.displacement_gradient)?,
            forces: self.law.modal_forces(&input, old)?,
            second_piola_global: mandel::rotate(&response.second_piola, &self.frame),
            response,
            difference_tangent,
            state,
        })
    }
}

impl PointStep {
    /// First Piola-Kirchhoff stress `P = F S` \[MPa\] in the global frame, from the global displacement gradient.
    #[must_use]
    pub fn first_piola_global(&self, displacement_gradient: &Matrix3<f64>) -> Matrix3<f64> {
        (displacement_gradient + Matrix3::identity()) * mandel::to_matrix(&self.second_piola_global)
    }
}
