//! Fibre fields: the frame of the yarns at a point of the reference configuration.

mod along_helix;
mod frames;
mod helical;
mod per_cell;

pub use along_helix::FibresAlongHelix;
pub use frames::{centroid_frames, fibre_frames, frame_deviation, frame_from_directions};
pub use helical::HelicalFibres;
pub use per_cell::{Parallel, PerCellFrames};

use crate::GeometryError;
use nalgebra::{Matrix3, Vector3};

/// A field of fibre frames in the reference configuration.
pub trait FibreField {
    /// Frame at the position `x` \[mm\] in the cell of index `cell`: columns e1 (fibre), e2, e3, orthonormal and
    /// right-handed.
    ///
    /// # Errors
    /// When the field has no frame there.
    fn frame(&self, x: &Vector3<f64>, cell: usize) -> Result<Matrix3<f64>, GeometryError>;
}

impl<F: FibreField + ?Sized> FibreField for &F {
    fn frame(&self, x: &Vector3<f64>, cell: usize) -> Result<Matrix3<f64>, GeometryError> {
        (**self).frame(x, cell)
    }
}

impl<F: FibreField + ?Sized> FibreField for Box<F> {
    fn frame(&self, x: &Vector3<f64>, cell: usize) -> Result<Matrix3<f64>, GeometryError> {
        (**self).frame(x, cell)
    }
}
