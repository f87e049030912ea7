//! Connectivity by index, inner nodes of 27-node bricks, nodes without an element.

use crate::deck::error::DeckErrorKind;
use crate::deck::raw::Raw;
use crate::deck::source::Fault;
use nalgebra::Vector3;
use subrope_geometry::CellKind;

/// Flat connectivity in VTK node order; indices count the nodes as written.
pub(super) fn connectivity(raw: &Raw, kind: CellKind) -> Result<Vec<u32>, Fault> {
    let mut cells = Vec::with_capacity(raw.elements.nodes.len());
    let table = &raw.elements.table;
    for ((nodes, &element), &at) in raw.elements.nodes.chunks_exact(kind.nodes()).zip(&table.labels).zip(&table.at) {
        let begin = cells.len();
        for &label in nodes {
            let index = raw.nodes.table.find(label);
            cells.push(index.ok_or_else(|| Fault::new(at, DeckErrorKind::UndefinedNode { label }))?);
        }
        if kind == CellKind::Hex27 && !sort_inner(&mut cells[begin..], &raw.nodes.points) {
            return Err(Fault::new(at, DeckErrorKind::InnerNodes { element }));
        }
    }
    Ok(cells)
}

/// Corners of the faces whose centres are nodes 20 to 25 in VTK order: -xi, +xi, -eta, +eta, -zeta, +zeta.
const FACE_CORNERS: [[usize; 4]; 6] =
    [[0, 3, 7, 4], [1, 2, 6, 5], [0, 1, 5, 4], [3, 2, 6, 7], [0, 1, 2, 3], [4, 5, 6, 7]];

/// Puts the seven inner nodes into VTK order by position: each belongs to the nearest of the expected places.
///
/// Codes disagree on the order of nodes 21 to 27 of this element (centre first or last, faces by label or by axis),
/// and the places lie half an edge apart, so that position tells them safely. Returns whether every place found
/// exactly one node.
fn sort_inner(cell: &mut [u32], points: &[Vector3<f64>]) -> bool {
    let at = |i: usize| points[cell[i] as usize];
    let mean = |corners: &[usize]| corners.iter().map(|&i| at(i)).sum::<Vector3<f64>>() / corners.len() as f64;
    let mut places = [Vector3::zeros(); 7];
    for (place, corners) in places.iter_mut().zip(&FACE_CORNERS) {
        *place = mean(corners);
    }
    places[6] = mean(&[0, 1, 2, 3, 4, 5, 6, 7]);
    let mut sorted = [None; 7];
    for &node in &cell[20..] {
        let distance = |i: usize| (places[i] - points[node as usize]).norm_squared();
        let nearest = (0..7).min_by(|&i, &j| distance(i).total_cmp(&distance(j))).unwrap_or(0);
        if sorted[nearest].replace(node).is_some() {
            return false;
        }
    }
    for (slot, node) in cell[20..].iter_mut().zip(sorted) {
        let Some(node) = node else { return false };
        *slot = node;
    }
    true
}

/// The nodes that elements use, numbered anew in the order of the deck.
pub(super) struct Compaction {
    new: Vec<Option<u32>>,
}

impl Compaction {
    pub fn new(nodes: usize, cells: &[u32]) -> Self {
        let mut used = vec![false; nodes];
        for &node in cells {
            used[node as usize] = true;
        }
        let mut next = 0;
        let number = |used: bool| {
            used.then(|| {
                next += 1;
                next - 1
            })
        };
        Self { new: used.into_iter().map(number).collect() }
    }

    /// New index of a node as written, when it is used.
    pub fn new_index(&self, node: u32) -> Option<u32> {
        self.new.get(node as usize).copied().flatten()
    }

    /// The entries of used nodes.
    pub fn keep<T: Copy>(&self, all: &[T]) -> Vec<T> {
        all.iter().zip(&self.new).filter(|(_, new)| new.is_some()).map(|(&x, _)| x).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use subrope_geometry::{Hex27, Hexahedron};

    #[test]
    fn inner_nodes_are_found_by_position() {
        let points: Vec<Vector3<f64>> = Hex27::NODES.iter().map(|&x| Vector3::from(x) + Vector3::repeat(7.0)).collect();
        let expected: Vec<u32> = (0..27).collect();
        // The centre first and the faces by label; then everything reversed.
        let mut cell: Vec<u32> = (0..20).chain([26, 24, 25, 22, 21, 23, 20]).collect();
        assert!(sort_inner(&mut cell, &points));
        assert_eq!(cell, expected);
        let mut cell: Vec<u32> = (0..20).chain((20..27).rev()).collect();
        assert!(sort_inner(&mut cell, &points));
        assert_eq!(cell, expected);
    }

    #[test]
    fn inner_nodes_elsewhere_are_refused() {
        let mut points: Vec<Vector3<f64>> = Hex27::NODES.iter().map(|&x| Vector3::from(x)).collect();
        points[21] = points[20];
        assert!(!sort_inner(&mut (0..27).collect::<Vec<u32>>(), &points));
    }
}
