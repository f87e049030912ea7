//! Neo-Hooke with a fibre term.

use super::measures::Measures;
use super::neo_hooke::CompressibleNeoHooke;
use super::{finish, positive, require_finite_tangent};
use crate::LawError;
use crate::law::{FibreResponse, Law, PointInput, Request, Response, StateVariable};

/// `W = mu/2 (I1 - 3) - mu ln J + lambda/2 (ln J)^2 + k/2 (I4 - 1)^2`, `I4 = C11`.
///
/// A mean elongation `e` takes the place of the point's own in the fibre term, `I4 = exp(2 e)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FibreNeoHooke {
    matrix: CompressibleNeoHooke,
    k: f64,
}

impl FibreNeoHooke {
    /// Law of the Lame constants `mu`, `lambda` and the fibre modulus `k` \[MPa\].
    ///
    /// # Errors
    /// [`LawError::Parameter`].
    pub fn new(mu: f64, lambda: f64, k: f64) -> Result<Self, LawError> {
        positive("k", k)?;
        Ok(Self { matrix: CompressibleNeoHooke::new(mu, lambda)?, k })
    }

    /// Fibre term at a mean elongation; returns its energy.
    #[inline]
    fn averaged(&self, elongation: f64, out: &mut Response) -> f64 {
        let growth = (2.0 * elongation).exp_m1();
        let square = 1.0 + growth;
        out.fibre = FibreResponse {
            fibre_stress: 2.0 * self.k * square * growth,
            fibre_stiffness: 4.0 * self.k * square * (square + growth),
            ..FibreResponse::default()
        };
        0.5 * self.k * growth * growth
    }

    /// Fibre term at the point's own elongation, `S11 += 4 k E11`; returns its energy.
    #[inline]
    fn own(&self, strain: f64, request: Request, out: &mut Response) -> f64 {
        out.second_piola[0] += 4.0 * self.k * strain;
        if request == Request::Tangent {
            out.tangent[(0, 0)] += 4.0 * self.k;
        }
        2.0 * self.k * strain * strain
    }
}

impl Law for FibreNeoHooke {
    fn name(&self) -> &'static str {
        "fibre_neo_hooke"
    }

    fn state_variables(&self) -> &[StateVariable] {
        &[]
    }

    #[inline]
    fn is_symmetric(&self) -> bool {
        true
    }

    fn has_potential(&self) -> bool {
        true
    }

    fn has_fibre_term(&self) -> bool {
        true
    }

    #[inline]
    fn evaluate(
        &self,
        input: &PointInput,
        _old: &[f64],
        _new: &mut [f64],
        request: Request,
        out: &mut Response,
    ) -> Result<(), LawError> {
        let measures = Measures::new(&input.displacement_gradient)?;
        let matrix = self.matrix.respond(&measures, request, out);
        let fibre = match input.mean_elongation {
            Some(elongation) if !elongation.is_finite() => return Err(LawError::NonFiniteInput),
            Some(elongation) => self.averaged(elongation, out),
            None => self.own(measures.strain.m11, request, out),
        };
        if request == Request::Tangent {
            require_finite_tangent(out)?;
        }
        finish(matrix + fibre, out)
    }
}
