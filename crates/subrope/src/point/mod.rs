//! Paths of one material point: a law driven through given deformations, without a mesh.
//!
//! Two files say the same. The JSON form ([`PathFile`]) holds paths of single steps with everything computed and is
//! written back with the same keys and layout. The TOML form ([`PathScene`]) is for people: the `[law]` of a scene, a
//! fibre direction and a few targets, between which the deformation is interpolated; it becomes a [`PathFile`]. A third is
//! written by a run that stopped where the law had no answer ([`FailedPointFile`]): the law is asked the same again.
//!
//! Units: MPa, mm, mJ/mm^3.

mod compute;
mod error;
mod failed;
mod format;
mod list;
mod modes;
mod parameters;
mod record;
mod table;
mod targets;

use std::path::Path;

use subrope_io::input;

pub use compute::compute;
pub use error::{EntryFault, Place, PointError};
pub use failed::{Asked, FailedPointFile, Failure};
pub use format::to_json;
pub use modes::displacement_gradient_of;
pub use parameters::Params;
pub use record::{PathFile, PathRecord, StepRecord, Tensor, parse as parse_json};
pub use table::to_csv;
pub use targets::{PathScene, Target};

/// What a point file holds.
#[derive(Clone, Debug)]
pub enum PointFile {
    /// Paths to drive a law along.
    Paths(PathFile),
    /// A point at which a run failed.
    Failed(Box<FailedPointFile>),
}

/// Reads a point file, JSON or (by its name's ending) TOML.
///
/// # Errors
/// [`PointError::Read`], and [`PointError::Invalid`] (TOML), [`PointError::Json`] or [`PointError::Entry`] (JSON).
pub fn read(path: &Path) -> Result<PointFile, PointError> {
    let people = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml"));
    let text = input::read_text(path, if people { input::MAX_TEXT } else { input::MAX_TABLE });
    let text = text.map_err(|source| PointError::Read { path: path.to_owned(), source })?;
    let name = path.display().to_string();
    if !people {
        return Ok(PointFile::Paths(parse_json(&name, &text)?));
    }
    Ok(match FailedPointFile::from_toml(&name, &text)? {
        Some(failed) => PointFile::Failed(Box::new(failed)),
        None => PointFile::Paths(PathScene::from_toml(&name, &text)?.path_file(&name)?),
    })
}

/// Reads a file of paths: [`read`] for who drives a law.
///
/// # Errors
/// As [`read`]; [`PointError::NoPaths`] for a point at which a run failed.
pub fn load(path: &Path) -> Result<PathFile, PointError> {
    match read(path)? {
        PointFile::Paths(paths) => Ok(paths),
        PointFile::Failed(_) => Err(PointError::NoPaths { path: path.to_owned() }),
    }
}
