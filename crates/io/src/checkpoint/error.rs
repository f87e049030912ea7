//! What is wrong with a checkpoint.

use std::path::PathBuf;

/// A checkpoint that cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{}: {fault} (section \"{section}\", byte {offset})", path.display())]
pub struct CheckpointError {
    /// The file.
    pub path: PathBuf,
    /// The section; empty for the file as a whole.
    pub section: String,
    /// Where in the file.
    pub offset: u64,
    /// What is wrong.
    pub fault: CheckpointFault,
}

/// What is wrong with a checkpoint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CheckpointFault {
    /// The file is something else.
    #[error("this is no checkpoint")]
    Magic,
    /// Written by a version of the program with another format.
    #[error("the checkpoint has format {found}, this program reads format {known}")]
    Format {
        /// Its format.
        found: u32,
        /// The format that is read.
        known: u32,
    },
    /// The file ends too early.
    #[error("the checkpoint is damaged: it ends too early")]
    Truncated,
    /// The file goes on behind its end.
    #[error("the checkpoint is damaged: {count} byte(s) stand behind its end")]
    Trailing {
        /// How many bytes.
        count: u64,
    },
    /// A checksum does not fit.
    #[error("the checkpoint is damaged: checksum {found:08x} instead of {expected:08x}")]
    Checksum {
        /// Of the content.
        found: u32,
        /// As stored.
        expected: u32,
    },
    /// A section that makes no sense.
    #[error("the checkpoint is damaged: its structure makes no sense")]
    Structure,
    /// A section is not there.
    #[error("the checkpoint lacks this section")]
    Missing,
    /// A section holds something else, or more or less of it.
    #[error("the section holds {found} values instead of {expected}, or values of another kind")]
    Shape {
        /// Values in the section.
        found: u64,
        /// Values wanted.
        expected: u64,
    },
}
