//! The trilinear hexahedron of eight nodes.

use super::quadrature::{GAUSS_2, product};
use super::{Hexahedron, QuadraturePoint};
use crate::CellKind;

/// Trilinear hexahedron: N_a = (1 + xi xi_a)(1 + eta eta_a)(1 + zeta zeta_a)/8.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Hex8;

static POINTS: [QuadraturePoint; 8] = product(&GAUSS_2);

impl Hexahedron<8> for Hex8 {
    const KIND: CellKind = CellKind::Hex8;
    const NODES: [[f64; 3]; 8] = [
        [-1.0, -1.0, -1.0],
        [1.0, -1.0, -1.0],
        [1.0, 1.0, -1.0],
        [-1.0, 1.0, -1.0],
        [-1.0, -1.0, 1.0],
        [1.0, -1.0, 1.0],
        [1.0, 1.0, 1.0],
        [-1.0, 1.0, 1.0],
    ];

    #[inline]
    fn shape(xi: [f64; 3]) -> [f64; 8] {
        let mut n = [0.0; 8];
        for (value, node) in n.iter_mut().zip(&Self::NODES) {
            *value = 0.125 * (1.0 + xi[0] * node[0]) * (1.0 + xi[1] * node[1]) * (1.0 + xi[2] * node[2]);
        }
        n
    }

    #[inline]
    fn gradient(xi: [f64; 3]) -> [[f64; 8]; 3] {
        let mut g = [[0.0; 8]; 3];
        for (a, node) in Self::NODES.iter().enumerate() {
            let [x, y, z] = [1.0 + xi[0] * node[0], 1.0 + xi[1] * node[1], 1.0 + xi[2] * node[2]];
            g[0][a] = 0.125 * node[0] * y * z;
            g[1][a] = 0.125 * node[1] * x * z;
            g[2][a] = 0.125 * node[2] * x * y;
        }
        g
    }

    #[inline]
    fn quadrature() -> &'static [QuadraturePoint] {
        &POINTS
    }
}
