//! Columns of the history: one row per converged increment.

use subrope_fem::analysis::{Analysis, IncrementRecord};
use subrope_io::Column;

use super::strands;
use crate::contact;
use crate::model::{MeshModel, RopeModel};

const MOTIONS: [(&str, &str); 6] =
    [("ux", "mm"), ("uy", "mm"), ("uz", "mm"), ("rx", "rad"), ("ry", "rad"), ("rz", "rad")];
const REACTIONS: [(&str, &str); 6] =
    [("fx", "N"), ("fy", "N"), ("fz", "N"), ("mx", "N mm"), ("my", "N mm"), ("mz", "N mm")];

const HEAD: [(&str, &str); 5] =
    [("time", "s"), ("step", "-"), ("increment", "-"), ("step_fraction", "-"), ("increment_length", "-")];
const ENERGIES: [(&str, &str); 9] = [
    ("external_work", "mJ"),
    ("stored_energy", "mJ"),
    ("dissipated_transverse", "mJ"),
    ("dissipated_longitudinal", "mJ"),
    ("dissipated_transverse_midpoint", "mJ"),
    ("dissipated_longitudinal_midpoint", "mJ"),
    ("stabilising_work", "mJ"),
    ("energy_error", "-"),
    ("released_energy", "mJ"),
];
const COUNTS: [(&str, &str); 4] = [("iterations", "-"), ("cutbacks", "-"), ("residual", "-"), ("negative_pivots", "-")];

/// Per strand of a rope.
const STRAND: [(&str, &str); 6] = [
    ("fz", "N"),
    ("share", "-"),
    ("mz", "N mm"),
    ("stored_energy", "mJ"),
    ("dissipated_transverse", "mJ"),
    ("dissipated_longitudinal", "mJ"),
];

/// Energies that only contacts have.
const CONTACT_ENERGIES: [(&str, &str); 3] =
    [("contact_friction_work", "mJ"), ("contact_stored_energy", "mJ"), ("interference_work", "mJ")];
/// Per pair.
const CONTACT: [(&str, &str); 6] = [
    ("normal_force", "N"),
    ("friction_force", "N"),
    ("friction_work", "mJ"),
    ("area", "mm^2"),
    ("largest_penetration", "mm"),
    ("touching_points", "-"),
];

/// Headers, with units.
pub fn columns(model: &RopeModel) -> Vec<Column> {
    let analysis = &model.analysis;
    let mut out: Vec<Column> = HEAD.iter().map(|(n, u)| Column::new(*n, *u)).collect();
    for point in analysis.model().kinematics.points() {
        for (name, unit) in MOTIONS.iter().chain(&REACTIONS) {
            out.push(Column::new(format!("{}_{name}", point.name), *unit));
        }
        out.extend((1..=point.slides.len()).map(|i| Column::new(format!("{}_slide_{i}", point.name), "mm")));
    }
    out.extend(ENERGIES.iter().chain(&COUNTS).map(|(n, u)| Column::new(*n, *u)));
    for strand in 1..=model.mesh.rope.as_ref().map_or(0, |r| r.strands.len()) {
        out.extend(STRAND.map(|(n, u)| Column::new(format!("strand_{strand}_{n}"), u)));
    }
    if contact::is_any(analysis) {
        out.extend(CONTACT_ENERGIES.map(|(n, u)| Column::new(n, u)));
    }
    for pair in contact::summaries(&model.mesh, analysis) {
        out.extend(CONTACT.map(|(n, u)| Column::new(format!("{}_{n}", pair.name), u)));
    }
    out
}

/// The row of an increment. `cutbacks` counts since the row before. The sign of reactions: what acts on the model.
pub fn row(mesh: &MeshModel, analysis: &Analysis, record: &IncrementRecord, cutbacks: usize) -> Vec<f64> {
    let mut out =
        vec![analysis.time(), record.step_index as f64, record.increment as f64, record.fraction, record.length];
    let kinematics = &analysis.model().kinematics;
    for (index, point) in kinematics.points().iter().enumerate() {
        let (u, r) = kinematics.point_motion(index, analysis.coordinates());
        let (force, moment) = analysis.point_reaction(index);
        for vector in [u, r, force, moment] {
            out.extend_from_slice(vector.as_slice());
        }
        out.extend(point.slides.iter().map(|&c| analysis.coordinates()[c as usize]));
    }
    let totals = analysis.totals();
    out.extend([
        totals.external_work,
        totals.stored,
        totals.dissipated[0],
        totals.dissipated[1],
        totals.dissipated_mid[0],
        totals.dissipated_mid[1],
        totals.stabilising,
        totals.energy_error(),
        totals.released,
        record.iterations as f64,
        cutbacks as f64,
        record.residual().unwrap_or(0.0),
        // Unknown for an unsymmetric factorisation.
        record.negative_pivots.map_or(-1.0, |n| n as f64),
    ]);
    for strand in strands(mesh, analysis) {
        out.extend([
            strand.force_n,
            strand.share_of_force,
            strand.torque_n_mm,
            strand.stored_mj,
            strand.dissipated_transverse_mj,
            strand.dissipated_longitudinal_mj,
        ]);
    }
    if contact::is_any(analysis) {
        out.extend([totals.contact_friction, totals.contact_stored, totals.interference]);
    }
    for pair in contact::summaries(mesh, analysis) {
        out.extend([
            pair.normal_force_n,
            pair.friction_force_n,
            pair.friction_work_mj,
            pair.area_mm2,
            pair.largest_penetration_mm,
            pair.touching_points as f64,
        ]);
    }
    out
}
