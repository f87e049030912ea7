//! Yarns wound around a straight axis.

use super::FibreField;
use crate::{Axis, GeometryError, Lay};
use nalgebra::{Matrix3, Vector3};

/// Helical fibres about a straight axis, all of one lay.
///
/// About the z axis, at (x, y) with r = hypot(x, y) and t = 2 pi r/pitch:
/// e1 = (-t y/r, t x/r, 1)/sqrt(1 + t^2), e2 = (x/r, y/r, 0) radial, e3 = e1 x e2.
/// On the axis e1 is its direction, the limit from all sides, and e2 the reference direction of the axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HelicalFibres {
    axis: Axis,
    lay: Lay,
}

impl HelicalFibres {
    /// Fibres of lay `lay` about `axis`.
    pub fn new(axis: Axis, lay: Lay) -> Self {
        Self { axis, lay }
    }

    /// The axis.
    pub fn axis(&self) -> &Axis {
        &self.axis
    }

    /// The lay.
    pub fn lay(&self) -> Lay {
        self.lay
    }
}

impl FibreField for HelicalFibres {
    #[inline]
    fn frame(&self, x: &Vector3<f64>, _cell: usize) -> Result<Matrix3<f64>, GeometryError> {
        let (offset, d) = (self.axis.offset(x), self.axis.direction());
        let radius = offset.norm();
        let slope = self.lay.rate() * radius;
        let e1 = (d + d.cross(&offset) * self.lay.rate()) / slope.hypot(1.0);
        let e2 = if radius > 0.0 { offset / radius } else { self.axis.reference() };
        Ok(Matrix3::from_columns(&[e1, e2, e1.cross(&e2)]))
    }
}
