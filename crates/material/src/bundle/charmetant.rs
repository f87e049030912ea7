//! Charmetant's four-invariant hyperelastic law: the bundle law without sliding.

use super::parameters::{BundleParameters, Compaction, ModeParameters};
use super::{BundleLaw, ConjugateForces};
use crate::LawError;
use crate::lanes::Lanes;
use crate::law::{LaneFailure, LaneInput, LaneResponse, Law, PointInput, Request, Response, StateVariable};

/// Parameters of [`CharmetantLaw`] \[MPa unless stated\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CharmetantParameters {
    /// Elongation modulus `K_elong` \[MPa\] beyond the toe.
    pub k_elong: f64,
    /// Elongation modulus \[MPa\] before the toe and in compression.
    pub k_elong_initial: f64,
    /// Width of the toe \[-\].
    pub toe: f64,
    /// Compaction modulus `K_comp` \[MPa\] of the power law `K_comp |I_comp|^p`.
    pub k_comp: f64,
    /// Exponent `p > 2` \[-\] of the power law.
    pub p: f64,
    /// Modulus \[MPa\] of the quadratic compaction energy that keeps the section stiff in expansion and at rest.
    pub k_rest: f64,
    /// Distortion modulus `K_dist` \[MPa\].
    pub k_dist: f64,
    /// Longitudinal shear modulus `K_sh` \[MPa\].
    pub k_sh: f64,
}

impl From<CharmetantParameters> for BundleParameters {
    fn from(from: CharmetantParameters) -> Self {
        Self {
            k_e: from.k_elong,
            k_ec: from.k_elong_initial,
            w_e: from.toe,
            k_c: from.k_rest,
            nu: 0.0,
            compaction: Compaction::Power { k_p: from.k_comp, m: from.p },
            transverse: ModeParameters::elastic(from.k_dist),
            longitudinal: ModeParameters::elastic(from.k_sh),
        }
    }
}

/// `W = W_elong(I_elong) + W_comp(I_comp) + 1/2 K_dist |I_dist|^2 + 1/2 K_sh |I_sh|^2`, hyperelastic, four invariants.
///
/// `W_comp = K_comp |I_comp|^p` in compaction, with a small quadratic term on both sides so that the tangent is
/// regular. Charmetant, Vidal-Salle and Boisse, Composites Science and Technology 71 (2011) 1623.
#[derive(Clone, Debug, PartialEq)]
pub struct CharmetantLaw(BundleLaw);

impl CharmetantLaw {
    /// A law with checked parameters.
    ///
    /// # Errors
    /// [`LawError::Parameter`], named by the symbols of [`BundleParameters`].
    pub fn new(parameters: CharmetantParameters) -> Result<Self, LawError> {
        BundleLaw::new(parameters.into()).map(Self)
    }

    /// The law as a bundle law without friction.
    #[must_use]
    pub fn as_bundle(&self) -> &BundleLaw {
        &self.0
    }

    /// Forces conjugate to the strain modes.
    ///
    /// # Errors
    /// As [`Law::evaluate`].
    pub fn conjugate_forces(&self, input: &PointInput) -> Result<ConjugateForces, LawError> {
        self.0.conjugate_forces(input, &[])
    }
}

impl Law for CharmetantLaw {
    fn name(&self) -> &'static str {
        "charmetant"
    }

    fn state_variables(&self) -> &[StateVariable] {
        self.0.state_variables()
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

    fn modal_forces(&self, input: &PointInput, _old: &[f64]) -> Result<Option<ConjugateForces>, LawError> {
        self.conjugate_forces(input).map(Some)
    }

    #[inline]
    fn evaluate(
        &self,
        input: &PointInput,
        old: &[f64],
        new: &mut [f64],
        request: Request,
        out: &mut Response,
    ) -> Result<(), LawError> {
        self.0.evaluate(input, old, new, request, out)
    }

    #[inline(always)]
    fn evaluate_lanes<V: Lanes>(
        &self,
        input: &LaneInput<V>,
        old: &[f64],
        new: &mut [f64],
        request: Request,
        out: &mut LaneResponse<V>,
    ) -> Result<(), LaneFailure> {
        self.0.evaluate_lanes(input, old, new, request, out)
    }
}
