//! From natural coordinates to a surface in space.

use super::{Quad4, Quad8, Quad9, Quadrilateral};
use crate::{CellKind, Face, GeometryError, Mesh};
use nalgebra::Vector3;

/// A point of a face with its tangents.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// Position X \[mm\].
    pub position: Vector3<f64>,
    /// Tangents dX/dxi and dX/deta \[mm\].
    pub tangents: [Vector3<f64>; 2],
    /// Their cross product \[mm^2\]: normal times area per area of natural coordinates.
    pub area_normal: Vector3<f64>,
}

/// Position, tangents and area normal of a face with nodal coordinates `nodes` \[mm\] at `xi`.
#[inline]
pub fn map_surface_point<Q: Quadrilateral<N>, const N: usize>(nodes: &[Vector3<f64>; N], xi: [f64; 2]) -> SurfacePoint {
    let (shape, gradient) = (Q::shape(xi), Q::gradient(xi));
    let mut position = Vector3::zeros();
    let mut tangents = [Vector3::zeros(); 2];
    for a in 0..N {
        position += nodes[a] * shape[a];
        tangents[0] += nodes[a] * gradient[0][a];
        tangents[1] += nodes[a] * gradient[1][a];
    }
    SurfacePoint { position, tangents, area_normal: tangents[0].cross(&tangents[1]) }
}

/// Area of a face \[mm^2\] by Gauss quadrature; exact for plane faces.
pub fn face_area<Q: Quadrilateral<N>, const N: usize>(nodes: &[Vector3<f64>; N]) -> f64 {
    let area = |xi| map_surface_point::<Q, N>(nodes, xi).area_normal.norm();
    Q::quadrature().iter().map(|point| point.weight * area(point.xi)).sum()
}

/// Area of a set of faces of a mesh \[mm^2\] by Gauss quadrature.
///
/// # Errors
/// [`GeometryError::FaceIndex`] when a face does not exist in the mesh.
pub fn surface_area(mesh: &Mesh, faces: &[Face]) -> Result<f64, GeometryError> {
    let area = |&face: &Face| match mesh.kind {
        CellKind::Hex8 => mesh.face_points(face).map(|nodes| face_area::<Quad4, 4>(&nodes)),
        CellKind::Hex20 | CellKind::Hex20R => mesh.face_points(face).map(|nodes| face_area::<Quad8, 8>(&nodes)),
        CellKind::Hex27 => mesh.face_points(face).map(|nodes| face_area::<Quad9, 9>(&nodes)),
    };
    let missing = |f: &Face| GeometryError::FaceIndex { cell: f.cell, face: f.face, cells: mesh.cell_count() };
    faces.iter().map(|face| area(face).ok_or_else(|| missing(face))).sum()
}
