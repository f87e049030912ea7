//! Going on with a run that was stopped.

use std::path::{Path, PathBuf};

use subrope_fem::FemError;
use subrope_io::IoError;

use super::checkpoint::{Found, VERSION};
use super::clock::Clock;
use super::session::Session;
use super::{RunError, RunOptions, RunOutcome, SUMMARY, ready};
use crate::Error;
use crate::model::RopeModel;
use crate::plan::Plan;
use crate::progress::Observer;
use crate::scene::SceneFile;

/// Why a run cannot go on.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RestartError {
    /// There is nothing to go on from.
    #[error("there is no checkpoint in {}", folder.display())]
    Missing {
        /// The folder.
        folder: PathBuf,
    },
    /// The checkpoint is damaged or cannot be read.
    #[error(transparent)]
    Checkpoint(IoError),
    /// The checkpoint belongs to another scene, or its deck has changed.
    #[error(
        "{} was written by another scene or with another deck: SHA-256 {found}, this one has {scene}", path.display()
    )]
    OtherScene {
        /// The checkpoint.
        path: PathBuf,
        /// SHA-256 of the scene that wrote it.
        found: String,
        /// SHA-256 of the scene at hand.
        scene: String,
    },
    /// The checkpoint was written by another version of the program.
    #[error("{} was written by version {found} of the program, this is {VERSION}", path.display())]
    OtherVersion {
        /// The checkpoint.
        path: PathBuf,
        /// Its version.
        found: String,
    },
    /// The checkpoint does not fit the model.
    #[error("the checkpoint does not fit the model: {cause}")]
    State {
        /// Why.
        cause: Box<FemError>,
    },
    /// A file of the run is not what the checkpoint knows.
    #[error("the results do not fit the checkpoint: {0}")]
    Results(IoError),
}

impl RestartError {
    /// What to try next.
    #[must_use]
    pub fn advice(&self) -> &'static str {
        match self {
            Self::Missing { .. } => {
                "run without --restart; checkpoints are written every output.checkpoint_every increments, into the folder \
                 of the results (--out)"
            }
            Self::Checkpoint(_) => {
                "rename checkpoint.previous to checkpoint to go on from the one before, or run without --restart"
            }
            Self::OtherScene { .. } => {
                "restore the scene as it was (its text stands in results.vtkhdf), choose another folder (--out), or run \
                 without --restart"
            }
            Self::OtherVersion { .. } => "go on with that version, or run without --restart",
            Self::State { .. } => "run without --restart",
            Self::Results(_) => {
                "put the files of the run back as the program left them, or run without --restart to begin anew"
            }
        }
    }
}

/// Goes on with a run from the last checkpoint in its folder: files are cut back to what the checkpoint knows, and what
/// follows is the same bit by bit as in a run that was never stopped. Answers nothing, and touches nothing, when the run is
/// done already.
///
/// # Errors
/// [`Error::Scene`], [`Error::Model`] for what is wrong in the input; [`Error::Run`] with [`RestartError`] when there is no
/// checkpoint or none that fits; else as [`run_scene`](super::run_scene).
pub fn restart_scene(
    path: &Path,
    options: RunOptions<'_>,
    observer: &mut dyn Observer,
) -> Result<Option<RunOutcome>, Error> {
    let file = SceneFile::load(path)?;
    let folder = options.folder.map_or_else(|| file.output_folder(), Path::to_path_buf);
    if is_done(&file, &folder) {
        return Ok(None);
    }
    let found = Found::of(&file, &folder).map_err(RunError::from)?;
    if found.is_previous {
        observer.on_warning(&"there is no last checkpoint: the run goes on from the one before");
    }
    let mut model = ready(RopeModel::new(&file, options.threads)?, observer);
    let clock = Clock::start();
    found.restore(&mut model.analysis).map_err(RunError::from)?;
    model.check_memory()?;
    observer.on_plan(&Plan::new(&file.scene, &model));
    let totals = model.analysis.totals();
    observer.on_restart(totals.increments, model.analysis.time());
    let session = Session::resume(&file, &model, &folder, (clock, &options), &found)?;
    session.run(&mut model, options.interrupt, observer).map(Some)
}

/// Whether the summary in a folder is that of a run of this scene by this version that is done.
fn is_done(file: &SceneFile, folder: &Path) -> bool {
    let Ok(text) = std::fs::read(folder.join(SUMMARY)) else { return false };
    let Ok(summary) = serde_json::from_slice::<serde_json::Value>(&text) else { return false };
    summary["status"]["state"] == "done" && summary["scene_hash"] == file.hash.as_str() && summary["version"] == VERSION
}
