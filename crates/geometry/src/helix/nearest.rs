//! The point of a helix nearest to a given point.

use super::{Helix, kepler};
use crate::GeometryError;
use nalgebra::Vector3;

impl Helix {
    /// Arc length s \[mm\] of the point of the helix nearest to `x` \[mm\].
    ///
    /// With cylindrical coordinates (rho, psi, z) of x, half the squared distance is, up to a constant,
    /// (zeta - z)^2/2 - rho a cos(theta_0 + k zeta - psi) at the axial coordinate zeta of the helix. With
    /// u = theta_0 + k zeta - psi its minimum solves u + rho a k^2 sin(u) = theta_0 + k z - psi.
    /// Where two points are equally near (on the far side of the axis) one of them is returned.
    ///
    /// # Errors
    /// [`GeometryError::NoNearestPoint`] when a coordinate is not finite.
    pub fn nearest(&self, x: &Vector3<f64>) -> Result<f64, GeometryError> {
        let local = self.axis.cylindrical(x);
        let k = self.lay.rate();
        let eccentricity = local.radius * self.radius * k * k;
        let phase = self.phase + k * local.axial - local.angle;
        // zeta = z - rho a k sin(u) instead of (u + psi - theta_0)/k holds for k = 0 too.
        let u = kepler(eccentricity, phase);
        let axial = local.axial - local.radius * self.radius * k * u.sin();
        if axial.is_finite() {
            Ok(self.arc_length(axial))
        } else {
            Err(GeometryError::NoNearestPoint { point: (*x).into() })
        }
    }
}
