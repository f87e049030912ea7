//! Two compressible neo-Hookean laws.

use nalgebra::{Matrix3, Matrix6, Vector6};

use super::measures::{Measures, exp_excess, log_excess};
use super::{finish, positive, refuse_mean_elongation, require, require_finite_tangent};
use crate::LawError;
use crate::law::{Law, PointInput, Request, Response, StateVariable};
use crate::mandel::{from_matrix, symmetric_product};

/// Mandel vector of the unit tensor.
const UNIT: [f64; 6] = [1.0, 1.0, 1.0, 0.0, 0.0, 0.0];

/// `W = mu/2 (I1 - 3) - mu ln J + lambda/2 (ln J)^2`, `S = 2 mu C^-1 E + lambda ln J C^-1`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompressibleNeoHooke {
    mu: f64,
    lambda: f64,
}

impl CompressibleNeoHooke {
    /// Law of the Lame constants `mu`, `lambda` \[MPa\].
    ///
    /// # Errors
    /// [`LawError::Parameter`] unless `mu > 0` and `3 lambda + 2 mu > 0`.
    pub fn new(mu: f64, lambda: f64) -> Result<Self, LawError> {
        positive("mu", mu)?;
        let stable = lambda.is_finite() && 3.0 * lambda + 2.0 * mu > 0.0;
        require(stable, "lambda", lambda, "must be finite and 3 lambda + 2 mu positive")?;
        Ok(Self { mu, lambda })
    }

    /// Writes stress and, on request, the tangent
    /// `lambda C^-1 (x) C^-1 + 2 (mu - lambda ln J) C^-1 [.] C^-1`; returns the energy.
    #[inline]
    pub(super) fn respond(&self, measures: &Measures, request: Request, out: &mut Response) -> f64 {
        let (mu, lambda, log) = (self.mu, self.lambda, measures.log_volume);
        let inverse = from_matrix(&measures.inverse);
        let turned = from_matrix(&(measures.inverse * measures.strain));
        out.second_piola = turned * (2.0 * mu) + inverse * (lambda * log);
        if request == Request::Tangent {
            let product = symmetric_product(&measures.inverse);
            out.tangent = inverse * inverse.transpose() * lambda + product * (2.0 * (mu - lambda * log));
        }
        mu * measures.excess() + 0.5 * lambda * log * log
    }
}

/// `W = mu/2 (J^(-2/3) I1 - 3) + kappa/4 (J^2 - 1 - 2 ln J)`,
/// `S = 2 mu J^(-2/3) C^-1 (E - 1/3 tr E) + kappa/2 (J^2 - 1) C^-1`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IsochoricNeoHooke {
    mu: f64,
    kappa: f64,
}

impl IsochoricNeoHooke {
    /// Law of the shear modulus `mu` and the bulk modulus `kappa` \[MPa\].
    ///
    /// # Errors
    /// [`LawError::Parameter`] unless both are positive.
    pub fn new(mu: f64, kappa: f64) -> Result<Self, LawError> {
        positive("mu", mu)?;
        positive("kappa", kappa)?;
        Ok(Self { mu, kappa })
    }

    #[inline]
    fn respond(&self, measures: &Measures, request: Request, out: &mut Response) -> f64 {
        let exponent = -2.0 / 3.0 * measures.log_volume;
        let modulus = self.mu * exponent.exp();
        let deviator = measures.strain - Matrix3::identity() * (measures.trace / 3.0);
        let inverse = from_matrix(&measures.inverse);
        let square_growth = measures.square_growth();
        let turned = from_matrix(&(measures.inverse * deviator));
        out.second_piola = turned * (2.0 * modulus) + inverse * (0.5 * self.kappa * square_growth);
        if request == Request::Tangent {
            out.tangent = self.tangent(measures, modulus, &inverse);
        }
        // 1/2 (J^(-2/3) I1 - 3) with every first-order term cancelled by hand.
        let isochoric = measures.excess() + 1.5 * exp_excess(exponent) + exponent.exp_m1() * measures.trace;
        self.mu * isochoric + 0.25 * self.kappa * log_excess(square_growth)
    }

    /// `mu J^(-2/3) (2/9 I1 A (x) A + 2/3 I1 A [.] A - 2/3 (1 (x) A + A (x) 1)) + kappa (J^2 A (x) A - (J^2 - 1) A
    /// [.] A)`, `A = C^-1`.
    #[inline]
    fn tangent(&self, measures: &Measures, modulus: f64, inverse: &Vector6<f64>) -> Matrix6<f64> {
        let first = 3.0 + 2.0 * measures.trace;
        let square_growth = measures.square_growth();
        let unit = Vector6::from(UNIT);
        let mixed = unit * inverse.transpose();
        let product = symmetric_product(&measures.inverse);
        inverse * inverse.transpose() * (2.0 / 9.0 * modulus * first + self.kappa * (1.0 + square_growth))
            + product * (2.0 / 3.0 * modulus * first - self.kappa * square_growth)
            - (mixed + mixed.transpose()) * (2.0 / 3.0 * modulus)
    }
}

macro_rules! elastic_law {
    ($law:ty, $name:literal) => {
        impl Law for $law {
            fn name(&self) -> &'static str {
                $name
            }

            fn state_variables(&self) -> &[StateVariable] {
                &[]
            }

            fn is_symmetric(&self) -> bool {
                true
            }

            fn has_potential(&self) -> bool {
                true
            }

            fn has_fibre_term(&self) -> bool {
                false
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
                refuse_mean_elongation(input)?;
                let measures = Measures::new(&input.displacement_gradient)?;
                let energy = self.respond(&measures, request, out);
                if request == Request::Tangent {
                    require_finite_tangent(out)?;
                }
                finish(energy, out)
            }
        }
    };
}

elastic_law!(CompressibleNeoHooke, "neo_hooke");
elastic_law!(IsochoricNeoHooke, "isochoric_neo_hooke");
