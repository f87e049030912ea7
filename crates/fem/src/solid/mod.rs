//! Solid bricks: kernel, formulations and the block of equal elements.

mod block;
mod formulation;
mod kernel;
mod output;

pub use block::{SolidBlock, SolidMesh};
pub use formulation::{ElementFailure, ElementInput, ElementResult, Formulation, Full, MeanElongation, MeanVolume};
pub use kernel::{NodeMatrix, NodeVector, PointGeometry};
pub use output::{ElementEnergies, PointSample, SolidFields};
