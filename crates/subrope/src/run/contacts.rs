//! What the contacts of a model tell: sums per pair, shares of the strands, fields on the cells that touch.

use serde::Serialize;
pub use subrope_contact::contacts;
use subrope_contact::{Contact, ContactReport};
use subrope_fem::analysis::Analysis;
#[cfg(feature = "hdf5")]
use subrope_geometry::{CellKind, Mesh, Quad4, Quad9, quadrilateral};

#[cfg(feature = "hdf5")]
use crate::model::ContactCells;
use crate::model::MeshModel;

/// A pair of surfaces at the end of a run.
#[derive(Clone, Debug, Serialize)]
pub struct PairSummary {
    /// Name of the pair.
    pub name: String,
    /// Integration points under pressure.
    pub touching_points: usize,
    /// Reference area under pressure \[mm^2\].
    pub area_mm2: f64,
    /// Sum of the pressure over the reference area \[N\].
    pub normal_force_n: f64,
    /// Sum of the magnitude of friction traction over the reference area \[N\].
    pub friction_force_n: f64,
    /// Largest pressure \[MPa\].
    pub largest_pressure_mpa: f64,
    /// Largest penetration \[mm\].
    pub largest_penetration_mm: f64,
    /// Energy dissipated by friction, end values as in the fields \[mJ\].
    pub friction_work_mj: f64,
    /// Normal penalty \[MPa/mm\].
    pub penalty_mpa_per_mm: f64,
}

/// One entry per pair.
pub fn summaries(analysis: &Analysis) -> Vec<PairSummary> {
    let summary = |contact: &Contact| {
        let ContactReport { touching, area, normal, friction, pressure, penetration, work } = contact.report();
        PairSummary {
            name: contact.name().to_owned(),
            touching_points: touching,
            area_mm2: area,
            normal_force_n: normal,
            friction_force_n: friction,
            largest_pressure_mpa: pressure,
            largest_penetration_mm: penetration,
            friction_work_mj: work,
            penalty_mpa_per_mm: contact.options().penalty,
        }
    };
    contacts(analysis).map(summary).collect()
}

/// Force along z at the high end that each strand of a rope carries \[N\].
pub fn strand_forces(mesh: &MeshModel, analysis: &Analysis) -> Vec<f64> {
    let Some(rope) = &mesh.rope else { return Vec::new() };
    let reactions = analysis.nodal_reactions();
    let share = |strand: usize| -> f64 {
        let set = subrope_geometry::rope::sets::of_strand(subrope_geometry::strand::sets::END_B, strand);
        let nodes = mesh.mesh.node_sets.get(&set).map_or(&[][..], Vec::as_slice);
        nodes.iter().map(|&n| reactions[3 * n as usize + 2]).sum()
    };
    (0..rope.strands.len()).map(share).collect()
}

#[cfg(feature = "hdf5")]
/// A quantity on the cells whose faces touch, mean over the face by reference area.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactField {
    /// Pressure \[MPa\].
    Pressure,
    /// Friction work per area \[mJ/mm^2\].
    FrictionWork,
    /// Slipped length \[mm\], mean over the points that have slipped.
    Slip,
}

#[cfg(feature = "hdf5")]
/// Values of all cells of a mesh; both sides of a pair show what happens between them.
pub fn field(kind: ContactField, mesh: &Mesh, analysis: &Analysis, cells: &[ContactCells]) -> Vec<f64> {
    let mut sums = vec![0.0; mesh.cell_count()];
    let mut areas = vec![0.0; mesh.cell_count()];
    for (contact, cells) in contacts(analysis).zip(cells) {
        for point in contact.points() {
            let Some(place) = point.state.place else { continue };
            let value = match kind {
                ContactField::Pressure => point.state.pressure,
                ContactField::FrictionWork => point.state.work,
                ContactField::Slip => point.state.slip,
            };
            if value == 0.0 {
                continue;
            }
            let own = cells.secondary.get(contact.secondary().face(point.patch));
            let other = cells.primary.get(contact.primary().face(place.patch as usize));
            for face in own.into_iter().chain(other) {
                let cell = face.cell as usize;
                sums[cell] += point.area * value;
                if kind == ContactField::Slip {
                    areas[cell] += point.area;
                } else if areas[cell] == 0.0 {
                    areas[cell] = face_area(mesh, *face);
                }
            }
        }
    }
    sums.iter().zip(&areas).map(|(s, a)| if *a > 0.0 { s / a } else { 0.0 }).collect()
}

#[cfg(feature = "hdf5")]
fn face_area(mesh: &Mesh, face: subrope_geometry::Face) -> f64 {
    match mesh.kind {
        CellKind::Hex8 => mesh.face_points(face).map_or(0.0, |x| quadrilateral::face_area::<Quad4, 4>(&x)),
        CellKind::Hex27 => mesh.face_points(face).map_or(0.0, |x| quadrilateral::face_area::<Quad9, 9>(&x)),
    }
}
