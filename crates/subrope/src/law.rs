//! Laws built from what a scene says.

use subrope_material as material;
use subrope_material::{Law, LawError};

use crate::scene;

/// Any law of a scene behind one pointer, for a single point. (Elements choose the type once per block instead.)
///
/// # Errors
/// [`LawError::Parameter`]; a checked scene has none.
pub fn build(law: &scene::Law) -> Result<Box<dyn Law>, LawError> {
    Ok(match law {
        scene::Law::Bundle(law) => Box::new(bundle(law)?),
        scene::Law::Charmetant(law) => Box::new(charmetant(law)?),
        scene::Law::Orthotropic(law) => Box::new(orthotropic(law)?),
        scene::Law::Isotropic(law) => Box::new(isotropic(law)?),
        scene::Law::NeoHooke(law) => Box::new(neo_hooke(law)?),
        scene::Law::NeoHookeIsochoric(law) => Box::new(neo_hooke_isochoric(law)?),
        scene::Law::FibreReinforced(law) => Box::new(fibre_reinforced(law)?),
    })
}

/// The bundle law.
///
/// # Errors
/// [`LawError::Parameter`].
pub fn bundle(law: &scene::BundleLaw) -> Result<material::BundleLaw, LawError> {
    material::BundleLaw::new(bundle_parameters(law))
}

/// Parameters of the bundle law. A parameter that a checked scene cannot lack counts as 0.
#[must_use]
pub fn bundle_parameters(law: &scene::BundleLaw) -> material::BundleParameters {
    let transverse =
        Sliding { tau: law.tau_t, h: law.H_t, h_inf: law.H_inf_t, kappa_s: law.kappa_s_t, x: law.X_t, mu: law.mu_t };
    let longitudinal =
        Sliding { tau: law.tau_l, h: law.H_l, h_inf: law.H_inf_l, kappa_s: law.kappa_s_l, x: law.X_l, mu: law.mu_l };
    let compaction = match law.compaction {
        scene::Compaction::Quadratic => material::Compaction::Quadratic,
        scene::Compaction::Power => {
            material::Compaction::Power { k_p: law.K_p.unwrap_or_default(), m: law.m.unwrap_or_default() }
        }
        scene::Compaction::LockUp => material::Compaction::LockUp { z_lock: law.z_lock.unwrap_or_default() },
    };
    material::BundleParameters {
        k_e: law.K_e,
        k_ec: law.K_ec,
        w_e: law.w_e,
        k_c: law.K_c,
        nu: law.nu,
        compaction,
        transverse: material::ModeParameters { k: law.K_t, friction: law.friction.then(|| transverse.friction()) },
        longitudinal: material::ModeParameters { k: law.K_l, friction: law.friction.then(|| longitudinal.friction()) },
    }
}

/// Sliding of one mode, as a scene says it.
struct Sliding {
    tau: Option<f64>,
    h: f64,
    h_inf: f64,
    kappa_s: Option<f64>,
    x: f64,
    mu: f64,
}

impl Sliding {
    fn friction(&self) -> material::Friction {
        let hardening = match self.kappa_s {
            Some(kappa_s) if self.h_inf > 0.0 => material::Hardening::Saturating { h_inf: self.h_inf, kappa_s },
            _ => material::Hardening::Linear { h: self.h },
        };
        material::Friction { tau: self.tau.unwrap_or_default(), hardening, x: self.x, mu: self.mu }
    }
}

/// Charmetant's law.
///
/// # Errors
/// [`LawError::Parameter`].
pub fn charmetant(law: &scene::CharmetantLaw) -> Result<material::CharmetantLaw, LawError> {
    material::CharmetantLaw::new(material::CharmetantParameters {
        k_elong: law.K_e,
        k_elong_initial: law.K_ec,
        toe: law.w_e,
        k_comp: law.K_p,
        p: law.m,
        k_rest: law.K_c,
        k_dist: law.K_t,
        k_sh: law.K_l,
    })
}

/// The orthotropic law.
///
/// # Errors
/// [`LawError::Parameter`], or a stiffness that is not positive definite.
pub fn orthotropic(law: &scene::OrthotropicLaw) -> Result<material::StVenantKirchhoff, LawError> {
    material::StVenantKirchhoff::orthotropic(&material::EngineeringConstants {
        e1: law.E1,
        e2: law.E2,
        e3: law.E3,
        nu12: law.nu12,
        nu13: law.nu13,
        nu23: law.nu23,
        g12: law.G12,
        g13: law.G13,
        g23: law.G23,
    })
}

/// The isotropic law.
///
/// # Errors
/// [`LawError::Parameter`].
pub fn isotropic(law: &scene::IsotropicLaw) -> Result<material::StVenantKirchhoff, LawError> {
    material::StVenantKirchhoff::isotropic(law.E, law.nu)
}

/// Compressible neo-Hooke.
///
/// # Errors
/// [`LawError::Parameter`].
pub fn neo_hooke(law: &scene::NeoHookeLaw) -> Result<material::CompressibleNeoHooke, LawError> {
    material::CompressibleNeoHooke::new(law.mu, law.lambda)
}

/// Neo-Hooke with its distortion apart from its volume change.
///
/// # Errors
/// [`LawError::Parameter`].
pub fn neo_hooke_isochoric(law: &scene::NeoHookeIsochoricLaw) -> Result<material::IsochoricNeoHooke, LawError> {
    material::IsochoricNeoHooke::new(law.mu, law.kappa)
}

/// Neo-Hooke with fibres.
///
/// # Errors
/// [`LawError::Parameter`].
pub fn fibre_reinforced(law: &scene::FibreReinforcedLaw) -> Result<material::FibreNeoHooke, LawError> {
    material::FibreNeoHooke::new(law.mu, law.lambda, law.k)
}
