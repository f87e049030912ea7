//! Paths of one material point: a law driven through given deformations, without a mesh.
//!
//! Two files say the same. The JSON form ([`PathFile`]) holds paths of single steps with everything computed and is
//! written back with the same keys and layout. The TOML form ([`PathScene`]) is for people: the `[law]` of a scene, a
//! fibre direction and a few targets, between which the deformation is interpolated; it becomes a [`PathFile`].
//!
//! Units: MPa, mm, mJ/mm^3.

mod compute;
mod error;
mod format;
mod list;
mod modes;
mod parameters;
mod record;
mod table;
mod targets;

use std::path::Path;

pub use compute::compute;
pub use error::{EntryFault, Place, PointError};
pub use format::to_json;
pub use modes::displacement_gradient_of;
pub use parameters::Params;
pub use record::{PathFile, PathRecord, StepRecord, Tensor};
pub use table::to_csv;
pub use targets::{PathScene, Target};

/// Reads a point file, JSON or (by its name's ending) TOML.
///
/// # Errors
/// [`PointError::Read`], and [`PointError::Invalid`] (TOML), [`PointError::Json`] or [`PointError::Entry`] (JSON).
pub fn load(path: &Path) -> Result<PathFile, PointError> {
    let text = std::fs::read_to_string(path).map_err(|source| PointError::Read { path: path.to_owned(), source })?;
    let name = path.display().to_string();
    if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml")) {
        PathScene::from_toml(&name, &text)?.path_file(&name)
    } else {
        record::parse(&name, &text)
    }
}
