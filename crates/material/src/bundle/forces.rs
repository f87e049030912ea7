//! Conjugate forces, energies and the second Piola-Kirchhoff stress.

use super::{BundleLaw, Update};
use crate::LawError;
use crate::lanes::{Lanes, finite};
use crate::law::{LaneResponse, PointInput};
use crate::strain::{StrainModes, dot};

/// Forces conjugate to the strain modes after an increment, and whether the modes slid.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ConjugateForces {
    /// The strain modes themselves \[-\].
    pub modes: StrainModes,
    /// `W_,e = W_e' + nu W_c'` \[MPa\], the fibre's Kirchhoff stress.
    pub elongation: f64,
    /// `W_,c = W_c'` \[MPa\], minus twice the transverse pressure.
    pub compaction: f64,
    /// `q_t = K_t (I_dist - I_dist^P)` \[MPa\].
    pub distortion: [f64; 2],
    /// `q_l = K_l (I_sh - I_sh^P)` \[MPa\].
    pub longitudinal_shear: [f64; 2],
    /// `p = max(0, -W_,c)` \[MPa\].
    pub compaction_pressure: f64,
    /// Whether the transverse and the longitudinal mode slid in the increment.
    pub slides: [bool; 2],
}

impl ConjugateForces {
    /// `W_,e, W_,c, q_t1, q_t2, q_l2, q_l3` \[MPa\].
    #[must_use]
    pub fn to_array(&self) -> [f64; 6] {
        let ([t1, t2], [l2, l3]) = (self.distortion, self.longitudinal_shear);
        [self.elongation, self.compaction, t1, t2, l2, l3]
    }
}

impl BundleLaw {
    /// Forces conjugate to the strain modes at the end of the increment that starts from `old`.
    ///
    /// # Errors
    /// As [`crate::Law::evaluate`].
    pub fn conjugate_forces(&self, input: &PointInput, old: &[f64]) -> Result<ConjugateForces, LawError> {
        let update = self.update_point(input, old)?;
        Ok(ConjugateForces {
            modes: update.kinematics.modes,
            elongation: update.axial.by_elongation,
            compaction: update.axial.by_compaction,
            distortion: update.transverse.force,
            longitudinal_shear: update.longitudinal.force,
            compaction_pressure: update.axial.pressure,
            slides: [update.transverse.slides, update.longitudinal.slides],
        })
    }
}

/// `P_ab = dW/dT_ab` in its parts: `P = chi T^-1 + deviator of w`.
#[derive(Clone, Copy, Debug)]
pub(super) struct SectionStress<V> {
    /// `chi = (W_,c - q_t.v/m)/4`.
    pub(super) chi: V,
    /// `q_t . v`.
    pub(super) work: V,
    /// `P22`, `P33`, `P23`.
    pub(super) components: [V; 3],
}

impl<V: Lanes> Update<V> {
    /// Stored energy, incremental potential and mid-point dissipation.
    #[inline(always)]
    pub(super) fn write_energies(&self, presses: bool, out: &mut LaneResponse<V>) {
        let dissipated = [self.transverse.dissipated_mid, self.longitudinal.dissipated_mid];
        out.stored_energy = self.axial.energy + self.transverse.stored + self.longitudinal.stored;
        out.dissipated_mid = dissipated;
        // Without pressure the mid-point dissipation is the integral of the yield stress over the slip.
        out.incremental_potential = (!presses).then_some(out.stored_energy + dissipated[0] + dissipated[1]);
    }

    #[inline(always)]
    pub(super) fn section_stress(&self) -> SectionStress<V> {
        let kinematics = &self.kinematics;
        let (q, v) = (self.transverse.force, kinematics.deviator);
        let work = dot(q, v);
        let chi = (self.axial.by_compaction - work * kinematics.inverse_mean) * 0.25;
        let radial = kinematics.c * work;
        let phi = kinematics.phi;
        let w = [(phi * q[0] - radial * v[0]) * 0.5, (phi * q[1] - radial * v[1]) * 0.5];
        let spherical = chi * kinematics.inverse_det;
        let [t22, t33, t23] = kinematics.section;
        let components = [spherical * t33 + w[0], spherical * t22 - w[0], w[1] - spherical * t23];
        SectionStress { chi, work, components }
    }

    /// `S = (W_,e/C11) e1 e1 + 2 P_ab N_a N_b + (2/C11) W_,ga sym(e1 N_a)`; without the first term when the
    /// elongation is averaged. Answers where it is finite.
    #[inline(always)]
    pub(super) fn write_stress(
        &self,
        section: &SectionStress<V>,
        averaged: bool,
        out: &mut LaneResponse<V>,
    ) -> V::Mask {
        use std::f64::consts::SQRT_2;
        let inverse = self.kinematics.inverse_c11;
        let fibre = if averaged { inverse.splat(0.0) } else { self.axial.by_elongation * inverse };
        let [p22, p33, p23] = section.components;
        let q = self.longitudinal.force;
        let shear = inverse * SQRT_2;
        let reduced = [fibre, p22 * 2.0, p33 * 2.0, shear * q[0], shear * q[1], p23 * (2.0 * SQRT_2)];
        out.second_piola = self.kinematics.expand(reduced);
        let [s1, s2, s3, s4, s5, s6] = out.second_piola;
        finite(&[s1, s2, s3, s4, s5, s6, out.stored_energy])
    }
}
