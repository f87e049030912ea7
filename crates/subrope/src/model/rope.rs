//! The mesh of a rope from what a scene says.

use subrope_geometry::{
    CellKind, Compaction, Handedness, HelixRadius, LayBy, Rope, RopeLay, RopeMesh, RopeStrand, Section, SectionArea,
    Sense, StrandOrigin, YarnLay, YarnLayBy,
};

use super::ModelError;
use crate::scene::{self, Scene};
use crate::sizing::RopeSizing;

/// Strands, sets and fibre fields.
pub(super) fn rope_mesh(scene: &Scene, entry: &scene::Rope, kind: CellKind) -> Result<RopeMesh, ModelError> {
    Ok(rope_of(scene, entry, kind).mesh()?)
}

/// The radius of a checked scene is given or follows; what has neither is refused by the geometry.
pub(super) fn rope_of(scene: &Scene, entry: &scene::Rope, kind: CellKind) -> Rope {
    let sizing = RopeSizing::of(scene);
    let radius = entry.radius.or(sizing.as_ref().and_then(RopeSizing::radius)).unwrap_or(f64::NAN);
    let section = section(&entry.mesh);
    let strand = |radius: f64, yarns: &scene::Yarns| RopeStrand { radius, yarns: yarns_of(yarns), section };
    Rope {
        strands: entry.strands,
        outer: strand(radius, &entry.yarns),
        core: entry.core.as_ref().map(|core| strand(core.radius, &core.yarns)),
        lay: RopeLay { by: lay_of(entry, sizing.as_ref()), handedness: hand_of(entry.hand) },
        helix_radius: entry.helix_radius.map_or(HelixRadius::Touching { gap: entry.gap }, HelixRadius::Given),
        compaction: if entry.compaction > 0.0 { Compaction::Degree(entry.compaction) } else { Compaction::None },
        length: entry.length,
        origin: match entry.origin {
            scene::Origin::Middle => StrandOrigin::Middle,
            scene::Origin::Bottom => StrandOrigin::Bottom,
        },
        layers: entry.mesh.layers,
        kind,
        ..Rope::default()
    }
}

fn hand_of(hand: scene::Hand) -> Handedness {
    match hand {
        scene::Hand::Right => Handedness::Right,
        scene::Hand::Left => Handedness::Left,
    }
}

/// A checked scene gives one, or it follows.
fn lay_of(entry: &scene::Rope, sizing: Option<&RopeSizing>) -> LayBy {
    match (entry.lay_angle, entry.lay_length, sizing.and_then(RopeSizing::lay_angle), entry.outer_diameter) {
        (Some(angle), ..) => LayBy::Angle(angle.to_radians()),
        (_, Some(length), ..) => LayBy::Length(length),
        (_, _, Some(angle), _) => LayBy::Angle(angle),
        (.., diameter) => LayBy::OuterDiameter(diameter.unwrap_or(f64::NAN)),
    }
}

fn yarns_of(entry: &scene::Yarns) -> YarnLay {
    let by = match (entry.surface_angle, entry.pitch) {
        (_, Some(pitch)) => YarnLayBy::Pitch(pitch),
        (Some(angle), _) if angle > 0.0 => YarnLayBy::SurfaceAngle(angle.to_radians()),
        _ => YarnLayBy::Parallel,
    };
    let sense = match entry.sense {
        scene::YarnSense::Opposite => Sense::Opposite,
        scene::YarnSense::Same => Sense::Same,
    };
    YarnLay { by, sense }
}

/// The section of a mesh entry.
pub(super) fn section(entry: &scene::StrandMesh) -> Section {
    Section {
        core_cells: entry.core,
        rings: entry.rings,
        core_fraction: entry.core_fraction,
        core_bulge: entry.core_bulge,
        area: match entry.area {
            scene::SectionArea::Exact => SectionArea::Exact,
            scene::SectionArea::Inscribed => SectionArea::Inscribed,
        },
    }
}
