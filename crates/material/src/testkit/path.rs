//! Paths of displacement gradients in the material frame.

use nalgebra::Matrix3;

/// A sequence of displacement gradients `H` \[-\] in the material frame, from rest.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    gradients: Vec<Matrix3<f64>>,
}

/// Factors of a path that loads, unloads, reverses and reloads; none is zero.
const CYCLE: [f64; 12] = [0.31, 0.63, 1.0, 0.97, 0.55, 0.02, -0.44, -0.9, -0.87, -0.3, 0.28, 0.83];

impl Path {
    /// A path through the given displacement gradients.
    #[must_use]
    pub fn new(gradients: Vec<Matrix3<f64>>) -> Self {
        Self { gradients }
    }

    /// Loading, unloading, reversal and reloading along one direction.
    #[must_use]
    pub fn cycle(direction: &Matrix3<f64>, amplitude: f64) -> Self {
        Self { gradients: CYCLE.iter().map(|factor| direction * (factor * amplitude)).collect() }
    }

    /// A closed loop in the plane of two directions, `steps` steps per turn, one and a quarter turns.
    #[must_use]
    pub fn circle(first: &Matrix3<f64>, second: &Matrix3<f64>, amplitude: f64, steps: usize) -> Self {
        let angle = |i: usize| std::f64::consts::TAU * (i as f64 + 0.3) / steps as f64;
        let gradients =
            (0..steps + steps / 4).map(|i| (first * angle(i).cos() + second * angle(i).sin()) * amplitude).collect();
        Self { gradients }
    }

    /// Four paths of an amplitude in strain: section distortion under compaction, longitudinal shear under tension, a
    /// general one with rotation, and a loop through all components.
    #[must_use]
    pub fn standard(amplitude: f64) -> Vec<Self> {
        let section = Matrix3::new(0.03, 0.07, 0.02, -0.05, -0.62, 0.81, 0.04, 0.33, 0.11);
        let shear = Matrix3::new(0.06, 0.92, -0.41, 0.13, -0.08, 0.05, 0.27, 0.02, -0.11);
        let general = Matrix3::new(0.11, 0.52, -0.37, 0.48, -0.44, 0.63, -0.29, 0.18, 0.21);
        vec![
            Self::cycle(&section, amplitude),
            Self::cycle(&shear, amplitude),
            Self::cycle(&general, amplitude),
            Self::circle(&section, &shear, amplitude, 10),
        ]
    }

    /// The displacement gradients.
    #[must_use]
    pub fn gradients(&self) -> &[Matrix3<f64>] {
        &self.gradients
    }
}
