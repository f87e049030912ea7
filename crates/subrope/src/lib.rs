//! Simulation of synthetic mooring ropes from the inside: scenes, models, runs and the command line.
//!
//! - [`document`]: TOML text with positions, checked against a schema, and errors that show the place;
//! - [`scene`]: what a user writes, as plain data, and its expansion into a program of motions and loads;
//! - [`law`]: laws built from what a scene says;
//! - [`model`]: a scene made ready to solve;
//! - [`run`]: solving it, with results on disk;
//! - [`point`]: paths of one material point;
//! - [`progress`]: how a run reports to whoever watches it;
//! - [`cli`]: the `subrope` command, the only part that prints.

#[cfg(feature = "cli")]
pub mod cli;
pub mod document;
mod error;
pub mod law;
pub mod mesh_file;
pub mod model;
pub mod point;
pub mod progress;
pub mod run;
pub mod scene;

pub use error::{Error, ExitCode};
