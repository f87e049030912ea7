//! Quality of a mesh: Jacobian, shape of the cells, volume, and the angles of its fibres.

mod angles;
mod cell;

pub use angles::{AngleStatistics, fibre_angles};
pub use cell::CellQuality;

use crate::hexahedron::jacobian;
use crate::{CellKind, GeometryError, Hex8, Hex20, Hex27, Hexahedron, Mesh};

/// A measure and the label of the cell where it is worst.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Worst {
    /// The measure.
    pub value: f64,
    /// Label of the cell.
    pub cell_label: u64,
}

/// Worst cells of a mesh, and its volume.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshQuality {
    /// Least Jacobian determinant dX/dxi \[mm^3\] at corners and integration points; 1/8 of the volume for a cuboid.
    pub least_determinant: Worst,
    /// Least scaled Jacobian (1 for a cuboid, not positive for an inverted cell), see [`CellQuality`].
    pub least_scaled_jacobian: Worst,
    /// Largest ratio of the longest edge to the shortest.
    pub largest_aspect_ratio: Worst,
    /// Largest skew (0 for a cuboid, 1 for a flat cell), see [`CellQuality`].
    pub largest_skew: Worst,
    /// Volume of the mesh \[mm^3\].
    pub volume: f64,
}

/// Quality of every cell, in mesh order.
///
/// # Errors
/// [`GeometryError::PointIndex`] when a cell refers to a node that does not exist.
pub fn cell_qualities(mesh: &Mesh) -> Result<Vec<CellQuality>, GeometryError> {
    let cells = 0..mesh.cell_count();
    match mesh.kind {
        CellKind::Hex8 => cells.map(|e| Ok(CellQuality::new::<Hex8, 8>(&mesh.checked_cell_points(e)?))).collect(),
        // Of 20 nodes too with the points of full integration: 2 x 2 x 2 do not integrate the determinant of their map.
        CellKind::Hex20 | CellKind::Hex20R => {
            cells.map(|e| Ok(CellQuality::new::<Hex20, 20>(&mesh.checked_cell_points(e)?))).collect()
        }
        CellKind::Hex27 => cells.map(|e| Ok(CellQuality::new::<Hex27, 27>(&mesh.checked_cell_points(e)?))).collect(),
    }
}

/// Worst cells and volume of a mesh; `None` for a mesh without cells.
///
/// # Errors
/// As [`cell_qualities`].
pub fn mesh_quality(mesh: &Mesh) -> Result<Option<MeshQuality>, GeometryError> {
    let cells = cell_qualities(mesh)?;
    let quality = || {
        Some(MeshQuality {
            least_determinant: worst(mesh, &cells, |q| q.least_determinant, f64::min)?,
            least_scaled_jacobian: worst(mesh, &cells, |q| q.scaled_jacobian, f64::min)?,
            largest_aspect_ratio: worst(mesh, &cells, |q| q.aspect_ratio, f64::max)?,
            largest_skew: worst(mesh, &cells, |q| q.skew, f64::max)?,
            volume: cells.iter().map(|q| q.volume).sum(),
        })
    };
    Ok(quality())
}

fn worst(
    mesh: &Mesh,
    cells: &[CellQuality],
    measure: impl Fn(&CellQuality) -> f64,
    pick: fn(f64, f64) -> f64,
) -> Option<Worst> {
    let value = cells.iter().map(&measure).reduce(pick)?;
    let cell = cells.iter().position(|q| measure(q) == value)?;
    Some(Worst { value, cell_label: mesh.cell_label(cell) })
}

/// Volume of a mesh \[mm^3\], integrated with the quadrature of its cells (exact for eight nodes; for 20 and 27
/// nodes of degree up to five in each coordinate, as their map has; 3 x 3 x 3 points whatever the rule of 20 nodes).
///
/// # Errors
/// As [`cell_qualities`].
pub fn volume(mesh: &Mesh) -> Result<f64, GeometryError> {
    match mesh.kind {
        CellKind::Hex8 => integrate::<Hex8, 8>(mesh),
        CellKind::Hex20 | CellKind::Hex20R => integrate::<Hex20, 20>(mesh),
        CellKind::Hex27 => integrate::<Hex27, 27>(mesh),
    }
}

fn integrate<H: Hexahedron<N>, const N: usize>(mesh: &Mesh) -> Result<f64, GeometryError> {
    let mut volume = 0.0;
    for cell in 0..mesh.cell_count() {
        let nodes = mesh.checked_cell_points::<N>(cell)?;
        for point in H::quadrature() {
            volume += point.weight * jacobian::<H, N>(&nodes, point.xi).determinant();
        }
    }
    Ok(volume)
}

/// Labels and least Jacobian determinants \[mm^3\] of the inverted cells, in mesh order.
///
/// A cell counts as inverted when its determinant is not positive at an integration point, or negative at a corner.
///
/// # Errors
/// As [`cell_qualities`].
pub fn inverted_cells(mesh: &Mesh) -> Result<Vec<(u64, f64)>, GeometryError> {
    match mesh.kind {
        CellKind::Hex8 => find_inverted::<Hex8, 8>(mesh),
        CellKind::Hex20 | CellKind::Hex20R => find_inverted::<Hex20, 20>(mesh),
        CellKind::Hex27 => find_inverted::<Hex27, 27>(mesh),
    }
}

fn find_inverted<H: Hexahedron<N>, const N: usize>(mesh: &Mesh) -> Result<Vec<(u64, f64)>, GeometryError> {
    let mut inverted = Vec::new();
    for cell in 0..mesh.cell_count() {
        let (points, all) = cell::least_determinants::<H, N>(&mesh.checked_cell_points(cell)?);
        if cell::is_inverted(points, all) {
            inverted.push((mesh.cell_label(cell), all));
        }
    }
    Ok(inverted)
}

/// Checks that no cell is inverted.
///
/// # Errors
/// [`GeometryError::Inverted`] for one inverted cell, [`GeometryError::InvertedCells`] for several.
pub fn check_orientation(mesh: &Mesh) -> Result<(), GeometryError> {
    let inverted = inverted_cells(mesh)?;
    match inverted.as_slice() {
        [] => Ok(()),
        &[(cell_label, determinant)] => Err(GeometryError::Inverted { cell_label, determinant }),
        &[first, ..] => {
            let worse = |a: (u64, f64), b: &(u64, f64)| if b.1 < a.1 { *b } else { a };
            let (worst_label, determinant) = inverted.iter().fold(first, worse);
            let cell_labels = inverted.iter().map(|&(label, _)| label).collect();
            Err(GeometryError::InvertedCells { cell_labels, worst_label, determinant })
        }
    }
}
