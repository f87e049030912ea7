//! The isoparametric map of hexahedra: shape functions, quadrature, Jacobian, physical gradients.

mod hex20;
mod hex27;
mod hex8;
mod map;
mod quadrature;

pub use hex8::Hex8;
pub use hex20::{Hex20, Hex20R, Serendipity};
pub use hex27::Hex27;
pub use map::{MappedPoint, jacobian, jacobian_of, map_point, position};
pub use quadrature::QuadraturePoint;

pub(crate) use hex27::{LATTICE, lagrange, lagrange_slope};
pub(crate) use quadrature::{GAUSS_2, GAUSS_3};

use crate::CellKind;

/// A hexahedron of `N` nodes on the natural coordinates xi in \[-1, 1\]^3, VTK node order.
pub trait Hexahedron<const N: usize>: Send + Sync + 'static {
    /// Kind of the cell.
    const KIND: CellKind;
    /// Natural coordinates of the nodes.
    const NODES: [[f64; 3]; N];

    /// Values of the shape functions N_a at `xi`.
    fn shape(xi: [f64; 3]) -> [f64; N];

    /// Derivatives dN_a/dxi_i at `xi`, index `[i][a]`.
    fn gradient(xi: [f64; 3]) -> [[f64; N]; 3];

    /// Gauss points (2 x 2 x 2 or 3 x 3 x 3; of full integration, but for [`Hex20R`]), xi_1 running fastest, xi_3 slowest.
    fn quadrature() -> &'static [QuadraturePoint];
}
