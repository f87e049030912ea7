//! Finite-strain finite element kernel.
//!
//! Bricks in a total Lagrangian description, nodes tied to reference points that rotate by any angle, Newton-Raphson with
//! exact tangents, automatic increments, sparse direct solvers. The kernel knows no rope: a strand is a mesh, a frame at
//! each integration point and a law.

pub mod analysis;
mod assembly;
mod contribution;
mod error;
pub mod kinematics;
mod line_bending;
pub mod linear;
pub mod parallel;
mod repeated;
pub mod solid;
pub mod state;

pub use assembly::{Assembled, Equations, Evaluation, Jump, System};
pub use contribution::{Configuration, Contribution, Energies, Product, Request, Sink, Verdict};
pub use error::FemError;
pub use line_bending::{BendingLine, LineBending};
pub use repeated::Repeated;
pub use state::{StateError, StateReader, StateWriter};

/// Temperature when nothing else is said \[K\].
pub const REFERENCE_TEMPERATURE: f64 = 293.15;
