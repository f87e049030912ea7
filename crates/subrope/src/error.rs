//! Errors of the whole program and the exit codes that answer them.

use std::fmt::Display;
use std::path::PathBuf;

use miette::{Diagnostic, LabeledSpan, SourceCode};

use crate::model::ModelError;
use crate::point::PointError;
use crate::run::{RunError, output_advice};
use crate::scene::SceneError;
use crate::stress::StressError;
use crate::study::StudyError;

/// Why a command did not do its work.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The scene is wrong.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The point file is wrong, or the law gives no answer.
    #[error(transparent)]
    Point(#[from] PointError),
    /// The scene makes no model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The run ended early.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The study is wrong, or gives no report.
    #[error(transparent)]
    Study(#[from] StudyError),
    /// The list of a stress table is wrong, or a member fails.
    #[error(transparent)]
    Stress(#[from] StressError),
    /// A mesh in a format that nobody writes.
    #[error("no mesh can be written to {}", path.display())]
    MeshFormat {
        /// The file.
        path: PathBuf,
    },
    /// A file cannot be written.
    #[error("cannot write {}", path.display())]
    Output {
        /// The file or folder.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A template that does not exist.
    #[error("there is no template named \"{found}\"")]
    UnknownTemplate {
        /// The name asked for.
        found: String,
        /// The names there are.
        allowed: Vec<&'static str>,
        /// The nearest of them.
        suggestion: Option<&'static str>,
    },
    /// A file that must not be overwritten.
    #[error("{} exists already", path.display())]
    Exists {
        /// The file.
        path: PathBuf,
    },
}

/// What the process answers to its caller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum ExitCode {
    /// Done.
    Done = 0,
    /// A member of a stress table fails.
    Failed = 1,
    /// The input is wrong.
    Input = 2,
    /// No equilibrium was found.
    NotConverged = 3,
    /// The output could not be written.
    Output = 4,
}

impl Error {
    /// The exit code that answers the error.
    #[must_use]
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Self::Run(error) => error.exit_code(),
            Self::Study(error) => error.exit_code(),
            Self::Stress(error) => error.exit_code(),
            Self::Scene(_)
            | Self::Model(_)
            | Self::Point(_)
            | Self::MeshFormat { .. }
            | Self::UnknownTemplate { .. }
            | Self::Exists { .. } => ExitCode::Input,
            Self::Output { .. } => ExitCode::Output,
        }
    }

    /// The whole error as plain text, with places, causes and advice.
    #[must_use]
    pub fn plain(&self) -> String {
        match self {
            Self::Scene(error) => error.plain(),
            Self::Point(PointError::Invalid(document))
            | Self::Study(StudyError::Invalid(document))
            | Self::Stress(StressError::Invalid(document)) => document.plain(),
            other => {
                let mut text = format!("error: {other}");
                let mut cause = std::error::Error::source(other);
                while let Some(inner) = cause {
                    let reason = inner.to_string();
                    // Many messages end with their cause already.
                    if !text.contains(&reason) {
                        text += &format!("\n  because: {reason}");
                    }
                    cause = inner.source();
                }
                other.help().into_iter().for_each(|help| text += &format!("\n  help: {help}"));
                text + "\n"
            }
        }
    }

    /// The error inside that knows its place.
    fn inner(&self) -> Option<&dyn Diagnostic> {
        match self {
            Self::Scene(error) => Some(error),
            Self::Point(error) => Some(error),
            Self::Study(error) => Some(error),
            Self::Stress(error) => Some(error),
            _ => None,
        }
    }

    /// What to try next.
    fn advice(&self) -> Option<String> {
        match self {
            Self::Run(error) => error.advice().map(str::to_owned),
            Self::Model(ModelError::TooLarge { .. }) => Some(
                "take a coarser mesh, fewer steps or cycles, `symmetry = \"helical\"` for a rope in tension or torsion, or a \
                 machine with more memory"
                    .to_owned(),
            ),
            Self::Output { source, .. } => output_advice(source.kind()).map(str::to_owned),
            Self::MeshFormat { .. } if cfg!(feature = "hdf5") => Some("name it .inp (Abaqus) or .vtkhdf".to_owned()),
            Self::MeshFormat { .. } => Some("name it .inp (Abaqus); VTKHDF is not built in".to_owned()),
            Self::Exists { .. } => Some("choose another folder, or move the file away".to_owned()),
            Self::UnknownTemplate { allowed, suggestion, .. } => {
                let meant = suggestion.map(|s| format!("did you mean \"{s}\"? ")).unwrap_or_default();
                Some(format!("{meant}templates: {}", allowed.join(", ")))
            }
            _ => None,
        }
    }
}

impl Diagnostic for Error {
    fn help<'a>(&'a self) -> Option<Box<dyn Display + 'a>> {
        match self.advice() {
            Some(advice) => Some(Box::new(advice)),
            None => self.inner().and_then(Diagnostic::help),
        }
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.inner().and_then(Diagnostic::source_code)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        self.inner().and_then(Diagnostic::labels)
    }

    fn related<'a>(&'a self) -> Option<Box<dyn Iterator<Item = &'a dyn Diagnostic> + 'a>> {
        self.inner().and_then(Diagnostic::related)
    }
}
