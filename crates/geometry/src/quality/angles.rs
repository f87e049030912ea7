//! Statistics of fibre angles over a mesh.

use crate::hexahedron::jacobian;
use crate::{CellKind, GeometryError, Hex8, Hex20, Hex20R, Hex27, Hexahedron, Mesh};
use nalgebra::{Matrix3, Vector3};

/// Angles between fibres and a direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AngleStatistics {
    /// Smallest angle \[rad\].
    pub least: f64,
    /// Mean over the volume \[rad\].
    pub mean: f64,
    /// Largest angle \[rad\].
    pub greatest: f64,
}

/// Statistics of the angle between e1 and the line along `direction` (any length), in \[0, pi/2\] \[rad\], over the
/// integration points of a mesh; `frames` as from [`crate::fibre_frames`].
///
/// # Errors
/// [`GeometryError::FrameIndex`] when there are fewer frames than integration points, or none at all;
/// [`GeometryError::PointIndex`] when a cell refers to a node that does not exist.
pub fn fibre_angles(
    mesh: &Mesh,
    frames: &[Matrix3<f64>],
    direction: &Vector3<f64>,
) -> Result<AngleStatistics, GeometryError> {
    let angles: Vec<f64> = frames.iter().map(|frame| angle(&frame.column(0).into(), direction)).collect();
    match mesh.kind {
        CellKind::Hex8 => collect::<Hex8, 8>(mesh, &angles),
        CellKind::Hex20 => collect::<Hex20, 20>(mesh, &angles),
        CellKind::Hex20R => collect::<Hex20R, 20>(mesh, &angles),
        CellKind::Hex27 => collect::<Hex27, 27>(mesh, &angles),
    }
}

/// Angle by the arc tangent, which keeps its digits near zero.
fn angle(fibre: &Vector3<f64>, direction: &Vector3<f64>) -> f64 {
    fibre.cross(direction).norm().atan2(fibre.dot(direction).abs())
}

fn collect<H: Hexahedron<N>, const N: usize>(mesh: &Mesh, angles: &[f64]) -> Result<AngleStatistics, GeometryError> {
    let rule = H::quadrature();
    let needed = mesh.cell_count() * rule.len();
    if angles.len() < needed || needed == 0 {
        return Err(GeometryError::FrameIndex { cell: angles.len() / rule.len(), frames: angles.len() });
    }
    let (mut sum, mut volume) = (0.0, 0.0);
    for (cell, values) in angles.chunks_exact(rule.len()).take(mesh.cell_count()).enumerate() {
        let nodes = mesh.checked_cell_points::<N>(cell)?;
        for (point, value) in rule.iter().zip(values) {
            let weight = point.weight * jacobian::<H, N>(&nodes, point.xi).determinant();
            sum += weight * value;
            volume += weight;
        }
    }
    let used = || angles[..needed].iter().copied();
    let (least, greatest) = (used().fold(f64::INFINITY, f64::min), used().fold(0.0, f64::max));
    Ok(AngleStatistics { least, mean: sum / volume, greatest })
}
