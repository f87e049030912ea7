//! Frames that do not depend on the position.

use super::{FibreField, frame_deviation};
use crate::GeometryError;
use nalgebra::{Matrix3, Vector3};

/// Largest deviation from orthonormality accepted in given frames.
const TOLERANCE: f64 = 1e-6;

/// One frame per cell, as an input deck gives it.
#[derive(Debug, Clone, PartialEq)]
pub struct PerCellFrames(pub Vec<Matrix3<f64>>);

impl PerCellFrames {
    /// Frames in the order of the cells, each orthonormal and right-handed within 1e-6.
    ///
    /// # Errors
    /// [`GeometryError::NotOrthonormal`] for the first frame that is not.
    pub fn new(frames: Vec<Matrix3<f64>>) -> Result<Self, GeometryError> {
        for (index, frame) in frames.iter().enumerate() {
            check(index, frame)?;
        }
        Ok(Self(frames))
    }
}

impl FibreField for PerCellFrames {
    #[inline]
    fn frame(&self, _x: &Vector3<f64>, cell: usize) -> Result<Matrix3<f64>, GeometryError> {
        self.0.get(cell).copied().ok_or(GeometryError::FrameIndex { cell, frames: self.0.len() })
    }
}

/// The same frame everywhere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parallel(pub Matrix3<f64>);

impl Parallel {
    /// A frame that is orthonormal and right-handed within 1e-6.
    ///
    /// # Errors
    /// [`GeometryError::NotOrthonormal`] when it is not.
    pub fn new(frame: Matrix3<f64>) -> Result<Self, GeometryError> {
        check(0, &frame)?;
        Ok(Self(frame))
    }
}

impl FibreField for Parallel {
    #[inline]
    fn frame(&self, _x: &Vector3<f64>, _cell: usize) -> Result<Matrix3<f64>, GeometryError> {
        Ok(self.0)
    }
}

fn check(index: usize, frame: &Matrix3<f64>) -> Result<(), GeometryError> {
    let deviation = frame_deviation(frame);
    if deviation <= TOLERANCE { Ok(()) } else { Err(GeometryError::NotOrthonormal { index, deviation }) }
}
