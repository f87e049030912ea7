//! Solid bricks: kernel, formulations and the block of equal elements.

mod averaged;
mod block;
mod failure;
mod formulation;
mod geometry;
mod kernel;
mod mean_elongation;
mod mean_volume;
mod output;
mod pack;
mod wide;

pub use block::{SolidBlock, SolidMesh};
pub use failure::FailedPoint;
pub use formulation::{ElementFailure, ElementInput, ElementResult, Formulation, Full, PointStrain};
pub use geometry::{BrickGeometry, PointGroup, ReferenceGradients};
pub use kernel::{Buffers, NodeMatrix, NodeVector};
pub use mean_elongation::MeanElongation;
pub use mean_volume::MeanVolume;
pub use output::{ElementEnergies, PointSample, SolidFields};
pub use wide::{Wide, WideMask};
