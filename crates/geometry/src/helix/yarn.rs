//! The yarn in a strand whose own axis is a helix: two levels of winding.

use super::{FrenetFrame, Helix, Lay};
use crate::{GeometryError, Parameter, check};
use nalgebra::Vector3;

/// A yarn at the radius r of a strand with a helical axis c(s), s the arc length of that axis:
///
/// y(s) = c(s) + r (cos(psi) n(s) + sin(psi) b(s)), psi(s) = phi_0 + 2 pi s/p,
///
/// with the Frenet normal n and binormal b of the axis and the pitch p of the yarns in the strand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Yarn {
    strand: Helix,
    lay: Lay,
    radius: f64,
    phase: f64,
}

impl Yarn {
    /// A yarn at distance `radius` \[mm\] from the axis of the strand, at the angle `phase` \[rad\] from its Frenet
    /// normal at s = 0; `lay` counts along the arc length of the axis.
    ///
    /// # Errors
    /// When the radius is negative or reaches the radius of curvature of the axis, or the phase is not finite.
    pub fn new(strand: Helix, lay: Lay, radius: f64, phase: f64) -> Result<Self, GeometryError> {
        check::range(Parameter::Radius, radius, 0.0, strand.curvature().recip())?;
        check::finite(Parameter::Phase, phase)?;
        Ok(Self { strand, lay, radius, phase })
    }

    /// Angle psi \[rad\] against the Frenet normal at arc length `s` \[mm\] of the axis.
    #[inline]
    pub fn angle(&self, s: f64) -> f64 {
        self.phase + self.lay.rate() * s
    }

    /// Position \[mm\] at arc length `s` \[mm\] of the axis of the strand.
    pub fn position(&self, s: f64) -> Vector3<f64> {
        let frame = self.strand.frenet(s);
        let (sin, cos) = self.angle(s).sin_cos();
        frame.position + (frame.normal * cos + frame.binormal * sin) * self.radius
    }

    /// Unit tangent at arc length `s` \[mm\] of the axis of the strand.
    pub fn tangent(&self, s: f64) -> Vector3<f64> {
        let (sin, cos) = self.angle(s).sin_cos();
        yarn_direction(&self.strand, &self.lay, &self.strand.frenet(s), self.radius * cos, self.radius * sin)
            .normalize()
    }
}

/// dy/ds of the yarn through the point u n + v b of the section of a strand:
/// (1 - kappa u) t + (omega + tau)(u b - v n), by the Frenet formulas n' = -kappa t + tau b, b' = -tau n.
#[inline]
pub(crate) fn yarn_direction(strand: &Helix, lay: &Lay, frame: &FrenetFrame, u: f64, v: f64) -> Vector3<f64> {
    let rate = lay.rate() + strand.torsion();
    frame.tangent * (1.0 - strand.curvature() * u) + (frame.binormal * u - frame.normal * v) * rate
}
