//! `*ELEMENT, TYPE=, ELSET=`: label and nodes, over as many lines as they need.

use super::file_of;
use crate::deck::error::DeckErrorKind;
use crate::deck::fields::{Fields, Item, label};
use crate::deck::keyword::Keyword;
use crate::deck::raw::{Entry, Raw};
use crate::deck::source::{At, Fault, Located};
use std::path::PathBuf;
use subrope_geometry::CellKind;

pub(in crate::deck) struct ElementBlock {
    set: Option<u32>,
    nodes: usize,
    /// Labels of the element that is being read, its own first, and where it began.
    pending: Vec<u64>,
    began: At,
    continued: bool,
}

impl ElementBlock {
    pub fn begin(keyword: &Keyword, raw: &mut Raw) -> Result<Self, DeckErrorKind> {
        keyword.allow("INPUT", &[])?;
        let element_type = keyword.required("TYPE")?.name();
        let kind = match element_type.as_str() {
            "C3D8" => CellKind::Hex8,
            "C3D20" => CellKind::Hex20,
            "C3D20R" => CellKind::Hex20R,
            "C3D27" => CellKind::Hex27,
            _ => return Err(DeckErrorKind::UnsupportedElement { element_type }),
        };
        match raw.elements.kind.replace(kind) {
            Some(other) if other != kind => Err(DeckErrorKind::MixedElements { element_type, nodes: other.nodes() }),
            _ => Ok(Self {
                set: keyword.name_of("ELSET").map(|name| raw.element_sets.define(name, false)),
                nodes: kind.nodes(),
                pending: Vec::with_capacity(kind.nodes() + 1),
                began: At::default(),
                continued: false,
            }),
        }
    }

    pub fn data(&mut self, raw: &mut Raw, files: &[PathBuf], at: At, fields: &Fields) -> Result<(), Fault> {
        if self.pending.is_empty() {
            self.began = at;
        }
        for field in &fields.items {
            self.pending.push(label(field).at(at)?);
        }
        self.continued = fields.continued;
        let complete = self.pending.len() == self.nodes + 1;
        if !complete && (self.pending.len() > self.nodes || !self.continued) {
            return Err(self.wrong_count());
        }
        if complete { self.store(raw, files).at(self.began) } else { Ok(()) }
    }

    pub fn end(self) -> Result<(), Fault> {
        if self.pending.is_empty() { Ok(()) } else { Err(self.wrong_count()) }
    }

    fn wrong_count(&self) -> Fault {
        Fault::new(self.began, DeckErrorKind::FieldCount { expected: self.nodes + 1, got: self.pending.len() })
    }

    fn store(&mut self, raw: &mut Raw, files: &[PathBuf]) -> Result<(), DeckErrorKind> {
        let Some((&element, nodes)) = self.pending.split_first() else { return Ok(()) };
        if let Err(twice) = raw.elements.add(element, nodes, self.began)? {
            let file = file_of(files, &twice);
            return Err(DeckErrorKind::DuplicateElement { label: element, file, line: twice.first.line });
        }
        if let Some(i) = (1..nodes.len()).find(|&i| nodes[..i].contains(&nodes[i])) {
            return Err(DeckErrorKind::RepeatedNode { element, label: nodes[i] });
        }
        if let Some(set) = self.set {
            raw.element_sets.add(set, self.began, Entry::Item(Item::Label(element)));
        }
        self.pending.clear();
        Ok(())
    }
}
