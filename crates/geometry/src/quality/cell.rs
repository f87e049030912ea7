//! Measures of one cell.

use crate::Hexahedron;
use crate::hexahedron::jacobian;
use nalgebra::{Matrix3, Vector3};

/// Corner nodes of the twelve edges.
const EDGES: [[usize; 2]; 12] =
    [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]];

/// Measures of one hexahedron.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CellQuality {
    /// Least Jacobian determinant \[mm^3\] at corners and integration points.
    pub least_determinant: f64,
    /// Least Jacobian determinant \[mm^3\] at the integration points.
    pub least_point_determinant: f64,
    /// Least determinant of the Jacobian matrix with columns scaled to unit length, over corners and integration
    /// points: 1 where all edges are at right angles, not positive where the cell is inverted or degenerate.
    pub scaled_jacobian: f64,
    /// Longest edge over shortest, between corners.
    pub aspect_ratio: f64,
    /// Largest |cosine| between two of the three lines that join the centres of opposite faces.
    pub skew: f64,
    /// Volume \[mm^3\].
    pub volume: f64,
}

impl CellQuality {
    /// Measures of the hexahedron with nodal coordinates `nodes` \[mm\].
    pub fn new<H: Hexahedron<N>, const N: usize>(nodes: &[Vector3<f64>; N]) -> Self {
        let (least_point_determinant, least_determinant) = least_determinants::<H, N>(nodes);
        let at_points = H::quadrature().iter().map(|p| (p.weight, jacobian::<H, N>(nodes, p.xi)));
        let at_corners = H::NODES.iter().take(8).map(|&xi| jacobian::<H, N>(nodes, xi));
        Self {
            least_determinant,
            least_point_determinant,
            scaled_jacobian: least(at_corners.chain(at_points.clone().map(|(_, j)| j)).map(scaled)),
            aspect_ratio: aspect_ratio(nodes),
            skew: skew(&jacobian::<H, N>(nodes, [0.0; 3])),
            volume: at_points.map(|(weight, j)| weight * j.determinant()).sum(),
        }
    }

    /// Whether the determinant is not positive at an integration point, or negative at a corner.
    pub fn is_inverted(&self) -> bool {
        is_inverted(self.least_point_determinant, self.least_determinant)
    }
}

/// Least Jacobian determinants: at the integration points, and at integration points and corners.
pub(super) fn least_determinants<H: Hexahedron<N>, const N: usize>(nodes: &[Vector3<f64>; N]) -> (f64, f64) {
    let determinant = |xi: [f64; 3]| jacobian::<H, N>(nodes, xi).determinant();
    let points = least(H::quadrature().iter().map(|p| determinant(p.xi)));
    let corners = least(H::NODES.iter().take(8).map(|&xi| determinant(xi)));
    (points, least([points, corners].into_iter()))
}

/// Zero is allowed at a corner: a cell with two edges in line there still has an invertible map inside.
pub(super) fn is_inverted(points: f64, all: f64) -> bool {
    points <= 0.0 || all < 0.0 || points.is_nan() || all.is_nan()
}

/// Smallest value; not a number when one of them is.
fn least(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(f64::INFINITY, |a, b| if b < a || b.is_nan() { b } else { a })
}

fn scaled(jacobian: Matrix3<f64>) -> f64 {
    let lengths: f64 = jacobian.column_iter().map(|column| column.norm()).product();
    if lengths > 0.0 { jacobian.determinant() / lengths } else { 0.0 }
}

fn aspect_ratio<const N: usize>(nodes: &[Vector3<f64>; N]) -> f64 {
    let lengths = EDGES.map(|[a, b]| (nodes[b] - nodes[a]).norm());
    lengths.iter().fold(0.0, |a: f64, &b| a.max(b)) / least(lengths.into_iter())
}

fn skew(centre: &Matrix3<f64>) -> f64 {
    let mut axes = *centre;
    for mut column in axes.column_iter_mut() {
        column.normalize_mut();
    }
    let cosines = axes.transpose() * axes;
    cosines.m12.abs().max(cosines.m13.abs()).max(cosines.m23.abs())
}
