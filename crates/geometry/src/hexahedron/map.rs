//! From natural to reference coordinates.

use super::Hexahedron;
use crate::GeometryError;
use nalgebra::{Matrix3, Vector3};

/// The isoparametric map of one cell at one point of natural coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MappedPoint<const N: usize> {
    /// Position X \[mm\].
    pub position: Vector3<f64>,
    /// Jacobian matrix dX_i/dxi_j \[mm\].
    pub jacobian: Matrix3<f64>,
    /// Its determinant \[mm^3\], positive.
    pub determinant: f64,
    /// Gradients of the shape functions dN_a/dX_i \[1/mm\], index `[i][a]`.
    pub gradient: [[f64; N]; 3],
}

/// Position X = sum_a N_a(xi) X_a \[mm\] for nodal coordinates `nodes` \[mm\].
#[inline]
pub fn position<H: Hexahedron<N>, const N: usize>(nodes: &[Vector3<f64>; N], xi: [f64; 3]) -> Vector3<f64> {
    let shape = H::shape(xi);
    let mut x = Vector3::zeros();
    for a in 0..N {
        x += nodes[a] * shape[a];
    }
    x
}

/// Jacobian matrix J_ij = dX_i/dxi_j = sum_a X_a,i dN_a/dxi_j \[mm\] for nodal coordinates `nodes` \[mm\].
#[inline]
pub fn jacobian<H: Hexahedron<N>, const N: usize>(nodes: &[Vector3<f64>; N], xi: [f64; 3]) -> Matrix3<f64> {
    jacobian_of(nodes, &H::gradient(xi))
}

/// Jacobian matrix J_ij = sum_a X_a,i dN_a/dxi_j \[mm\] of gradients dN_a/dxi_j that are known.
#[inline]
#[must_use]
pub fn jacobian_of<const N: usize>(nodes: &[Vector3<f64>; N], gradient: &[[f64; N]; 3]) -> Matrix3<f64> {
    let mut columns = [Vector3::zeros(); 3];
    for (column, slope) in columns.iter_mut().zip(gradient) {
        for a in 0..N {
            *column += nodes[a] * slope[a];
        }
    }
    Matrix3::from_columns(&columns)
}

/// Position, Jacobian matrix and physical gradients dN_a/dX = J^-T dN_a/dxi at `xi`.
///
/// # Errors
/// [`GeometryError::SingularMap`] unless the determinant is positive and its inverse finite.
#[inline]
pub fn map_point<H: Hexahedron<N>, const N: usize>(
    nodes: &[Vector3<f64>; N],
    xi: [f64; 3],
) -> Result<MappedPoint<N>, GeometryError> {
    let natural = H::gradient(xi);
    let jacobian = jacobian_of(nodes, &natural);
    let determinant = jacobian.determinant();
    if !(determinant > 0.0 && determinant.recip().is_finite()) {
        return Err(GeometryError::SingularMap { determinant, xi });
    }
    let inverse = adjugate(&jacobian) / determinant;
    let mut gradient = [[0.0; N]; 3];
    for (i, row) in gradient.iter_mut().enumerate() {
        for a in 0..N {
            row[a] =
                natural[0][a] * inverse[(0, i)] + natural[1][a] * inverse[(1, i)] + natural[2][a] * inverse[(2, i)];
        }
    }
    Ok(MappedPoint { position: position::<H, N>(nodes, xi), jacobian, determinant, gradient })
}

/// Adjugate of a matrix: its rows are the cross products of the columns.
#[inline]
fn adjugate(m: &Matrix3<f64>) -> Matrix3<f64> {
    let [a, b, c]: [Vector3<f64>; 3] = [m.column(0).into(), m.column(1).into(), m.column(2).into()];
    Matrix3::from_rows(&[b.cross(&c).transpose(), c.cross(&a).transpose(), a.cross(&b).transpose()])
}
