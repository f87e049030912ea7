//! A deck as written, before labels and names are resolved.

use super::error::DeckErrorKind;
use super::fields::Item;
use super::source::At;
use nalgebra::Vector3;
use std::collections::{BTreeMap, HashMap};
use subrope_geometry::CellKind;

/// Nodes or elements that 32-bit indices can count, one index being reserved.
pub(super) const MAX_ITEMS: usize = u32::MAX as usize - 1;

/// Everything read from the lines of a deck.
#[derive(Debug, Default)]
pub(super) struct Raw {
    pub nodes: Nodes,
    pub elements: Elements,
    pub node_sets: Sets,
    pub element_sets: Sets,
    pub surfaces: BTreeMap<String, RawSurface>,
    pub orientations: BTreeMap<String, RawOrientation>,
    pub distributions: BTreeMap<String, RawDistribution>,
    /// Points per row of every distribution table; `None` where a table does not hold points.
    pub tables: BTreeMap<String, Option<usize>>,
    pub sections: Vec<RawSection>,
    pub ignored: Vec<(At, String)>,
    pub instances: usize,
}

/// Labels in the order of their definition.
#[derive(Debug, Default)]
pub(super) struct Labels {
    pub labels: Vec<u64>,
    pub at: Vec<At>,
    index: HashMap<u64, u32>,
}

impl Labels {
    /// Adds a label, or gives the place of its first definition.
    fn add(&mut self, label: u64, at: At) -> Result<Result<(), At>, DeckErrorKind> {
        if self.labels.len() >= MAX_ITEMS {
            return Err(DeckErrorKind::TooManyItems { limit: MAX_ITEMS });
        }
        if let Some(&first) = self.index.get(&label) {
            return Ok(Err(self.at[first as usize]));
        }
        self.index.insert(label, self.labels.len() as u32);
        self.labels.push(label);
        self.at.push(at);
        Ok(Ok(()))
    }

    /// Index of a label.
    pub fn find(&self, label: u64) -> Option<u32> {
        self.index.get(&label).copied()
    }

    pub fn len(&self) -> usize {
        self.labels.len()
    }
}

/// A label defined twice; the caller knows the name of the file.
pub(super) struct Twice {
    pub first: At,
}

/// Nodes as written.
#[derive(Debug, Default)]
pub(super) struct Nodes {
    pub table: Labels,
    pub points: Vec<Vector3<f64>>,
}

impl Nodes {
    pub fn add(&mut self, label: u64, point: Vector3<f64>, at: At) -> Result<Result<(), Twice>, DeckErrorKind> {
        Ok(match self.table.add(label, at)? {
            Ok(()) => {
                self.points.push(point);
                Ok(())
            }
            Err(first) => Err(Twice { first }),
        })
    }
}

/// Elements as written: node labels in the order of the deck.
#[derive(Debug, Default)]
pub(super) struct Elements {
    pub kind: Option<CellKind>,
    pub table: Labels,
    pub nodes: Vec<u64>,
}

impl Elements {
    pub fn add(&mut self, label: u64, nodes: &[u64], at: At) -> Result<Result<(), Twice>, DeckErrorKind> {
        Ok(match self.table.add(label, at)? {
            Ok(()) => {
                self.nodes.extend_from_slice(nodes);
                Ok(())
            }
            Err(first) => Err(Twice { first }),
        })
    }
}

/// One addition to a set.
#[derive(Debug)]
pub(super) enum Entry {
    Item(Item),
    Range {
        first: u64,
        last: u64,
        step: u64,
    },
    /// The nodes of an element set.
    NodesOf(String),
}

/// Sets as written: additions in the order of the deck.
#[derive(Debug, Default)]
pub(super) struct Sets {
    pub names: Vec<String>,
    /// Whether every definition of the set is marked INTERNAL.
    pub internal: Vec<bool>,
    pub additions: Vec<(u32, At, Entry)>,
    index: HashMap<String, u32>,
}

impl Sets {
    /// Index of the set of a name, defined if need be.
    pub fn define(&mut self, name: String, internal: bool) -> u32 {
        match self.index.get(&name) {
            Some(&set) => {
                self.internal[set as usize] &= internal;
                set
            }
            None => {
                let set = self.names.len() as u32;
                self.names.push(name.clone());
                self.internal.push(internal);
                self.index.insert(name, set);
                set
            }
        }
    }

    pub fn add(&mut self, set: u32, at: At, entry: Entry) {
        self.additions.push((set, at, entry));
    }

    pub fn find(&self, name: &str) -> Option<u32> {
        self.index.get(name).copied()
    }
}

/// A surface as written.
#[derive(Debug)]
pub(super) struct RawSurface {
    pub internal: bool,
    pub rows: Vec<(At, Item, u8)>,
}

/// Where an orientation takes its points from.
#[derive(Debug)]
pub(super) enum Points {
    /// Points a, b and the origin.
    Fixed([Vector3<f64>; 3]),
    /// A distribution over the elements.
    Distribution(String),
}

/// An orientation as written.
#[derive(Debug)]
pub(super) struct RawOrientation {
    pub at: At,
    pub points: Points,
    /// Local axis (0 to 2) and angle [rad] of an additional rotation.
    pub rotation: Option<(usize, f64)>,
}

/// A row of a distribution: elements and the first of its values.
#[derive(Debug)]
pub(super) struct RawRow {
    pub at: At,
    /// `None` for the default.
    pub item: Option<Item>,
    pub values: Vec<f64>,
}

/// A distribution as written.
#[derive(Debug)]
pub(super) struct RawDistribution {
    pub by_element: bool,
    pub table: Option<String>,
    pub rows: Vec<RawRow>,
}

/// A solid section as written.
#[derive(Debug)]
pub(super) struct RawSection {
    pub at: At,
    pub elements: String,
    pub material: Option<String>,
    pub orientation: Option<String>,
}
