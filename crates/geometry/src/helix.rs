//! Helices: lay, position and Frenet frame, nearest point, and the yarn in a strand whose own axis is a helix.

mod kepler;
mod lay;
mod nearest;
mod touching;
mod yarn;

pub use lay::{Handedness, Lay};
pub use touching::{touching_pair, touching_radius, touching_radius_at_angle};
pub use yarn::Yarn;

pub(crate) use kepler::kepler;
pub(crate) use yarn::yarn_direction;

use crate::{Axis, GeometryError, Parameter, check};
use nalgebra::Vector3;

/// A helix about a straight axis, parametrised by its arc length s \[mm\].
///
/// With the twist rate k = 2 pi/pitch of its [`Lay`] and the radius a:
/// theta(s) = theta_0 + k s cos(beta), axial(s) = s cos(beta), tan(beta) = a |k|.
/// s = 0 lies in the plane through the origin of the axis, at the phase theta_0 from its reference direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Helix {
    axis: Axis,
    radius: f64,
    lay: Lay,
    phase: f64,
}

/// Position and Frenet frame of a curve at one point: tangent, normal and binormal = tangent x normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrenetFrame {
    /// Position \[mm\].
    pub position: Vector3<f64>,
    /// Unit tangent.
    pub tangent: Vector3<f64>,
    /// Unit normal, towards the axis of a helix.
    pub normal: Vector3<f64>,
    /// Unit binormal.
    pub binormal: Vector3<f64>,
}

impl Helix {
    /// A helix of radius `radius` \[mm\] about `axis`; `phase` is its angle \[rad\] at s = 0.
    ///
    /// An untwisted lay gives a straight line beside the axis, its normal still pointing to the axis.
    ///
    /// # Errors
    /// When the radius is not positive and finite, or the phase is not finite.
    pub fn new(axis: Axis, radius: f64, lay: Lay, phase: f64) -> Result<Self, GeometryError> {
        check::positive(Parameter::HelixRadius, radius)?;
        check::finite(Parameter::Phase, phase)?;
        Ok(Self { axis, radius, lay, phase })
    }

    /// The axis.
    pub fn axis(&self) -> &Axis {
        &self.axis
    }

    /// Radius a \[mm\].
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// The lay.
    pub fn lay(&self) -> Lay {
        self.lay
    }

    /// Angle at s = 0 \[rad\].
    pub fn phase(&self) -> f64 {
        self.phase
    }

    /// Arc length per axial length, 1/cos(beta) = sqrt(1 + a^2 k^2).
    #[inline]
    pub fn stretch(&self) -> f64 {
        (self.radius * self.lay.rate()).hypot(1.0)
    }

    /// Arc length \[mm\] of a piece of helix that advances by `axial` \[mm\].
    #[inline]
    pub fn arc_length(&self, axial: f64) -> f64 {
        axial * self.stretch()
    }

    /// Axial advance \[mm\] of a piece of helix of arc length `s` \[mm\].
    #[inline]
    pub fn axial(&self, s: f64) -> f64 {
        s / self.stretch()
    }

    /// Angle theta \[rad\] about the axis at arc length `s` \[mm\].
    #[inline]
    pub fn angle(&self, s: f64) -> f64 {
        self.phase + self.lay.rate() * self.axial(s)
    }

    /// Curvature kappa = a k^2/(1 + a^2 k^2) \[1/mm\].
    pub fn curvature(&self) -> f64 {
        let k = self.lay.rate();
        self.radius * k * k / self.stretch().powi(2)
    }

    /// Torsion tau = k/(1 + a^2 k^2) \[1/mm\], positive for a right-handed helix.
    pub fn torsion(&self) -> f64 {
        self.lay.rate() / self.stretch().powi(2)
    }

    /// Position \[mm\] at arc length `s` \[mm\].
    #[inline]
    pub fn position(&self, s: f64) -> Vector3<f64> {
        let (sin, cos) = self.angle(s).sin_cos();
        self.axis.position(self.radius * cos, self.radius * sin, self.axial(s))
    }

    /// Unit tangent at arc length `s` \[mm\].
    #[inline]
    pub fn tangent(&self, s: f64) -> Vector3<f64> {
        let around = self.axis.circumferential(self.angle(s)) * (self.radius * self.lay.rate());
        (self.axis.direction() + around) / self.stretch()
    }

    /// Position and Frenet frame at arc length `s` \[mm\].
    #[inline]
    pub fn frenet(&self, s: f64) -> FrenetFrame {
        let normal = -self.axis.radial(self.angle(s));
        let tangent = self.tangent(s);
        FrenetFrame { position: self.position(s), tangent, normal, binormal: tangent.cross(&normal) }
    }
}
