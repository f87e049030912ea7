//! The fibre field of a strand.

use super::StrandAxis;
use crate::{FibreField, FibresAlongHelix, GeometryError, HelicalFibres, Lay};
use nalgebra::{Matrix3, Vector3};

/// Fibre field of a strand with a straight or helical axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StrandFibres {
    /// About a straight axis.
    Straight(HelicalFibres),
    /// About a helical axis.
    Helix(FibresAlongHelix),
}

impl StrandFibres {
    /// Yarns of lay `lay` about `axis`.
    pub fn new(axis: &StrandAxis, lay: Lay) -> Self {
        match *axis {
            StrandAxis::Straight(axis) => Self::Straight(HelicalFibres::new(axis, lay)),
            StrandAxis::Helix(helix) => Self::Helix(FibresAlongHelix::new(helix, lay)),
        }
    }
}

impl FibreField for StrandFibres {
    fn frame(&self, x: &Vector3<f64>, cell: usize) -> Result<Matrix3<f64>, GeometryError> {
        match self {
            Self::Straight(field) => field.frame(x, cell),
            Self::Helix(field) => field.frame(x, cell),
        }
    }
}
