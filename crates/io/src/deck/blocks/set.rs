//! `*NSET` and `*ELSET`: labels, names of sets defined above, generated ranges.

use crate::deck::error::DeckErrorKind;
use crate::deck::fields::{Fields, Item, label};
use crate::deck::keyword::Keyword;
use crate::deck::raw::{Entry, Raw, Sets};
use crate::deck::source::At;

pub(in crate::deck) struct SetBlock {
    of_nodes: bool,
    set: u32,
    generate: bool,
}

impl SetBlock {
    pub fn nodes(keyword: &Keyword, raw: &mut Raw, at: At) -> Result<Self, DeckErrorKind> {
        let set = raw.node_sets.define(keyword.required("NSET")?.name(), keyword.has("INTERNAL"));
        if let Some(elements) = keyword.name_of("ELSET") {
            raw.node_sets.add(set, at, Entry::NodesOf(elements));
        }
        Ok(Self { of_nodes: true, set, generate: keyword.has("GENERATE") })
    }

    pub fn elements(keyword: &Keyword, raw: &mut Raw) -> Result<Self, DeckErrorKind> {
        let set = raw.element_sets.define(keyword.required("ELSET")?.name(), keyword.has("INTERNAL"));
        Ok(Self { of_nodes: false, set, generate: keyword.has("GENERATE") })
    }

    pub fn data(&mut self, raw: &mut Raw, at: At, fields: &Fields) -> Result<(), DeckErrorKind> {
        let sets: &mut Sets = if self.of_nodes { &mut raw.node_sets } else { &mut raw.element_sets };
        if self.generate {
            sets.add(self.set, at, range(fields)?);
            return Ok(());
        }
        for field in fields.items.iter().filter(|field| !field.is_empty()) {
            sets.add(self.set, at, Entry::Item(Item::parse(field)?));
        }
        Ok(())
    }
}

fn range(fields: &Fields) -> Result<Entry, DeckErrorKind> {
    let (first, last, step) = match fields.items.as_slice() {
        [first, last] | [first, last, ""] => (label(first)?, label(last)?, 1),
        [first, last, step] => (label(first)?, label(last)?, label(step)?),
        other => return Err(DeckErrorKind::FieldCount { expected: 3, got: other.len() }),
    };
    match first <= last {
        true => Ok(Entry::Range { first, last, step }),
        false => Err(DeckErrorKind::BadRange { first, last, step }),
    }
}
