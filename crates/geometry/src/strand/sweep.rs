//! Sweeping a section along the axis: nodes level by level, cells layer by layer.

use super::{Strand, sets};
use crate::hexahedron::LATTICE as HEX_LATTICE;
use crate::quadrilateral::LATTICE as QUAD_LATTICE;
use crate::{CellKind, Face, Mesh, SectionMesh};
use nalgebra::Vector3;

/// The face of a swept outer cell that lies on the surface: nodes 1, 2, 6, 5 (S4).
const OUTER_FACE: u8 = 3;

/// The mesh with its sets, and which of the [`points`] its nodes are: bricks of 20 nodes have none in the middle of their
/// faces and of themselves.
pub(super) fn sweep(strand: &Strand, section: &SectionMesh) -> (Mesh, Vec<u32>) {
    let mut mesh = Mesh::new(strand.kind, points(strand, section), cells(strand, section));
    let (size, top) = (section.points.len() as u32, (levels(strand) - 1) as u32);
    let on_level = |level: u32| (level * size..(level + 1) * size).collect::<Vec<u32>>();
    let along = |nodes: &[u32]| (0..=top).flat_map(|l| nodes.iter().map(move |n| l * size + n)).collect::<Vec<u32>>();
    let node_sets = [
        (sets::END_A, on_level(0)),
        (sets::END_B, on_level(top)),
        (sets::SURFACE_NODES, along(&section.outer)),
        (sets::AXIS, along(&[section.centre])),
    ];
    mesh.node_sets = node_sets.into_iter().map(|(name, nodes)| (name.to_owned(), nodes)).collect();
    mesh.element_sets.insert(sets::STRAND.to_owned(), (0..mesh.cell_count() as u32).collect());
    mesh.surfaces.insert(sets::LATERAL.to_owned(), lateral(strand, section));
    let kept = mesh.drop_unused_points();
    mesh.point_labels = (1..=kept.len() as u64).collect();
    (mesh, kept)
}

/// Positions of all nodes that bricks may have.
pub(super) fn points(strand: &Strand, section: &SectionMesh) -> Vec<Vector3<f64>> {
    let (low, high) = strand.span();
    let (last, rate) = (levels(strand) - 1, strand.line_rate());
    let mut points = Vec::with_capacity((last + 1) * section.points.len());
    for level in 0..=last {
        // Both ends exact, and the middle level of a strand about the origin exactly at s = 0.
        let s = (low * (last - level) as f64 + high * level as f64) / last as f64;
        points.extend(section.points.iter().map(|local| strand.axis.place(s, local, rate, strand.ends)));
    }
    points
}

fn levels(strand: &Strand) -> usize {
    strand.kind.order() * strand.layers + 1
}

fn cells(strand: &Strand, section: &SectionMesh) -> Vec<u32> {
    let size = section.points.len() as u32;
    let order = strand.kind.order() as u32;
    let local = local_nodes(strand.kind);
    let mut cells = Vec::with_capacity(strand.cell_count() * strand.kind.nodes());
    for layer in 0..strand.layers as u32 {
        for quad in section.cells.chunks_exact(section.nodes_per_cell) {
            cells.extend(local.iter().map(|&(node, level)| (layer * order + level) * size + quad[node]));
        }
    }
    cells
}

/// For every node of the hexahedron: the node of the quadrilateral and the level above the bottom of the layer.
fn local_nodes(kind: CellKind) -> Vec<(usize, u32)> {
    let order = kind.order();
    let node = |ij: [usize; 2]| QUAD_LATTICE.iter().position(|&place| place == ij).unwrap_or(0);
    HEX_LATTICE.iter().take(kind.nodes()).map(|&[i, j, k]| (node([i, j]), (k * order / 2) as u32)).collect()
}

fn lateral(strand: &Strand, section: &SectionMesh) -> Vec<Face> {
    let per_layer = section.cell_count() as u32;
    let layer_faces = |layer: u32| section.outer_cells.iter().map(move |c| layer * per_layer + c);
    (0..strand.layers as u32).flat_map(layer_faces).map(|cell| Face { cell, face: OUTER_FACE }).collect()
}
