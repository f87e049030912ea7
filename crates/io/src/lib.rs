//! Files of the project: Abaqus and CalculiX decks in and out, VTKHDF results, histories, summaries, checkpoints.
//!
//! The crate takes and gives plain data (meshes, frames, slices of numbers); it knows no element and no solver.
//! Every failure is an [`IoError`], whose [`class`](IoError::class) tells a wrong input from a failed output.

#![forbid(unsafe_code)]

pub mod atomic;
pub mod checkpoint;
pub mod cpu;
pub mod deck;
pub mod error;
pub mod history;
pub mod input;
pub mod memory;
pub mod summary;
#[cfg(feature = "hdf5")]
pub mod vtkhdf;
pub mod writes;

pub use atomic::AtomicFile;
pub use checkpoint::{CheckpointError, CheckpointFault, CheckpointReader, CheckpointWriter};
pub use cpu::cpu_time;
pub use deck::{
    Deck, DeckError, DeckErrorKind, DeckView, Ignored, NumberFormat, parse_deck, parse_deck_of, read_deck, write_deck,
};
pub use error::{Action, ErrorClass, IoError, OutputCause, OutputError, TextError, TextErrorKind, ValueError};
pub use history::{Column, History, HistoryPlace, HistoryWriter, parse_history, read_history};
pub use memory::{available_memory, peak_memory, resident_memory};
pub use summary::{write_json, write_json_with};
#[cfg(feature = "hdf5")]
pub use vtkhdf::{
    FieldSpec, Location, Precision, Provenance, ResultImage, ResultReader, ResultWriter, StaticField, WriterOptions,
    write_mesh_vtkhdf,
};
pub use writes::Writes;
