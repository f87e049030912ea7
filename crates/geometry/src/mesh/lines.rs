//! Lines of nodes along the third direction of bricks, which in a swept mesh run from end to end.

use super::{CellKind, Mesh};
use crate::hexahedron::LATTICE;

/// Lines of nodes along the third natural direction of the bricks of a mesh, and the neighbours of nodes across them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NodeLines {
    /// Nodes of every line from its low to its high end, lines by the index of their first node.
    pub lines: Vec<Vec<u32>>,
    /// Of every node of the mesh, those next to it in the first and second direction, ascending.
    pub across: Vec<Vec<u32>>,
}

impl Mesh {
    /// The lines of nodes along the third natural direction of the bricks: along the axis of a swept strand, or along
    /// its yarns where mesh lines follow those. Every node is in one line; bricks of 20 nodes have lines of two
    /// densities, along edges with the nodes in their middle and between the middles of edges without.
    ///
    /// `None` where bricks do not continue each other: a node has two successors, or is one of two nodes.
    ///
    /// # Panics
    /// When a cell refers to a node that does not exist; see [`Mesh::validate`].
    #[must_use]
    pub fn node_lines(&self) -> Option<NodeLines> {
        let mut next: Vec<Option<u32>> = vec![None; self.point_count()];
        let mut is_first = vec![true; self.point_count()];
        let mut across: Vec<Vec<u32>> = vec![Vec::new(); self.point_count()];
        let (up, sideways) = (steps(self.kind, 2), [steps(self.kind, 0), steps(self.kind, 1)].concat());
        for cell in self.cells.chunks_exact(self.kind.nodes()) {
            for &(a, b) in &up {
                let (low, high) = (cell[a], cell[b]);
                if next[low as usize].is_none() {
                    next[low as usize] = Some(high);
                    // The end of another line cannot be that of this one.
                    std::mem::replace(&mut is_first[high as usize], false).then_some(())?;
                } else if next[low as usize] != Some(high) {
                    return None;
                }
            }
            for &(a, b) in &sideways {
                across[cell[a] as usize].push(cell[b]);
                across[cell[b] as usize].push(cell[a]);
            }
        }
        across.iter_mut().for_each(sort_without_repeats);
        let firsts = (0_u32..).zip(&is_first).filter(|(_, first)| **first).map(|(node, _)| node);
        let line = |first| std::iter::successors(Some(first), |&node| next[node as usize]).collect();
        Some(NodeLines { lines: firsts.map(line).collect(), across })
    }
}

fn sort_without_repeats(nodes: &mut Vec<u32>) {
    nodes.sort_unstable();
    nodes.dedup();
}

/// Pairs of local nodes of which the second is the next one along a natural direction.
fn steps(kind: CellKind, direction: usize) -> Vec<(usize, usize)> {
    let places = &LATTICE[..kind.nodes()];
    let beyond = |a: [usize; 3], b: [usize; 3]| (0..3).all(|k| if k == direction { b[k] > a[k] } else { b[k] == a[k] });
    let next = |a: usize| {
        let candidates = (0..places.len()).filter(|&b| beyond(places[a], places[b]));
        Some((a, candidates.min_by_key(|&b| places[b][direction])?))
    };
    (0..places.len()).filter_map(next).collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use super::*;
    use crate::{MeshLines, Strand};

    fn strand(kind: CellKind) -> Mesh {
        Strand { kind, layers: 3, lines: MeshLines::Yarns, ..Strand::default() }.mesh().unwrap()
    }

    #[test]
    fn every_node_is_in_one_line_that_rises_and_keeps_its_radius() {
        for kind in [CellKind::Hex8, CellKind::Hex20, CellKind::Hex27] {
            let mesh = strand(kind);
            let lines = mesh.node_lines().unwrap().lines;
            assert_eq!(lines.iter().map(Vec::len).sum::<usize>(), mesh.point_count(), "{kind:?}");
            for line in &lines {
                let radius = |node: u32| mesh.points[node as usize].xy().norm();
                for pair in line.windows(2) {
                    assert!(mesh.points[pair[1] as usize].z > mesh.points[pair[0] as usize].z);
                    assert!((radius(pair[1]) - radius(pair[0])).abs() < 1e-12);
                }
                let (first, last) = (mesh.points[line[0] as usize].z, mesh.points[line[line.len() - 1] as usize].z);
                assert!((last - first - 60.0).abs() < 1e-12, "from end to end");
            }
        }
    }

    #[test]
    fn neighbours_across_lie_in_the_section() {
        for kind in [CellKind::Hex8, CellKind::Hex20, CellKind::Hex27] {
            let mesh = strand(kind);
            for (node, beside) in mesh.node_lines().unwrap().across.iter().enumerate() {
                assert!(beside.len() >= 2, "{kind:?}");
                assert!(beside.iter().all(|&b| (mesh.points[b as usize].z - mesh.points[node].z).abs() < 1e-12));
            }
        }
    }

    #[test]
    fn bricks_that_do_not_continue_each_other_have_no_lines() {
        let mut mesh = strand(CellKind::Hex8);
        // Two bricks on one: both would continue its lines.
        let (below, above) = (mesh.cells[..8].to_vec(), mesh.cells[48 * 8..49 * 8].to_vec());
        mesh.cells =
            [below.clone(), above.clone(), [below[4..].to_vec(), above[..4].iter().map(|n| n + 1).collect()].concat()]
                .concat();
        assert!(mesh.node_lines().is_none());
    }
}
