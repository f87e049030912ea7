//! Laws and their parameters. Symbols are those of the published laws.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The law of the material, chosen by `kind`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Law {
    /// Rope-yarn bundle with friction between the rope-yarns.
    Bundle(BundleLaw),
    /// Hyperelastic yarn of Charmetant, Vidal-Salle and Boisse (2011): the bundle without sliding, with their power law
    /// of compaction.
    Charmetant(CharmetantLaw),
    /// St. Venant-Kirchhoff with three planes of symmetry, axis 1 along the fibre.
    Orthotropic(OrthotropicLaw),
    /// St. Venant-Kirchhoff, isotropic.
    Isotropic(IsotropicLaw),
    /// `W = mu/2 (I1 - 3) - mu ln J + lambda/2 ln^2 J`.
    NeoHooke(NeoHookeLaw),
    /// `W = mu/2 (J^(-2/3) I1 - 3) + kappa/4 (J^2 - 1 - 2 ln J)`.
    NeoHookeIsochoric(NeoHookeIsochoricLaw),
    /// Neo-Hooke with fibres: `W = mu/2 (I1 - 3) - mu ln J + lambda/2 ln^2 J + k/2 (I4 - 1)^2`.
    FibreReinforced(FibreReinforcedLaw),
}

impl Law {
    /// The word in a scene file.
    #[must_use]
    pub fn word(&self) -> &'static str {
        match self {
            Self::Bundle(_) => "bundle",
            Self::Charmetant(_) => "charmetant",
            Self::Orthotropic(_) => "orthotropic",
            Self::Isotropic(_) => "isotropic",
            Self::NeoHooke(_) => "neo_hooke",
            Self::NeoHookeIsochoric(_) => "neo_hooke_isochoric",
            Self::FibreReinforced(_) => "fibre_reinforced",
        }
    }

    /// Whether the law has a fibre term of its own, whose elongation an element can average.
    #[must_use]
    pub fn has_fibre_term(&self) -> bool {
        matches!(self, Self::Bundle(_) | Self::Charmetant(_) | Self::FibreReinforced(_))
    }
}

/// Rope-yarn bundle:
/// `W = W_e(I_elong) + W_c(I_comp + nu I_elong) + K_t/2 |I_dist - I_dist^P|^2 + K_l/2 |I_sh - I_sh^P|^2`,
/// with transverse (t) and longitudinal (l) sliding where
/// `|q - X I^P| = tau + H kappa + mu p`, or with `H_inf (1 - exp(-kappa/kappa_s))` in place of `H kappa`.
#[allow(non_snake_case)] // the symbols of the law
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BundleLaw {
    /// Modulus along the rope-yarns in tension \[MPa\].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub K_e: f64,
    /// Modulus along the rope-yarns in compression \[MPa\], far below K_e since rope-yarns buckle.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub K_ec: f64,
    /// Width of the toe: elongation over which the modulus rises from K_ec to K_e \[-\].
    #[serde(default)]
    #[schemars(extend("minimum" = 0))]
    pub w_e: f64,
    /// Coupling of elongation and compaction \[-\]: a stretched bundle contracts; 0.5 keeps its volume.
    #[serde(default)]
    pub nu: f64,
    /// What resists compaction beyond K_c: "quadratic" (nothing), "power" (K_p, m) or "lock_up" (z_lock).
    #[serde(default)]
    pub compaction: Compaction,
    /// Modulus of compaction and expansion of the section \[MPa\].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub K_c: f64,
    /// Factor of the power law of compaction `K_p |z|^m` \[MPa\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 0))]
    pub K_p: Option<f64>,
    /// Exponent of the power law of compaction \[-\], above 2.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 2))]
    pub m: Option<f64>,
    /// Compaction at which the section is packed solid \[-\], negative.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMaximum" = 0))]
    pub z_lock: Option<f64>,
    /// Modulus of transverse distortion \[MPa\]; 4 times the transverse shear modulus.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub K_t: f64,
    /// Modulus of longitudinal shear \[MPa\].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub K_l: f64,
    /// Whether rope-yarns slide; without, the law is elastic and the keys of sliding are not read.
    #[serde(default = "yes")]
    pub friction: bool,
    /// Threshold of transverse sliding \[MPa\]; twice the transverse shear strength between rope-yarns.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 0))]
    pub tau_t: Option<f64>,
    /// Linear isotropic hardening of transverse sliding \[MPa\].
    #[serde(default)]
    #[schemars(extend("minimum" = 0))]
    pub H_t: f64,
    /// Kinematic hardening of transverse sliding \[MPa\].
    #[serde(default)]
    #[schemars(extend("minimum" = 0))]
    pub X_t: f64,
    /// Pressure dependence of transverse sliding \[-\]; a yarn-on-yarn friction coefficient f means mu_t = f.
    #[serde(default)]
    #[schemars(extend("minimum" = 0))]
    pub mu_t: f64,
    /// Saturating hardening of transverse sliding: its final value \[MPa\].
    #[serde(default)]
    #[schemars(extend("minimum" = 0))]
    pub H_inf_t: f64,
    /// Saturating hardening of transverse sliding: the slip over which it develops \[-\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub kappa_s_t: Option<f64>,
    /// Threshold of longitudinal sliding \[MPa\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 0))]
    pub tau_l: Option<f64>,
    /// Linear isotropic hardening of longitudinal sliding \[MPa\].
    #[serde(default)]
    #[schemars(extend("minimum" = 0))]
    pub H_l: f64,
    /// Kinematic hardening of longitudinal sliding \[MPa\].
    #[serde(default)]
    #[schemars(extend("minimum" = 0))]
    pub X_l: f64,
    /// Pressure dependence of longitudinal sliding \[-\]; a yarn-on-yarn friction coefficient f means mu_l = f/2.
    #[serde(default)]
    #[schemars(extend("minimum" = 0))]
    pub mu_l: f64,
    /// Saturating hardening of longitudinal sliding: its final value \[MPa\].
    #[serde(default)]
    #[schemars(extend("minimum" = 0))]
    pub H_inf_l: f64,
    /// Saturating hardening of longitudinal sliding: the slip over which it develops \[-\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub kappa_s_l: Option<f64>,
}

fn yes() -> bool {
    true
}

/// What resists compaction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Compaction {
    /// `K_c/2 z^2`.
    #[default]
    Quadratic,
    /// `K_c/2 z^2 + K_p |z|^m` when compacted.
    Power,
    /// `-K_c/2 z_lock^2 ln(1 - (z/z_lock)^2)` when compacted.
    LockUp,
}

/// Hyperelastic yarn of Charmetant, Vidal-Salle and Boisse (2011).
#[allow(non_snake_case)] // the symbols of the law
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CharmetantLaw {
    /// Modulus along the rope-yarns in tension \[MPa\].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub K_e: f64,
    /// Modulus along the rope-yarns in compression \[MPa\].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub K_ec: f64,
    /// Width of the toe \[-\].
    #[serde(default)]
    #[schemars(extend("minimum" = 0))]
    pub w_e: f64,
    /// Modulus of compaction and expansion of the section \[MPa\].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub K_c: f64,
    /// Factor of the power law of compaction `K_p |I_comp|^m` \[MPa\].
    #[schemars(extend("minimum" = 0))]
    pub K_p: f64,
    /// Exponent of the power law of compaction \[-\], above 2.
    #[schemars(extend("exclusiveMinimum" = 2))]
    pub m: f64,
    /// Modulus of transverse distortion \[MPa\].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub K_t: f64,
    /// Modulus of longitudinal shear \[MPa\].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub K_l: f64,
}

/// St. Venant-Kirchhoff with three planes of symmetry, axis 1 along the fibre.
#[allow(non_snake_case)] // the symbols of the law
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OrthotropicLaw {
    /// Young's modulus along the fibre \[MPa\].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub E1: f64,
    /// Young's modulus along axis 2 \[MPa\].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub E2: f64,
    /// Young's modulus along axis 3 \[MPa\].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub E3: f64,
    /// Contraction along 2 under tension along 1 \[-\].
    pub nu12: f64,
    /// Contraction along 3 under tension along 1 \[-\].
    pub nu13: f64,
    /// Contraction along 3 under tension along 2 \[-\].
    pub nu23: f64,
    /// Shear modulus in the plane 12 \[MPa\].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub G12: f64,
    /// Shear modulus in the plane 13 \[MPa\].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub G13: f64,
    /// Shear modulus in the plane 23 \[MPa\].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub G23: f64,
}

/// St. Venant-Kirchhoff, isotropic.
#[allow(non_snake_case)] // the symbols of the law
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct IsotropicLaw {
    /// Young's modulus \[MPa\].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub E: f64,
    /// Poisson's ratio \[-\], between -1 and 0.5.
    #[schemars(extend("exclusiveMinimum" = -1, "exclusiveMaximum" = 0.5))]
    pub nu: f64,
}

/// Compressible neo-Hooke.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NeoHookeLaw {
    /// Shear modulus \[MPa\].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub mu: f64,
    /// First Lame constant \[MPa\].
    #[schemars(extend("minimum" = 0))]
    pub lambda: f64,
}

/// Neo-Hooke with its distortion apart from its volume change.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NeoHookeIsochoricLaw {
    /// Shear modulus \[MPa\].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub mu: f64,
    /// Bulk modulus \[MPa\].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub kappa: f64,
}

/// Neo-Hooke with fibres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FibreReinforcedLaw {
    /// Shear modulus \[MPa\].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub mu: f64,
    /// First Lame constant \[MPa\].
    #[schemars(extend("minimum" = 0))]
    pub lambda: f64,
    /// Modulus of the fibres \[MPa\].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub k: f64,
}
