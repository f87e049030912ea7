//! The isoparametric map of quadrilateral faces in space, for surface integrals.

mod map;
mod quad4;
mod quad8;
mod quad9;

pub use map::{SurfacePoint, face_area, map_surface_point, surface_area};
pub use quad4::Quad4;
pub use quad8::Quad8;
pub use quad9::Quad9;

pub(crate) use quad9::LATTICE;

/// A point of a quadrature rule on \[-1, 1\]^2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FacePoint {
    /// Natural coordinates.
    pub xi: [f64; 2],
    /// Weight; the weights of a rule sum to 4.
    pub weight: f64,
}

/// A quadrilateral of `N` nodes on the natural coordinates xi in \[-1, 1\]^2.
///
/// Node order: corners counter-clockwise, mid-sides (01, 12, 23, 30), centre (of nine nodes), as in [`crate::CellKind::face`].
pub trait Quadrilateral<const N: usize>: Send + Sync + 'static {
    /// Natural coordinates of the nodes.
    const NODES: [[f64; 2]; N];

    /// Values of the shape functions N_a at `xi`.
    fn shape(xi: [f64; 2]) -> [f64; N];

    /// Derivatives dN_a/dxi_i at `xi`, index `[i][a]`.
    fn gradient(xi: [f64; 2]) -> [[f64; N]; 2];

    /// Gauss points (2 x 2 or 3 x 3), xi_1 running fastest.
    fn quadrature() -> &'static [FacePoint];
}

/// Product of a line rule of `L` points with itself, `P` = L^2 points, first coordinate fastest.
const fn product<const L: usize, const P: usize>(line: &[(f64, f64); L]) -> [FacePoint; P] {
    let mut points = [FacePoint { xi: [0.0; 2], weight: 0.0 }; P];
    let mut p = 0;
    while p < P {
        let (x, y) = (line[p % L], line[p / L]);
        points[p] = FacePoint { xi: [x.0, y.0], weight: x.1 * y.1 };
        p += 1;
    }
    points
}
