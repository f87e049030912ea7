//! A straight axis in space with a reference direction: the frame of cylindrical coordinates.

use crate::{GeometryError, Parameter, check};
use nalgebra::Vector3;

/// A straight axis: origin, unit direction d, unit reference direction r (angle 0) and d x r (angle 90 deg).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axis {
    origin: Vector3<f64>,
    direction: Vector3<f64>,
    reference: Vector3<f64>,
    transverse: Vector3<f64>,
}

/// Cylindrical coordinates about an [`Axis`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cylindrical {
    /// Distance from the axis \[mm\].
    pub radius: f64,
    /// Angle from the reference direction, right-handed about the axis, in (-pi, pi] \[rad\].
    pub angle: f64,
    /// Coordinate along the axis \[mm\].
    pub axial: f64,
}

impl Default for Axis {
    /// The global z axis with reference direction x.
    fn default() -> Self {
        Self { origin: Vector3::zeros(), direction: Vector3::z(), reference: Vector3::x(), transverse: Vector3::y() }
    }
}

impl Axis {
    /// The axis through `origin` \[mm\] along `direction` (any length but zero).
    ///
    /// The reference direction is the global axis least aligned with the direction (the first one where two are equally
    /// little aligned), made normal to it: for +z the reference direction is +x.
    ///
    /// # Errors
    /// When the origin is not finite or the direction is zero or not finite.
    pub fn new(origin: Vector3<f64>, direction: Vector3<f64>) -> Result<Self, GeometryError> {
        let least = direction.iamin();
        let mut reference = Vector3::zeros();
        reference[least] = 1.0;
        Self::with_reference(origin, direction, reference)
    }

    /// The axis through `origin` \[mm\] along `direction`; `reference` is made normal to it and gives the angle 0.
    ///
    /// # Errors
    /// When the origin is not finite, a direction is zero or not finite, or both are parallel.
    pub fn with_reference(
        origin: Vector3<f64>,
        direction: Vector3<f64>,
        reference: Vector3<f64>,
    ) -> Result<Self, GeometryError> {
        for &x in &origin {
            check::finite(Parameter::Origin, x)?;
        }
        let direction = unit(direction, 0.0)?;
        let normal = unit(reference, 0.0)?;
        let projected = unit(normal - direction * direction.dot(&normal), 1e-12)?;
        let reference = unit(projected - direction * direction.dot(&projected), 0.0)?;
        Ok(Self { origin, direction, reference, transverse: direction.cross(&reference) })
    }

    /// The origin \[mm\].
    pub fn origin(&self) -> Vector3<f64> {
        self.origin
    }

    /// The unit direction.
    pub fn direction(&self) -> Vector3<f64> {
        self.direction
    }

    /// The unit direction of angle 0.
    pub fn reference(&self) -> Vector3<f64> {
        self.reference
    }

    /// The unit direction of angle 90 deg.
    pub fn transverse(&self) -> Vector3<f64> {
        self.transverse
    }

    /// Radial unit vector at an angle \[rad\].
    #[inline]
    pub fn radial(&self, angle: f64) -> Vector3<f64> {
        let (sin, cos) = angle.sin_cos();
        self.reference * cos + self.transverse * sin
    }

    /// Circumferential unit vector at an angle \[rad\].
    #[inline]
    pub fn circumferential(&self, angle: f64) -> Vector3<f64> {
        let (sin, cos) = angle.sin_cos();
        self.transverse * cos - self.reference * sin
    }

    /// Position of local coordinates: `x` along the reference direction, `y` along the transverse one, `axial` \[mm\].
    #[inline]
    pub fn position(&self, x: f64, y: f64, axial: f64) -> Vector3<f64> {
        self.origin + self.reference * x + self.transverse * y + self.direction * axial
    }

    /// Cylindrical coordinates of a position \[mm\].
    #[inline]
    pub fn cylindrical(&self, position: &Vector3<f64>) -> Cylindrical {
        let d = position - self.origin;
        let (x, y) = (d.dot(&self.reference), d.dot(&self.transverse));
        Cylindrical { radius: x.hypot(y), angle: y.atan2(x), axial: d.dot(&self.direction) }
    }

    /// The part of `position - origin` normal to the axis \[mm\]; zero where it is lost in rounding.
    #[inline]
    pub fn offset(&self, position: &Vector3<f64>) -> Vector3<f64> {
        let d = position - self.origin;
        let first = d - self.direction * d.dot(&self.direction);
        // The second projection removes the axial rest that rounding leaves close to the axis.
        let offset = first - self.direction * first.dot(&self.direction);
        if offset.norm_squared() > 1e-24 * d.norm_squared() { offset } else { Vector3::zeros() }
    }
}

fn unit(vector: Vector3<f64>, least: f64) -> Result<Vector3<f64>, GeometryError> {
    let norm = vector.norm();
    if norm > least && norm.is_finite() {
        Ok(vector / norm)
    } else {
        Err(GeometryError::NotPositive { parameter: Parameter::Direction, value: norm })
    }
}
