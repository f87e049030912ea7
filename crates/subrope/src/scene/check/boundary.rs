//! Checks of reference points and constraints.

use super::{Checker, top};
use crate::document::{Location, ProblemKind};
use crate::scene::{End, EndKind};

impl Checker<'_> {
    pub(super) fn boundary(&mut self) {
        let scene = self.scene;
        self.unique("end", &scene.end.iter().map(|e| e.name.as_str()).collect::<Vec<_>>());
        self.unique("constraint", &scene.constraint.iter().map(|c| c.name.as_str()).collect::<Vec<_>>());
        for (index, end) in scene.end.iter().enumerate() {
            let at = top("end").at(index);
            let help = "letters, digits, _, -, + and blanks within; give the node set by `set`";
            self.heading(&at.at("name"), &end.name, help);
            let key = if end.set.is_some() { "set" } else { "name" };
            self.node_set(&at.at(key), end.set());
            if end.kind == EndKind::Sliding {
                self.sliding(&at, end);
            }
            if let Some(other) = scene.end[..index].iter().find(|o| o.set().eq_ignore_ascii_case(end.set())) {
                let cause = format!("the set \"{}\" is already carried by \"{}\"", end.set(), other.name);
                self.inconsistent(&at.at(key), cause, "a node follows one reference point only");
            }
        }
        for (index, constraint) in scene.constraint.iter().enumerate() {
            let at = top("constraint").at(index);
            self.node_set(&at.at("set"), &constraint.set);
            if constraint.components.values().iter().all(Option::is_none) {
                self.inconsistent(&at.at("components"), "the constraint has no component", "for example { uz = 0.0 }");
            }
        }
    }

    /// Only the end of a strand of a rope has a radius to slide on.
    fn sliding(&mut self, at: &Location, end: &End) {
        let Some(rope) = &self.scene.rope else {
            let cause = format!("the end \"{}\" is \"sliding\", and the scene has no strands of a [rope]", end.name);
            let help = "give a [rope], or kind = \"rigid\" or \"radial\" (each node free along its own radius)";
            return self.inconsistent(&at.at("kind"), cause, help);
        };
        let allowed = rope.end_sets();
        if !allowed.iter().any(|set| set.eq_ignore_ascii_case(end.set())) {
            let key = if end.set.is_some() { "set" } else { "name" };
            let kind =
                ProblemKind::UnknownName { what: "end of the rope's strands", found: end.set().to_owned(), allowed };
            self.report(&at.at(key), kind, "a \"sliding\" end carries the end of all strands or of one");
        }
    }
}
