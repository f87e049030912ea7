//! Errors of scene files.

use std::path::PathBuf;

use miette::Diagnostic;

use crate::document::InvalidDocument;

/// Why a scene cannot be used.
#[derive(Debug, thiserror::Error, Diagnostic)]
pub enum SceneError {
    /// The file cannot be read.
    #[error("cannot read the scene {}", path.display())]
    #[diagnostic(help("give the path of a scene file, for example one written by `subrope new`"))]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The scene has problems; each has its place.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Invalid(Box<InvalidDocument>),
}

impl From<InvalidDocument> for SceneError {
    fn from(document: InvalidDocument) -> Self {
        Self::Invalid(Box::new(document))
    }
}

impl SceneError {
    /// The whole error as plain text, with places and advice.
    #[must_use]
    pub fn plain(&self) -> String {
        match self {
            Self::Read { source, .. } => format!("error: {self}: {source}\n"),
            Self::Invalid(document) => document.plain(),
        }
    }
}
