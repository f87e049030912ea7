//! The quadratic serendipity hexahedron of 20 nodes, with full and with reduced integration.

use super::hex27::nodes;
use super::quadrature::{GAUSS_2, GAUSS_3, product};
use super::{Hexahedron, QuadraturePoint};
use crate::CellKind;

/// Serendipity hexahedron, of which [`Hex20`] and [`Hex20R`] differ in their integration points.
///
/// With xi_a the natural coordinates of node a: at a corner
/// N_a = (1 + xi xi_a)(1 + eta eta_a)(1 + zeta zeta_a)(xi xi_a + eta eta_a + zeta zeta_a - 2)/8, in the middle of an edge
/// along xi N_a = (1 - xi^2)(1 + eta eta_a)(1 + zeta zeta_a)/4, and so for the other edges.
///
/// Node order of VTK's quadratic hexahedron: corners 0-7; mid-edges 8-11 (bottom), 12-15 (top), 16-19 (vertical): the first
/// twenty of [`Hex27`](super::Hex27).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Serendipity<const REDUCED: bool>;

/// Integrated at 3 x 3 x 3 points (`C3D20`).
pub type Hex20 = Serendipity<false>;

/// Integrated at 2 x 2 x 2 points (`C3D20R`).
///
/// One element alone has six modes beside the rigid ones that cost no energy, a straight row of two has three; distorted
/// elements in a row have none, nor have four about an edge.
pub type Hex20R = Serendipity<true>;

static FULL_POINTS: [QuadraturePoint; 27] = product(&GAUSS_3);
static REDUCED_POINTS: [QuadraturePoint; 8] = product(&GAUSS_2);

/// Corners come first.
const CORNERS: usize = 8;

/// One factor of a shape function and its derivative: linear towards an end of an edge, quadratic along the edge.
#[inline]
fn factor(x: f64, node: f64) -> (f64, f64) {
    if node == 0.0 { (1.0 - x * x, -2.0 * x) } else { (1.0 + x * node, node) }
}

impl<const REDUCED: bool> Hexahedron<20> for Serendipity<REDUCED> {
    const KIND: CellKind = if REDUCED { CellKind::Hex20R } else { CellKind::Hex20 };
    const NODES: [[f64; 3]; 20] = nodes();

    #[inline]
    fn shape(xi: [f64; 3]) -> [f64; 20] {
        let mut n = [0.0; 20];
        for (a, (value, node)) in n.iter_mut().zip(&Self::NODES).enumerate() {
            let product: f64 = (0..3).map(|i| factor(xi[i], node[i]).0).product();
            let sum = xi[0] * node[0] + xi[1] * node[1] + xi[2] * node[2];
            *value = if a < CORNERS { 0.125 * product * (sum - 2.0) } else { 0.25 * product };
        }
        n
    }

    #[inline]
    fn gradient(xi: [f64; 3]) -> [[f64; 20]; 3] {
        let mut g = [[0.0; 20]; 3];
        for (a, node) in Self::NODES.iter().enumerate() {
            let f: [(f64, f64); 3] = std::array::from_fn(|i| factor(xi[i], node[i]));
            let product = f[0].0 * f[1].0 * f[2].0;
            let sum = xi[0] * node[0] + xi[1] * node[1] + xi[2] * node[2];
            let slopes = [f[0].1 * f[1].0 * f[2].0, f[0].0 * f[1].1 * f[2].0, f[0].0 * f[1].0 * f[2].1];
            for i in 0..3 {
                g[i][a] =
                    if a < CORNERS { 0.125 * (slopes[i] * (sum - 2.0) + product * node[i]) } else { 0.25 * slopes[i] };
            }
        }
        g
    }

    #[inline]
    fn quadrature() -> &'static [QuadraturePoint] {
        if REDUCED { &REDUCED_POINTS } else { &FULL_POINTS }
    }
}
