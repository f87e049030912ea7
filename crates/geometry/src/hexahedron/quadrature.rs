//! Gauss-Legendre points on \[-1, 1\] and their products.

/// A point of a quadrature rule on \[-1, 1\]^3.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct QuadraturePoint {
    /// Natural coordinates.
    pub xi: [f64; 3],
    /// Weight; the weights of a rule sum to 8.
    pub weight: f64,
}

/// Two-point rule (position, weight): exact for polynomials of degree 3.
pub(crate) const GAUSS_2: [(f64, f64); 2] = [(-0.577_350_269_189_625_8, 1.0), (0.577_350_269_189_625_8, 1.0)];

/// Three-point rule (position, weight): exact for polynomials of degree 5.
pub(crate) const GAUSS_3: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];

/// Product of a line rule of `L` points with itself, `P` = L^3 points, first coordinate fastest.
pub(super) const fn product<const L: usize, const P: usize>(line: &[(f64, f64); L]) -> [QuadraturePoint; P] {
    let mut points = [QuadraturePoint { xi: [0.0; 3], weight: 0.0 }; P];
    let mut p = 0;
    while p < P {
        let (x, y, z) = (line[p % L], line[(p / L) % L], line[p / (L * L)]);
        points[p] = QuadraturePoint { xi: [x.0, y.0, z.0], weight: x.1 * y.1 * z.1 };
        p += 1;
    }
    points
}
