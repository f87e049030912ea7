//! What a law is at rest.

use nalgebra::Matrix3;

use crate::{Law, LawError, PointInput, Request, Response};

/// Stiffness `dS_22/dE_22` \[MPa\] of a law across its fibres at rest: what contact penalties are measured by.
///
/// # Errors
/// As [`Law::evaluate`].
pub fn transverse_modulus(law: &dyn Law) -> Result<f64, LawError> {
    let old = vec![0.0; law.state_len()];
    let (mut new, mut response) = (old.clone(), Response::default());
    law.evaluate(&PointInput::new(Matrix3::zeros()), &old, &mut new, Request::Tangent, &mut response)?;
    Ok(response.tangent[(1, 1)])
}
