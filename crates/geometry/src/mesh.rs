//! Hexahedral meshes with named node sets, element sets and surfaces.

mod extent;
mod faces;
mod lines;
mod unused;
mod validate;

pub use extent::extent;
pub use faces::exterior_faces;
pub use lines::NodeLines;

use crate::GeometryError;
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// Kind of hexahedron; one mesh holds one kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum CellKind {
    /// Trilinear brick of eight nodes (`C3D8`, VTK cell type 12).
    Hex8,
    /// Quadratic serendipity brick of 20 nodes, 3 x 3 x 3 integration points (`C3D20`, VTK cell type 25).
    Hex20,
    /// The same with 2 x 2 x 2 integration points (`C3D20R`, VTK cell type 25).
    Hex20R,
    /// Triquadratic brick of 27 nodes (VTK cell type 29).
    Hex27,
}

impl CellKind {
    /// Nodes per cell: 8, 20 or 27.
    #[inline]
    pub const fn nodes(self) -> usize {
        match self {
            Self::Hex8 => 8,
            Self::Hex20 | Self::Hex20R => 20,
            Self::Hex27 => 27,
        }
    }

    /// Integration points per cell: 8 (2 x 2 x 2) or 27 (3 x 3 x 3).
    #[inline]
    pub const fn points(self) -> usize {
        match self {
            Self::Hex8 | Self::Hex20R => 8,
            Self::Hex20 | Self::Hex27 => 27,
        }
    }

    /// Degree of the shape functions along an edge: 1 or 2.
    #[inline]
    pub const fn order(self) -> usize {
        match self {
            Self::Hex8 => 1,
            Self::Hex20 | Self::Hex20R | Self::Hex27 => 2,
        }
    }

    /// Whether faces and cell have no node in their middle, although edges have.
    #[inline]
    pub const fn is_serendipity(self) -> bool {
        matches!(self, Self::Hex20 | Self::Hex20R)
    }

    /// Nodes per face: 4, 8 or 9.
    #[inline]
    pub const fn face_nodes(self) -> usize {
        match self {
            Self::Hex8 => 4,
            Self::Hex20 | Self::Hex20R => 8,
            Self::Hex27 => 9,
        }
    }
}

/// One face of one cell; face 0 to 5 is Abaqus S1 to S6.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Face {
    /// Zero-based cell index.
    pub cell: u32,
    /// Face of the cell, 0 to 5.
    pub face: u8,
}

/// A hexahedral mesh in the reference configuration.
///
/// Indices are zero-based everywhere; labels are the numbers of an input deck.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    /// Kind of all cells.
    pub kind: CellKind,
    /// Reference coordinates of the nodes \[mm\].
    pub points: Vec<Vector3<f64>>,
    /// Flat connectivity, `kind.nodes()` node indices per cell, VTK node order.
    pub cells: Vec<u32>,
    /// Number of every node as in a deck; 1-based when generated.
    pub point_labels: Vec<u64>,
    /// Number of every cell as in a deck; 1-based when generated.
    pub cell_labels: Vec<u64>,
    /// Named sets of node indices.
    pub node_sets: BTreeMap<String, Vec<u32>>,
    /// Named sets of cell indices.
    pub element_sets: BTreeMap<String, Vec<u32>>,
    /// Named sets of faces.
    pub surfaces: BTreeMap<String, Vec<Face>>,
}

impl Mesh {
    /// A mesh without sets, nodes and cells labelled from 1.
    ///
    /// `points` \[mm\], `cells` as in [`Mesh::cells`]. Nothing is checked; see [`Mesh::validate`].
    pub fn new(kind: CellKind, points: Vec<Vector3<f64>>, cells: Vec<u32>) -> Self {
        let point_labels = (1..=points.len() as u64).collect();
        let cell_labels = (1..=(cells.len() / kind.nodes()) as u64).collect();
        Self {
            kind,
            points,
            cells,
            point_labels,
            cell_labels,
            node_sets: BTreeMap::new(),
            element_sets: BTreeMap::new(),
            surfaces: BTreeMap::new(),
        }
    }

    /// Number of cells.
    #[inline]
    pub fn cell_count(&self) -> usize {
        self.cells.len() / self.kind.nodes()
    }

    /// Number of nodes.
    #[inline]
    pub fn point_count(&self) -> usize {
        self.points.len()
    }

    /// Node indices of a cell in VTK node order.
    ///
    /// # Panics
    /// When `cell >= self.cell_count()`.
    #[inline]
    pub fn cell(&self, cell: usize) -> &[u32] {
        let nodes = self.kind.nodes();
        &self.cells[cell * nodes..(cell + 1) * nodes]
    }

    /// Reference coordinates of the nodes of a cell \[mm\]; `None` when the cell does not exist, has not `N` nodes or
    /// refers to a node that does not exist.
    #[inline]
    pub fn cell_points<const N: usize>(&self, cell: usize) -> Option<[Vector3<f64>; N]> {
        if self.kind.nodes() != N {
            return None;
        }
        let nodes = self.cells.get(cell * N..(cell + 1) * N)?;
        let mut out = [Vector3::zeros(); N];
        for (x, &node) in out.iter_mut().zip(nodes) {
            *x = *self.points.get(node as usize)?;
        }
        Some(out)
    }

    /// As [`Mesh::cell_points`] for a cell that is known to exist, with the node that does not exist in the error.
    pub(crate) fn checked_cell_points<const N: usize>(&self, cell: usize) -> Result<[Vector3<f64>; N], GeometryError> {
        self.cell_points(cell).ok_or_else(|| {
            let points = self.point_count();
            let missing = self.cell(cell).iter().find(|&&node| node as usize >= points);
            let index = missing.copied().unwrap_or(u32::MAX);
            GeometryError::PointIndex { cell_label: self.cell_label(cell), index, points }
        })
    }

    /// Label of a cell; its one-based position where no label is stored.
    pub fn cell_label(&self, cell: usize) -> u64 {
        self.cell_labels.get(cell).copied().unwrap_or(cell as u64 + 1)
    }

    /// Label of a node; its one-based position where no label is stored.
    pub fn point_label(&self, point: usize) -> u64 {
        self.point_labels.get(point).copied().unwrap_or(point as u64 + 1)
    }
}
