//! Faces and their neighbours as grids of control points.

use std::collections::HashMap;

use crate::ContactError;
use crate::patch::{PATCH_NODES, PatchKind, Stencil};

/// Patch and edge beyond each of the four edges of a patch.
pub(super) type Beyond = [Option<(u32, u8)>; 4];

/// Corners of a patch: edge `e` runs from corner `e` to the next.
pub(super) type Quad = [u32; 4];

/// Four quadrilaterals of every nine-node face.
pub(super) fn quarters(lists: &[Vec<u32>]) -> Vec<(Quad, u32)> {
    const PARTS: [[usize; 4]; 4] = [[0, 4, 8, 7], [4, 1, 5, 8], [8, 5, 2, 6], [7, 8, 6, 3]];
    lists.iter().zip(0..).flat_map(|(l, f)| PARTS.iter().map(move |p| (p.map(|k| l[k]), f))).collect()
}

/// Patch and edge beyond every edge.
pub(super) fn neighbours(quads: &[Quad]) -> Result<Vec<Beyond>, ContactError> {
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
pub(super) fn valences(quads: &[Quad], neighbours: &[Beyond]) -> HashMap<u32, (u32, bool)> {
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
pub(super) fn control_grid(
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
pub(super) fn stencil(grid: &[Combination]) -> (PatchKind, Vec<u32>) {
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
