//! Several bodies of bricks in one list of nodes, and rigid frames among them.

use nalgebra::{Matrix3, Vector3};
use subrope_contact::{Smoothing, Surface};
use subrope_fem::kinematics::{Section, SectionKind};
use subrope_geometry::{CellKind, Face, Mesh};

use crate::meshes::Lattice;

/// Bodies as one mesh.
pub struct Bodies {
    /// All nodes and all bricks.
    pub mesh: Mesh,
}

/// A structured body among others.
#[derive(Clone, Copy, Debug)]
pub struct Body {
    lattice: Lattice,
    node: u32,
    cell: u32,
}

impl Body {
    /// Nodes of the plane where parameter `axis` is 0 or 1.
    #[must_use]
    pub fn face(&self, axis: usize, end: bool) -> Vec<u32> {
        self.lattice.face(axis, end).iter().map(|n| n + self.node).collect()
    }

    /// All nodes.
    #[must_use]
    pub fn nodes(&self) -> Vec<u32> {
        (self.node..self.node + self.lattice.nodes().iter().product::<usize>() as u32).collect()
    }

    /// Faces of the cells on a plane of constant parameter.
    #[must_use]
    pub fn faces(&self, axis: usize, end: bool) -> Vec<Face> {
        let faces = self.lattice.face_cells(axis, end).into_iter();
        faces.map(|f| Face { cell: f.cell + self.cell, face: f.face }).collect()
    }
}

impl Bodies {
    /// No body yet.
    #[must_use]
    pub fn new(kind: CellKind) -> Self {
        Self { mesh: Mesh::new(kind, Vec::new(), Vec::new()) }
    }

    /// Adds a structured body whose nodes are images of the parameters, 0 to 1.
    pub fn add(&mut self, cells: [usize; 3], map: impl Fn([f64; 3]) -> [f64; 3]) -> Body {
        let lattice = Lattice::new(cells, self.mesh.kind);
        let [node, cell] = self.join(&lattice.mesh(map));
        Body { lattice, node, cell }
    }

    /// Adds a mesh; answers its first node and its first cell.
    pub fn join(&mut self, other: &Mesh) -> [u32; 2] {
        let (node, cell) = (self.mesh.point_count() as u32, self.mesh.cell_count() as u32);
        let points = self.mesh.points.iter().chain(&other.points).copied().collect();
        let cells = self.mesh.cells.iter().copied().chain(other.cells.iter().map(|n| n + node)).collect();
        self.mesh = Mesh::new(self.mesh.kind, points, cells);
        [node, cell]
    }

    /// Adds the four nodes of a rigid frame: its origin, then one node `arm` away along each axis (columns of `axes`).
    pub fn frame(&mut self, origin: Vector3<f64>, axes: &Matrix3<f64>, arm: f64) -> [u32; 4] {
        let first = self.mesh.point_count() as u32;
        self.mesh.points.push(origin);
        self.mesh.points.extend((0..3).map(|k| origin + axes.column(k) * arm));
        self.mesh.point_labels = (1..=self.mesh.points.len() as u64).collect();
        [first, first + 1, first + 2, first + 3]
    }

    /// A surface of a body.
    #[must_use]
    pub fn surface(&self, body: &Body, axis: usize, end: bool, smoothing: Smoothing) -> Surface {
        Surface::new(&self.mesh, &body.faces(axis, end), smoothing).unwrap()
    }
}

/// A rigid section about a point.
#[must_use]
pub fn rigid(name: &str, position: Vector3<f64>, nodes: &[u32]) -> Section {
    Section { name: name.into(), position, axis: Vector3::z(), nodes: nodes.to_vec(), kind: SectionKind::Rigid }
}
