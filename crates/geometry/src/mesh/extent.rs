//! How large a set of points is.

use nalgebra::Vector3;

/// Diagonal of the box around points, along the axes \[mm\]; zero without any.
#[must_use]
pub fn extent(points: &[Vector3<f64>]) -> f64 {
    let Some(&first) = points.first() else { return 0.0 };
    let (low, high) = points.iter().fold((first, first), |(low, high), p| (low.inf(p), high.sup(p)));
    (high - low).norm()
}
