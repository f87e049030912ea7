//! What the bent strand shows, as numbers: where it bends, out of which plane, how oval it gets, and where each sliding
//! mode dissipates.
//!
//! Definitions: curvature = relative rotation of best-fit sections per reference length; ovality = (largest -
//! smallest)/mean width in the section's plane; centre = dissipation-weighted coordinate towards the tension side over
//! the radius; 90 % volume = smallest volume fraction that holds 90 % of a mode's dissipation.

use std::cell::LazyCell;

use nalgebra::Vector3;
use serde::Serialize;
use subrope_fem::analysis::Analysis;
use subrope_fem::solid::SolidFields;
use subrope_geometry::Mesh;
use subrope_material::StateKind;

use super::sections::{SectionShape, rotation_vector, section_shapes};
use super::session::integration_points;

/// Findings on a bent strand.
#[derive(Clone, Debug, Serialize)]
pub struct Findings {
    /// Mean curvature: rotation of one end against the other over the length \[1/mm\].
    pub mean_curvature_per_mm: f64,
    /// Largest curvature between neighbouring sections \[1/mm\].
    pub largest_curvature_per_mm: f64,
    /// Length of the peak of curvature that holds it: of the stretch in which the curvature exceeds half of the largest
    /// \[mm\].
    pub curvature_peak_length_mm: f64,
    /// Zones of high curvature, lowest first: maxima above 1.5 times the mean, a diameter apart.
    pub curvature_zones: Vec<Zone>,
    /// Whether the zones mirror each other: |sum of their z| about the middle over the length \[-\].
    pub zone_asymmetry: f64,
    /// Largest displacement of a section's centroid out of the plane of bending \[mm\].
    pub out_of_plane_mm: f64,
    /// Largest ovality of a section \[-\].
    pub largest_ovality: f64,
    /// Length less the distance of the end centres \[mm\].
    pub approach_mm: f64,
    /// Transverse sliding; absent when nothing slid.
    pub transverse: Option<ModeFinding>,
    /// Longitudinal sliding.
    pub longitudinal: Option<ModeFinding>,
    /// Peak density of longitudinal over that of transverse dissipation \[-\].
    pub peak_ratio: Option<f64>,
}

/// A zone of high curvature.
#[derive(Clone, Debug, Serialize)]
pub struct Zone {
    /// Reference coordinate from the middle of the strand \[mm\].
    pub z_mm: f64,
    /// Its curvature over the mean one \[-\].
    pub curvature_ratio: f64,
    /// Ovality of the section there \[-\].
    pub ovality: f64,
}

/// Where a sliding mode dissipates.
#[derive(Clone, Debug, Serialize)]
pub struct ModeFinding {
    /// Dissipated in all \[mJ\].
    pub total_mj: f64,
    /// Peak density \[mJ/mm^3\].
    pub peak_mj_per_mm3: f64,
    /// Reference position of the peak \[mm\].
    pub peak_at_mm: [f64; 3],
    /// Centre towards the tension side over the radius \[-\]: positive outside, negative inside of the bend.
    pub centre_over_radius: f64,
    /// Coordinate of the peak towards the tension side over the radius \[-\].
    pub peak_over_radius: f64,
    /// Smallest fraction of the volume that holds 90 % \[-\].
    pub volume_of_90_percent: f64,
}

/// A sliding mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Between rope-yarns across the section.
    Transverse,
    /// Along the rope-yarns.
    Longitudinal,
}

impl Mode {
    fn kind(self) -> StateKind {
        match self {
            Self::Transverse => StateKind::TransverseDissipation,
            Self::Longitudinal => StateKind::LongitudinalDissipation,
        }
    }
}

/// Largest density of each kind of dissipation over all integration points, end values.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct PeakDensities {
    /// Transverse sliding \[mJ/mm^3\].
    pub transverse_mj_per_mm3: f64,
    /// Longitudinal sliding \[mJ/mm^3\].
    pub longitudinal_mj_per_mm3: f64,
}

impl PeakDensities {
    /// Of the committed state; `None` for laws without sliding.
    #[must_use]
    pub fn new(analysis: &Analysis) -> Option<Self> {
        let fields = || analysis.model().contributions.iter().filter_map(|c| c.fields());
        let peak = |mode: Mode| fields().filter_map(|f| peak_density(f, mode)).max_by(f64::total_cmp);
        Some(Self {
            transverse_mj_per_mm3: peak(Mode::Transverse)?,
            longitudinal_mj_per_mm3: peak(Mode::Longitudinal)?,
        })
    }
}

fn peak_density(fields: &dyn SolidFields, mode: Mode) -> Option<f64> {
    let offset = fields.state_variables().iter().find(|v| v.kind == mode.kind())?.offset;
    let points = (0..fields.element_count()).flat_map(|e| (0..fields.points_per_element()).map(move |q| (e, q)));
    Some(points.map(|(e, q)| fields.point_state(e, q).0[offset]).fold(0.0, f64::max))
}

/// Rotation between the ends below which a strand does not count as bent \[rad\].
const LEAST_BEND: f64 = 1e-6;

impl Findings {
    /// Findings at the committed state; `None` when the mesh has no sections along z or is not bent.
    #[must_use]
    pub fn new(mesh: &Mesh, analysis: &Analysis) -> Option<Self> {
        let sections = section_shapes(mesh, analysis.displacement());
        let (first, last) = (sections.first()?, sections.last()?);
        if sections.len() < 5 {
            return None;
        }
        let length = last.z - first.z;
        let curvature = curvatures(&sections);
        let bend = bend_vector(&sections);
        let transverse_part = Vector3::new(bend.x, bend.y, 0.0);
        if transverse_part.norm() < LEAST_BEND {
            return None;
        }
        let axis = transverse_part.normalize();
        let mean = transverse_part.norm() / length;
        let middle = 0.5 * (first.z + last.z);
        let radius = mesh_radius(mesh);
        let zones = zones(&sections, &curvature, mean, middle, radius);
        let fields = analysis.model().contributions.iter().find_map(|c| c.fields());
        let side = Vector3::z().cross(&axis);
        // Not needed where nothing slides.
        let points = LazyCell::new(|| integration_points(mesh));
        let mode = |m| fields.and_then(|f| mode_finding(f, &points, m, &side, radius));
        let (transverse, longitudinal) = (mode(Mode::Transverse), mode(Mode::Longitudinal));
        Some(Self {
            mean_curvature_per_mm: mean,
            largest_curvature_per_mm: curvature.iter().map(|(_, c)| *c).fold(0.0, f64::max),
            curvature_peak_length_mm: peak_length(&curvature, (first.z, last.z)),
            zone_asymmetry: zones.iter().map(|z| z.z_mm).sum::<f64>().abs() / length,
            curvature_zones: zones,
            out_of_plane_mm: sections.iter().map(|s| s.displacement.dot(&axis).abs()).fold(0.0, f64::max),
            largest_ovality: sections.iter().map(|s| s.ovality).fold(0.0, f64::max),
            approach_mm: length - (last.centroid - first.centroid).norm(),
            peak_ratio: match (&transverse, &longitudinal) {
                (Some(t), Some(l)) if t.peak_mj_per_mm3 > 0.0 => Some(l.peak_mj_per_mm3 / t.peak_mj_per_mm3),
                _ => None,
            },
            transverse,
            longitudinal,
        })
    }
}

/// Middle and bending curvature \[1/mm\] between neighbouring sections, without twist.
fn curvatures(sections: &[SectionShape]) -> Vec<(f64, f64)> {
    sections
        .windows(2)
        .map(|pair| {
            let turn = rotation_vector(&(pair[0].rotation.transpose() * pair[1].rotation));
            let bend = turn.x.hypot(turn.y);
            (0.5 * (pair[0].z + pair[1].z), bend / (pair[1].z - pair[0].z))
        })
        .collect()
}

/// Length of the stretch around the largest curvature in which the curvature, linear between the middles of the layers
/// and constant beyond the last, exceeds half of it \[mm\]; `ends` are the coordinates of the end sections.
fn peak_length(curvature: &[(f64, f64)], ends: (f64, f64)) -> f64 {
    let Some(at) = (0..curvature.len()).max_by(|&i, &j| curvature[i].1.total_cmp(&curvature[j].1)) else { return 0.0 };
    let half = 0.5 * curvature[at].1;
    let crossing = |pair: (&(f64, f64), &(f64, f64))| {
        let (&(inside, high), &(outside, low)) = pair;
        (low < half).then(|| inside + (outside - inside) * (high - half) / (high - low))
    };
    let above = curvature[at..].iter().zip(&curvature[at + 1..]).find_map(crossing);
    let below =
        curvature[..at].iter().rev().zip(curvature[..=at].iter().rev()).find_map(|(out, inn)| crossing((inn, out)));
    above.unwrap_or(ends.1) - below.unwrap_or(ends.0)
}

/// Sum of the spatial rotations from section to section \[rad\]: in plane bending all turn about one axis, and there is no
/// limit at half a turn.
fn bend_vector(sections: &[SectionShape]) -> Vector3<f64> {
    sections.windows(2).map(|pair| rotation_vector(&(pair[1].rotation * pair[0].rotation.transpose()))).sum()
}

/// Curvature over the mean one from which a maximum counts as a zone.
const ZONE_RATIO: f64 = 1.5;

/// Local maxima of the curvature, each the largest within a diameter of the strand.
fn zones(sections: &[SectionShape], curvature: &[(f64, f64)], mean: f64, middle: f64, radius: f64) -> Vec<Zone> {
    let largest_nearby =
        |z: f64, value: f64| curvature.iter().all(|(other, c)| (other - z).abs() > 2.0 * radius || *c <= value);
    let peaks = curvature.iter().filter(|(z, value)| *value > ZONE_RATIO * mean && largest_nearby(*z, *value));
    let zone = |(z, value): &(f64, f64)| {
        let near = sections.iter().min_by(|a, b| (a.z - z).abs().total_cmp(&(b.z - z).abs()))?;
        Some(Zone { z_mm: z - middle, curvature_ratio: value / mean, ovality: near.ovality })
    };
    peaks.filter_map(zone).collect()
}

fn mesh_radius(mesh: &Mesh) -> f64 {
    mesh.points.iter().map(|p| p.x.hypot(p.y)).fold(0.0, f64::max)
}

fn mode_finding(
    fields: &dyn SolidFields,
    points: &LazyCell<Vec<Vector3<f64>>, impl FnOnce() -> Vec<Vector3<f64>>>,
    mode: Mode,
    side: &Vector3<f64>,
    radius: f64,
) -> Option<ModeFinding> {
    let offset = fields.state_variables().iter().find(|v| v.kind == mode.kind())?.offset;
    let per_element = fields.points_per_element();
    let mut samples: Vec<(f64, f64, usize)> = Vec::with_capacity(fields.element_count() * per_element);
    for element in 0..fields.element_count() {
        for q in 0..per_element {
            let (state, volume) = fields.point_state(element, q);
            samples.push((state[offset], volume, element * per_element + q));
        }
    }
    let total: f64 = samples.iter().map(|(d, v, _)| d * v).sum();
    if total <= 0.0 {
        return None;
    }
    let centre = samples.iter().map(|(d, v, i)| d * v * points[*i].dot(side)).sum::<f64>() / total;
    samples.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.2.cmp(&b.2)));
    let &(peak, _, at) = samples.first()?;
    Some(ModeFinding {
        total_mj: total,
        peak_mj_per_mm3: peak,
        peak_at_mm: points[at].into(),
        centre_over_radius: centre / radius,
        peak_over_radius: points[at].dot(side) / radius,
        volume_of_90_percent: volume_fraction(&samples, 0.9 * total),
    })
}

/// Fraction of the volume that the densest points need to hold a share of the dissipation.
fn volume_fraction(densest_first: &[(f64, f64, usize)], share: f64) -> f64 {
    let volume: f64 = densest_first.iter().map(|(_, v, _)| v).sum();
    let (mut held, mut used) = (0.0, 0.0);
    for (density, v, _) in densest_first {
        if held >= share {
            break;
        }
        held += density * v;
        used += v;
    }
    used / volume
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn length_of_a_peak_at_half_its_height() {
        // A triangle from 0 at z = 2 over 1 at z = 4 to 0 at z = 8 on a line of 10.
        let triangle = |z: f64| ((z - 2.0) / 2.0).min((8.0 - z) / 4.0).max(0.0);
        let samples: Vec<_> = (0..20).map(|i| 0.5 * f64::from(i)).map(|z| (z, triangle(z))).collect();
        assert!((peak_length(&samples, (0.0, 10.0)) - 3.0).abs() < 1e-12);
        // At an end the peak reaches up to it, and a constant curvature from end to end.
        let ramp: Vec<_> = (0..10).map(|i| (f64::from(i) + 0.5, f64::from(i) + 0.5)).collect();
        assert!((peak_length(&ramp, (0.0, 10.0)) - 5.25).abs() < 1e-12);
        assert!((peak_length(&[(0.5, 1.0), (1.5, 1.0)], (0.0, 2.0)) - 2.0).abs() < 1e-12);
    }
}
