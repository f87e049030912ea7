//! Parameters of the bundle law, with the symbols of the formulas.

use crate::LawError;

/// Parameters of [`super::BundleLaw`] \[MPa unless stated\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BundleParameters {
    /// Tension modulus `K_e` \[MPa\] of the fibre direction.
    pub k_e: f64,
    /// Compression modulus `K_ec` \[MPa\]; much smaller than `K_e`, because rope-yarns buckle.
    pub k_ec: f64,
    /// Width `w_e` \[-\] of the toe over which the modulus rises from `K_ec` to `K_e`; 0 for a kink.
    pub w_e: f64,
    /// Compaction modulus `K_c` \[MPa\].
    pub k_c: f64,
    /// Coupling `nu` \[-\] of compaction to elongation, `z = I_comp + nu I_elong`; 1/2 keeps the volume.
    pub nu: f64,
    /// What happens when the section is compacted.
    pub compaction: Compaction,
    /// Transverse distortion of the section.
    pub transverse: ModeParameters,
    /// Longitudinal shear, rope-yarn along rope-yarn.
    pub longitudinal: ModeParameters,
}

/// Energy `W_c(z)` of a compacted section, `z < 0`; an expanded one always has `1/2 K_c z^2`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Compaction {
    /// `1/2 K_c z^2`.
    Quadratic,
    /// `1/2 K_c z^2 + K_p |z|^m`, Charmetant's power law.
    Power {
        /// `K_p` \[MPa\].
        k_p: f64,
        /// Exponent `m > 2` \[-\].
        m: f64,
    },
    /// `-1/2 K_c z_l^2 ln(1 - (z/z_l)^2)`: the section cannot pack beyond `z_l`.
    LockUp {
        /// `z_l < 0` \[-\].
        z_lock: f64,
    },
}

/// One sliding mode: elastic stiffness and, if it slides, its friction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModeParameters {
    /// Stiffness `K` \[MPa\].
    pub k: f64,
    /// Friction between the rope-yarns; `None`: elastic.
    pub friction: Option<Friction>,
}

/// Yield condition `|q - b| <= tau + hardening(kappa) + mu p` with back stress `b = X I^P`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    /// Threshold `tau` \[MPa\]; infinity: never slides.
    pub tau: f64,
    /// Isotropic hardening.
    pub hardening: Hardening,
    /// Kinematic hardening modulus `X` \[MPa\].
    pub x: f64,
    /// Coefficient `mu` \[-\] of the compaction pressure `p`.
    pub mu: f64,
}

/// Isotropic hardening as a function of the accumulated sliding `kappa`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Hardening {
    /// `H kappa`.
    Linear {
        /// `H` \[MPa\].
        h: f64,
    },
    /// `H_inf (1 - exp(-kappa/kappa_s))`: settles, so that cycles keep dissipating.
    Saturating {
        /// `H_inf` \[MPa\].
        h_inf: f64,
        /// `kappa_s` \[-\].
        kappa_s: f64,
    },
}

impl Friction {
    /// Threshold `tau` and linear isotropic hardening `H`, nothing else.
    #[must_use]
    pub fn isotropic(tau: f64, h: f64) -> Self {
        Self { tau, hardening: Hardening::Linear { h }, x: 0.0, mu: 0.0 }
    }
}

impl ModeParameters {
    /// A mode that never slides.
    #[must_use]
    pub fn elastic(k: f64) -> Self {
        Self { k, friction: None }
    }

    /// A mode that slides.
    #[must_use]
    pub fn sliding(k: f64, friction: Friction) -> Self {
        Self { k, friction: Some(friction) }
    }
}

impl BundleParameters {
    /// The same parameters with both modes elastic.
    #[must_use]
    pub fn without_friction(mut self) -> Self {
        self.transverse.friction = None;
        self.longitudinal.friction = None;
        self
    }

    /// Checks every value.
    ///
    /// # Errors
    /// [`LawError::Parameter`] naming the first impossible one.
    pub fn validate(&self) -> Result<(), LawError> {
        positive("K_e", self.k_e)?;
        positive("K_ec", self.k_ec)?;
        not_negative("w_e", self.w_e)?;
        positive("K_c", self.k_c)?;
        require(self.nu.is_finite(), "nu", self.nu, "must be finite")?;
        self.compaction.validate()?;
        self.transverse.validate(["K_t", "tau_t", "H_t", "H_inf_t", "kappa_s_t", "X_t", "mu_t"])?;
        self.longitudinal.validate(["K_l", "tau_l", "H_l", "H_inf_l", "kappa_s_l", "X_l", "mu_l"])
    }
}

impl Compaction {
    fn validate(&self) -> Result<(), LawError> {
        match *self {
            Self::Quadratic => Ok(()),
            Self::Power { k_p, m } => {
                not_negative("K_p", k_p)?;
                require(m > 2.0 && m.is_finite(), "m", m, "must be finite and greater than 2")
            }
            Self::LockUp { z_lock } => {
                require(z_lock < 0.0 && z_lock.is_finite(), "z_lock", z_lock, "must be finite and negative")
            }
        }
    }
}

impl ModeParameters {
    fn validate(&self, [k, tau, h, h_inf, kappa_s, x, mu]: [&'static str; 7]) -> Result<(), LawError> {
        positive(k, self.k)?;
        let Some(friction) = self.friction else {
            return Ok(());
        };
        require(friction.tau >= 0.0, tau, friction.tau, "must not be negative (infinity: never slides)")?;
        match friction.hardening {
            Hardening::Linear { h: modulus } => not_negative(h, modulus)?,
            Hardening::Saturating { h_inf: limit, kappa_s: scale } => {
                not_negative(h_inf, limit)?;
                positive(kappa_s, scale)?;
            }
        }
        not_negative(x, friction.x)?;
        not_negative(mu, friction.mu)
    }
}

fn positive(name: &'static str, value: f64) -> Result<(), LawError> {
    require(value > 0.0 && value.is_finite(), name, value, "must be finite and positive")
}

fn not_negative(name: &'static str, value: f64) -> Result<(), LawError> {
    require(value >= 0.0 && value.is_finite(), name, value, "must be finite and not negative")
}

fn require(holds: bool, name: &'static str, value: f64, requirement: &'static str) -> Result<(), LawError> {
    if holds { Ok(()) } else { Err(LawError::Parameter { name, value, requirement }) }
}
