//! Errors of the crate: wrong input, wrong values, failed output.

use crate::checkpoint::CheckpointError;
use crate::deck::DeckError;
use std::path::{Path, PathBuf};
use subrope_geometry::GeometryError;

/// Anything that can fail in this crate.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum IoError {
    /// A deck is wrong; file, line and text are told.
    #[error(transparent)]
    Deck(#[from] DeckError),
    /// A text file of the project (history) is wrong.
    #[error(transparent)]
    Text(#[from] TextError),
    /// A checkpoint is damaged, or lacks something.
    #[error(transparent)]
    Checkpoint(Box<CheckpointError>),
    /// A result file is not what it was when a checkpoint was written.
    #[error("{}: its first {length} bytes are not those that the checkpoint knows", path.display())]
    Changed {
        /// The file.
        path: PathBuf,
        /// Bytes that the checkpoint knows.
        length: u64,
    },
    /// A file cannot be read.
    #[error("{}: cannot be read: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// A result file cannot be read or lacks something.
    #[error("{}: {cause}", path.display())]
    ReadResult {
        /// The file.
        path: PathBuf,
        /// What the library says.
        cause: OutputCause,
    },
    /// A result file has no such field or step.
    #[error("{}: no field {field:?} at step {step} ({steps} steps)", path.display())]
    NoSuchField {
        /// The file.
        path: PathBuf,
        /// Name of the field.
        field: String,
        /// Zero-based step.
        step: usize,
        /// Steps in the file.
        steps: usize,
    },
    /// Values or names handed over for writing are not acceptable.
    #[error(transparent)]
    Value(#[from] ValueError),
    /// A mesh handed over for writing is inconsistent.
    #[error(transparent)]
    Mesh(#[from] GeometryError),
    /// An output failed.
    #[error(transparent)]
    Output(#[from] OutputError),
}

impl From<CheckpointError> for IoError {
    fn from(error: CheckpointError) -> Self {
        Self::Checkpoint(Box::new(error))
    }
}

/// What an error means to a caller that must choose an exit code.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ErrorClass {
    /// A file given by the user is missing or wrong.
    Input,
    /// Values computed by the program cannot be written (not finite, wrong length, wrong name).
    Value,
    /// A file cannot be written (folder, permission, full disk).
    Output,
}

impl IoError {
    /// A file that was there before and cannot be opened to go on with it: gone, or refused by the system.
    pub(crate) fn reopened(path: &Path, source: std::io::Error) -> Self {
        match source.kind() {
            std::io::ErrorKind::NotFound => Self::Read { path: path.to_path_buf(), source },
            _ => OutputError::new(path, Action::Open, source).into(),
        }
    }

    /// What kind of failure the system reported, where it was the system that refused an output.
    pub fn system_kind(&self) -> Option<std::io::ErrorKind> {
        match self {
            Self::Output(OutputError { cause: OutputCause::System(error), .. }) => Some(error.kind()),
            _ => None,
        }
    }

    /// Whether the input, the values or the output is at fault.
    pub const fn class(&self) -> ErrorClass {
        match self {
            Self::Deck(_)
            | Self::Text(_)
            | Self::Checkpoint(_)
            | Self::Changed { .. }
            | Self::Read { .. }
            | Self::ReadResult { .. }
            | Self::NoSuchField { .. } => ErrorClass::Input,
            Self::Value(_) | Self::Mesh(_) => ErrorClass::Value,
            Self::Output(_) => ErrorClass::Output,
        }
    }
}

/// What was being done when an output failed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Action {
    /// Creating the file.
    Create,
    /// Writing to it.
    Write,
    /// Flushing it to the disk.
    Flush,
    /// Moving it to its final name.
    Rename,
    /// Closing it.
    Close,
    /// Opening it again.
    Open,
}

impl std::fmt::Display for Action {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Create => "created",
            Self::Write => "written",
            Self::Flush => "flushed",
            Self::Rename => "renamed",
            Self::Close => "closed",
            Self::Open => "opened again",
        })
    }
}

/// The reason an underlying layer gives.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OutputCause {
    /// The operating system.
    #[error(transparent)]
    System(#[from] std::io::Error),
    /// The JSON writer.
    #[error(transparent)]
    Json(#[from] serde_json::Error),
    /// The HDF5 library, in its own words.
    #[error("{message}")]
    Hdf5 {
        /// Its message.
        message: String,
    },
    /// An earlier operation on the same file failed; nothing more is written to it.
    #[error("an earlier write to it failed")]
    EarlierFailure,
}

/// An output file that cannot be written.
#[derive(Debug, thiserror::Error)]
#[error("{}: cannot be {action}: {cause}", path.display())]
pub struct OutputError {
    /// The file.
    pub path: PathBuf,
    /// What was being done.
    pub action: Action,
    /// Why it failed.
    #[source]
    pub cause: OutputCause,
}

impl OutputError {
    pub(crate) fn new(path: &Path, action: Action, cause: impl Into<OutputCause>) -> Self {
        Self { path: path.to_path_buf(), action, cause: cause.into() }
    }
}

/// A line of a text file of the project that cannot be understood.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{}:{line}: {kind}", path.display())]
pub struct TextError {
    /// The file.
    pub path: PathBuf,
    /// One-based line.
    pub line: usize,
    /// What is wrong.
    pub kind: TextErrorKind,
}

/// What is wrong with a line of a history.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TextErrorKind {
    /// The file has no header.
    #[error("a header is missing")]
    NoHeader,
    /// A header is not `name [unit]`.
    #[error("header {header:?} is not of the form name [unit]")]
    BadHeader {
        /// The header.
        header: String,
    },
    /// The number of values differs from the number of columns.
    #[error("{got} values in {expected} columns")]
    ValueCount {
        /// Number of columns.
        expected: usize,
        /// Number of values.
        got: usize,
    },
    /// A value is not a finite number.
    #[error("{field:?} is not a finite number")]
    BadNumber {
        /// The value.
        field: String,
    },
}

/// Values or names that cannot be written.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ValueError {
    /// A name is empty or holds a character its file format cannot carry.
    #[error("{name:?} cannot be the name of a field, a column or a set")]
    Name {
        /// The name.
        name: String,
    },
    /// A text holds a character its file format cannot carry.
    #[error("the text stored as {name:?} holds a zero byte")]
    Text {
        /// Name of the text.
        name: String,
    },
    /// A name occurs twice.
    #[error("the name {name:?} occurs twice")]
    DuplicateName {
        /// The name.
        name: String,
    },
    /// A field has no component, or more than [`MAX_COMPONENTS`](Self::MAX_COMPONENTS).
    #[error("field {name:?} has {components} components")]
    Components {
        /// Name of the field.
        name: String,
        /// Its number of components.
        components: usize,
    },
    /// The number of arrays or values given differs from the number declared.
    #[error("{got} values or arrays given where {expected} were declared")]
    Count {
        /// Declared.
        expected: usize,
        /// Given.
        got: usize,
    },
    /// The number of values of a field is not its number of points or cells times its components.
    #[error("field {name:?} has {got} values instead of {expected}")]
    Length {
        /// Name of the field.
        name: String,
        /// Expected number of values.
        expected: usize,
        /// Given number of values.
        got: usize,
    },
    /// A value is not finite, or too large for single precision.
    #[error("{name:?}: value {index} is {value:e}, which cannot be written")]
    NotFinite {
        /// Name of the field or column.
        name: String,
        /// Zero-based index of the value.
        index: usize,
        /// The value.
        value: f64,
    },
    /// Step values must increase.
    #[error("step value {value} does not exceed the one before, {previous}")]
    StepOrder {
        /// The value before.
        previous: f64,
        /// The value given.
        value: f64,
    },
    /// Constant fields must be written before the first step.
    #[error("constant field {name:?} comes after {steps} steps were written")]
    LateConstant {
        /// Name of the field.
        name: String,
        /// Steps already written.
        steps: usize,
    },
    /// A frame is not orthonormal and right-handed.
    #[error("the frame of cell {cell_label} is not orthonormal and right-handed: it deviates by {deviation}")]
    Frame {
        /// Label of the cell.
        cell_label: u64,
        /// Largest deviation of F^T F from the identity, or of det F from 1.
        deviation: f64,
    },
    /// A compression level is not 0 to 9.
    #[error("compression level {level} is not one of 0 to 9")]
    Deflate {
        /// The level.
        level: u8,
    },
    /// A material index has no name.
    #[error("material index {index}, but {names} names are given")]
    Material {
        /// The index.
        index: u32,
        /// Number of names.
        names: usize,
    },
}

impl ValueError {
    /// Largest number of components of one field.
    pub const MAX_COMPONENTS: usize = 4096;
}
