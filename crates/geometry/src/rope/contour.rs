//! The transverse section of the smooth contact surface of a strand in a rope.

use crate::spline::{greatest, shrinkage};
use crate::{GeometryError, Strand, StrandAxis};
use nalgebra::Vector2;

/// Control points of the section of a smooth strand surface by a plane normal to the rope, about the rope axis; the
/// axis of the strand lies on the first coordinate axis.
///
/// Surfaces that wind around one axis at one rate touch where their sections by one plane normal to that axis touch.
/// The section of a helical tube is symmetric about the line from the rope axis to the axis of the strand; sections of
/// neighbours are therefore mirror images about the line between them, and touch where they reach that line.
pub(super) struct Contour(Vec<Vector2<f64>>);

impl Contour {
    /// The contour of a strand with flat ends about the z axis of phase 0, of which one layer is meshed; `spacing` is
    /// the distance of its rings along the rope axis \[mm\].
    pub(super) fn new(layer: &Strand, mesh: &crate::Mesh, spacing: f64) -> Self {
        let rate = match layer.axis {
            StrandAxis::Straight(_) => 0.0,
            StrandAxis::Helix(helix) => helix.lay().rate(),
        };
        let factor = shrinkage(rate * spacing);
        let grid = layer.surface_grid();
        Self(grid.ring(0).iter().map(|&node| mesh.points[node as usize].xy() * factor).collect())
    }

    /// How far \[mm\] the contour reaches beyond the line between neighbours of `strands` strands, which leaves the
    /// rope axis at the angle pi/`strands`.
    pub(super) fn excess(&self, strands: usize) -> f64 {
        let (sin, cos) = (std::f64::consts::PI / strands as f64).sin_cos();
        greatest(&self.0, |x| x.y * cos - x.x * sin)
    }

    /// Least distance \[mm\] from the rope axis.
    pub(super) fn inner_radius(&self) -> f64 {
        -greatest(&self.0, |x| -x.norm())
    }
}

/// The root of a function that is close to linear, by the secant method from `x` and `x + step`.
pub(super) fn secant(
    x: f64,
    step: f64,
    f: impl Fn(f64) -> Result<f64, GeometryError>,
) -> Result<Option<f64>, GeometryError> {
    let (mut old, mut new) = (x, x + step);
    let (mut f_old, mut f_new) = (f(old)?, f(new)?);
    for _ in 0..50 {
        if f_new == 0.0 || (new - old).abs() <= 1e-13 * (new.abs() + step.abs()) {
            return Ok(Some(new));
        }
        let next = new - f_new * (new - old) / (f_new - f_old);
        if !next.is_finite() {
            return Ok(None);
        }
        (old, f_old, new) = (new, f_new, next);
        f_new = f(new)?;
    }
    Ok(None)
}
