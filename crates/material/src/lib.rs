//! Invariant-based, frictional laws of fibre bundles.
//!
//! A law answers at one point: displacement gradient in, second Piola-Kirchhoff stress, consistent tangent and new
//! state out ([`Law`]). It knows no mesh. The law of the bundle of rope-yarns is [`BundleLaw`], written in the six
//! [`StrainModes`]; [`CharmetantLaw`] is its elastic ancestor; St. Venant-Kirchhoff and neo-Hooke serve verification.
//! [`driver`] runs a law along a path, [`testkit`] puts any law through the battery all laws here pass.
//!
//! Units: mm, N, MPa, mJ, s, K. Symmetric tensors are [`mandel`] vectors in the material frame, whose first axis is the
//! fibre.

#![forbid(unsafe_code)]

mod bundle;
pub mod driver;
mod elastic;
mod error;
pub mod lanes;
mod law;
pub mod mandel;
mod rest;
mod strain;
pub mod testkit;

pub use bundle::{
    BundleLaw, BundleParameters, CharmetantLaw, CharmetantParameters, Compaction, ConjugateForces, Friction, Hardening,
    ModeParameters,
};
pub use elastic::{CompressibleNeoHooke, EngineeringConstants, FibreNeoHooke, IsochoricNeoHooke, StVenantKirchhoff};
pub use error::LawError;
pub use law::{
    FibreResponse, LaneFailure, LaneFibreResponse, LaneInput, LaneResponse, Law, PointInput, Request, Response,
    StateKind, StateVariable,
};
pub use rest::transverse_modulus;
pub use strain::StrainModes;
