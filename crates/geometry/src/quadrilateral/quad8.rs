//! The quadratic serendipity quadrilateral of eight nodes.

use super::{FacePoint, Quadrilateral, product};
use crate::hexahedron::GAUSS_3;

/// Serendipity quadrilateral, a face of the 20-node brick: at a corner
/// N_a = (1 + xi xi_a)(1 + eta eta_a)(xi xi_a + eta eta_a - 1)/4, in the middle of a side along xi
/// N_a = (1 - xi^2)(1 + eta eta_a)/2.
///
/// A uniform load pulls its corners against the load: their shares are -1/12, those of the mid-sides 1/3.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Quad8;

static POINTS: [FacePoint; 9] = product(&GAUSS_3);

impl Quadrilateral<8> for Quad8 {
    const NODES: [[f64; 2]; 8] =
        [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]];

    #[inline]
    fn shape([x, y]: [f64; 2]) -> [f64; 8] {
        Self::NODES.map(|[a, b]| match (a == 0.0, b == 0.0) {
            (true, _) => 0.5 * (1.0 - x * x) * (1.0 + y * b),
            (_, true) => 0.5 * (1.0 + x * a) * (1.0 - y * y),
            _ => 0.25 * (1.0 + x * a) * (1.0 + y * b) * (x * a + y * b - 1.0),
        })
    }

    #[inline]
    fn gradient([x, y]: [f64; 2]) -> [[f64; 8]; 2] {
        [
            Self::NODES.map(|[a, b]| match (a == 0.0, b == 0.0) {
                (true, _) => -x * (1.0 + y * b),
                (_, true) => 0.5 * a * (1.0 - y * y),
                _ => 0.25 * a * (1.0 + y * b) * (2.0 * x * a + y * b),
            }),
            Self::NODES.map(|[a, b]| match (a == 0.0, b == 0.0) {
                (true, _) => 0.5 * b * (1.0 - x * x),
                (_, true) => -y * (1.0 + x * a),
                _ => 0.25 * b * (1.0 + x * a) * (x * a + 2.0 * y * b),
            }),
        ]
    }

    #[inline]
    fn quadrature() -> &'static [FacePoint] {
        &POINTS
    }
}
