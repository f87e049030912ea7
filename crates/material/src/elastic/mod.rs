//! Elastic laws for verification: St. Venant-Kirchhoff and neo-Hooke.

mod fibre_neo_hooke;
mod measures;
mod neo_hooke;
mod st_venant_kirchhoff;

use crate::LawError;
use crate::lanes::finite;
use crate::law::{PointInput, Response};

pub use fibre_neo_hooke::FibreNeoHooke;
pub use neo_hooke::{CompressibleNeoHooke, IsochoricNeoHooke};
pub use st_venant_kirchhoff::{EngineeringConstants, StVenantKirchhoff};

/// A law without a fibre term refuses a mean elongation.
#[inline]
fn refuse_mean_elongation(input: &PointInput) -> Result<(), LawError> {
    if input.mean_elongation.is_some() { Err(LawError::NoFibreTerm) } else { Ok(()) }
}

/// Energy of a law without dissipation, and the check that the answer is finite.
#[inline]
fn finish(energy: f64, out: &mut Response) -> Result<(), LawError> {
    out.stored_energy = energy;
    out.incremental_potential = Some(energy);
    out.dissipated_mid = [0.0; 2];
    let finite = energy.is_finite() && finite(out.second_piola.as_slice());
    if finite { Ok(()) } else { Err(LawError::NonFiniteResponse) }
}

#[inline]
fn require_finite_tangent(out: &Response) -> Result<(), LawError> {
    if finite(out.tangent.as_slice()) { Ok(()) } else { Err(LawError::NonFiniteResponse) }
}

/// Error unless a parameter is finite and positive.
fn positive(name: &'static str, value: f64) -> Result<(), LawError> {
    require(value > 0.0 && value.is_finite(), name, value, "must be finite and positive")
}

fn require(holds: bool, name: &'static str, value: f64, requirement: &'static str) -> Result<(), LawError> {
    if holds { Ok(()) } else { Err(LawError::Parameter { name, value, requirement }) }
}
