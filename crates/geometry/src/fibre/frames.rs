//! Frames at all integration points of a mesh, and frames from two directions.

use super::FibreField;
use crate::hexahedron::position;
use crate::{CellKind, GeometryError, Hex8, Hex20, Hex20R, Hex27, Hexahedron, Mesh};
use nalgebra::{Matrix3, Vector3};

/// Frames at every integration point of a mesh, cell after cell, points in the order of
/// [`Hexahedron::quadrature`]; columns e1 (fibre), e2, e3.
///
/// # Errors
/// [`GeometryError::PointIndex`] when a cell refers to a node that does not exist, and the errors of the field.
pub fn fibre_frames<F: FibreField + ?Sized>(mesh: &Mesh, field: &F) -> Result<Vec<Matrix3<f64>>, GeometryError> {
    match mesh.kind {
        CellKind::Hex8 => sample::<Hex8, 8, F>(mesh, field, &points(Hex8::quadrature())),
        CellKind::Hex20 => sample::<Hex20, 20, F>(mesh, field, &points(Hex20::quadrature())),
        CellKind::Hex20R => sample::<Hex20R, 20, F>(mesh, field, &points(Hex20R::quadrature())),
        CellKind::Hex27 => sample::<Hex27, 27, F>(mesh, field, &points(Hex27::quadrature())),
    }
}

/// One frame per cell, at its centre xi = 0.
///
/// `fibre_frames(mesh, &PerCellFrames(centroid_frames(mesh, field)?))` is the field made constant in every cell.
///
/// # Errors
/// As [`fibre_frames`].
pub fn centroid_frames<F: FibreField + ?Sized>(mesh: &Mesh, field: &F) -> Result<Vec<Matrix3<f64>>, GeometryError> {
    match mesh.kind {
        CellKind::Hex8 => sample::<Hex8, 8, F>(mesh, field, &[[0.0; 3]]),
        CellKind::Hex20 | CellKind::Hex20R => sample::<Hex20, 20, F>(mesh, field, &[[0.0; 3]]),
        CellKind::Hex27 => sample::<Hex27, 27, F>(mesh, field, &[[0.0; 3]]),
    }
}

fn points(rule: &[crate::QuadraturePoint]) -> Vec<[f64; 3]> {
    rule.iter().map(|point| point.xi).collect()
}

fn sample<H: Hexahedron<N>, const N: usize, F: FibreField + ?Sized>(
    mesh: &Mesh,
    field: &F,
    points: &[[f64; 3]],
) -> Result<Vec<Matrix3<f64>>, GeometryError> {
    let mut frames = Vec::with_capacity(mesh.cell_count() * points.len());
    for cell in 0..mesh.cell_count() {
        let nodes = mesh.checked_cell_points::<N>(cell)?;
        for &xi in points {
            frames.push(field.frame(&position::<H, N>(&nodes, xi), cell)?);
        }
    }
    Ok(frames)
}

/// The frame with e1 along `fibre` and e2 in the plane of `fibre` and `second`, on the side of `second`
/// (the two axes of an orientation in an input deck); lengths do not matter.
///
/// # Errors
/// [`GeometryError::NoFrame`] when a direction is zero or not finite, or both are parallel.
pub fn frame_from_directions(fibre: &Vector3<f64>, second: &Vector3<f64>) -> Result<Matrix3<f64>, GeometryError> {
    let failure = GeometryError::NoFrame { fibre: (*fibre).into(), second: (*second).into() };
    let unit = |v: Vector3<f64>, least: f64| {
        let norm = v.norm();
        (norm > least && norm.is_finite()).then(|| v / norm)
    };
    let frame = || {
        let (e1, a) = (unit(*fibre, 0.0)?, unit(*second, 0.0)?);
        let e3 = unit(e1.cross(&a), 1e-10)?;
        let e3 = unit(e3 - e1 * e1.dot(&e3), 0.0)?;
        Some(Matrix3::from_columns(&[e1, e3.cross(&e1), e3]))
    };
    frame().ok_or(failure)
}

/// How far a frame is from orthonormal and right-handed: the largest entry of |F^T F - 1|, or |det F - 1| where larger;
/// infinite when an entry is not finite.
pub fn frame_deviation(frame: &Matrix3<f64>) -> f64 {
    let gram = (frame.transpose() * frame - Matrix3::identity()).amax();
    let deviation = gram.max((frame.determinant() - 1.0).abs());
    if frame.iter().all(|x| x.is_finite()) { deviation } else { f64::INFINITY }
}
