//! One mesh of all strands of a rope.

use super::{Rope, RopeFibres, RopeShape, sets};
use crate::strand::sets as strand_sets;
use crate::{CellKind, Face, GeometryError, Mesh, Strand, StrandAxis, SurfaceGrid, fibre_frames};
use nalgebra::Matrix3;

/// The mesh of a rope with what belongs to it, in its numbering.
#[derive(Debug, Clone, PartialEq)]
pub struct RopeMesh {
    /// All strands, their nodes and cells one after the other; sets as told in [`sets`].
    pub mesh: Mesh,
    /// Zero-based index of the strand of every cell.
    pub strand_of_cell: Vec<u32>,
    /// The strands: outer ones first, then the core.
    pub strands: Vec<Strand>,
    /// The surface nodes of every strand.
    pub surfaces: Vec<SurfaceGrid>,
    /// The yarns.
    pub fibres: RopeFibres,
    /// Helix radius, lay and gaps.
    pub shape: RopeShape,
}

impl RopeMesh {
    /// Fibre frames at every integration point, cell after cell, as [`fibre_frames`].
    ///
    /// # Errors
    /// The errors of the fields of the strands.
    pub fn frames(&self) -> Result<Vec<Matrix3<f64>>, GeometryError> {
        fibre_frames(&self.mesh, &self.fibres)
    }
}

impl Rope {
    /// The mesh.
    ///
    /// # Errors
    /// As [`Rope::shape`] and [`Strand::mesh`]; [`GeometryError::TooLarge`].
    pub fn mesh(&self) -> Result<RopeMesh, GeometryError> {
        let shape = self.shape()?;
        let strands = self.strands_of(&shape)?;
        let (mesh, surfaces) = join(&strands, |strand| self.strand_mesh(strand, &shape))?;
        let fibres = RopeFibres::new(&strands);
        let strand_of_cell = (0..mesh.cell_count()).map(|cell| fibres.strand(cell) as u32).collect();
        Ok(RopeMesh { mesh, strand_of_cell, strands, surfaces, fibres, shape })
    }

    /// The mesh of a strand, outer ones flattened where the rope is compacted.
    pub(super) fn strand_mesh(&self, strand: &Strand, shape: &RopeShape) -> Result<Mesh, GeometryError> {
        match strand.axis {
            StrandAxis::Helix(_) if shape.compaction > 0.0 => {
                strand.mesh_of(self.flattened(strand, shape.helix_radius, shape.lay, shape.compaction)?)
            }
            _ => strand.mesh(),
        }
    }
}

/// One mesh of any strands, equal or not, with the sets of a rope, and their surface nodes; [`RopeFibres::new`] of the
/// same strands is its fibre field.
///
/// # Errors
/// As [`Strand::mesh`]; [`GeometryError::TooLarge`]; [`GeometryError::KindsDiffer`] when the strands are not all meshed
/// with one kind of cell.
pub fn join_strands(strands: &[Strand]) -> Result<(Mesh, Vec<SurfaceGrid>), GeometryError> {
    join(strands, Strand::mesh)
}

pub(super) fn join(
    strands: &[Strand],
    part: impl Fn(&Strand) -> Result<Mesh, GeometryError>,
) -> Result<(Mesh, Vec<SurfaceGrid>), GeometryError> {
    let kind = strands.first().map_or(CellKind::Hex8, |strand| strand.kind);
    let mut mesh = Mesh::new(kind, Vec::new(), Vec::new());
    let mut surfaces = Vec::with_capacity(strands.len());
    for (i, strand) in strands.iter().enumerate() {
        if strand.kind != kind {
            return Err(GeometryError::KindsDiffer { strand: i + 1 });
        }
        surfaces.push(strand.surface_grid().shifted(mesh.point_count() as u32));
        append(&mut mesh, part(strand)?, i)?;
    }
    mesh.point_labels = (1..=mesh.point_count() as u64).collect();
    mesh.cell_labels = (1..=mesh.cell_count() as u64).collect();
    mesh.node_sets.insert(sets::ALL.to_owned(), (0..mesh.point_count() as u32).collect());
    mesh.element_sets.insert(sets::ALL.to_owned(), (0..mesh.cell_count() as u32).collect());
    Ok((mesh, surfaces))
}

/// Adds the mesh of the strand of index `strand` with its sets; its ends also join the ends of the rope.
fn append(mesh: &mut Mesh, part: Mesh, strand: usize) -> Result<(), GeometryError> {
    let (points, cells) = (mesh.point_count() + part.point_count(), mesh.cell_count() + part.cell_count());
    if points > u32::MAX as usize {
        return Err(GeometryError::TooLarge { points: points as u128, cells: cells as u128 });
    }
    let (first_point, first_cell) = (mesh.point_count() as u32, mesh.cell_count() as u32);
    for (name, nodes) in part.node_sets {
        let nodes: Vec<u32> = nodes.iter().map(|node| node + first_point).collect();
        if [strand_sets::END_A, strand_sets::END_B].contains(&name.as_str()) {
            mesh.node_sets.entry(name.clone()).or_default().extend(&nodes);
        }
        mesh.node_sets.insert(sets::of_strand(&name, strand), nodes);
    }
    for (name, members) in part.element_sets {
        let members = members.iter().map(|cell| cell + first_cell).collect();
        mesh.element_sets.insert(sets::of_strand(&name, strand), members);
    }
    for (name, faces) in part.surfaces {
        let faces = faces.iter().map(|face| Face { cell: face.cell + first_cell, ..*face }).collect();
        mesh.surfaces.insert(sets::of_strand(&name, strand), faces);
    }
    mesh.points.extend(part.points);
    mesh.cells.extend(part.cells.iter().map(|node| node + first_point));
    Ok(())
}
