//! The bilinear quadrilateral of four nodes.

use super::{FacePoint, Quadrilateral, product};
use crate::hexahedron::GAUSS_2;

/// Bilinear quadrilateral: N_a = (1 + xi xi_a)(1 + eta eta_a)/4.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Quad4;

static POINTS: [FacePoint; 4] = product(&GAUSS_2);

impl Quadrilateral<4> for Quad4 {
    const NODES: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

    #[inline]
    fn shape([x, y]: [f64; 2]) -> [f64; 4] {
        Self::NODES.map(|[a, b]| 0.25 * (1.0 + x * a) * (1.0 + y * b))
    }

    #[inline]
    fn gradient([x, y]: [f64; 2]) -> [[f64; 4]; 2] {
        [Self::NODES.map(|[a, b]| 0.25 * a * (1.0 + y * b)), Self::NODES.map(|[a, b]| 0.25 * b * (1.0 + x * a))]
    }

    #[inline]
    fn quadrature() -> &'static [FacePoint] {
        &POINTS
    }
}
