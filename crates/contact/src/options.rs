//! Settings of a contact.

use crate::ContactError;
use crate::law::Normal;

/// How the surfaces are kept apart.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Method {
    /// Pressure in proportion to the penetration.
    #[default]
    Penalty,
    /// Multipliers (Uzawa) until the penetration falls below a limit.
    Augmented {
        /// Largest penetration \[mm\].
        penetration: f64,
        /// Most rounds per increment.
        rounds: usize,
    },
}

/// Tangent of friction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FrictionTangent {
    /// Exact, unsymmetric: quadratic convergence, solved by GMRES.
    #[default]
    Exact,
    /// Its symmetric part: more iterations, each cheaper.
    Symmetric,
}

/// Settings of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactOptions {
    /// Normal penalty \[MPa/mm\].
    pub penalty: f64,
    /// Depth over which the normal penalty sets in \[mm\]; zero: at once.
    pub toe: f64,
    /// Tangential penalty \[MPa/mm\].
    pub tangential_penalty: f64,
    /// Coefficient of friction.
    pub friction: f64,
    /// How the surfaces are kept apart.
    pub method: Method,
    /// Tangent of friction.
    pub tangent: FrictionTangent,
    /// Integration points of a patch along its two directions.
    pub points: [usize; 2],
    /// Gap up to which patches count as candidates \[mm\].
    pub reach: f64,
    /// Time over which surfaces that overlap at the start are pressed apart \[s\]; zero: the overlap acts at once.
    pub ramp: f64,
}

/// A penalty \[MPa/mm\] of surfaces of bodies with transverse modulus `modulus` \[MPa\] and size (radius) `size` \[mm\]:
/// 300 times what a layer of that thickness offers at rest. Rope-yarn bundles stiffen far above that under tension: three
/// strands stretched by 3 % changed their force by 2.1, .55 % on doubling the factors 20, 160, so about .3 % is left here.
#[must_use]
pub fn default_penalty(modulus: f64, size: f64) -> f64 {
    300.0 * modulus / size
}

impl ContactOptions {
    /// Frictionless penalty contact for bodies of transverse modulus `modulus` \[MPa\] and size (radius) `size` \[mm\].
    #[must_use]
    pub fn new(modulus: f64, size: f64) -> Self {
        let penalty = default_penalty(modulus, size);
        Self {
            penalty,
            toe: 0.0,
            tangential_penalty: penalty,
            friction: 0.0,
            method: Method::Penalty,
            tangent: FrictionTangent::Exact,
            points: [6, 3],
            reach: 0.1 * size,
            ramp: 0.0,
        }
    }

    /// The law of the pressure.
    #[must_use]
    pub fn normal(&self) -> Normal {
        Normal { penalty: self.penalty, toe: self.toe }
    }

    /// Checks ranges.
    ///
    /// # Errors
    /// [`ContactError::Option`].
    pub fn validate(&self) -> Result<(), ContactError> {
        let positive =
            [("penalty", self.penalty), ("tangential penalty", self.tangential_penalty), ("reach", self.reach)];
        for (option, value) in positive {
            if !(value > 0.0 && value.is_finite()) {
                return Err(ContactError::Option { option, range: "positive and finite", value });
            }
        }
        for (option, value) in [("toe", self.toe), ("friction", self.friction), ("ramp", self.ramp)] {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(ContactError::Option { option, range: "zero or positive, and finite", value });
            }
        }
        if let Method::Augmented { penetration, .. } = self.method
            && !(penetration > 0.0 && penetration.is_finite())
        {
            return Err(ContactError::Option {
                option: "penetration",
                range: "positive and finite",
                value: penetration,
            });
        }
        match self.points.iter().find(|n| !(1..=32).contains(*n)) {
            Some(&n) => Err(ContactError::Option { option: "points", range: "between 1 and 32", value: n as f64 }),
            None => Ok(()),
        }
    }
}
