//! What each strand of a rope carries, stores and loses.

use nalgebra::Vector3;
use serde::Serialize;
use subrope_fem::analysis::Analysis;
use subrope_geometry::{rope, strand};

use crate::model::MeshModel;

/// One strand of a rope.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct StrandSummary {
    /// Force along z at the high end \[N\].
    pub force_n: f64,
    /// Its part of the forces of all strands \[-\]; zero where those cancel.
    pub share_of_force: f64,
    /// Moment about z at the high end, about the middle of the rope's section there \[N mm\].
    pub torque_n_mm: f64,
    /// Stored \[mJ\].
    pub stored_mj: f64,
    /// Dissipated by transverse sliding, end values as in the fields \[mJ\].
    pub dissipated_transverse_mj: f64,
    /// Dissipated by longitudinal sliding, end values as in the fields \[mJ\].
    pub dissipated_longitudinal_mj: f64,
    /// Mid-point values, as in the balance \[mJ\].
    pub dissipated_transverse_midpoint_mj: f64,
    /// Mid-point values, as in the balance \[mJ\].
    pub dissipated_longitudinal_midpoint_mj: f64,
}

/// Part of the sum of magnitudes up to which the sum of forces counts as nothing.
const CANCELLED: f64 = 1e-6;

/// All strands of a rope at the committed state, the core last; empty without a rope.
#[must_use]
pub fn strands(mesh: &MeshModel, analysis: &Analysis) -> Vec<StrandSummary> {
    let Some(shape) = &mesh.rope else { return Vec::new() };
    let mut out = vec![StrandSummary::default(); shape.strands.len()];
    match mesh.slice {
        Some(slice) => share_alike(slice.strands, analysis, &mut out),
        None => add_forces(mesh, analysis, &mut out),
    }
    let Some(solid) = analysis.model().contributions.iter().find_map(|c| c.fields()) else { return out };
    for (element, &index) in shape.strand_of_cell.iter().enumerate() {
        let strand = &mut out[index as usize];
        let (energies, dissipated) = (solid.element_energies(element), solid.element_dissipation(element));
        strand.stored_mj += energies.stored;
        strand.dissipated_transverse_mj += dissipated[0];
        strand.dissipated_longitudinal_mj += dissipated[1];
        strand.dissipated_transverse_midpoint_mj += energies.dissipated_mid[0];
        strand.dissipated_longitudinal_midpoint_mj += energies.dissipated_mid[1];
    }
    out.iter_mut().for_each(|strand| strand.lengthen(mesh.layers_per_strand()));
    out
}

impl StrandSummary {
    /// From a layer of a slice to the length of the rope.
    fn lengthen(&mut self, layers: f64) {
        for energy in [
            &mut self.stored_mj,
            &mut self.dissipated_transverse_mj,
            &mut self.dissipated_longitudinal_mj,
            &mut self.dissipated_transverse_midpoint_mj,
            &mut self.dissipated_longitudinal_midpoint_mj,
        ] {
            *energy *= layers;
        }
    }
}

/// Equal strands have equal shares; they have no end about whose middle a strand could turn its own.
fn share_alike(strands: usize, analysis: &Analysis, out: &mut [StrandSummary]) {
    let (force, moment) = analysis.point_reaction(0);
    let share = 1.0 / strands as f64;
    for strand in out {
        (strand.force_n, strand.torque_n_mm) = (share * force.z, share * moment.z);
        strand.share_of_force = if force.z == 0.0 { 0.0 } else { share };
    }
}

fn add_forces(mesh: &MeshModel, analysis: &Analysis, out: &mut [StrandSummary]) {
    let (reactions, displacement) = (analysis.nodal_reactions(), analysis.displacement());
    let vector = |of: &[f64], n: u32| Vector3::from_column_slice(&of[3 * n as usize..3 * n as usize + 3]);
    let place = |n: u32| mesh.mesh.points[n as usize] + vector(displacement, n);
    let set = |name: &str| mesh.mesh.node_sets.get(name).map_or(&[][..], Vec::as_slice);
    let end = set(strand::sets::END_B);
    let middle = end.iter().map(|&n| place(n)).sum::<Vector3<f64>>() / end.len().max(1) as f64;
    for (index, strand) in out.iter_mut().enumerate() {
        for &node in set(&rope::sets::of_strand(strand::sets::END_B, index)) {
            let force = vector(&reactions, node);
            strand.force_n += force.z;
            strand.torque_n_mm += (place(node) - middle).cross(&force).z;
        }
    }
    let all: f64 = out.iter().map(|s| s.force_n).sum();
    // Forces that cancel have no shares.
    if all.abs() > CANCELLED * out.iter().map(|s| s.force_n.abs()).sum::<f64>() {
        out.iter_mut().for_each(|s| s.share_of_force = s.force_n / all);
    }
}
