//! Errors of `subrope stress`: what is wrong with a list, not what becomes of its members.

use std::path::PathBuf;

use miette::Diagnostic;
use subrope_io::IoError;

use crate::document::InvalidDocument;
use crate::error::ExitCode;
use crate::study::SettingFault;

/// Why there is no table, or why it ends with a failure.
#[derive(Debug, thiserror::Error, Diagnostic)]
#[non_exhaustive]
pub enum StressError {
    /// The file cannot be read.
    #[error("cannot read the list {}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The list has problems; each has its place.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Invalid(Box<InvalidDocument>),
    /// A family names a scene that is not in the list.
    #[error("family \"{family}\": there is no [scene.{scene}] in the list; there are: {}", allowed.join(", "))]
    UnknownScene {
        /// The family.
        family: String,
        /// The scene asked for.
        scene: String,
        /// The scenes there are.
        allowed: Vec<String>,
    },
    /// A family that was asked for does not exist.
    #[error("there is no family named \"{name}\"; there are: {}", allowed.join(", "))]
    UnknownFamily {
        /// The name asked for.
        name: String,
        /// The families there are.
        allowed: Vec<String>,
    },
    /// A setting cannot be put into the scene.
    #[error("family \"{family}\", `{key}`: {fault}")]
    Setting {
        /// The family.
        family: String,
        /// The key.
        key: String,
        /// Why.
        fault: Box<SettingFault>,
    },
    /// Lists of a family have different lengths.
    #[error(
        "family \"{family}\": `levels`, `members` and `twins` must be of one length, not {found} beside {expected}"
    )]
    Lengths {
        /// The family.
        family: String,
        /// One length.
        found: usize,
        /// Another.
        expected: usize,
    },
    /// A limit of a member that does not exist.
    #[error("family \"{family}\": there is no member \"{member}\" that a limit could explain; there are: {}", allowed.join("; "))]
    UnknownMember {
        /// The family.
        family: String,
        /// The member named.
        member: String,
        /// The members there are.
        allowed: Vec<String>,
    },
    /// A folder cannot be made.
    #[error("cannot use {}: {source}", path.display())]
    File {
        /// The folder.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A table cannot be written.
    #[error(transparent)]
    Output(#[from] IoError),
    /// The user stopped it.
    #[error("interrupted")]
    Interrupted,
    /// The table is complete, and some of it fails.
    #[error("{failed} of {members} members fail: {}", names.join("; "))]
    Failed {
        /// How many fail.
        failed: usize,
        /// Of how many.
        members: usize,
        /// Which.
        names: Vec<String>,
    },
}

impl StressError {
    /// The exit code that answers it.
    #[must_use]
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Self::File { .. } | Self::Output(_) => ExitCode::Output,
            Self::Interrupted => ExitCode::NotConverged,
            Self::Failed { .. } => ExitCode::Failed,
            _ => ExitCode::Input,
        }
    }
}
