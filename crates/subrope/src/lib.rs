//! Simulation of synthetic mooring ropes from the inside: scenes, models, runs and the command line.
//!
//! - [`document`]: TOML text with positions, checked against a schema, and errors that show the place;
//! - [`scene`]: what a user writes, as plain data, and its expansion into a program of motions and loads;
//! - [`sizing`]: what follows of a rope from its yarns, masses and diameters;
//! - [`law`]: laws built from what a scene says;
//! - [`model`]: a scene made ready to solve;
//! - [`check`]: what a scene amounts to, before solving;
//! - [`estimate`]: what it takes of memory, and what is refused;
//! - [`plan`]: what a run will use and what it leaves out;
//! - [`run`]: solving it, with results on disk;
//! - [`study`]: a scene run with varied settings, errors against time and memory;
//! - [`stress`]: extreme scenes, and whether the program holds there;
//! - [`analytic`]: closed forms to compare a run with;
//! - [`point`]: paths of one material point;
//! - [`progress`]: how a run reports to whoever watches it;
//! - [`cli`]: the `subrope` command, the only part that prints.
//!
//! Features, all on by default: `contact` (crate `subrope-contact`), `hdf5` (result files), `parallel` (threads), `cli`. What is
//! left out is named where a scene or a command asks for it.
//!
//! A strand of 96 bricks, stretched by 1 % with its ends kept from turning:
//!
//! ```
//! use subrope::{model::RopeModel, scene::Scene};
//!
//! let scene = Scene::from_toml(
//!     "strand.toml",
//!     r#"
//!     title = "A strand in tension"
//!     [strand]
//!     radius = 2.785          # mm
//!     length = 20.0           # mm
//!     surface_angle = 30.0    # degrees
//!     mesh = { core = 2, rings = 1, layers = 8 }
//!     [law]
//!     kind = "bundle"
//!     K_e = 2000.0            # MPa
//!     K_ec = 100.0
//!     K_c = 60.0
//!     K_t = 15.0
//!     K_l = 20.0
//!     nu = 0.5
//!     friction = false
//!     [[end]]
//!     name = "END_A"
//!     [[end]]
//!     name = "END_B"
//!     [[step]]
//!     name = "pull"
//!     tension = { elongation = 0.01 }
//!     "#,
//! )?;
//! let mut model = RopeModel::from_scene(&scene, None, Some(1))?;
//! model.solve()?;
//! let (force, moment) = model.analysis.point_reaction(1);
//! assert!(force.z > 0.0, "it resists");
//! assert!(moment.z > 0.0, "a right-handed strand kept from turning turns back");
//! assert!(model.analysis.totals().energy_error().abs() < 0.01);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![forbid(unsafe_code)]

pub mod analytic;
pub mod check;
#[cfg(feature = "cli")]
pub mod cli;
mod contact;
pub mod document;
mod error;
pub mod estimate;
pub mod law;
pub mod mesh_file;
pub mod model;
pub mod plan;
pub mod point;
pub mod progress;
pub mod run;
pub mod scene;
pub mod sizing;
pub mod stress;
pub mod study;

pub use error::{Error, ExitCode};
