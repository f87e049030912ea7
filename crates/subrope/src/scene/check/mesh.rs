//! Checks of strand, deck and element.

use super::names::Names;
use super::{Checker, top};
use crate::document::Location;
use crate::scene::{Deck, Fibres, Formulation, HelixFibres, Strand};

impl Checker<'_> {
    pub(super) fn mesh(&mut self) {
        let scene = self.scene;
        let meshes =
            [("strand", scene.strand.is_some()), ("rope", scene.rope.is_some()), ("deck", scene.deck.is_some())];
        let given: Vec<&str> = meshes.iter().filter(|(_, given)| *given).map(|(key, _)| *key).collect();
        match given[..] {
            [] => {
                let help = "add [strand] or [rope] (a generated mesh), or [deck] (a mesh from an Abaqus file)";
                self.inconsistent(&Location::root(), "the scene has no mesh", help);
            }
            [first, second, ..] => {
                let cause = format!("a scene has either [{first}] or [{second}], not both");
                self.inconsistent(&top(second), cause, "keep one of [strand], [rope] and [deck]");
            }
            _ => {}
        }
        if let Some(rope) = &scene.rope {
            self.rope(rope);
        }
        if let Some(strand) = &scene.strand {
            self.strand(strand);
        }
        if let Some(deck) = &scene.deck {
            self.deck(deck);
        }
        self.formulation();
    }

    fn strand(&mut self, strand: &Strand) {
        let at = top("strand");
        match (strand.surface_angle, strand.pitch) {
            (Some(_), Some(_)) => {
                let help = "tan(surface_angle) = 2 pi radius / pitch: give one of the two";
                self.inconsistent(&at.at("pitch"), "`surface_angle` and `pitch` exclude each other", help);
            }
            (None, None) => {
                let help = "or `pitch` (mm); surface_angle = 0 means straight rope-yarns";
                self.missing(&at, "surface_angle", help);
            }
            _ => {}
        }
        self.yarn_bending(strand);
    }

    /// The bending stiffness of rope-yarns belongs to mesh lines along them, and those bend at inner nodes.
    fn yarn_bending(&mut self, strand: &Strand) {
        if strand.yarn_bending.is_none() {
            return;
        }
        let at = top("strand").at("yarn_bending");
        if !strand.has_lines_along_yarns() {
            let cause =
                "the mesh lines of the strand run along its axis, and rope-yarns that bend need lines along them";
            self.inconsistent(&at, cause, "set lines = \"yarns\" in [strand.mesh], or leave out [strand.yarn_bending]");
        }
        if strand.mesh.layers < 2 {
            let cause = "in one layer of bricks no mesh line has an inner node at which it could bend";
            self.inconsistent(&at, cause, "layers = 2 or more in [strand.mesh]");
        }
    }

    fn deck(&mut self, deck: &Deck) {
        let at = top("deck");
        match &deck.fibres {
            Fibres::Deck => {}
            Fibres::Parallel(direction) => self.direction(&at.at("fibres").at("parallel"), "parallel", *direction),
            Fibres::Helix(helix) => self.helix(&at.at("fibres").at("helix"), helix),
        }
        let Some(names) = self.names.filter(|n| !n.includes) else { return };
        let known = Names::new(names.sets.union(&names.surfaces).cloned().collect());
        for (alias, name) in &deck.sets {
            self.one_of(&at.at("sets").at(alias.as_str()), "node set or surface in the deck", name, Some(&known));
        }
    }

    fn direction(&mut self, at: &Location, key: &str, direction: [f64; 3]) {
        if direction.iter().all(|c| *c == 0.0) {
            self.inconsistent(at, format!("`{key}` is a direction and cannot be zero"), "");
        }
    }

    fn helix(&mut self, at: &Location, helix: &HelixFibres) {
        self.direction(&at.at("axis"), "axis", helix.axis);
        let help = "give either `pitch`, or `angle` and `radius`";
        match (helix.pitch, helix.angle, helix.radius) {
            (Some(_), None, None) | (None, Some(_), Some(_)) => {}
            (None, Some(_), None) => self.missing(at, "radius", help),
            (None, None, Some(_)) => self.missing(at, "angle", help),
            (None, None, None) => self.missing(at, "pitch", help),
            (Some(_), _, _) => {
                self.inconsistent(&at.at("pitch"), "`pitch` excludes `angle` and `radius`", help);
            }
        }
    }

    fn formulation(&mut self) {
        self.touching();
        let (element, law) = (&self.scene.element, &self.scene.law);
        if element.formulation != Formulation::Hex8MeanElongation || law.has_fibre_term() {
            return;
        }
        let own = top("element").at("formulation");
        let at = if self.document.contains(&own) { own } else { top("law").at("kind") };
        let cause = format!(
            "the formulation \"{}\" averages a fibre term, and the law \"{}\" has none",
            element.formulation.word(),
            law.word()
        );
        let help = "choose [element] formulation = \"hex8\", \"hex8_mean_volume\", \"hex20\", \"hex20r\" or \"hex27\"; laws with a fibre \
                    term: bundle, charmetant, fibre_reinforced";
        self.inconsistent(&at, cause, help);
    }

    /// Faces of 20-node bricks have no node in their middle, without which there is no smooth surface.
    fn touching(&mut self) {
        let (scene, formulation) = (self.scene, self.scene.element.formulation);
        let what = match (&scene.rope, scene.contact.is_empty()) {
            (Some(_), _) => "the strands of a [rope]",
            (None, false) => "surfaces of a [[contact]]",
            (None, true) => return,
        };
        if !formulation.can_touch() {
            let word = formulation.word();
            let cause = format!(
                "{what} touch along smooth surfaces, for which the bricks of \"{word}\" lack the nodes in the middle of \
                 their faces"
            );
            let help = "choose formulation = \"hex8_mean_elongation\" or \"hex27\"";
            self.inconsistent(&top("element").at("formulation"), cause, help);
        }
    }
}
