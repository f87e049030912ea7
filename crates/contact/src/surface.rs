//! Surfaces of patches: facets as meshed, smooth splines through the same nodes, and rigid planes and cylinders.

mod grid;

use nalgebra::Vector3;
use subrope_geometry::{CellKind, Face, Mesh};

use crate::ContactError;
use crate::patch::{PATCH_NODES, PatchKind, Shape};
use grid::{Beyond, Quad, control_grid, neighbours, quarters, stencil, valences};

/// How a surface is made of the faces of a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Smoothing {
    /// Bicubic B-spline whose control points are the nodes: twice continuously differentiable, so that two faceted
    /// cylinders touch as smooth ones do. It lies inside a ring of N nodes by about (1 - cos(2 pi/N))/3 of its radius.
    #[default]
    Spline,
    /// The faces as they are meshed.
    None,
}

/// A surface that may touch others. Normals (first tangent x second) point outwards.
#[derive(Clone, Debug)]
pub struct Surface {
    kinds: Vec<PatchKind>,
    nodes: Vec<u32>,
    starts: Vec<u32>,
    /// Patch and edge beyond every edge.
    neighbours: Vec<Beyond>,
    /// The face of the mesh that every patch belongs to.
    faces: Vec<u32>,
}

impl Surface {
    /// A surface of faces of a mesh.
    ///
    /// # Errors
    /// [`ContactError::NoFace`] when a face does not exist; [`ContactError::Serendipity`] for cells of 20 nodes; [`ContactError::Branching`] when three faces share an edge;
    /// [`ContactError::Irregular`] when a spline meets an inner node where not four faces meet.
    pub fn new(mesh: &Mesh, faces: &[Face], smoothing: Smoothing) -> Result<Self, ContactError> {
        let mut lists = Vec::with_capacity(faces.len());
        for face in faces {
            let nodes = mesh.face_nodes(*face).ok_or(ContactError::NoFace { cell: face.cell, face: face.face })?;
            lists.push(nodes.collect::<Vec<u32>>());
        }
        Self::of_faces(&lists, mesh.kind, smoothing)
    }

    /// A surface of faces between any nodes: four of each for cells of eight nodes, nine for those of 27, in the order of
    /// the faces of a mesh, corners counter-clockwise seen from outside.
    ///
    /// # Errors
    /// [`ContactError::Serendipity`] for cells of 20 nodes; [`ContactError::FaceNodes`] when a face has too few nodes; as [`Surface::new`].
    pub fn of_faces(faces: &[Vec<u32>], kind: CellKind, smoothing: Smoothing) -> Result<Self, ContactError> {
        if kind.is_serendipity() {
            return Err(ContactError::Serendipity);
        }
        let needed = kind.face_nodes();
        if let Some((face, list)) = faces.iter().enumerate().find(|(_, list)| list.len() < needed) {
            return Err(ContactError::FaceNodes { face, found: list.len(), needed });
        }
        match (smoothing, kind) {
            (Smoothing::None, kind) => Self::facets(faces, kind),
            (Smoothing::Spline, CellKind::Hex8) => {
                let quads: Vec<(Quad, u32)> =
                    faces.iter().zip(0..).map(|(l, f)| ([l[0], l[1], l[2], l[3]], f)).collect();
                Self::spline(&quads)
            }
            (Smoothing::Spline, _) => Self::spline(&quarters(faces)),
        }
    }

    /// The patches of some faces alone, with the shape that all faces give them: a spline does not end where they do. Faces
    /// count from the first of them.
    #[must_use]
    pub fn part(&self, faces: std::ops::Range<usize>) -> Self {
        let kept: Vec<usize> = (0..self.patch_count()).filter(|&p| faces.contains(&self.face(p))).collect();
        let renumbered = |(patch, edge): (u32, u8)| Some((kept.binary_search(&(patch as usize)).ok()? as u32, edge));
        let neighbours = kept.iter().map(|&p| self.neighbours[p].map(|beyond| beyond.and_then(renumbered)));
        let mut part = Self::empty(neighbours.collect());
        kept.iter().for_each(|&p| part.push(self.kinds[p].clone(), self.nodes(p), self.faces[p] - faces.start as u32));
        part
    }

    /// Whether a patch lies at the edge of the surface.
    #[must_use]
    pub fn is_at_edge(&self, patch: usize) -> bool {
        !self.kinds[patch].is_unbounded() && self.neighbours[patch].iter().any(Option::is_none)
    }

    fn facets(lists: &[Vec<u32>], kind: CellKind) -> Result<Self, ContactError> {
        let quads: Vec<Quad> = lists.iter().map(|l| [l[0], l[1], l[2], l[3]]).collect();
        let neighbours = neighbours(&quads)?;
        let mut surface = Self::empty(neighbours);
        for (list, face) in lists.iter().zip(0..) {
            let kind = if kind == CellKind::Hex8 { PatchKind::Bilinear } else { PatchKind::Biquadratic };
            surface.push(kind, list, face);
        }
        Ok(surface)
    }

    fn spline(quads: &[(Quad, u32)]) -> Result<Self, ContactError> {
        let corners: Vec<Quad> = quads.iter().map(|(q, _)| *q).collect();
        let mut surface = Self::empty(neighbours(&corners)?);
        let valence = valences(&corners, &surface.neighbours);
        for (patch, (_, face)) in quads.iter().enumerate() {
            let grid = control_grid(patch, &corners, &surface.neighbours, &valence)?;
            let (kind, nodes) = stencil(&grid);
            surface.push(kind, &nodes, *face);
        }
        Ok(surface)
    }

    /// A rigid cylinder about the third axis of a frame: `nodes` are its origin and one node along each axis, `arm`
    /// \[mm\] away.
    #[must_use]
    pub fn cylinder(nodes: [u32; 4], radius: f64, arm: f64) -> Self {
        Self::rigid(nodes, PatchKind::Cylinder { radius, arm })
    }

    /// A rigid plane through the origin of a frame, solid on the side of the negative third axis.
    #[must_use]
    pub fn plane(nodes: [u32; 4], arm: f64) -> Self {
        Self::rigid(nodes, PatchKind::Plane { arm })
    }

    fn rigid(nodes: [u32; 4], kind: PatchKind) -> Self {
        let mut surface = Self::empty(vec![[None; 4]]);
        surface.push(kind, &nodes, 0);
        surface
    }

    fn empty(neighbours: Vec<Beyond>) -> Self {
        Self { kinds: Vec::new(), nodes: Vec::new(), starts: vec![0], neighbours, faces: Vec::new() }
    }

    fn push(&mut self, kind: PatchKind, nodes: &[u32], face: u32) {
        self.kinds.push(kind);
        self.nodes.extend_from_slice(nodes);
        self.starts.push(self.nodes.len() as u32);
        self.faces.push(face);
    }

    /// Number of patches.
    #[must_use]
    pub fn patch_count(&self) -> usize {
        self.kinds.len()
    }

    /// Nodes of a patch.
    #[must_use]
    pub fn nodes(&self, patch: usize) -> &[u32] {
        &self.nodes[self.starts[patch] as usize..self.starts[patch + 1] as usize]
    }

    /// All nodes, once each, in order.
    #[must_use]
    pub fn all_nodes(&self) -> Vec<u32> {
        let mut nodes = self.nodes.clone();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }

    /// What a patch is.
    #[must_use]
    pub fn kind(&self, patch: usize) -> &PatchKind {
        &self.kinds[patch]
    }

    /// Index, in the list given to [`Surface::new`] or [`Surface::of_faces`], of the face that a patch belongs to.
    #[must_use]
    pub fn face(&self, patch: usize) -> usize {
        self.faces[patch] as usize
    }

    /// Shape functions of a patch.
    #[must_use]
    pub fn shape(&self, patch: usize, xi: [f64; 2]) -> Shape {
        self.kinds[patch].shape(xi)
    }

    /// Positions of the nodes of a patch: reference positions plus displacements.
    #[must_use]
    pub fn gather(
        &self,
        patch: usize,
        positions: &[Vector3<f64>],
        displacement: &[f64],
    ) -> [Vector3<f64>; PATCH_NODES] {
        let mut out = [Vector3::zeros(); PATCH_NODES];
        for (x, &node) in out.iter_mut().zip(self.nodes(patch)) {
            let at = 3 * node as usize;
            *x = positions[node as usize] + Vector3::from_column_slice(&displacement[at..at + 3]);
        }
        out
    }

    /// The patch beyond an edge and the same point in its coordinates; [`None`] at the edge of the surface.
    ///
    /// Edges are numbered from corner to corner, (-1, -1), (1, -1), (1, 1), (-1, 1).
    #[must_use]
    pub fn cross(&self, patch: usize, edge: u8, xi: [f64; 2]) -> Option<(usize, [f64; 2])> {
        let (beyond, entry) = self.neighbours[patch][edge as usize]?;
        let (along, depth) = match edge {
            0 => (xi[0], -1.0 - xi[1]),
            1 => (xi[1], xi[0] - 1.0),
            2 => (-xi[0], xi[1] - 1.0),
            _ => (-xi[1], -1.0 - xi[0]),
        };
        let at = match entry {
            0 => [-along, depth - 1.0],
            1 => [1.0 - depth, -along],
            2 => [along, 1.0 - depth],
            _ => [depth - 1.0, along],
        };
        Some((beyond as usize, at))
    }

    /// The patches that share an edge with a patch, or an edge with one of those.
    #[must_use]
    pub fn around(&self, patch: usize) -> Vec<usize> {
        let next = |p: usize| self.neighbours[p].iter().flatten().map(|(q, _)| *q as usize);
        let mut out: Vec<usize> = next(patch).flat_map(|q| next(q).chain([q])).filter(|&q| q != patch).collect();
        out.sort_unstable();
        out.dedup();
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A spline through a lattice of control points reproduces linear functions in both directions, whatever edges the
    /// patch has; curved lines of nodes are followed up to the edge across them.
    #[test]
    fn edges_continue_linearly_across_only() {
        for cells in [[4, 1], [1, 4], [3, 2], [2, 3], [3, 3]] {
            let node = |i: usize, j: usize| (j * (cells[0] + 1) + i) as u32;
            let mut quads = Vec::new();
            for j in 0..cells[1] {
                for i in 0..cells[0] {
                    quads.push(([node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)], quads.len() as u32));
                }
            }
            let surface = Surface::spline(&quads).unwrap_or_else(|e| unreachable!("{e}"));
            let curve = |x: f64, y: f64| Vector3::new(x, y, x * x + 3.0 * y * y);
            let positions: Vec<Vector3<f64>> =
                (0..=cells[1]).flat_map(|j| (0..=cells[0]).map(move |i| curve(i as f64, j as f64))).collect();
            let rest = vec![0.0; 3 * positions.len()];
            for patch in 0..surface.patch_count() {
                let (i, j) = (patch % cells[0], patch / cells[0]);
                let nodal = surface.gather(patch, &positions, &rest);
                for xi in [[-0.7, -0.4], [-0.7, 0.4], [0.7, -0.4], [0.7, 0.4]] {
                    let shape = surface.shape(patch, xi);
                    let x = shape.combine(&shape.value, &nodal);
                    let at = [i as f64 + 0.5 * (xi[0] + 1.0), j as f64 + 0.5 * (xi[1] + 1.0)];
                    assert!((x.x - at[0]).abs() < 1e-13 && (x.y - at[1]).abs() < 1e-13);
                    // x^2 of a uniform spline is x^2 + 1/3 inside; the second derivative falls to zero at an edge.
                    let second = |v: f64, n: usize, height: f64| {
                        let (ends, t) = ([v < 1.0, v > n as f64 - 1.0], v.fract());
                        let inner = v * v + 1.0 / 3.0;
                        let left = if ends[0] { (1.0 - t).powi(3) / 6.0 * 2.0 } else { 0.0 };
                        let right = if ends[1] { t.powi(3) / 6.0 * 2.0 } else { 0.0 };
                        height * (inner - left - right)
                    };
                    let exact = second(at[0], cells[0], 1.0) + second(at[1], cells[1], 3.0);
                    assert!((x.z - exact).abs() < 1e-12, "{cells:?} {patch} {xi:?}: {} {exact}", x.z);
                }
            }
        }
    }
}
