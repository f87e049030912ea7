//! The point at which a run failed, as a file that `subrope point` takes.

use std::path::{Path, PathBuf};

use subrope_fem::FemError;
use subrope_io::atomic::write_atomically;
use subrope_io::{Action, IoError, OutputCause, OutputError};

use crate::model::RopeModel;
use crate::point::{Asked, FailedPointFile, Failure};
use crate::scene::Scene;

/// Name of the file.
pub const FILE: &str = "failed_point.toml";

/// Writes the point at which a law gave no answer, if that is what ended the run.
///
/// # Errors
/// [`IoError::Output`].
pub fn write(folder: &Path, scene: &Scene, model: &RopeModel, cause: &FemError) -> Result<Option<PathBuf>, IoError> {
    let Some((element, point, asked, source)) = cause.failed_point() else { return Ok(None) };
    let analysis = &model.analysis;
    let file = FailedPointFile {
        title: scene.title.clone(),
        failure: Failure {
            message: source.to_string(),
            element,
            point,
            strand: strand_of(model, element),
            step: analysis.steps_done() + 1,
            increment: analysis.totals().increments + 1,
            time: analysis.time(),
        },
        asked: Asked::of(asked),
        law: scene.law.clone(),
    };
    let path = folder.join(FILE);
    let text = file.to_toml().map_err(|error| {
        let cause = OutputCause::System(std::io::Error::other(error));
        OutputError { path: path.clone(), action: Action::Write, cause }
    })?;
    write_atomically(&path, text.as_bytes())?;
    Ok(Some(path))
}

/// Strand of an element of a rope, from 1.
fn strand_of(model: &RopeModel, label: u64) -> Option<u32> {
    let cell = model.mesh.mesh.cell_labels.iter().position(|l| *l == label)?;
    model.mesh.rope.as_ref()?.strand_of_cell.get(cell).map(|strand| strand + 1)
}
