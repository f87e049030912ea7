//! What every keyword does with its data lines.

mod distribution;
mod element;
mod node;
mod orientation;
mod set;
mod surface;

use super::error::DeckErrorKind;
use super::fields::Fields;
use super::keyword::Keyword;
use super::raw::{Raw, RawSection, Twice};
use super::source::{At, Fault, Located};
use distribution::{DistributionBlock, TableBlock};
use element::ElementBlock;
use node::NodeBlock;
use orientation::OrientationBlock;
use set::SetBlock;
use std::path::PathBuf;
use surface::SurfaceBlock;

/// Keywords that would change the mesh: to ignore them would silently give another one.
const MESH_CHANGING: [&str; 8] =
    ["ELCOPY", "ELGEN", "NCOPY", "NFILL", "NGEN", "NMAP", "SYMMETRICMODELGENERATION", "SYSTEM"];

/// The keyword that is being read.
pub(super) enum Block {
    /// Data lines are skipped.
    Skip,
    /// Data lines are refused, because they would move the mesh.
    Refuse(String),
    Node(NodeBlock),
    Element(ElementBlock),
    Set(SetBlock),
    Surface(SurfaceBlock),
    Orientation(OrientationBlock),
    Distribution(DistributionBlock),
    Table(TableBlock),
}

impl Block {
    /// Begins a keyword.
    pub fn begin(keyword: &Keyword, raw: &mut Raw, at: At) -> Result<Self, DeckErrorKind> {
        Ok(match keyword.name.as_str() {
            "HEADING" => Self::Skip,
            "NODE" => Self::Node(NodeBlock::begin(keyword, raw)?),
            "ELEMENT" => Self::Element(ElementBlock::begin(keyword, raw)?),
            "NSET" => Self::Set(SetBlock::nodes(keyword, raw, at)?),
            "ELSET" => Self::Set(SetBlock::elements(keyword, raw)?),
            "SURFACE" => match SurfaceBlock::begin(keyword, raw)? {
                Some(block) => Self::Surface(block),
                None => Self::ignore(keyword, raw, at),
            },
            "ORIENTATION" => Self::Orientation(OrientationBlock::begin(keyword, raw, at)?),
            "DISTRIBUTION" => Self::Distribution(DistributionBlock::begin(keyword, raw)?),
            "DISTRIBUTIONTABLE" => Self::Table(TableBlock::begin(keyword, raw)?),
            "SOLIDSECTION" => Self::section(keyword, raw, at)?,
            "INSTANCE" => Self::instance(keyword, raw, at)?,
            name if MESH_CHANGING.contains(&name) => {
                return Err(DeckErrorKind::UnsupportedKeyword { keyword: keyword.display.clone() });
            }
            _ => Self::ignore(keyword, raw, at),
        })
    }

    fn ignore(keyword: &Keyword, raw: &mut Raw, at: At) -> Self {
        raw.ignored.push((at, keyword.display.clone()));
        Self::Skip
    }

    fn section(keyword: &Keyword, raw: &mut Raw, at: At) -> Result<Self, DeckErrorKind> {
        raw.sections.push(RawSection {
            at,
            elements: keyword.required("ELSET")?.name(),
            material: keyword.name_of("MATERIAL"),
            orientation: keyword.name_of("ORIENTATION"),
        });
        Ok(Self::Skip)
    }

    /// One instance in place is the part itself; a second or a moved one is another mesh.
    fn instance(keyword: &Keyword, raw: &mut Raw, at: At) -> Result<Self, DeckErrorKind> {
        raw.instances += 1;
        if raw.instances > 1 {
            return Err(DeckErrorKind::UnsupportedKeyword { keyword: keyword.display.clone() });
        }
        raw.ignored.push((at, keyword.display.clone()));
        Ok(Self::Refuse(keyword.display.clone()))
    }

    /// Takes a data line.
    pub fn data(&mut self, raw: &mut Raw, files: &[PathBuf], at: At, line: &str) -> Result<(), Fault> {
        let fields = match self {
            Self::Skip => return Ok(()),
            Self::Refuse(keyword) => Err(DeckErrorKind::UnsupportedKeyword { keyword: keyword.clone() }),
            _ => Fields::parse(line),
        };
        let fields = fields.at(at)?;
        match self {
            Self::Skip | Self::Refuse(_) => Ok(()),
            Self::Node(block) => block.data(raw, files, at, &fields).at(at),
            Self::Element(block) => block.data(raw, files, at, &fields),
            Self::Set(block) => block.data(raw, at, &fields).at(at),
            Self::Surface(block) => block.data(raw, at, &fields).at(at),
            Self::Orientation(block) => block.data(&fields).at(at),
            Self::Distribution(block) => block.data(raw, at, &fields).at(at),
            Self::Table(block) => block.data(raw, &fields).at(at),
        }
    }

    /// Ends the keyword.
    pub fn end(self, raw: &mut Raw) -> Result<(), Fault> {
        match self {
            Self::Element(block) => block.end(),
            Self::Orientation(block) => block.end(raw),
            Self::Distribution(block) => block.end(raw),
            _ => Ok(()),
        }
    }
}

fn file_of(files: &[PathBuf], twice: &Twice) -> PathBuf {
    files.get(twice.first.file as usize).cloned().unwrap_or_default()
}
