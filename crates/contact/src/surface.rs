//! Surfaces of patches: facets as meshed, smooth splines through the same nodes, and rigid planes and cylinders.

use std::collections::HashMap;

use nalgebra::Vector3;
use subrope_geometry::{CellKind, Face, Mesh};

use crate::ContactError;
use crate::patch::{PATCH_NODES, PatchKind, Shape, Stencil};

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

/// Patch and edge beyond each of the four edges of a patch.
type Beyond = [Option<(u32, u8)>; 4];

/// Corners of a patch: edge `e` runs from corner `e` to the next.
type Quad = [u32; 4];

impl Surface {
    /// A surface of faces of a mesh.
    ///
    /// # Errors
    /// [`ContactError::NoFace`] when a face does not exist; [`ContactError::Branching`] when three faces share an edge;
    /// [`ContactError::Irregular`] when a spline meets an inner node where not four faces meet.
    pub fn new(mesh: &Mesh, faces: &[Face], smoothing: Smoothing) -> Result<Self, ContactError> {
        let mut lists = Vec::with_capacity(faces.len());
        for face in faces {
            let nodes = mesh.face_nodes(*face).ok_or(ContactError::NoFace { cell: face.cell, face: face.face })?;
            lists.push(nodes.collect::<Vec<u32>>());
        }
        match (smoothing, mesh.kind) {
            (Smoothing::None, kind) => Self::facets(&lists, kind),
            (Smoothing::Spline, CellKind::Hex8) => {
                let quads: Vec<(Quad, u32)> =
                    lists.iter().zip(0..).map(|(l, f)| ([l[0], l[1], l[2], l[3]], f)).collect();
                Self::spline(&quads)
            }
            (Smoothing::Spline, CellKind::Hex27) => Self::spline(&quarters(&lists)),
        }
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

    /// Index, in the list given to [`Surface::new`], of the face that a patch belongs to.
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

/// Four quadrilaterals of every nine-node face.
fn quarters(lists: &[Vec<u32>]) -> Vec<(Quad, u32)> {
    const PARTS: [[usize; 4]; 4] = [[0, 4, 8, 7], [4, 1, 5, 8], [8, 5, 2, 6], [7, 8, 6, 3]];
    lists.iter().zip(0..).flat_map(|(l, f)| PARTS.iter().map(move |p| (p.map(|k| l[k]), f))).collect()
}

/// Patch and edge beyond every edge.
fn neighbours(quads: &[Quad]) -> Result<Vec<Beyond>, ContactError> {
    let mut edges: HashMap<(u32, u32), (u32, u8)> = HashMap::with_capacity(4 * quads.len());
    for (quad, patch) in quads.iter().zip(0_u32..) {
        for e in 0..4_u8 {
            let (a, b) = edge_of(quad, e);
            if edges.insert((a, b), (patch, e)).is_some() {
                return Err(ContactError::Branching { nodes: [a, b] });
            }
        }
    }
    let beyond = |quad: &Quad, e: u8| {
        let (a, b) = edge_of(quad, e);
        edges.get(&(b, a)).copied()
    };
    Ok(quads.iter().map(|q| std::array::from_fn(|e| beyond(q, e as u8))).collect())
}

fn edge_of(quad: &Quad, e: u8) -> (u32, u32) {
    (quad[e as usize], quad[(e as usize + 1) % 4])
}

/// Faces at every node, and whether it lies at the edge of the surface.
fn valences(quads: &[Quad], neighbours: &[Beyond]) -> HashMap<u32, (u32, bool)> {
    let mut out: HashMap<u32, (u32, bool)> = HashMap::new();
    for (quad, beyond) in quads.iter().zip(neighbours) {
        for e in 0..4 {
            out.entry(quad[e]).or_default().0 += 1;
            if beyond[e].is_none() {
                out.entry(quad[e]).or_default().1 = true;
                out.entry(quad[(e + 1) % 4]).or_default().1 = true;
            }
        }
    }
    out
}

/// A control point as a combination of nodes.
type Combination = Vec<(u32, f64)>;

/// The sixteen control points of a patch, first coordinate fastest; those beyond an edge of the surface continue
/// linearly.
fn control_grid(
    patch: usize,
    quads: &[Quad],
    neighbours: &[Beyond],
    valence: &HashMap<u32, (u32, bool)>,
) -> Result<Vec<Combination>, ContactError> {
    let quad = &quads[patch];
    for node in quad {
        let (count, edge) = valence.get(node).copied().unwrap_or_default();
        if (edge && count > 2) || (!edge && count != 4) {
            return Err(ContactError::Irregular { node: *node, faces: count });
        }
    }
    let mut grid: Vec<Option<Combination>> = vec![None; 16];
    let inner = [[1, 1], [2, 1], [2, 2], [1, 2]];
    for (place, node) in inner.iter().zip(quad) {
        grid[place[0] + 4 * place[1]] = Some(vec![(*node, 1.0)]);
    }
    for e in 0..4 {
        let Some((beyond, entry)) = neighbours[patch][e] else { continue };
        let other = &quads[beyond as usize];
        let entry = entry as usize;
        // Beyond corner e stands the end of the entry edge's successor, beyond corner e + 1 the start of its predecessor.
        let at_first = other[(entry + 2) % 4];
        let at_second = other[(entry + 3) % 4];
        let (first, second) = (outward(inner[e], e), outward(inner[(e + 1) % 4], e));
        grid[first[0] + 4 * first[1]] = Some(vec![(at_first, 1.0)]);
        grid[second[0] + 4 * second[1]] = Some(vec![(at_second, 1.0)]);
        // The face across the corner e: across the edge of `other` that leaves from corner e.
        if let Some((diagonal, back)) = neighbours[beyond as usize][(entry + 1) % 4] {
            let far = quads[diagonal as usize][(back as usize + 3) % 4];
            let corner = outward(first, (e + 3) % 4);
            grid[corner[0] + 4 * corner[1]] = Some(vec![(far, 1.0)]);
        }
    }
    continue_linearly(&mut grid);
    Ok(grid.into_iter().map(Option::unwrap_or_default).collect())
}

/// The place one step beyond an edge.
fn outward([i, j]: [usize; 2], edge: usize) -> [usize; 2] {
    match edge {
        0 => [i, j - 1],
        1 => [i + 1, j],
        2 => [i, j + 1],
        _ => [i - 1, j],
    }
}

/// Missing lines of control points: twice the nearest less the next, across the edge that has nothing beyond it. A corner
/// of which one line is there continues that line; where both are missing the order does not matter.
fn continue_linearly(grid: &mut [Option<Combination>]) {
    let fill = |grid: &mut [Option<Combination>], at: usize, near: usize, far: usize| {
        if grid[at].is_none()
            && let (Some(near), Some(far)) = (grid[near].clone(), grid[far].clone())
        {
            let scaled = |c: Combination, f: f64| c.into_iter().map(move |(n, w)| (n, f * w));
            grid[at] = Some(scaled(near, 2.0).chain(scaled(far, -1.0)).collect());
        }
    };
    // Lines that the faces beyond them have made: first and last row.
    for row in [0, 12] {
        fill(grid, row, row + 1, row + 2);
        fill(grid, row + 3, row + 2, row + 1);
    }
    for row in [4, 8] {
        fill(grid, row, row + 1, row + 2);
        fill(grid, row + 3, row + 2, row + 1);
    }
    for column in 0..4 {
        fill(grid, column, column + 4, column + 8);
        fill(grid, column + 12, column + 8, column + 4);
    }
}

/// Kind and nodes of a spline patch.
fn stencil(grid: &[Combination]) -> (PatchKind, Vec<u32>) {
    if grid.iter().all(|c| c.len() == 1) {
        return (PatchKind::Spline(None), grid.iter().map(|c| c[0].0).collect());
    }
    let mut nodes: Vec<u32> = Vec::with_capacity(PATCH_NODES);
    let mut weights = vec![[0.0; PATCH_NODES]; 16];
    for (row, combination) in weights.iter_mut().zip(grid) {
        for (node, w) in combination {
            let at = nodes.iter().position(|n| n == node).unwrap_or_else(|| {
                nodes.push(*node);
                nodes.len() - 1
            });
            row[at] += w;
        }
    }
    let count = nodes.len();
    (PatchKind::Spline(Some(Box::new(Stencil { weights, nodes: count }))), nodes)
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
