//! St. Venant-Kirchhoff: linear between `S` and `E`.

use nalgebra::{Matrix3, Matrix6};

use super::measures::volume_growth;
use super::{positive, refuse_mean_elongation, require};
use crate::LawError;
use crate::lanes::{self, Lanes, finite};
use crate::law::{LaneFailure, LaneInput, LaneResponse, Law, PointInput, Request, Response, StateVariable, each_lane};

/// Engineering constants of an orthotropic material, moduli \[MPa\], Poisson ratios \[-\]; 1 is the fibre.
///
/// `nu_ij` is minus the strain along `j` per strain along `i` under a stress along `i`: `nu_ij/E_i = nu_ji/E_j`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EngineeringConstants {
    /// `E1` \[MPa\].
    pub e1: f64,
    /// `E2` \[MPa\].
    pub e2: f64,
    /// `E3` \[MPa\].
    pub e3: f64,
    /// `nu12` \[-\].
    pub nu12: f64,
    /// `nu13` \[-\].
    pub nu13: f64,
    /// `nu23` \[-\].
    pub nu23: f64,
    /// `G12` \[MPa\].
    pub g12: f64,
    /// `G13` \[MPa\].
    pub g13: f64,
    /// `G23` \[MPa\].
    pub g23: f64,
}

impl EngineeringConstants {
    fn validate(&self) -> Result<(), LawError> {
        for (name, value) in
            [("E1", self.e1), ("E2", self.e2), ("E3", self.e3), ("G12", self.g12), ("G13", self.g13), ("G23", self.g23)]
        {
            positive(name, value)?;
        }
        let bound = "must be smaller in magnitude than sqrt(E_i/E_j)";
        require(self.nu12 * self.nu12 < self.e1 / self.e2, "nu12", self.nu12, bound)?;
        require(self.nu13 * self.nu13 < self.e1 / self.e3, "nu13", self.nu13, bound)?;
        require(self.nu23 * self.nu23 < self.e2 / self.e3, "nu23", self.nu23, bound)
    }

    /// Compliance of the three normal components.
    fn compliance(&self) -> Matrix3<f64> {
        let (s12, s13, s23) = (-self.nu12 / self.e1, -self.nu13 / self.e1, -self.nu23 / self.e2);
        Matrix3::new(1.0 / self.e1, s12, s13, s12, 1.0 / self.e2, s23, s13, s23, 1.0 / self.e3)
    }

    /// Mandel stiffness.
    fn stiffness(&self) -> Result<Matrix6<f64>, LawError> {
        self.validate()?;
        let compliance = self.compliance();
        let volume = compliance.determinant() * self.e1 * self.e2 * self.e3;
        let requirement = "1 - nu12 nu21 - nu23 nu32 - nu31 nu13 - 2 nu21 nu32 nu13 must be positive";
        let error = LawError::Parameter { name: "nu12, nu13, nu23", value: volume, requirement };
        let normal = compliance.try_inverse().filter(|_| volume > 0.0).ok_or(error)?;
        let mut stiffness = Matrix6::zeros();
        stiffness.fixed_view_mut::<3, 3>(0, 0).copy_from(&normal);
        for (i, shear) in [(3, self.g12), (4, self.g13), (5, self.g23)] {
            stiffness[(i, i)] = 2.0 * shear;
        }
        Ok(stiffness)
    }
}

/// `W = 1/2 E : D : E`, `S = D : E`; isotropic or orthotropic in the material frame.
#[derive(Clone, Debug, PartialEq)]
pub struct StVenantKirchhoff {
    stiffness: Matrix6<f64>,
}

impl StVenantKirchhoff {
    /// Orthotropic law in the material frame.
    ///
    /// # Errors
    /// [`LawError::Parameter`] unless the energy is positive definite.
    pub fn orthotropic(constants: &EngineeringConstants) -> Result<Self, LawError> {
        constants.stiffness().map(|stiffness| Self { stiffness })
    }

    /// Isotropic law of Young's modulus `E` \[MPa\] and Poisson's ratio `nu` \[-\].
    ///
    /// # Errors
    /// [`LawError::Parameter`] unless `E > 0` and `-1 < nu < 1/2`.
    pub fn isotropic(young: f64, poisson: f64) -> Result<Self, LawError> {
        positive("E", young)?;
        require(poisson > -1.0 && poisson < 0.5, "nu", poisson, "must lie between -1 and 1/2")?;
        let shear = young / (2.0 * (1.0 + poisson));
        let lame = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
        let mut stiffness = Matrix6::identity() * (2.0 * shear);
        stiffness.fixed_view_mut::<3, 3>(0, 0).add_scalar_mut(lame);
        Ok(Self { stiffness })
    }

    /// Stiffness \[MPa\], Mandel.
    #[must_use]
    pub fn stiffness(&self) -> &Matrix6<f64> {
        &self.stiffness
    }
}

impl StVenantKirchhoff {
    /// The whole answer; says in which lanes it is one.
    #[inline(always)]
    fn answer<V: Lanes>(&self, input: &LaneInput<V>, request: Request, out: &mut LaneResponse<V>) -> V::Mask {
        let growth = lanes::volume_growth(&input.gradient);
        let strain = lanes::green_lagrange(&input.gradient);
        let zero = growth.splat(0.0);
        out.second_piola = [zero; 6];
        let mut energy = zero;
        for i in 0..6 {
            for (j, component) in strain.iter().enumerate() {
                let modulus = zero.splat(self.stiffness[(i, j)]);
                out.second_piola[i] = component.mul_add(modulus, out.second_piola[i]);
                if request == Request::Tangent {
                    out.tangent[j][i] = modulus;
                }
            }
            energy = strain[i].mul_add(out.second_piola[i] * 0.5, energy);
        }
        (out.stored_energy, out.incremental_potential, out.dissipated_mid) = (energy, Some(energy), [zero; 2]);
        zero.splat(-1.0).lt(growth) & finite(&out.second_piola) & finite(&[energy, growth])
    }
}

impl Law for StVenantKirchhoff {
    fn name(&self) -> &'static str {
        "st_venant_kirchhoff"
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
        let mut lane = LaneResponse::zero(0.0);
        if !self.answer(&LaneInput::of(input), request, &mut lane) {
            volume_growth(&input.displacement_gradient)?;
            return Err(LawError::NonFiniteResponse);
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
        if input.mean_elongation.is_none() && V::all(self.answer(input, request, out)) {
            return Ok(());
        }
        each_lane(self, input, old, new, request, out)
    }
}
