//! Errors of point files.

use std::path::PathBuf;

use miette::Diagnostic;
use subrope_material::LawError;

use crate::document::InvalidDocument;

/// Why a point file gives no answer.
#[derive(Debug, thiserror::Error, Diagnostic)]
pub enum PointError {
    /// The file cannot be read.
    #[error("cannot read the point file {}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A TOML file has problems; each has its place.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Invalid(Box<InvalidDocument>),
    /// A JSON file is not JSON, or an entry has the wrong type.
    #[error("{file}: {source}")]
    #[diagnostic(help(
        "layout: {{\"paths\": [{{\"name\", \"params\", \"frame\", \"state0\", \"steps\": [{{\"F\": 3x3}}]}}]}}"
    ))]
    Json {
        /// The file.
        file: String,
        /// What is wrong, with the entry, line and column.
        #[source]
        source: serde_json::Error,
    },
    /// An entry of a JSON file cannot be used.
    #[error("{place}: {fault}")]
    Entry {
        /// The entry.
        place: Box<Place>,
        /// What is wrong.
        fault: EntryFault,
    },
    /// A point at which a run failed, where paths are asked for.
    #[error("{} holds a point at which a run failed, and no paths", path.display())]
    NoPaths {
        /// The file.
        path: PathBuf,
    },
    /// The law gives no answer at a point where a run failed.
    #[error("element {element}, integration point {point}: {source}")]
    #[diagnostic(help("it is the failure of the run: change the parameters in [law] to see what helps"))]
    Failed {
        /// Label of the element.
        element: u64,
        /// Integration point, from 0.
        point: usize,
        /// Why.
        source: LawError,
    },
    /// The law gives no answer.
    #[error("{place}: the law gives no answer")]
    Law {
        /// The path and the step.
        place: Box<Place>,
        /// Why.
        source: LawError,
    },
}

/// An entry of a file of paths: indices of path and step from 0.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// The file.
    pub file: String,
    /// Index of the path.
    pub path: Option<usize>,
    /// Its name.
    pub name: String,
    /// Index of the step.
    pub step: Option<usize>,
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.file)?;
        if let Some(path) = self.path {
            write!(f, ": paths[{path}]")?;
        }
        if !self.name.is_empty() {
            write!(f, " \"{}\"", self.name)?;
        }
        if let Some(step) = self.step {
            write!(f, ", steps[{step}]")?;
        }
        Ok(())
    }
}

/// What is wrong with an entry.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EntryFault {
    /// A step without a deformation.
    #[error("the step needs one of the keys F, H, modes")]
    NoDeformation,
    /// A number that is not finite.
    #[error("a number in `{key}` is not finite")]
    NotFinite {
        /// The key.
        key: &'static str,
    },
    /// The frame is no rotation.
    #[error("`frame` must be a rotation with the columns e1, e2, e3: it deviates from one by {deviation:e}")]
    Frame {
        /// Largest entry of `R^T R - 1`, or 2 for a left-handed frame \[-\].
        deviation: f64,
    },
    /// The state has the wrong length.
    #[error("`state0` must hold 8 numbers (DP1 DP2 gP2 gP3 kappa_t kappa_l d_t d_l), not {found}")]
    State {
        /// Its length.
        found: usize,
    },
    /// A parameter is missing.
    #[error("`params` needs {key}")]
    MissingParameter {
        /// The parameter.
        key: &'static str,
    },
    /// A parameter is not a number.
    #[error("`params`: {key} = {found} must be a number")]
    NotANumber {
        /// The parameter.
        key: &'static str,
        /// What the file says.
        found: String,
    },
    /// A parameter has an impossible value.
    #[error("`params`: {key} = {value:e} must be {allowed}")]
    Parameter {
        /// The parameter.
        key: &'static str,
        /// Its value.
        value: f64,
        /// What it may be.
        allowed: &'static str,
    },
    /// A parameter that nobody reads.
    #[error("`params`: unknown key {key}; allowed: {}", allowed.join(", "))]
    UnknownParameter {
        /// The key.
        key: String,
        /// The known keys.
        allowed: &'static [&'static str],
    },
}

impl From<InvalidDocument> for PointError {
    fn from(document: InvalidDocument) -> Self {
        Self::Invalid(Box::new(document))
    }
}
