//! Laws of fibre bundles. (under construction)

mod error;
mod law;

pub use error::LawError;
pub use law::{FibreResponse, Law, PointInput, Request, Response, StateKind, StateVariable};
