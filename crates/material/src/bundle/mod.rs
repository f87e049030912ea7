//! The law of a bundle of rope-yarns: axial energy, transverse and longitudinal elasticity with friction.

mod axial;
mod charmetant;
mod forces;
mod friction;
mod parameters;
mod state;
mod tangent;

use crate::LawError;
use crate::lanes::{Lanes, finite};
use crate::law::{LaneFailure, LaneInput, LaneResponse, Law, PointInput, Request, Response, StateVariable, each_lane};
use crate::strain::{Kinematics, failure, rows};
use axial::AxialResponse;
pub use charmetant::{CharmetantLaw, CharmetantParameters};
pub use forces::ConjugateForces;
use friction::{ModeInput, ModeUpdate};
pub use parameters::{BundleParameters, Compaction, Friction, Hardening, ModeParameters};
use state::BundleState;

/// Law of the rope-yarn bundle in the strain modes of [`crate::StrainModes`]:
///
/// `W = W_e(I_elong) + W_c(z) + 1/2 K_t |I_dist - I_dist^P|^2 + 1/2 K_l |I_sh - I_sh^P|^2`, `z = I_comp + nu I_elong`,
///
/// with `W_e`, `W_c` as in [`BundleParameters`] and sliding in both modes once
/// `|q - b| > tau + hardening(kappa) + mu p`, `q = K (I - I^P)`, `b = X I^P`, `p = max(0, -dW/dI_comp)`. The update is
/// backward Euler (radial return) and the tangent that of the discrete update.
///
/// Elastic invariants: Charmetant, Vidal-Salle and Boisse, Composites Science and Technology 71 (2011) 1623; friction
/// as plasticity of the modes: Civier, Bles, Davies and Marco, MARINE 2023.
#[derive(Clone, Debug, PartialEq)]
pub struct BundleLaw {
    parameters: BundleParameters,
    slides: bool,
    presses: bool,
}

/// What one evaluation finds before it is cast into stress and tangent.
#[derive(Clone, Copy, Debug)]
struct Update<V: Lanes> {
    kinematics: Kinematics<V>,
    axial: AxialResponse<V>,
    transverse: ModeUpdate<V>,
    longitudinal: ModeUpdate<V>,
    /// Where input and answer are sound.
    valid: V::Mask,
}

impl BundleLaw {
    /// A law with checked parameters.
    ///
    /// # Errors
    /// [`LawError::Parameter`].
    pub fn new(parameters: BundleParameters) -> Result<Self, LawError> {
        parameters.validate()?;
        let frictions = [parameters.transverse.friction, parameters.longitudinal.friction];
        let slides = frictions.iter().any(Option::is_some);
        let presses = frictions.iter().flatten().any(|friction| friction.mu > 0.0);
        Ok(Self { parameters, slides, presses })
    }

    /// Parameters the law was made of.
    #[must_use]
    pub fn parameters(&self) -> &BundleParameters {
        &self.parameters
    }

    /// Strain modes, axial response and return map of both modes.
    #[inline(always)]
    fn update<V: Lanes>(&self, input: &LaneInput<V>, old: &[f64]) -> Update<V> {
        let old = BundleState::read(input.gradient[0][0], old, self.slides, self.presses);
        let kinematics = Kinematics::new(&input.gradient);
        let modes = &kinematics.modes;
        let axial =
            AxialResponse::new(&self.parameters, input.mean_elongation.unwrap_or(modes.elongation), modes.compaction);
        let drive = |strain, old_mode| ModeInput {
            strain,
            old: old_mode,
            pressure: axial.pressure,
            old_pressure: old.pressure,
        };
        let transverse = ModeUpdate::new(&self.parameters.transverse, &drive(modes.distortion, old.transverse));
        let longitudinal =
            ModeUpdate::new(&self.parameters.longitudinal, &drive(modes.longitudinal_shear, old.longitudinal));
        let mut valid = kinematics.valid & axial.valid;
        if self.slides {
            valid = valid & finite(&old.numbers());
        }
        Update { kinematics, axial, transverse, longitudinal, valid }
    }

    /// [`BundleLaw::update`] of a single point.
    fn update_point(&self, input: &PointInput, old: &[f64]) -> Result<Update<f64>, LawError> {
        self.check_length(old, 1)?;
        let update = self.update(&LaneInput::of(input), old);
        if update.valid { Ok(update) } else { Err(self.diagnose(input, old)) }
    }

    /// The whole answer; says in which lanes it is one.
    #[inline(always)]
    fn answer<V: Lanes>(
        &self,
        input: &LaneInput<V>,
        old: &[f64],
        new: &mut [f64],
        request: Request,
        out: &mut LaneResponse<V>,
    ) -> V::Mask {
        let update = self.update(input, old);
        update.write_state(new, self.slides, self.presses);
        let section = update.section_stress();
        let averaged = input.mean_elongation.is_some();
        update.write_energies(self.presses, out);
        let mut valid = update.valid & update.write_stress(&section, averaged, out);
        if averaged {
            update.write_fibre_response(out);
        }
        if request == Request::Tangent {
            valid = valid & update.write_tangent(&section, averaged, out);
        }
        valid
    }

    #[inline(always)]
    fn check_length(&self, state: &[f64], points: usize) -> Result<(), LawError> {
        let (expected, found) = (self.state_len(), state.len());
        if found == expected * points { Ok(()) } else { Err(LawError::StateLength { expected, found }) }
    }

    /// Why a point has no answer.
    #[cold]
    fn diagnose(&self, input: &PointInput, old: &[f64]) -> LawError {
        let elongation = input.mean_elongation.unwrap_or(0.0);
        if !elongation.is_finite() || !old.iter().all(|number| number.is_finite()) {
            return LawError::NonFiniteInput;
        }
        let gradient = rows(&input.displacement_gradient);
        let kinematics = Kinematics::new(&gradient);
        if !kinematics.valid {
            return failure(&gradient);
        }
        let modes = &kinematics.modes;
        let compaction = modes.compaction + self.parameters.nu * input.mean_elongation.unwrap_or(modes.elongation);
        match self.parameters.compaction {
            Compaction::LockUp { z_lock } if compaction <= z_lock => LawError::LockedUp { compaction, limit: z_lock },
            _ => LawError::NonFiniteResponse,
        }
    }
}

impl Law for BundleLaw {
    fn name(&self) -> &'static str {
        "bundle"
    }

    fn state_variables(&self) -> &[StateVariable] {
        state::variables(self.slides, self.presses)
    }

    #[inline]
    fn state_len(&self) -> usize {
        state::len(self.slides, self.presses)
    }

    #[inline]
    fn is_symmetric(&self) -> bool {
        !self.presses
    }

    fn has_potential(&self) -> bool {
        !self.presses
    }

    fn has_fibre_term(&self) -> bool {
        true
    }

    fn modal_forces(&self, input: &PointInput, old: &[f64]) -> Result<Option<ConjugateForces>, LawError> {
        self.conjugate_forces(input, old).map(Some)
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
        self.check_length(old, 1)?;
        self.check_length(new, 1)?;
        let mut lane = LaneResponse::zero(0.0);
        if !self.answer(&LaneInput::of(input), old, new, request, &mut lane) {
            return Err(self.diagnose(input, old));
        }
        lane.write_to(out, input, request);
        Ok(())
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
        let fits = self.check_length(old, input.points).and(self.check_length(new, input.points));
        if fits.is_ok() && V::all(self.answer(input, old, new, request, out)) {
            return Ok(());
        }
        // The lanes one by one say which of them fails, and why.
        each_lane(self, input, old, new, request, out)
    }
}
