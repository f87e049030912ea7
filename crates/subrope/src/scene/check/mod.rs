//! Checks of a scene that need more than one value.

mod boundary;
mod contact;
mod law;
mod mesh;
mod motion;
mod names;
mod output;
mod sizing;
mod slice;
mod step;

pub(crate) use law::check_law;

use std::collections::BTreeSet;

use super::Scene;
use super::sets::DeckNames;
use crate::document::{Document, Location, MOST_PROBLEMS, Problem, ProblemKind};
use names::{Names, SetNames};

/// Names that a message lists.
const MOST_NAMES: usize = 100;

/// All problems of a scene; `names` are those of its deck, when it has been opened.
pub(super) fn check(scene: &Scene, document: &Document, names: Option<&DeckNames>) -> Vec<Problem> {
    let sets = SetNames::of(scene, names);
    let mut checker = Checker { scene, document, names, sets: &sets, problems: Vec::new() };
    checker.mesh();
    checker.law();
    checker.boundary();
    checker.contacts();
    checker.slice();
    checker.output();
    checker.steps();
    checker.problems
}

struct Checker<'a> {
    scene: &'a Scene,
    document: &'a Document,
    names: Option<&'a DeckNames>,
    sets: &'a SetNames,
    problems: Vec<Problem>,
}

fn top(key: &str) -> Location {
    Location::root().at(key)
}

impl Checker<'_> {
    /// Whether more problems would be read by nobody.
    fn is_full(&self) -> bool {
        self.problems.len() >= MOST_PROBLEMS
    }

    fn report(&mut self, at: &Location, kind: ProblemKind, help: &str) {
        if self.is_full() {
            return;
        }
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
    fn known<'n>(
        &mut self,
        at: &Location,
        what: &'static str,
        name: &str,
        allowed: impl Iterator<Item = &'n str> + Clone,
        help: &str,
    ) -> bool {
        let found = allowed.clone().any(|a| a == name);
        if !found && !self.is_full() {
            let allowed = allowed.take(MOST_NAMES).map(str::to_owned).collect();
            self.report(at, ProblemKind::UnknownName { what, found: name.to_owned(), allowed }, help);
        }
        found
    }

    /// Names must differ; the second of two equal ones is reported.
    fn unique(&mut self, table: &str, names: &[&str]) {
        let mut seen = BTreeSet::new();
        for (index, name) in names.iter().enumerate() {
            if !seen.insert(name) {
                let cause = format!("the name \"{name}\" is used twice in [[{table}]]");
                self.inconsistent(&top(table).at(index).at("name"), cause, "give each its own name");
            }
        }
    }

    /// A node set; names of a deck do not distinguish case.
    fn node_set(&mut self, at: &Location, name: &str) {
        self.one_of(at, "node set", name, self.sets.nodes.as_ref());
    }

    /// A surface; names of a deck do not distinguish case.
    fn surface(&mut self, at: &Location, name: &str) {
        self.one_of(at, "surface", name, self.sets.surfaces.as_ref());
    }

    /// A name among those known, if they are.
    fn one_of(&mut self, at: &Location, what: &'static str, name: &str, known: Option<&Names>) {
        if let Some(known) = known.filter(|known| !known.has(name))
            && !self.is_full()
        {
            let allowed = known.listed.iter().take(MOST_NAMES).cloned().collect();
            self.report(at, ProblemKind::UnknownName { what, found: name.to_owned(), allowed }, "");
        }
    }
}
