//! Results in the VTKHDF format, version 2.2, type `UnstructuredGrid`, one part.
//!
//! The mesh is written once, arrays are appended step by step; the displacement is point data (Warp By Vector).
//! Readers need VTK 9.3 or newer. Texts (provenance, scene) are kept under `/subrope`, outside `/VTKHDF`: strings in
//! field data crash current readers. Tensors are arrays of 6 or 9 components, because readers drop every array after
//! one of shape (n, 3, 3). The file uses no feature newer than HDF5 1.10, and no file locks, so that a viewer can
//! look at a running computation.

mod arrays;
mod check;
mod image;
mod mesh;
mod reader;
mod storage;
mod writer;

pub use image::ResultImage;
pub use mesh::write_mesh_vtkhdf;
pub use reader::ResultReader;
pub use writer::ResultWriter;

use std::collections::BTreeMap;

/// Where the values of a field live.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Location {
    /// At the nodes.
    Point,
    /// In the cells; one component per integration point is possible.
    Cell,
}

impl Location {
    const fn group(self) -> &'static str {
        match self {
            Self::Point => "PointData",
            Self::Cell => "CellData",
        }
    }

    const fn offsets(self) -> &'static str {
        match self {
            Self::Point => "PointDataOffsets",
            Self::Cell => "CellDataOffsets",
        }
    }
}

/// A field of a result file.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct FieldSpec {
    /// Its name: not empty, without `/`, `.` and control characters.
    pub name: String,
    /// Where its values live.
    pub location: Location,
    /// Components per point or cell, at least 1.
    pub components: usize,
}

impl FieldSpec {
    /// A field at the nodes.
    pub fn point(name: impl Into<String>, components: usize) -> Self {
        Self { name: name.into(), location: Location::Point, components }
    }

    /// A field in the cells.
    pub fn cell(name: impl Into<String>, components: usize) -> Self {
        Self { name: name.into(), location: Location::Cell, components }
    }
}

/// A field and its values, component running fastest.
#[derive(Debug, Clone, Copy)]
pub struct StaticField<'a> {
    /// The field.
    pub spec: &'a FieldSpec,
    /// Points or cells times components.
    pub values: &'a [f64],
}

/// Texts stored under `/subrope` by name: version, scene, host.
pub type Provenance = BTreeMap<String, String>;

/// Number format of fields; coordinates and step values are always double.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Precision {
    /// Single precision, seven digits.
    #[default]
    F32,
    /// Double precision.
    F64,
}

/// How fields are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct WriterOptions {
    /// Number format of fields.
    pub precision: Precision,
    /// Level of compression, 0 to 9; `None` for no compression.
    pub deflate: Option<u8>,
}

/// Single precision, lightly compressed: higher levels take twice the time for a few percent.
impl Default for WriterOptions {
    fn default() -> Self {
        Self { precision: Precision::F32, deflate: Some(1) }
    }
}
