//! What contacts tell in numbers: sums per pair, what every point carries.

use subrope_contact::{Contact, ContactReport, contacts};
use subrope_fem::analysis::Analysis;

use super::super::{PairLoads, PairSummary, PointLoad};
use crate::model::MeshModel;

/// Whether something may touch.
pub fn is_any(analysis: &Analysis) -> bool {
    contacts(analysis).next().is_some()
}

/// Sums and extremes of a contact over the whole length of a pair of strands; the points of a slice count once.
fn report(mesh: &MeshModel, contact: &Contact) -> ContactReport {
    let (one, layers) = (contact.report(), mesh.layers_per_strand());
    let ContactReport { area, normal, friction, work, .. } = one;
    let [area, normal, friction, work] = [area, normal, friction, work].map(|sum| layers * sum);
    ContactReport { area, normal, friction, work, ..one }
}

/// One entry per pair.
pub fn summaries(mesh: &MeshModel, analysis: &Analysis) -> Vec<PairSummary> {
    let summary = |contact: &Contact| {
        let ContactReport { touching, area, normal, friction, pressure, penetration, work } = report(mesh, contact);
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

/// What every point carries, pair by pair.
pub fn loads(analysis: &Analysis) -> Vec<PairLoads> {
    let pair = |contact: &Contact| {
        let points = contact.points().zip(contact.gaps(analysis.displacement())).map(|(point, foot)| PointLoad {
            face: contact.secondary().face(point.patch),
            area: point.area,
            pressure: point.state.pressure,
            friction: point.state.traction.norm(),
            work: point.state.work,
            gap: foot.map(|(_, gap)| gap),
        });
        PairLoads { name: contact.name().to_owned(), reach: contact.options().reach, points: points.collect() }
    };
    contacts(analysis).map(pair).collect()
}
