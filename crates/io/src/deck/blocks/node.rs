//! `*NODE, NSET=`: label, x, y, z.

use super::file_of;
use crate::deck::error::DeckErrorKind;
use crate::deck::fields::{Fields, Item, label, number};
use crate::deck::keyword::Keyword;
use crate::deck::raw::{Entry, Raw};
use crate::deck::source::At;
use nalgebra::Vector3;
use std::path::PathBuf;

pub(in crate::deck) struct NodeBlock {
    set: Option<u32>,
}

impl NodeBlock {
    pub fn begin(keyword: &Keyword, raw: &mut Raw) -> Result<Self, DeckErrorKind> {
        keyword.allow("SYSTEM", &["R", "RECTANGULAR"])?;
        keyword.allow("INPUT", &[])?;
        Ok(Self { set: keyword.name_of("NSET").map(|name| raw.node_sets.define(name, false)) })
    }

    pub fn data(&mut self, raw: &mut Raw, files: &[PathBuf], at: At, fields: &Fields) -> Result<(), DeckErrorKind> {
        let [node, x, y, z] = fields.exactly()?;
        let node = label(node)?;
        let point = Vector3::new(number(x)?, number(y)?, number(z)?);
        if let Err(twice) = raw.nodes.add(node, point, at)? {
            let file = file_of(files, &twice);
            return Err(DeckErrorKind::DuplicateNode { label: node, file, line: twice.first.line });
        }
        if let Some(set) = self.set {
            raw.node_sets.add(set, at, Entry::Item(Item::Label(node)));
        }
        Ok(())
    }
}
