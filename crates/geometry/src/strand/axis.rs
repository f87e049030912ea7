//! The axis of a strand and the place of a section on it.

use crate::helix::kepler;
use crate::{Axis, GeometryError, Helix};
use nalgebra::{Vector2, Vector3};
use std::f64::consts::PI;

/// Axis of a strand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StrandAxis {
    /// A straight axis; the section lies in its reference and transverse directions.
    Straight(Axis),
    /// A helix; the section lies in its Frenet normal and binormal.
    Helix(Helix),
}

/// Position of the sections of a strand with a helical axis; a straight one has plane normal sections either way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum StrandEnds {
    /// Every section is normal to the axis of the strand.
    #[default]
    Normal,
    /// Every section is the cut of the strand by a plane normal to the axis of the helix (of the rope).
    Flat,
}

impl Default for StrandAxis {
    fn default() -> Self {
        Self::Straight(Axis::default())
    }
}

impl StrandAxis {
    /// Position of the point (u, v) \[mm\] of the section at arc length `s` \[mm\] on mesh lines that turn by `rate`
    /// \[rad/mm\].
    pub(crate) fn place(&self, s: f64, local: &Vector2<f64>, rate: f64, ends: StrandEnds) -> Vector3<f64> {
        match (self, ends) {
            (Self::Straight(axis), _) => {
                let turned = turn(local, rate * s);
                axis.position(turned.x, turned.y, s)
            }
            (Self::Helix(helix), StrandEnds::Normal) => on_helix(helix, s, local, rate),
            (Self::Helix(helix), StrandEnds::Flat) => {
                on_helix(helix, flat_arc_length(helix, s, local, rate), local, rate)
            }
        }
    }

    /// Checks that sections of radius `radius` \[mm\] neither overlap nor fold.
    pub(super) fn check_radius(&self, radius: f64, rate: f64, ends: StrandEnds) -> Result<(), GeometryError> {
        let Self::Helix(helix) = self else {
            return Ok(());
        };
        if radius * helix.curvature() >= 1.0 {
            return Err(GeometryError::SectionsOverlap { radius, curvature_radius: helix.curvature().recip() });
        }
        let product = (radius * rate * helix.radius() * helix.lay().rate()).abs();
        if ends == StrandEnds::Flat && product >= 1.0 {
            return Err(GeometryError::FlatSectionFolds { product });
        }
        Ok(())
    }
}

fn turn(local: &Vector2<f64>, angle: f64) -> Vector2<f64> {
    let (sin, cos) = angle.sin_cos();
    Vector2::new(local.x * cos - local.y * sin, local.x * sin + local.y * cos)
}

fn on_helix(helix: &Helix, s: f64, local: &Vector2<f64>, rate: f64) -> Vector3<f64> {
    let (frame, turned) = (helix.frenet(s), turn(local, rate * s));
    frame.position + frame.normal * turned.x + frame.binormal * turned.y
}

/// Arc length s at which the mesh line through `local` meets the plane of the axis point at arc length `s_0`.
///
/// The line at (r, psi) has the axial coordinate (s + a k r sin(psi + rate s)) cos(beta), since the normal of the helix
/// has no axial part and the binormal has a k cos(beta). With w = psi + rate s this is w + e sin(w) = psi + rate s_0,
/// e = rate a k r, and s = s_0 - a k r sin(w).
fn flat_arc_length(helix: &Helix, s_0: f64, local: &Vector2<f64>, rate: f64) -> f64 {
    let (radius, angle) = (local.norm(), local.y.atan2(local.x));
    let rise = helix.radius() * helix.lay().rate() * radius;
    let (e, m) = (rate * rise, angle + rate * s_0);
    // u + e sin(u) = m with e < 0 is the equation for -e after a shift by half a turn.
    let w = if e >= 0.0 { kepler(e, m) } else { kepler(-e, m - PI) + PI };
    s_0 - rise * w.sin()
}
