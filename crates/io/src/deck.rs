//! Abaqus and CalculiX input decks: meshes, sets, surfaces, orientations.

mod blocks;
mod error;
mod fields;
mod keyword;
mod raw;
mod resolve;
mod source;
mod write;

pub use error::{DeckError, DeckErrorKind};
pub use write::{DeckView, NumberFormat, write_deck};

use crate::error::IoError;
use blocks::Block;
use nalgebra::Matrix3;
use raw::Raw;
use source::{Fault, Line, Source};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use subrope_geometry::Mesh;

/// What a deck holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Deck {
    /// The mesh with its node sets, element sets and surfaces; names are in upper case.
    ///
    /// Sets and surfaces marked `INTERNAL` in the deck are used where named, but not kept.
    pub mesh: Mesh,
    /// Fibre frame of every cell, columns e1, e2, e3; `None` without an orientation.
    pub frames: Vec<Option<Matrix3<f64>>>,
    /// Names of the materials of the sections, in the order of their first use.
    pub material_names: Vec<String>,
    /// Material of every cell as an index into `material_names`; `None` without a section or without a material.
    pub materials: Vec<Option<u32>>,
    /// Keywords that have no meaning here; their data lines were skipped.
    pub ignored: Vec<Ignored>,
    /// Label and coordinates \[mm\] of nodes that no element uses, for example reference nodes of rigid bodies.
    pub unused_nodes: Vec<(u64, [f64; 3])>,
    /// Sets and surfaces without members, or left without members when unused nodes were dropped.
    pub dropped_sets: Vec<String>,
}

impl Deck {
    /// Name of the material of a cell.
    pub fn material(&self, cell: usize) -> Option<&str> {
        let index = self.materials.get(cell).copied().flatten()?;
        self.material_names.get(index as usize).map(String::as_str)
    }
}

/// A keyword without meaning here.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Ignored {
    /// File in which it stands.
    pub file: PathBuf,
    /// One-based line.
    pub line: u32,
    /// The keyword in upper case, without the asterisk.
    pub keyword: String,
}

/// Reads a deck and the files it includes.
///
/// Keywords: `*NODE`, `*ELEMENT` (C3D8, C3D20, C3D20R, C3D27), `*NSET`, `*ELSET`, `*SURFACE` (of element faces), `*ORIENTATION`
/// (rectangular), `*DISTRIBUTION`, `*DISTRIBUTION TABLE`, `*SOLID SECTION`, `*INCLUDE`, `*HEADING`. Keywords that would
/// change the mesh (`*NGEN`, `*SYSTEM`, several instances) are refused, all others are listed in [`Deck::ignored`].
/// Sets may name sets defined above them. Paths of included files are relative to the including file. A node of a
/// 27-node brick beyond the twentieth is recognised by its position, because codes order them differently.
///
/// The coordinates are taken as they are; whether bricks are inverted is for the mesh to tell.
///
/// # Errors
/// [`IoError::Read`] when the deck itself cannot be read, [`IoError::Deck`] with file, line and text for everything
/// else. Memory stays within a constant factor of the size of the files and of the sets they define, which is bounded.
pub fn read_deck(path: &Path) -> Result<Deck, IoError> {
    let mut source = match Source::open(path) {
        Ok(source) => source,
        Err(DeckErrorKind::Unreadable { path, source }) => return Err(IoError::Read { path, source }),
        Err(kind) => return Err(DeckError { file: path.to_path_buf(), line: 0, text: "".into(), kind }.into()),
    };
    parse(&mut source).map_err(|fault| describe(fault, &source.files, None).into())
}

/// Reads a deck from a text; `name` stands for it in messages, and its folder is where included files are looked for.
///
/// # Errors
/// As [`read_deck`].
pub fn parse_deck(name: &Path, text: &str) -> Result<Deck, IoError> {
    let mut source = Source::text(name, text);
    parse(&mut source).map_err(|fault| describe(fault, &source.files, Some(text)).into())
}

/// Reads a deck from texts by their names, among which `name` and all that it includes are looked for; no file is opened.
///
/// # Errors
/// As [`read_deck`].
pub fn parse_deck_of(name: &Path, texts: &BTreeMap<PathBuf, Vec<u8>>) -> Result<Deck, IoError> {
    let text = texts.get(name).map(|bytes| String::from_utf8_lossy(bytes).into_owned()).unwrap_or_default();
    let mut source = Source::texts(name, texts.clone());
    parse(&mut source).map_err(|fault| describe(fault, &source.files, Some(&text)).into())
}

fn parse(source: &mut Source) -> Result<Deck, Fault> {
    let mut raw = Raw::default();
    let mut block = None;
    while let Some((at, line)) = source.next()? {
        match line {
            Line::Keyword(keyword) => {
                if let Some(ended) = block.take() {
                    Block::end(ended, &mut raw)?;
                }
                block = Some(Block::begin(&keyword, &mut raw, at).map_err(|kind| Fault::new(at, kind))?);
            }
            Line::Data(data) => match &mut block {
                Some(block) => block.data(&mut raw, &source.files, at, &data)?,
                None => return Err(Fault::new(at, DeckErrorKind::NoKeyword)),
            },
        }
    }
    if let Some(ended) = block {
        ended.end(&mut raw)?;
    }
    resolve::resolve(&raw, &source.files)
}

/// Adds the name of the file and the text of the line, which is looked up again: errors are rare, lines are many.
fn describe(fault: Fault, files: &[PathBuf], main: Option<&str>) -> DeckError {
    let file = files.get(fault.at.file as usize).cloned().unwrap_or_default();
    let index = (fault.at.line as usize).checked_sub(1);
    let text = index.and_then(|index| match (main, fault.at.file) {
        (Some(text), 0) => text.lines().nth(index).map(str::to_owned),
        _ => line_of(&file, index),
    });
    let text: String = text.unwrap_or_default().trim().chars().take(200).collect();
    DeckError { file, line: fault.at.line, text: text.into(), kind: fault.kind }
}

fn line_of(path: &Path, index: usize) -> Option<String> {
    let lines = BufReader::new(File::open(path).ok()?).split(b'\n');
    let line = lines.map_while(Result::ok).nth(index)?;
    Some(String::from_utf8_lossy(&line).into_owned())
}
