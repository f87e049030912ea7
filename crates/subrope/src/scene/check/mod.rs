//! Checks of a scene that need more than one value.

mod boundary;
mod contact;
mod law;
mod mesh;
mod motion;
mod sizing;
mod slice;
mod step;

pub(crate) use law::check_law;

use super::sets::DeckNames;
use super::{STRAND_SETS, STRAND_SURFACES, Scene};
use crate::document::{Document, Location, Problem, ProblemKind};

/// All problems of a scene; `names` are those of its deck, when it has been opened.
pub(super) fn check(scene: &Scene, document: &Document, names: Option<&DeckNames>) -> Vec<Problem> {
    let mut checker = Checker { scene, document, names, problems: Vec::new() };
    checker.mesh();
    checker.law();
    checker.boundary();
    checker.contacts();
    checker.slice();
    checker.steps();
    checker.problems
}

struct Checker<'a> {
    scene: &'a Scene,
    document: &'a Document,
    names: Option<&'a DeckNames>,
    problems: Vec<Problem>,
}

fn top(key: &str) -> Location {
    Location::root().at(key)
}

impl Checker<'_> {
    fn report(&mut self, at: &Location, kind: ProblemKind, help: &str) {
        let problem = self.document.problem(at, kind);
        self.problems.push(if help.is_empty() { problem } else { problem.help(help) });
    }

    fn inconsistent(&mut self, at: &Location, cause: impl Into<String>, help: &str) {
        self.report(at, ProblemKind::Inconsistent { cause: cause.into() }, help);
    }

    fn missing(&mut self, table: &Location, key: &str, help: &str) {
        let kind = ProblemKind::MissingKey { key: key.to_owned(), table: table.table_name() };
        self.report(table, kind, help);
    }

    fn out_of_range(&mut self, at: &Location, key: &str, found: f64, requirement: &str) {
        let kind = ProblemKind::OutOfRange { key: key.to_owned(), found, requirement: requirement.to_owned() };
        self.report(at, kind, "");
    }

    /// A name that must be one of those defined.
    fn known(&mut self, at: &Location, what: &'static str, name: &str, allowed: &[String], help: &str) -> bool {
        let found = allowed.iter().any(|a| a == name);
        if !found {
            let kind = ProblemKind::UnknownName { what, found: name.to_owned(), allowed: allowed.to_vec() };
            self.report(at, kind, help);
        }
        found
    }

    /// Names must differ; the second of two equal ones is reported.
    fn unique(&mut self, table: &str, names: &[&str]) {
        for (index, name) in names.iter().enumerate() {
            if names[..index].contains(name) {
                let cause = format!("the name \"{name}\" is used twice in [[{table}]]");
                self.inconsistent(&top(table).at(index).at("name"), cause, "give each its own name");
            }
        }
    }

    /// A node set; names of a deck do not distinguish case.
    fn node_set(&mut self, at: &Location, name: &str) {
        if let Some(allowed) = self.set_names()
            && !allowed.iter().any(|a| a.eq_ignore_ascii_case(name))
        {
            let kind = ProblemKind::UnknownName { what: "node set", found: name.to_owned(), allowed };
            self.report(at, kind, "");
        }
    }

    /// A surface; names of a deck do not distinguish case.
    fn surface(&mut self, at: &Location, name: &str) {
        let scene = self.scene;
        let generated = scene.strand.as_ref().map(|_| STRAND_SURFACES.map(str::to_owned).to_vec());
        let generated = generated.or(scene.rope.as_ref().map(super::Rope::surface_names));
        let allowed: Vec<String> = match (generated, self.names.filter(|n| !n.includes)) {
            (Some(names), _) => names,
            (None, Some(names)) => names.surfaces.iter().cloned().chain(self.aliases()).collect(),
            (None, None) => return,
        };
        if !allowed.iter().any(|a| a.eq_ignore_ascii_case(name)) {
            let kind = ProblemKind::UnknownName { what: "surface", found: name.to_owned(), allowed };
            self.report(at, kind, "");
        }
    }

    /// Names that the scene gives to sets and surfaces of its deck.
    fn aliases(&self) -> impl Iterator<Item = String> {
        self.scene.deck.iter().flat_map(|d| d.sets.keys().cloned())
    }

    /// The names of node sets, when they are all known.
    fn set_names(&self) -> Option<Vec<String>> {
        if self.scene.strand.is_some() {
            return Some(STRAND_SETS.map(str::to_owned).to_vec());
        }
        if let Some(rope) = &self.scene.rope {
            return Some(rope.set_names());
        }
        let names = self.names.filter(|n| !n.includes)?;
        Some(names.sets.iter().cloned().chain(self.aliases()).chain(["ALL".to_owned()]).collect())
    }
}
