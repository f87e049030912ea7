//! Lay: how fast something winds around an axis.

use crate::{GeometryError, Parameter, check};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Sense of winding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Handedness {
    /// Right-handed (Z lay): seen along the axis, the helix turns clockwise as it goes away.
    Right,
    /// Left-handed (S lay).
    Left,
}

impl Handedness {
    /// +1 for right-handed, -1 for left-handed.
    #[inline]
    pub fn sign(self) -> f64 {
        match self {
            Self::Right => 1.0,
            Self::Left => -1.0,
        }
    }

    /// The other one.
    pub fn opposite(self) -> Self {
        match self {
            Self::Right => Self::Left,
            Self::Left => Self::Right,
        }
    }
}

/// Winding about an axis, the same at every radius: twist rate k = 2 pi/pitch \[rad/mm\].
///
/// The lay length is the length of axis per turn; the pitch is the lay length with the sign of the handedness. At the
/// radius r the angle to the axis is atan(r |k|). Untwisted is k = 0, an infinite lay length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lay {
    rate: f64,
}

impl Lay {
    /// No winding: parallel to the axis.
    pub const PARALLEL: Self = Self { rate: 0.0 };

    /// From a twist rate \[rad/mm\] known to be finite.
    pub(crate) const fn from_finite_rate(rate: f64) -> Self {
        Self { rate }
    }

    /// From the twist rate k \[rad/mm\], positive for right-handed.
    ///
    /// # Errors
    /// When it is not finite.
    pub fn from_rate(rate: f64) -> Result<Self, GeometryError> {
        Ok(Self { rate: check::finite(Parameter::TwistRate, rate)? })
    }

    /// From the signed pitch \[mm\], positive for right-handed.
    ///
    /// # Errors
    /// When it is zero or not finite.
    pub fn from_pitch(pitch: f64) -> Result<Self, GeometryError> {
        check::finite(Parameter::Pitch, pitch)?;
        check::positive(Parameter::LayLength, pitch.abs())?;
        Self::from_rate(TAU / pitch)
    }

    /// From the lay length \[mm\].
    ///
    /// # Errors
    /// When it is not positive and finite.
    pub fn from_lay_length(lay_length: f64, handedness: Handedness) -> Result<Self, GeometryError> {
        check::positive(Parameter::LayLength, lay_length)?;
        Self::from_rate(handedness.sign() * TAU / lay_length)
    }

    /// From the angle to the axis \[rad\], in \[0, pi/2), at the radius `radius` \[mm\].
    ///
    /// # Errors
    /// When the radius is not positive or the angle is out of range.
    pub fn from_angle(radius: f64, angle: f64, handedness: Handedness) -> Result<Self, GeometryError> {
        check::positive(Parameter::Radius, radius)?;
        check::range(Parameter::Angle, angle, 0.0, FRAC_PI_2)?;
        Self::from_rate(handedness.sign() * angle.tan() / radius)
    }

    /// From the arc length per turn \[mm\] at the radius `radius` \[mm\]; it exceeds the circumference 2 pi r.
    ///
    /// # Errors
    /// When the radius is not positive or the arc length does not exceed the circumference.
    pub fn from_arc_length(radius: f64, arc_length: f64, handedness: Handedness) -> Result<Self, GeometryError> {
        let around = TAU * check::positive(Parameter::Radius, radius)?;
        check::range(Parameter::ArcLength, arc_length, around.next_up(), f64::INFINITY)?;
        // sqrt((l - c)(l + c)) keeps its digits where l is close to c.
        Self::from_lay_length(((arc_length - around) * (arc_length + around)).sqrt(), handedness)
    }

    /// Twist rate k \[rad/mm\], positive for right-handed.
    #[inline]
    pub fn rate(&self) -> f64 {
        self.rate
    }

    /// Signed pitch 2 pi/k \[mm\]; infinite when untwisted.
    pub fn pitch(&self) -> f64 {
        TAU / self.rate
    }

    /// Lay length 2 pi/|k| \[mm\]; infinite when untwisted.
    pub fn lay_length(&self) -> f64 {
        TAU / self.rate.abs()
    }

    /// Handedness; `None` when untwisted.
    pub fn handedness(&self) -> Option<Handedness> {
        match self.rate {
            k if k > 0.0 => Some(Handedness::Right),
            k if k < 0.0 => Some(Handedness::Left),
            _ => None,
        }
    }

    /// Angle to the axis at the radius `radius` \[mm\]: atan(r |k|) \[rad\].
    pub fn angle(&self, radius: f64) -> f64 {
        (radius * self.rate.abs()).atan()
    }

    /// Arc length per turn at the radius `radius` \[mm\]: hypot(lay length, 2 pi r) \[mm\].
    pub fn arc_length(&self, radius: f64) -> f64 {
        self.lay_length().hypot(TAU * radius)
    }
}
