//! Deformed sections of a strand: place, rotation, curvature, ovality.
//!
//! Sections are the layers of nodes with the same reference coordinate along z. Each gets its centroid, the rotation that
//! fits it best (Kabsch: minimises the squared distances), and the widths of its projection on its own plane.

use nalgebra::{Matrix3, Vector3};
use subrope_geometry::Mesh;

/// A deformed section.
#[derive(Clone, Debug, PartialEq)]
pub struct SectionShape {
    /// Reference coordinate along the strand \[mm\].
    pub z: f64,
    /// Current centroid \[mm\].
    pub centroid: Vector3<f64>,
    /// Displacement of the centroid \[mm\].
    pub displacement: Vector3<f64>,
    /// Best-fit rotation from the reference.
    pub rotation: Matrix3<f64>,
    /// (largest - smallest)/mean width in the section's own plane \[-\].
    pub ovality: f64,
}

/// Directions in which a width is taken, over half a turn.
const DIRECTIONS: usize = 90;

/// Least number of nodes of a section.
const LEAST_NODES: usize = 4;

/// The sections of a mesh along z under nodal displacements (three per node), lowest first. Nodes count as one section
/// when their z agree to 1e-6 of the length; layers of fewer than four nodes are left out, and so are those half way up
/// 20-node bricks, which hold no more than the corners of a section.
#[must_use]
pub fn section_shapes(mesh: &Mesh, displacement: &[f64]) -> Vec<SectionShape> {
    let layers = layers(mesh);
    let fullest = layers.iter().map(Vec::len).max().unwrap_or_default();
    let least = if mesh.kind.is_serendipity() { fullest.div_ceil(2) } else { LEAST_NODES };
    layers.iter().filter(|l| l.len() >= least).map(|l| shape(mesh, displacement, l)).collect()
}

fn layers(mesh: &Mesh) -> Vec<Vec<u32>> {
    let z = |n: u32| mesh.points[n as usize].z;
    let mut order: Vec<u32> = (0..mesh.point_count() as u32).collect();
    order.sort_by(|&a, &b| z(a).total_cmp(&z(b)).then(a.cmp(&b)));
    let (Some(&low), Some(&high)) = (order.first(), order.last()) else { return Vec::new() };
    let tolerance = 1e-6 * (z(high) - z(low));
    order.chunk_by(|&a, &b| z(b) - z(a) <= tolerance).map(<[u32]>::to_vec).collect()
}

fn shape(mesh: &Mesh, displacement: &[f64], nodes: &[u32]) -> SectionShape {
    let count = nodes.len() as f64;
    let reference = |n: u32| mesh.points[n as usize];
    let moved = |n: u32| Vector3::from_column_slice(&displacement[3 * n as usize..3 * n as usize + 3]);
    let start: Vector3<f64> = nodes.iter().map(|&n| reference(n)).sum::<Vector3<f64>>() / count;
    let shift: Vector3<f64> = nodes.iter().map(|&n| moved(n)).sum::<Vector3<f64>>() / count;
    let centroid = start + shift;
    let mut covariance = Matrix3::zeros();
    let mut current = Vec::with_capacity(nodes.len());
    for &n in nodes {
        let now = reference(n) + moved(n) - centroid;
        covariance += now * (reference(n) - start).transpose();
        current.push(now);
    }
    let rotation = best_rotation(&covariance);
    SectionShape { z: start.z, centroid, displacement: shift, rotation, ovality: ovality(&current, &rotation) }
}

/// Rotation nearest to a matrix of rank two or three.
fn best_rotation(covariance: &Matrix3<f64>) -> Matrix3<f64> {
    let svd = covariance.svd(true, true);
    let (Some(u), Some(v_t)) = (svd.u, svd.v_t) else { return Matrix3::identity() };
    let mut sign = Matrix3::identity();
    // The weakest direction takes the sign that makes it a rotation.
    let weakest = svd.singular_values.imin();
    sign[(weakest, weakest)] = (u * v_t).determinant().signum();
    u * sign * v_t
}

fn ovality(points: &[Vector3<f64>], rotation: &Matrix3<f64>) -> f64 {
    let (a, b) = (rotation.column(0), rotation.column(1));
    let flat: Vec<[f64; 2]> = points.iter().map(|p| [a.dot(p), b.dot(p)]).collect();
    let (mut least, mut largest, mut sum) = (f64::INFINITY, 0.0_f64, 0.0);
    for i in 0..DIRECTIONS {
        let (s, c) = (std::f64::consts::PI * i as f64 / DIRECTIONS as f64).sin_cos();
        let along = flat.iter().map(|p| c * p[0] + s * p[1]);
        let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        let width = high - low;
        least = least.min(width);
        largest = largest.max(width);
        sum += width;
    }
    if sum > 0.0 { (largest - least) / (sum / DIRECTIONS as f64) } else { 0.0 }
}

/// Rotation vector of a rotation matrix \[rad\], angle in \[0, pi\].
pub(super) fn rotation_vector(rotation: &Matrix3<f64>) -> Vector3<f64> {
    let axial = 0.5
        * Vector3::new(
            rotation[(2, 1)] - rotation[(1, 2)],
            rotation[(0, 2)] - rotation[(2, 0)],
            rotation[(1, 0)] - rotation[(0, 1)],
        );
    let (sine, cosine) = (axial.norm(), 0.5 * (rotation.trace() - 1.0));
    let angle = sine.atan2(cosine);
    if sine > 1e-12 {
        return axial * (angle / sine);
    }
    if cosine > 0.0 {
        return axial;
    }
    // Half a turn: the axis is the eigenvector of R + 1.
    let symmetric = rotation + Matrix3::identity();
    let column = (0..3).max_by(|&i, &j| symmetric[(i, i)].total_cmp(&symmetric[(j, j)])).unwrap_or(0);
    symmetric.column(column).normalize() * angle
}
