//! The triquadratic hexahedron of 27 nodes.

use super::quadrature::{GAUSS_3, product};
use super::{Hexahedron, QuadraturePoint};
use crate::CellKind;

/// Triquadratic hexahedron: products of the quadratic Lagrange polynomials on -1, 0, 1.
///
/// Node order of VTK's tri-quadratic hexahedron: corners 0-7; mid-edges 8-11 (bottom), 12-15 (top), 16-19 (vertical);
/// face centres 20 (-xi), 21 (+xi), 22 (-eta), 23 (+eta), 24 (-zeta), 25 (+zeta); centre 26.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Hex27;

static POINTS: [QuadraturePoint; 27] = product(&GAUSS_3);

/// Position of every node on the 3 x 3 x 3 lattice.
pub(crate) const LATTICE: [[usize; 3]; 27] = [
    [0, 0, 0],
    [2, 0, 0],
    [2, 2, 0],
    [0, 2, 0],
    [0, 0, 2],
    [2, 0, 2],
    [2, 2, 2],
    [0, 2, 2],
    [1, 0, 0],
    [2, 1, 0],
    [1, 2, 0],
    [0, 1, 0],
    [1, 0, 2],
    [2, 1, 2],
    [1, 2, 2],
    [0, 1, 2],
    [0, 0, 1],
    [2, 0, 1],
    [2, 2, 1],
    [0, 2, 1],
    [0, 1, 1],
    [2, 1, 1],
    [1, 0, 1],
    [1, 2, 1],
    [1, 1, 0],
    [1, 1, 2],
    [1, 1, 1],
];

/// Quadratic Lagrange polynomials on -1, 0, 1.
#[inline]
pub(crate) fn lagrange(x: f64) -> [f64; 3] {
    [0.5 * x * (x - 1.0), (1.0 - x) * (1.0 + x), 0.5 * x * (x + 1.0)]
}

/// Their derivatives.
#[inline]
pub(crate) fn lagrange_slope(x: f64) -> [f64; 3] {
    [x - 0.5, -2.0 * x, x + 0.5]
}

impl Hexahedron<27> for Hex27 {
    const KIND: CellKind = CellKind::Hex27;
    const NODES: [[f64; 3]; 27] = nodes();

    #[inline]
    fn shape(xi: [f64; 3]) -> [f64; 27] {
        let [x, y, z] = xi.map(lagrange);
        LATTICE.map(|[i, j, k]| x[i] * y[j] * z[k])
    }

    #[inline]
    fn gradient(xi: [f64; 3]) -> [[f64; 27]; 3] {
        let [x, y, z] = xi.map(lagrange);
        let [dx, dy, dz] = xi.map(lagrange_slope);
        [
            LATTICE.map(|[i, j, k]| dx[i] * y[j] * z[k]),
            LATTICE.map(|[i, j, k]| x[i] * dy[j] * z[k]),
            LATTICE.map(|[i, j, k]| x[i] * y[j] * dz[k]),
        ]
    }

    #[inline]
    fn quadrature() -> &'static [QuadraturePoint] {
        &POINTS
    }
}

/// Natural coordinates of the first `N` nodes.
pub(super) const fn nodes<const N: usize>() -> [[f64; 3]; N] {
    let mut out = [[0.0; 3]; N];
    let mut a = 0;
    while a < N {
        let [i, j, k] = LATTICE[a];
        out[a] = [i as f64 - 1.0, j as f64 - 1.0, k as f64 - 1.0];
        a += 1;
    }
    out
}
