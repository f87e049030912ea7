//! Faces of hexahedra: node lists, outward orientation, and the faces that belong to one cell only.

use super::{CellKind, Face, Mesh};
use nalgebra::Vector3;

/// Local nodes of the faces S1 to S6: four corners, four mid-sides, centre.
///
/// Abaqus lists the corners of S1 to S6 of a C3D8 as 1-2-3-4, 5-8-7-6, 1-5-6-2, 2-6-7-3, 3-7-8-4, 4-8-5-1: the normal
/// of these lists points into the cell. Here each list starts at the same side of the face but runs the other way
/// round, so that the normal points outwards.
const FACES: [[usize; 9]; 6] = [
    [0, 3, 2, 1, 11, 10, 9, 8, 24],
    [4, 5, 6, 7, 12, 13, 14, 15, 25],
    [0, 1, 5, 4, 8, 17, 12, 16, 22],
    [1, 2, 6, 5, 9, 18, 13, 17, 21],
    [2, 3, 7, 6, 10, 19, 14, 18, 23],
    [3, 0, 4, 7, 11, 16, 15, 19, 20],
];

impl CellKind {
    /// Local node numbers of a face (0 to 5 = Abaqus S1 to S6), outward orientation: the four corners of a quad4,
    /// with the mid-sides of a quad8 or these and the centre of a quad9. `None` for a face number above 5.
    #[inline]
    pub fn face(self, face: u8) -> Option<&'static [usize]> {
        FACES.get(usize::from(face)).and_then(|nodes| nodes.get(..self.face_nodes()))
    }
}

impl Mesh {
    /// Node indices of a face, outward orientation, in quad4, quad8 or quad9 order; `None` when the face does not exist.
    pub fn face_nodes(&self, face: Face) -> Option<impl ExactSizeIterator<Item = u32> + '_> {
        let nodes = self.kind.nodes();
        let first = face.cell as usize * nodes;
        let cell = self.cells.get(first..first + nodes)?;
        let local = self.kind.face(face.face)?;
        Some(local.iter().map(move |&a| cell[a]))
    }

    /// Reference coordinates of the nodes of a face \[mm\]; `None` when the face does not exist, has not `N` nodes or
    /// refers to a node that does not exist.
    pub fn face_points<const N: usize>(&self, face: Face) -> Option<[Vector3<f64>; N]> {
        let nodes = self.face_nodes(face)?;
        if nodes.len() != N {
            return None;
        }
        let mut out = [Vector3::zeros(); N];
        for (x, node) in out.iter_mut().zip(nodes) {
            *x = *self.points.get(node as usize)?;
        }
        Some(out)
    }
}

/// The faces that belong to one cell only, ordered by cell and face.
///
/// Two faces are the same when they have the same four corner nodes.
pub fn exterior_faces(mesh: &Mesh) -> Vec<Face> {
    let mut faces = keyed_faces(mesh);
    faces.sort_unstable();
    let mut exterior: Vec<Face> =
        faces.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() == 1).map(|same| same[0].1).collect();
    exterior.sort_unstable();
    exterior
}

fn keyed_faces(mesh: &Mesh) -> Vec<([u32; 4], Face)> {
    let mut faces = Vec::with_capacity(6 * mesh.cell_count());
    for (cell, nodes) in (0_u32..).zip(mesh.cells.chunks_exact(mesh.kind.nodes())) {
        for (face, local) in (0_u8..).zip(&FACES) {
            let mut key = [nodes[local[0]], nodes[local[1]], nodes[local[2]], nodes[local[3]]];
            key.sort_unstable();
            faces.push((key, Face { cell, face }));
        }
    }
    faces
}
