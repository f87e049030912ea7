//! What the whole-scene tests in `tests/tests` share: small meshes, models put together by hand, runs with a memory.

#![allow(clippy::unwrap_used, reason = "a helper of tests fails by panicking")]
#![allow(clippy::panic, reason = "a helper of tests fails by panicking")]

mod bodies;
mod bricks;
mod compare;
mod dense;
mod meshes;
mod problem;
mod rope;
pub mod truss;
mod wires;

pub use bodies::{Bodies, Body, rigid};
pub use bricks::{Brick, brick, constant_frames, fields_of, peer_law};
pub use compare::{Worst, close, matrix_close, relative, scientific};
pub use dense::Dense;
pub use meshes::{Lattice, elevated, patch_cube, renumbered, rotated_connectivity, serendipity};
pub use problem::{Problem, Recorder, Row, StepBuilder};
pub use rope::{Run, SET_C, rod_on_strand, run_scene, run_with_files, scene, scene_file, short_rope, try_run};
pub use wires::{Middle, Wires};
