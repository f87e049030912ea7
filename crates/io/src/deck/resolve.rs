//! From a deck as written to a mesh with indices.

mod cells;
mod frames;
mod sets;

use super::error::DeckErrorKind;
use super::raw::Raw;
use super::source::{At, Fault};
use super::{Deck, Ignored};
use cells::Compaction;
use frames::Sections;
use nalgebra::Vector3;
use sets::Resolved;
use std::collections::BTreeMap;
use std::path::PathBuf;
use subrope_geometry::{Face, Mesh};

/// Members of all sets together \[count\]: nested sets could multiply without bound.
pub(super) const MAX_MEMBERS: usize = 50_000_000;

/// Resolves labels and names, and drops nodes that no element uses.
pub(super) fn resolve(raw: &Raw, files: &[PathBuf]) -> Result<Deck, Fault> {
    let Some(kind) = raw.elements.kind.filter(|_| raw.elements.table.len() > 0) else {
        return Err(Fault::new(At::default(), DeckErrorKind::NoElements));
    };
    let written = cells::connectivity(raw, kind)?;
    let compaction = Compaction::new(raw.nodes.table.len(), &written);
    let mut budget = MAX_MEMBERS;
    let elements = Resolved::elements(raw, &mut budget)?;
    let nodes = Resolved::nodes(raw, &elements, &written, kind.nodes(), &mut budget)?;
    let surfaces = sets::surfaces(raw, &elements, &mut budget)?;
    let sections = Sections::resolve(raw, &elements, &mut budget)?;
    let mut dropped_sets = Vec::new();
    let node_sets = nodes.named(&raw.node_sets, |node| compaction.new_index(node), &mut dropped_sets);
    let element_sets = elements.named(&raw.element_sets, Some, &mut dropped_sets);
    let mesh = Mesh {
        kind,
        points: compaction.keep(&raw.nodes.points),
        cells: written.iter().filter_map(|&node| compaction.new_index(node)).collect(),
        point_labels: compaction.keep(&raw.nodes.table.labels),
        cell_labels: raw.elements.table.labels.clone(),
        node_sets,
        element_sets,
        surfaces: named_surfaces(raw, surfaces, &mut dropped_sets),
    };
    Ok(Deck {
        mesh,
        frames: sections.frames,
        material_names: sections.material_names,
        materials: sections.materials,
        ignored: ignored(raw, files),
        unused_nodes: unused(raw, &compaction),
        dropped_sets,
    })
}

fn named_surfaces(
    raw: &Raw,
    surfaces: BTreeMap<String, Vec<Face>>,
    dropped: &mut Vec<String>,
) -> BTreeMap<String, Vec<Face>> {
    let mut named = BTreeMap::new();
    for (name, faces) in surfaces {
        let internal = raw.surfaces.get(&name).is_some_and(|surface| surface.internal);
        match (internal, faces.is_empty()) {
            (true, _) => {}
            (false, true) => dropped.push(name),
            (false, false) => {
                named.insert(name, faces);
            }
        }
    }
    named
}

fn unused(raw: &Raw, compaction: &Compaction) -> Vec<(u64, [f64; 3])> {
    let nodes = raw.nodes.table.labels.iter().zip(&raw.nodes.points);
    let described = |(label, x): (&u64, &Vector3<f64>)| (*label, [x.x, x.y, x.z]);
    (0..).zip(nodes).filter(|(i, _)| compaction.new_index(*i).is_none()).map(|(_, node)| described(node)).collect()
}

fn ignored(raw: &Raw, files: &[PathBuf]) -> Vec<Ignored> {
    let place = |at: &At| files.get(at.file as usize).cloned().unwrap_or_default();
    raw.ignored
        .iter()
        .map(|(at, keyword)| Ignored { file: place(at), line: at.line, keyword: keyword.clone() })
        .collect()
}
