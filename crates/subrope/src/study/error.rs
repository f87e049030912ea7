//! Errors of studies.

use std::path::PathBuf;

use miette::Diagnostic;
use subrope_io::IoError;

use crate::document::InvalidDocument;
use crate::error::ExitCode;

/// Why a study does not end with a report.
#[derive(Debug, thiserror::Error, Diagnostic)]
#[non_exhaustive]
pub enum StudyError {
    /// The file cannot be read.
    #[error("cannot read the study {}", path.display())]
    #[diagnostic(help("give the path of a study file, such as those in the folder studies"))]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The study has problems; each has its place.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Invalid(Box<InvalidDocument>),
    /// A folder or a file of the study cannot be made or read.
    #[error("cannot use {}: {source}", path.display())]
    File {
        /// The folder or file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The program itself cannot be started for a member.
    #[error("cannot start {}: {source}", program.display())]
    Start {
        /// The program.
        program: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A result cannot be written.
    #[error(transparent)]
    Output(#[from] IoError),
    /// No member gave a result.
    #[error("all {members} members failed; the first: {first}")]
    #[diagnostic(help("run the scene of a member, {} and the like, by itself", scene.display()))]
    AllFailed {
        /// How many.
        members: usize,
        /// Why the first one failed.
        first: String,
        /// Its scene.
        scene: PathBuf,
    },
    /// The user stopped the study.
    #[error("interrupted after {runs} runs; what they give is in {}", folder.display())]
    #[diagnostic(help("`--resume` goes on from there"))]
    Interrupted {
        /// Finished runs.
        runs: usize,
        /// Folder of the results.
        folder: PathBuf,
    },
}

impl StudyError {
    /// The exit code that answers it.
    #[must_use]
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Self::Read { .. } | Self::Invalid(_) => ExitCode::Input,
            Self::File { .. } | Self::Start { .. } | Self::Output(_) => ExitCode::Output,
            Self::AllFailed { .. } | Self::Interrupted { .. } => ExitCode::NotConverged,
        }
    }
}
