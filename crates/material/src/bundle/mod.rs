//! The law of a bundle of rope-yarns: axial energy, transverse and longitudinal elasticity with friction.

mod axial;
mod charmetant;
mod forces;
mod friction;
mod parameters;
mod state;
mod tangent;

use crate::LawError;
use crate::law::{Law, PointInput, Request, Response, StateVariable};
use crate::strain::Kinematics;
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
struct Update {
    kinematics: Kinematics,
    axial: AxialResponse,
    transverse: ModeUpdate,
    longitudinal: ModeUpdate,
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
    #[inline]
    fn update(&self, input: &PointInput, old: &BundleState) -> Result<Update, LawError> {
        let kinematics = Kinematics::new(&input.displacement_gradient)?;
        let modes = &kinematics.modes;
        let elongation = input.mean_elongation.unwrap_or(modes.elongation);
        if !elongation.is_finite() {
            return Err(LawError::NonFiniteInput);
        }
        let axial = AxialResponse::new(&self.parameters, elongation, modes.compaction)?;
        let drive = |strain, old_mode| ModeInput {
            strain,
            old: old_mode,
            pressure: axial.pressure,
            old_pressure: old.pressure,
        };
        let transverse = ModeUpdate::new(&self.parameters.transverse, &drive(modes.distortion, old.transverse));
        let longitudinal =
            ModeUpdate::new(&self.parameters.longitudinal, &drive(modes.longitudinal_shear, old.longitudinal));
        Ok(Update { kinematics, axial, transverse, longitudinal })
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
        let old_state = BundleState::read(old, self.slides, self.presses)?;
        let update = self.update(input, &old_state)?;
        update.write_state(new, self.slides, self.presses)?;
        let section = update.section_stress();
        let averaged = input.mean_elongation.is_some();
        update.write_energies(self.presses, out);
        update.write_stress(&section, averaged, out)?;
        if averaged {
            update.write_fibre_response(out);
        }
        match request {
            Request::Stress => Ok(()),
            Request::Tangent => update.write_tangent(&section, averaged, out),
        }
    }
}
