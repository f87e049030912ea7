//! The names of sets and surfaces that a scene may refer to.

use std::collections::BTreeSet;

use crate::scene::sets::DeckNames;
use crate::scene::{Rope, STRAND_SETS, STRAND_SURFACES, Scene};

/// Names of node sets and of surfaces, where all are known.
pub(super) struct SetNames {
    pub nodes: Option<Names>,
    pub surfaces: Option<Names>,
}

/// Some names, which do not distinguish case.
pub(super) struct Names {
    /// As written.
    pub listed: Vec<String>,
    upper: BTreeSet<String>,
}

impl Names {
    pub fn new(listed: Vec<String>) -> Self {
        let upper = listed.iter().map(|name| name.to_ascii_uppercase()).collect();
        Self { listed, upper }
    }

    pub fn has(&self, name: &str) -> bool {
        self.upper.contains(&name.to_ascii_uppercase())
    }
}

impl SetNames {
    /// Of the mesh of a scene; `deck` are the names in its deck, when it has been opened.
    pub fn of(scene: &Scene, deck: Option<&DeckNames>) -> Self {
        if scene.strand.is_some() {
            return Self::generated(
                STRAND_SETS.map(str::to_owned).to_vec(),
                STRAND_SURFACES.map(str::to_owned).to_vec(),
            );
        }
        if let Some(rope) = &scene.rope {
            return Self::generated(rope.set_names(), Rope::surface_names(rope));
        }
        // Names in included files are not seen.
        let Some(deck) = deck.filter(|names| !names.includes) else { return Self { nodes: None, surfaces: None } };
        let aliases = || scene.deck.iter().flat_map(|d| d.sets.keys().cloned());
        let nodes = deck.sets.iter().cloned().chain(aliases()).chain(["ALL".to_owned()]).collect();
        Self::generated(nodes, deck.surfaces.iter().cloned().chain(aliases()).collect())
    }

    fn generated(nodes: Vec<String>, surfaces: Vec<String>) -> Self {
        Self { nodes: Some(Names::new(nodes)), surfaces: Some(Names::new(surfaces)) }
    }
}
