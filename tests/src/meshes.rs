//! Meshes: structured blocks, the MacNeal-Harder patch, 27-node bricks on eight-node ones, other numberings.

use std::collections::BTreeMap;

use nalgebra::Vector3;
use subrope_geometry::{CellKind, Face, Hex8, Hex27, Hexahedron, Mesh};

/// A structured block of `cells` bricks along three parameters that run from 0 to 1. Bricks of 20 nodes leave the nodes in the
/// middle of faces and bricks to nobody.
#[derive(Clone, Copy, Debug)]
pub struct Lattice {
    /// Bricks along each parameter.
    pub cells: [usize; 3],
    /// Kind of brick.
    pub kind: CellKind,
}

impl Lattice {
    /// A block of bricks.
    #[must_use]
    pub fn new(cells: [usize; 3], kind: CellKind) -> Self {
        Self { cells, kind }
    }

    fn order(self) -> usize {
        self.kind.order()
    }

    /// Nodes along each parameter.
    #[must_use]
    pub fn nodes(self) -> [usize; 3] {
        self.cells.map(|n| n * self.order() + 1)
    }

    /// Index of a node by its place in the lattice.
    #[must_use]
    pub fn node(self, [i, j, k]: [usize; 3]) -> u32 {
        let [nx, ny, _] = self.nodes();
        ((k * ny + j) * nx + i) as u32
    }

    /// The mesh whose nodes are images of the parameters.
    #[must_use]
    pub fn mesh(self, map: impl Fn([f64; 3]) -> [f64; 3]) -> Mesh {
        let [nx, ny, nz] = self.nodes();
        let mut points = Vec::with_capacity(nx * ny * nz);
        for (k, j, i) in triples([nz, ny, nx]) {
            let at = [i as f64 / (nx - 1) as f64, j as f64 / (ny - 1) as f64, k as f64 / (nz - 1) as f64];
            points.push(Vector3::from(map(at)));
        }
        let [cx, cy, cz] = self.cells;
        let mut cells = Vec::new();
        for (k, j, i) in triples([cz, cy, cx]) {
            cells.extend(self.cell([i, j, k]));
        }
        Mesh::new(self.kind, points, cells)
    }

    fn cell(self, at: [usize; 3]) -> Vec<u32> {
        let order = self.order();
        let place = |xi: [f64; 3]| {
            let step = xi.map(|x| ((x + 1.0) * 0.5 * order as f64).round() as usize);
            self.node([at[0] * order + step[0], at[1] * order + step[1], at[2] * order + step[2]])
        };
        natural_nodes(self.kind).iter().map(|xi| place(*xi)).collect()
    }

    /// Nodes of the plane where parameter `axis` is 0 (`end` false) or 1 (`end` true).
    #[must_use]
    pub fn face(self, axis: usize, end: bool) -> Vec<u32> {
        let n = self.nodes();
        let wanted = if end { n[axis] - 1 } else { 0 };
        let all = triples([n[2], n[1], n[0]]).map(|(k, j, i)| [i, j, k]);
        all.filter(|place| place[axis] == wanted).map(|place| self.node(place)).collect()
    }

    /// Faces of the cells on such a plane.
    #[must_use]
    pub fn face_cells(self, axis: usize, end: bool) -> Vec<Face> {
        const FACES: [[u8; 2]; 3] = [[5, 3], [2, 4], [0, 1]];
        let [cx, cy, cz] = self.cells;
        let wanted = if end { self.cells[axis] - 1 } else { 0 };
        let all = triples([cz, cy, cx]).map(|(k, j, i)| [i, j, k]).filter(|place| place[axis] == wanted);
        let face = FACES[axis][usize::from(end)];
        all.map(|[i, j, k]| Face { cell: ((k * cy + j) * cx + i) as u32, face }).collect()
    }

    /// Shares of a uniform load on the nodes of a face of constant parameter `axis`, in the order of [`Self::face`]:
    /// exact where the face is a parallelogram with evenly spaced nodes. They sum to 1.
    #[must_use]
    pub fn face_shares(self, axis: usize) -> Vec<f64> {
        let n = self.nodes();
        let weights: Vec<Vec<f64>> = (0..3).map(|d| if d == axis { vec![1.0] } else { self.line_shares(d) }).collect();
        let index = |d: usize, i: usize| if d == axis { 0 } else { i };
        let all = triples([n[2], n[1], n[0]]).map(|(k, j, i)| [i, j, k]);
        all.filter(|place| place[axis] == 0).map(|p| (0..3).map(|d| weights[d][index(d, p[d])]).product()).collect()
    }

    /// Integrals of the shape functions along a line of unit length.
    fn line_shares(self, d: usize) -> Vec<f64> {
        let mut shares = vec![0.0; self.nodes()[d]];
        let (order, count) = (self.order(), self.cells[d]);
        let rule: &[f64] = if order == 1 { &[0.5, 0.5] } else { &[1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0] };
        for cell in 0..count {
            for (a, w) in rule.iter().enumerate() {
                shares[cell * order + a] += w / count as f64;
            }
        }
        shares
    }
}

fn triples([a, b, c]: [usize; 3]) -> impl Iterator<Item = (usize, usize, usize)> {
    (0..a).flat_map(move |i| (0..b).flat_map(move |j| (0..c).map(move |k| (i, j, k))))
}

/// The unit cube of seven distorted bricks of MacNeal and Harder (Finite Elements in Analysis and Design 1 (1985) 3);
/// nodes 0 to 7 are its corners.
#[must_use]
pub fn patch_cube() -> Mesh {
    const INNER: [[f64; 3]; 8] = [
        [0.249, 0.342, 0.192],
        [0.826, 0.288, 0.288],
        [0.850, 0.649, 0.263],
        [0.273, 0.750, 0.230],
        [0.320, 0.186, 0.643],
        [0.677, 0.305, 0.683],
        [0.788, 0.693, 0.644],
        [0.165, 0.745, 0.702],
    ];
    const CELLS: [[u32; 8]; 7] = [
        [9, 10, 11, 12, 13, 14, 15, 16],
        [1, 2, 3, 4, 9, 10, 11, 12],
        [13, 14, 15, 16, 5, 6, 7, 8],
        [1, 2, 10, 9, 5, 6, 14, 13],
        [2, 3, 11, 10, 6, 7, 15, 14],
        [3, 4, 12, 11, 7, 8, 16, 15],
        [4, 1, 9, 12, 8, 5, 13, 16],
    ];
    let corners = Hex8::NODES.map(|xi| xi.map(|x| 0.5 * (x + 1.0)));
    let points = corners.into_iter().chain(INNER).map(Vector3::from).collect();
    Mesh::new(CellKind::Hex8, points, CELLS.iter().flatten().map(|n| n - 1).collect())
}

/// The same bricks with 27 nodes: the new ones in the middle of edges, faces and bricks.
#[must_use]
pub fn elevated(mesh: &Mesh) -> Mesh {
    let mut points = mesh.points.clone();
    let mut known: BTreeMap<Vec<u32>, u32> = BTreeMap::new();
    let mut cells = Vec::with_capacity(27 * mesh.cell_count());
    for e in 0..mesh.cell_count() {
        let (corners, x) = (mesh.cell(e), mesh.cell_points::<8>(e).unwrap());
        for xi in Hex27::NODES {
            let shape = Hex8::shape(xi);
            let mut key: Vec<u32> = (0..8).filter(|&a| shape[a] > 0.0).map(|a| corners[a]).collect();
            key.sort_unstable();
            if let [corner] = key[..] {
                cells.push(corner);
                continue;
            }
            cells.push(*known.entry(key).or_insert_with(|| {
                points.push(x.iter().zip(shape).map(|(p, n)| p * n).sum());
                points.len() as u32 - 1
            }));
        }
    }
    Mesh::new(CellKind::Hex27, points, cells)
}

/// 27-node bricks without the nodes in the middle of their faces and of themselves, as 20-node bricks of `kind`.
#[must_use]
pub fn serendipity(mesh: &Mesh, kind: CellKind) -> Mesh {
    let cells = mesh.cells.chunks_exact(27).flat_map(|cell| cell[..20].to_vec()).collect();
    let mut out = Mesh { node_sets: mesh.node_sets.clone(), ..Mesh::new(kind, mesh.points.clone(), cells) };
    out.drop_unused_points();
    out
}

/// The same mesh with its nodes numbered from the last to the first: new index of node n is `count - 1 - n`.
#[must_use]
pub fn renumbered(mesh: &Mesh) -> Mesh {
    let last = mesh.point_count() as u32 - 1;
    let points = mesh.points.iter().rev().copied().collect();
    Mesh::new(mesh.kind, points, mesh.cells.iter().map(|n| last - n).collect())
}

/// The same bricks, each seen from another side: the natural axes of brick e are turned in one of three ways.
#[must_use]
pub fn rotated_connectivity(mesh: &Mesh) -> Mesh {
    let turn = |e: usize, [x, y, z]: [f64; 3]| match e % 3 {
        0 => [y, z, x],
        1 => [-y, x, z],
        _ => [x, -y, -z],
    };
    let mut cells = Vec::with_capacity(mesh.cells.len());
    for e in 0..mesh.cell_count() {
        let nodes = natural_nodes(mesh.kind);
        let find = |xi: [f64; 3]| nodes.iter().position(|n| *n == xi).unwrap();
        // Adding 0.0 turns -0.0 into 0.0: equal anyway, but clear.
        cells.extend(nodes.iter().map(|xi| mesh.cell(e)[find(turn(e, *xi).map(|v| v + 0.0))]));
    }
    Mesh::new(mesh.kind, mesh.points.clone(), cells)
}

fn natural_nodes(kind: CellKind) -> Vec<[f64; 3]> {
    // Bricks of 8 and of 20 nodes have the first of those of 27.
    Hex27::NODES[..kind.nodes()].to_vec()
}
