//! Area and orientation of a section mesh.

use super::SectionMesh;
use crate::GeometryError;
use crate::quadrilateral::{Quad4, Quad9, Quadrilateral};
use nalgebra::Vector2;

impl SectionMesh {
    /// Area \[mm^2\], integrated over the cells; exact for the polynomials of their map.
    pub fn area(&self) -> f64 {
        match self.nodes_per_cell {
            4 => self.cell_nodes::<4>().map(|nodes| area::<Quad4, 4>(&nodes)).sum(),
            _ => self.cell_nodes::<9>().map(|nodes| area::<Quad9, 9>(&nodes)).sum(),
        }
    }

    /// Checks that the Jacobian determinant is positive at all nodes and integration points of every cell.
    pub(super) fn check_orientation(&self) -> Result<(), GeometryError> {
        match self.nodes_per_cell {
            4 => check(self.cell_nodes::<4>().map(|nodes| least::<Quad4, 4>(&nodes))),
            _ => check(self.cell_nodes::<9>().map(|nodes| least::<Quad9, 9>(&nodes))),
        }
    }

    fn cell_nodes<const N: usize>(&self) -> impl Iterator<Item = [Vector2<f64>; N]> {
        self.cells.as_chunks::<N>().0.iter().map(|cell| cell.map(|node| self.points[node as usize]))
    }
}

fn determinant<Q: Quadrilateral<N>, const N: usize>(nodes: &[Vector2<f64>; N], xi: [f64; 2]) -> f64 {
    let gradient = Q::gradient(xi);
    let mut tangents = [Vector2::zeros(); 2];
    for a in 0..N {
        tangents[0] += nodes[a] * gradient[0][a];
        tangents[1] += nodes[a] * gradient[1][a];
    }
    tangents[0].perp(&tangents[1])
}

fn area<Q: Quadrilateral<N>, const N: usize>(nodes: &[Vector2<f64>; N]) -> f64 {
    Q::quadrature().iter().map(|point| point.weight * determinant::<Q, N>(nodes, point.xi)).sum()
}

fn least<Q: Quadrilateral<N>, const N: usize>(nodes: &[Vector2<f64>; N]) -> f64 {
    let points = Q::quadrature().iter().map(|point| point.xi).chain(Q::NODES);
    points.map(|xi| determinant::<Q, N>(nodes, xi)).fold(f64::INFINITY, f64::min)
}

fn check(least: impl Iterator<Item = f64>) -> Result<(), GeometryError> {
    for (cell, determinant) in least.enumerate() {
        if determinant <= 0.0 || determinant.is_nan() {
            return Err(GeometryError::SectionFolds { cell, determinant });
        }
    }
    Ok(())
}
