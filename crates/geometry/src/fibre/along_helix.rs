//! Yarns in a strand whose own axis is a helix.

use super::FibreField;
use crate::GeometryError;
use crate::helix::{Helix, Lay, yarn_direction};
use nalgebra::{Matrix3, Vector3};

/// Fibres of a strand with a helical axis: at every point the tangent of the [`crate::Yarn`] that passes there.
///
/// With s the arc length of the nearest point of the axis, (t, n, b) its Frenet frame and x - c(s) = u n + v b:
/// e1 ~ (1 - kappa u) t + (omega + tau)(u b - v n), omega = 2 pi/p the twist rate of the yarns in the strand;
/// e2 = (u n + v b)/hypot(u, v), on the axis n; e3 = e1 x e2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FibresAlongHelix {
    strand: Helix,
    lay: Lay,
}

impl FibresAlongHelix {
    /// Fibres in a strand with the axis `strand`; `lay` counts along the arc length of that axis.
    pub fn new(strand: Helix, lay: Lay) -> Self {
        Self { strand, lay }
    }

    /// The axis of the strand.
    pub fn strand(&self) -> &Helix {
        &self.strand
    }

    /// The lay of the yarns in the strand.
    pub fn lay(&self) -> Lay {
        self.lay
    }
}

impl FibreField for FibresAlongHelix {
    fn frame(&self, x: &Vector3<f64>, _cell: usize) -> Result<Matrix3<f64>, GeometryError> {
        let frame = self.strand.frenet(self.strand.nearest(x)?);
        let offset = x - frame.position;
        let (u, v) = (offset.dot(&frame.normal), offset.dot(&frame.binormal));
        let curvature = self.strand.curvature();
        if curvature * u >= 1.0 {
            let curvature_radius = curvature.recip();
            return Err(GeometryError::BeyondCurvature { point: (*x).into(), distance: u, curvature_radius });
        }
        let e1 = yarn_direction(&self.strand, &self.lay, &frame, u, v).normalize();
        let radius = u.hypot(v);
        let scale = self.strand.radius() + offset.norm();
        let radial =
            if radius > 1e-12 * scale { (frame.normal * u + frame.binormal * v) / radius } else { frame.normal };
        let e2 = (radial - e1 * e1.dot(&radial)).normalize();
        Ok(Matrix3::from_columns(&[e1, e2, e1.cross(&e2)]))
    }
}
