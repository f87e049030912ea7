//! Sets and surfaces by index.

use super::MAX_MEMBERS;
use crate::deck::error::DeckErrorKind;
use crate::deck::fields::Item;
use crate::deck::raw::{Entry, Labels, Raw, Sets};
use crate::deck::source::{Fault, Located};
use std::collections::{BTreeMap, BTreeSet};
use subrope_geometry::Face;

/// Members of every set by index, in the order in which the sets are defined; ascending, without repetition.
pub(super) struct Resolved {
    members: Vec<Vec<u32>>,
}

/// Takes `count` members from what is allowed.
pub(super) fn spend(budget: &mut usize, count: usize) -> Result<(), DeckErrorKind> {
    *budget = budget.checked_sub(count).ok_or(DeckErrorKind::TooManyMembers { limit: MAX_MEMBERS })?;
    Ok(())
}

impl Resolved {
    pub fn elements(raw: &Raw, budget: &mut usize) -> Result<Self, Fault> {
        let undefined = |label| DeckErrorKind::UndefinedElement { label };
        let unknown = |name| DeckErrorKind::UnknownElementSet { name };
        let none = |_: &str, _: &mut usize| Ok(Vec::new());
        Self::resolve(&raw.element_sets, &raw.elements.table, undefined, unknown, none, budget)
    }

    pub fn nodes(
        raw: &Raw,
        elements: &Self,
        cells: &[u32],
        nodes_per_cell: usize,
        budget: &mut usize,
    ) -> Result<Self, Fault> {
        let undefined = |label| DeckErrorKind::UndefinedNode { label };
        let unknown = |name| DeckErrorKind::UnknownNodeSet { name };
        let nodes_of = |name: &str, budget: &mut usize| {
            let set = raw.element_sets.find(name);
            let set = set.ok_or_else(|| DeckErrorKind::UnknownElementSet { name: name.to_owned() })?;
            let mut nodes = BTreeSet::new();
            spend(budget, elements.of(set).len())?;
            for &cell in elements.of(set) {
                let begin = cell as usize * nodes_per_cell;
                nodes.extend(&cells[begin..begin + nodes_per_cell]);
            }
            Ok(nodes.into_iter().collect())
        };
        Self::resolve(&raw.node_sets, &raw.nodes.table, undefined, unknown, nodes_of, budget)
    }

    fn resolve(
        sets: &Sets,
        labels: &Labels,
        undefined: impl Fn(u64) -> DeckErrorKind,
        unknown: impl Fn(String) -> DeckErrorKind,
        nodes_of: impl Fn(&str, &mut usize) -> Result<Vec<u32>, DeckErrorKind>,
        budget: &mut usize,
    ) -> Result<Self, Fault> {
        let mut members: Vec<Vec<u32>> = vec![Vec::new(); sets.names.len()];
        let mut seen = vec![false; sets.names.len()];
        for (set, at, entry) in &sets.additions {
            let added = match entry {
                Entry::Item(Item::Label(label)) => {
                    labels.find(*label).map(|i| vec![i]).ok_or_else(|| undefined(*label))
                }
                Entry::Item(Item::Set(name)) => match sets.find(name) {
                    Some(other) if seen[other as usize] => {
                        // Kept sorted, so that a set named again and again is sorted once.
                        let other = &mut members[other as usize];
                        *other = unique(std::mem::take(other));
                        Ok(other.clone())
                    }
                    _ => Err(unknown(name.clone())),
                },
                Entry::Range { first, last, step } => range(labels, [*first, *last, *step], &undefined),
                Entry::NodesOf(name) => nodes_of(name, budget),
            };
            let added = added.at(*at)?;
            spend(budget, added.len()).at(*at)?;
            members[*set as usize].extend(added);
            seen[*set as usize] = true;
        }
        Ok(Self { members: members.into_iter().map(unique).collect() })
    }

    /// Members of a set.
    pub fn of(&self, set: u32) -> &[u32] {
        self.members.get(set as usize).map_or(&[], Vec::as_slice)
    }

    /// The sets by name, renumbered, without internal ones; those left empty are listed in `dropped`.
    pub fn named(
        self,
        sets: &Sets,
        renumber: impl Fn(u32) -> Option<u32>,
        dropped: &mut Vec<String>,
    ) -> BTreeMap<String, Vec<u32>> {
        let mut named = BTreeMap::new();
        for ((name, &internal), members) in sets.names.iter().zip(&sets.internal).zip(self.members) {
            let members: Vec<u32> = members.into_iter().filter_map(&renumber).collect();
            match (internal, members.is_empty()) {
                (true, _) => {}
                (false, true) => dropped.push(name.clone()),
                (false, false) => {
                    named.insert(name.clone(), members);
                }
            }
        }
        named
    }
}

fn unique(mut members: Vec<u32>) -> Vec<u32> {
    members.sort_unstable();
    members.dedup();
    members
}

/// Indices of a generated range. A range of more labels than are defined is refused before it is walked.
fn range(
    labels: &Labels,
    [first, last, step]: [u64; 3],
    undefined: impl Fn(u64) -> DeckErrorKind,
) -> Result<Vec<u32>, DeckErrorKind> {
    let steps = last.saturating_sub(first).checked_div(step);
    let steps = steps.ok_or(DeckErrorKind::BadRange { first, last, step })?;
    if steps >= labels.len() as u64 {
        return Err(DeckErrorKind::LongRange { count: steps.saturating_add(1), defined: labels.len() });
    }
    (0..=steps).map(|i| first + i * step).map(|label| labels.find(label).ok_or_else(|| undefined(label))).collect()
}

/// Faces of every surface, in the order of the deck, without repetition.
pub(super) fn surfaces(
    raw: &Raw,
    elements: &Resolved,
    budget: &mut usize,
) -> Result<BTreeMap<String, Vec<Face>>, Fault> {
    let mut surfaces = BTreeMap::new();
    for (name, surface) in &raw.surfaces {
        let (mut faces, mut seen) = (Vec::new(), BTreeSet::new());
        for (at, item, face) in &surface.rows {
            let cells = cells_of(raw, elements, item).at(*at)?;
            spend(budget, cells.len()).at(*at)?;
            let new = cells.into_iter().map(|cell| Face { cell, face: *face }).filter(|face| seen.insert(*face));
            faces.extend(new);
        }
        surfaces.insert(name.clone(), faces);
    }
    Ok(surfaces)
}

pub(super) fn cells_of(raw: &Raw, elements: &Resolved, item: &Item) -> Result<Vec<u32>, DeckErrorKind> {
    match item {
        Item::Label(label) => {
            let cell = raw.elements.table.find(*label).ok_or(DeckErrorKind::UndefinedElement { label: *label })?;
            Ok(vec![cell])
        }
        Item::Set(name) => {
            let set = raw.element_sets.find(name);
            let set = set.ok_or_else(|| DeckErrorKind::UnknownElementSet { name: name.clone() })?;
            Ok(elements.of(set).to_vec())
        }
    }
}
