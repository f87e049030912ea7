//! The biquadratic quadrilateral of nine nodes.

use super::{FacePoint, Quadrilateral, product};
use crate::hexahedron::{GAUSS_3, lagrange, lagrange_slope};

/// Biquadratic quadrilateral: products of the quadratic Lagrange polynomials on -1, 0, 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Quad9;

static POINTS: [FacePoint; 9] = product(&GAUSS_3);

/// Position of every node on the 3 x 3 lattice.
pub(crate) const LATTICE: [[usize; 2]; 9] = [[0, 0], [2, 0], [2, 2], [0, 2], [1, 0], [2, 1], [1, 2], [0, 1], [1, 1]];

impl Quadrilateral<9> for Quad9 {
    const NODES: [[f64; 2]; 9] = [
        [-1.0, -1.0],
        [1.0, -1.0],
        [1.0, 1.0],
        [-1.0, 1.0],
        [0.0, -1.0],
        [1.0, 0.0],
        [0.0, 1.0],
        [-1.0, 0.0],
        [0.0, 0.0],
    ];

    #[inline]
    fn shape(xi: [f64; 2]) -> [f64; 9] {
        let [x, y] = xi.map(lagrange);
        LATTICE.map(|[i, j]| x[i] * y[j])
    }

    #[inline]
    fn gradient(xi: [f64; 2]) -> [[f64; 9]; 2] {
        let [x, y] = xi.map(lagrange);
        let [dx, dy] = xi.map(lagrange_slope);
        [LATTICE.map(|[i, j]| dx[i] * y[j]), LATTICE.map(|[i, j]| x[i] * dy[j])]
    }

    #[inline]
    fn quadrature() -> &'static [FacePoint] {
        &POINTS
    }
}
