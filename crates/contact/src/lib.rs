//! Frictional contact between the surfaces of deforming bodies, and with rigid cylinders and planes.
//!
//! A [`Contact`] is a contribution of [`subrope_fem`] for one pair of surfaces. It works as a pipeline:
//!
//! 1. [`search`]: which patches may touch, by a tree of boxes that is kept and refitted;
//! 2. [`foot`]: the closest point of the primary surface to every integration point of the secondary one;
//! 3. [`law`]: normal pressure (penalty or augmented Lagrangian) and Coulomb friction, per reference area;
//! 4. [`kernel`]: forces and the exact tangent, spread to the nodes.
//!
//! Surfaces ([`Surface`]) are splines through the surface nodes, the facets as meshed, or rigid planes and cylinders; all
//! are linear in the positions of their nodes. The gap is negative in penetration; pressure, traction and friction work
//! count per reference area of the secondary surface.

#![forbid(unsafe_code)]

mod contact;
mod error;
pub mod foot;
pub mod kernel;
pub mod law;
mod options;
pub mod patch;
mod point;
pub mod search;
pub mod spline;
mod state;
mod surface;

pub use contact::{Contact, ContactReport, contacts};
pub use error::ContactError;
pub use options::{ContactOptions, FrictionTangent, Method, default_penalty};
pub use point::{History, PointRecord};
pub use surface::{Smoothing, Surface};
