//! Why a run ended early.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use subrope_fem::FemError;
use subrope_io::IoError;

use super::restart::RestartError;
use crate::error::ExitCode;

/// Why a run ended early.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// No equilibrium, or a model that cannot be solved.
    #[error("{cause}{}", replayed(point.as_deref()))]
    Solver {
        /// What the kernel says.
        cause: Box<FemError>,
        /// Folder with the results up to the last converged increment, if there is one.
        kept: Option<PathBuf>,
        /// File with the point at which the law had no answer, if that is the cause.
        point: Option<PathBuf>,
    },
    /// The user stopped the run; results are complete up to the last converged increment.
    #[error("interrupted after increment {increments}; results up to there are in {}", folder.display())]
    Interrupted {
        /// Converged increments.
        increments: usize,
        /// Folder of the results.
        folder: PathBuf,
        /// Whether there is a checkpoint to go on from.
        restart: bool,
    },
    /// The run cannot go on.
    #[error(transparent)]
    Restart(Box<RestartError>),
    /// Results could not be written, and there is a checkpoint to go on from.
    #[error("{cause}; --restart goes on after increment {increments}")]
    Halted {
        /// What failed.
        cause: Box<IoError>,
        /// Increments at the checkpoint.
        increments: usize,
    },
    /// Results could not be written.
    #[error(transparent)]
    Output(#[from] IoError),
    /// The folder of the results could not be made.
    #[error("cannot make the folder {}: {source}", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A file of an earlier run could not be taken away.
    #[error("cannot replace {}: {source}", path.display())]
    Replace {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
}

impl RunError {
    /// The exit code that answers it.
    #[must_use]
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Self::Solver { cause, .. } => match cause.as_ref() {
                FemError::IncrementTooShort { .. }
                | FemError::FixedIncrementFailed { .. }
                | FemError::TooManyIncrements { .. } => ExitCode::NotConverged,
                cause if cause.is_recoverable() => ExitCode::NotConverged,
                _ => ExitCode::Input,
            },
            Self::Interrupted { .. } => ExitCode::NotConverged,
            Self::Restart(_) => ExitCode::Input,
            Self::Output(_) | Self::Halted { .. } | Self::Folder { .. } | Self::Replace { .. } => ExitCode::Output,
        }
    }

    /// What to try next.
    #[must_use]
    pub fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Solver { cause, .. } => match cause.as_ref() {
                FemError::IncrementTooShort { .. } => Some(
                    "the structure may pass a limit point here: follow the path beyond it if you do not yet (increments.control = \"arc_length\"), allow smaller \
                     increments (increments.minimum), more iterations (solver.max_iterations), or damp the jump (solver.stabilisation); a section that yields \
                     without hardening wrinkles under pressure: rope-yarns whose friction grows with it (law.mu_t, \
                     law.mu_l) or that harden (law.H_t, law.X_t) stand; long strands that just touch start more easily \
                     with a toe (contact.toe); results up to the last converged increment are kept",
                ),
                FemError::FixedIncrementFailed { .. } => {
                    Some("take more increments (increments.fixed), or leave `fixed` out and let the program choose")
                }
                FemError::TooManyIncrements { .. } => Some("raise increments.max_count"),
                FemError::RigidModes { .. } => {
                    Some("give the part an [[end]] with prescribed motion, or a [[constraint]] on a node set")
                }
                _ => None,
            },
            Self::Interrupted { restart, .. } => restart.then_some("--restart goes on from there"),
            Self::Restart(error) => Some(error.advice()),
            Self::Output(cause) => advice_on(cause),
            Self::Halted { cause, .. } => advice_on(cause),
            Self::Folder { source, .. } | Self::Replace { source, .. } => output_advice(source.kind()),
        }
    }
}

/// Where a failed point was written to.
fn replayed(point: Option<&Path>) -> String {
    point.map_or_else(String::new, |path| format!("; the point is in {0}: subrope point {0}", path.display()))
}

fn advice_on(cause: &IoError) -> Option<&'static str> {
    match cause {
        IoError::Value(_) => {
            Some("a result is not finite or too large for single precision: check the units of the scene")
        }
        other => output_advice(other.system_kind()?),
    }
}

impl From<RestartError> for RunError {
    fn from(error: RestartError) -> Self {
        Self::Restart(Box::new(error))
    }
}

/// What to do when the system refuses an output.
pub(crate) fn output_advice(kind: ErrorKind) -> Option<&'static str> {
    match kind {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::FileTooLarge => {
            Some("free some space, or write elsewhere; what was written before is kept")
        }
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => Some("choose a folder that you may write to"),
        ErrorKind::NotFound => Some("make the folder first, or choose another one"),
        ErrorKind::AlreadyExists | ErrorKind::NotADirectory => Some("a file is in the way of a folder of that name"),
        ErrorKind::IsADirectory => Some("a folder is in the way of a file of that name"),
        _ => None,
    }
}
