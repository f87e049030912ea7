//! The interface between a law and whoever drives it (an element, the point driver, a test).
//!
//! A law works in its own *material frame*: the caller rotates the displacement gradient into the frame whose first
//! axis is the fibre (`H_f = R^T H R`, `R` = columns e1 e2 e3) and rotates what comes back. Symmetric tensors are
//! Mandel vectors in the order 11, 22, 33, 12, 13, 23 with the shear entries multiplied by sqrt(2), so that
//! `a : b` is the dot product of the vectors and a fourth-order tensor is a plain 6x6 matrix.

use nalgebra::{Matrix3, Matrix6, Vector6};

use crate::lanes::{Lanes, MAX_LANES};
use crate::strain::rows;
use crate::{ConjugateForces, LawError};

/// What a law is asked at one integration point. Everything is in the material frame.
#[derive(Clone, Debug)]
pub struct PointInput {
    /// Displacement gradient `H = F - 1` \[-\], reference configuration. `H` and not `F`, so that a strain of 1e-14
    /// survives.
    pub displacement_gradient: Matrix3<f64>,
    /// Takes the place of the fibre elongation `I_elong` \[-\] in the axial energy `W_A` (mean-elongation brick);
    /// `None`: the point's own elongation.
    pub mean_elongation: Option<f64>,
    /// Length of the time increment \[s\].
    pub time_increment: f64,
    /// Temperature \[K\].
    pub temperature: f64,
}

impl PointInput {
    /// Input at a displacement gradient, with the point's own elongation, a time increment of 1 s and 293.15 K.
    #[must_use]
    #[inline]
    pub fn new(displacement_gradient: Matrix3<f64>) -> Self {
        Self { displacement_gradient, mean_elongation: None, time_increment: 1.0, temperature: 293.15 }
    }

    /// The same with a mean elongation.
    #[must_use]
    #[inline]
    pub fn with_mean_elongation(mut self, elongation: f64) -> Self {
        self.mean_elongation = Some(elongation);
        self
    }
}

/// How much of the answer is needed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Request {
    /// Stress, energies and the new state.
    Stress,
    /// The same and the consistent tangent.
    Tangent,
}

/// The share of the response that is conjugate to a prescribed mean elongation `e` (see
/// [`PointInput::mean_elongation`]).
///
/// With `W(C, e)` the axial energy written in the independent elongation `e`, the total differential of the response is
/// `dS = tangent dE + stress_by_elongation de` and `d(fibre_stress) = fibre_stress_by_strain . dE + fibre_stiffness
/// de`. The two vectors are equal when the law's tangent is symmetric.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FibreResponse {
    /// `dW/de` \[MPa\], the fibre's Kirchhoff stress.
    pub fibre_stress: f64,
    /// `d2W/de2` \[MPa\].
    pub fibre_stiffness: f64,
    /// `dS/de` \[MPa\], Mandel.
    pub stress_by_elongation: Vector6<f64>,
    /// `d(dW/de)/dE` \[MPa\], Mandel.
    pub fibre_stress_by_strain: Vector6<f64>,
}

/// What a law answers. The caller owns it and passes it again, so a kernel allocates nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Response {
    /// Second Piola-Kirchhoff stress `S` \[MPa\], Mandel, material frame. With a mean elongation: without the part
    /// `fibre_stress * 2 dI_elong/dC`, which the element adds with its own average.
    pub second_piola: Vector6<f64>,
    /// Consistent tangent `dS/dE = 2 dS/dC` of the discrete update \[MPa\], Mandel. Written when asked for.
    pub tangent: Matrix6<f64>,
    /// Written when a mean elongation is given.
    pub fibre: FibreResponse,
    /// Stored energy after the increment \[mJ/mm^3\]: elastic potential and back-stress energy.
    pub stored_energy: f64,
    /// Incremental potential \[mJ/mm^3\] whose derivative by `E` is `S` (stored energy plus what slip costs in this
    /// increment at the integrated yield stress); `None` where there is none (pressure-dependent friction).
    pub incremental_potential: Option<f64>,
    /// Dissipated in this increment by transverse and by longitudinal sliding \[mJ/mm^3\], mid-point value: for the
    /// energy balance. The end value accumulates in the state.
    pub dissipated_mid: [f64; 2],
}

/// [`PointInput`] of several points, one in each lane; lanes without a point repeat the last one.
#[derive(Clone, Copy, Debug)]
pub struct LaneInput<V> {
    /// How many lanes hold a point of their own: at least one.
    pub points: usize,
    /// `gradient[i][j] = H_ij` \[-\].
    pub gradient: [[V; 3]; 3],
    /// As in [`PointInput`].
    pub mean_elongation: Option<V>,
    /// Length of the time increment \[s\].
    pub time_increment: f64,
    /// Temperature \[K\].
    pub temperature: f64,
}

impl LaneInput<f64> {
    /// One point.
    #[inline(always)]
    pub(crate) fn of(input: &PointInput) -> Self {
        Self {
            points: 1,
            gradient: rows(&input.displacement_gradient),
            mean_elongation: input.mean_elongation,
            time_increment: input.time_increment,
            temperature: input.temperature,
        }
    }
}

/// [`FibreResponse`] of several points.
#[derive(Clone, Copy, Debug)]
pub struct LaneFibreResponse<V> {
    /// `dW/de` \[MPa\].
    pub fibre_stress: V,
    /// `d2W/de2` \[MPa\].
    pub fibre_stiffness: V,
    /// `dS/de` \[MPa\], Mandel.
    pub stress_by_elongation: [V; 6],
    /// `d(dW/de)/dE` \[MPa\], Mandel.
    pub fibre_stress_by_strain: [V; 6],
}

/// [`Response`] of several points.
#[derive(Clone, Copy, Debug)]
pub struct LaneResponse<V> {
    /// `S` \[MPa\], Mandel.
    pub second_piola: [V; 6],
    /// Columns of `dS/dE` \[MPa\], Mandel. Written when asked for.
    pub tangent: [[V; 6]; 6],
    /// Written when a mean elongation is given.
    pub fibre: LaneFibreResponse<V>,
    /// Stored energy \[mJ/mm^3\].
    pub stored_energy: V,
    /// Incremental potential \[mJ/mm^3\], if there is one.
    pub incremental_potential: Option<V>,
    /// Dissipated in this increment by the two sliding modes \[mJ/mm^3\].
    pub dissipated_mid: [V; 2],
}

impl<V: Lanes> LaneResponse<V> {
    /// All zero.
    #[must_use]
    #[inline(always)]
    pub fn zero(witness: V) -> Self {
        let zero = witness.splat(0.0);
        Self {
            second_piola: [zero; 6],
            tangent: [[zero; 6]; 6],
            fibre: LaneFibreResponse {
                fibre_stress: zero,
                fibre_stiffness: zero,
                stress_by_elongation: [zero; 6],
                fibre_stress_by_strain: [zero; 6],
            },
            stored_energy: zero,
            incremental_potential: None,
            dissipated_mid: [zero; 2],
        }
    }

    /// From the responses of single points, the last repeated.
    fn gather(witness: V, of: &[Response], out: &mut Self) {
        let last = of.len() - 1;
        let lanes = |number: &dyn Fn(&Response) -> f64| witness.fill(|lane| number(&of[lane.min(last)]));
        out.second_piola = std::array::from_fn(|i| lanes(&|r| r.second_piola[i]));
        out.tangent = std::array::from_fn(|j| std::array::from_fn(|i| lanes(&|r| r.tangent[(i, j)])));
        out.fibre = LaneFibreResponse {
            fibre_stress: lanes(&|r| r.fibre.fibre_stress),
            fibre_stiffness: lanes(&|r| r.fibre.fibre_stiffness),
            stress_by_elongation: std::array::from_fn(|i| lanes(&|r| r.fibre.stress_by_elongation[i])),
            fibre_stress_by_strain: std::array::from_fn(|i| lanes(&|r| r.fibre.fibre_stress_by_strain[i])),
        };
        out.stored_energy = lanes(&|r| r.stored_energy);
        let potential = of.iter().all(|r| r.incremental_potential.is_some());
        out.incremental_potential = potential.then(|| lanes(&|r| r.incremental_potential.unwrap_or(0.0)));
        out.dissipated_mid = [0, 1].map(|i| lanes(&|r| r.dissipated_mid[i]));
    }
}

impl LaneResponse<f64> {
    /// As the response of a point; what was not asked for stays as it is.
    pub(crate) fn write_to(&self, out: &mut Response, input: &PointInput, request: Request) {
        out.second_piola = self.second_piola.into();
        if request == Request::Tangent {
            out.tangent.as_mut_slice().copy_from_slice(self.tangent.as_flattened());
        }
        if input.mean_elongation.is_some() {
            out.fibre = FibreResponse {
                fibre_stress: self.fibre.fibre_stress,
                fibre_stiffness: self.fibre.fibre_stiffness,
                stress_by_elongation: self.fibre.stress_by_elongation.into(),
                fibre_stress_by_strain: self.fibre.fibre_stress_by_strain.into(),
            };
        }
        out.stored_energy = self.stored_energy;
        out.incremental_potential = self.incremental_potential;
        out.dissipated_mid = self.dissipated_mid;
    }
}

/// The first lane without an answer, and why it has none.
#[derive(Clone, Debug, PartialEq)]
pub struct LaneFailure {
    /// Lane.
    pub lane: usize,
    /// Why.
    pub source: LawError,
}

/// What a state variable means, so that output needs no knowledge of the law.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum StateKind {
    /// Plastic part of the two transverse distortions `I_dist^P` \[-\].
    DistortionPlastic,
    /// Plastic part of the two longitudinal shears `I_sh^P` \[-\].
    LongitudinalShearPlastic,
    /// Accumulated transverse sliding `kappa_t` \[-\].
    TransverseSliding,
    /// Accumulated longitudinal sliding `kappa_l` \[-\].
    LongitudinalSliding,
    /// Energy dissipated by transverse sliding `d_t` \[mJ/mm^3\].
    TransverseDissipation,
    /// Energy dissipated by longitudinal sliding `d_l` \[mJ/mm^3\].
    LongitudinalDissipation,
    /// Compaction pressure of the last increment `p` \[MPa\].
    CompactionPressure,
}

/// One entry of a law's state: `components` consecutive numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StateVariable {
    /// Meaning.
    pub kind: StateKind,
    /// Index of its first number in the state of a point.
    pub offset: usize,
    /// How many numbers.
    pub components: usize,
}

/// A constitutive law: pure, re-entrant, without memory of its own.
pub trait Law: Send + Sync + std::fmt::Debug {
    /// Short name, as in a scene file.
    fn name(&self) -> &'static str;

    /// Layout of a point's state; empty for an elastic law, which then costs no memory.
    fn state_variables(&self) -> &[StateVariable];

    /// Numbers in a point's state.
    fn state_len(&self) -> usize {
        self.state_variables().iter().map(|v| v.components).sum()
    }

    /// Whether the tangent is symmetric for every input.
    fn is_symmetric(&self) -> bool;

    /// Whether the update derives from an incremental potential ([`Response::incremental_potential`] is always `Some`).
    fn has_potential(&self) -> bool;

    /// Whether [`PointInput::mean_elongation`] is understood: the law has a fibre term written apart.
    fn has_fibre_term(&self) -> bool;

    /// Forces conjugate to the strain modes after the increment from `old`; `None` for a law not written in the modes.
    ///
    /// # Errors
    /// As [`Law::evaluate`].
    fn modal_forces(&self, _input: &PointInput, _old: &[f64]) -> Result<Option<ConjugateForces>, LawError> {
        Ok(None)
    }

    /// Answers at one point. `old` is read, `new` is written (both of length [`Law::state_len`]); calling twice gives
    /// the same.
    ///
    /// # Errors
    /// [`LawError`] on `J <= 0`, on a non-finite input or result and past a lock-up. `new` and `out` are then
    /// unspecified.
    fn evaluate(
        &self,
        input: &PointInput,
        old: &[f64],
        new: &mut [f64],
        request: Request,
        out: &mut Response,
    ) -> Result<(), LawError>;

    /// Answers at several points, whose states lie one after the other in `old` and `new`. A law that is not written for
    /// lanes is asked point by point.
    ///
    /// # Errors
    /// [`LaneFailure`] with what [`Law::evaluate`] says of the first point that fails.
    #[inline]
    fn evaluate_lanes<V: Lanes>(
        &self,
        input: &LaneInput<V>,
        old: &[f64],
        new: &mut [f64],
        request: Request,
        out: &mut LaneResponse<V>,
    ) -> Result<(), LaneFailure>
    where
        Self: Sized,
    {
        each_lane(self, input, old, new, request, out)
    }
}

/// [`Law::evaluate_lanes`] by [`Law::evaluate`] in each lane.
#[inline(never)]
pub(crate) fn each_lane<L: Law, V: Lanes>(
    law: &L,
    input: &LaneInput<V>,
    old: &[f64],
    new: &mut [f64],
    request: Request,
    out: &mut LaneResponse<V>,
) -> Result<(), LaneFailure> {
    let n = law.state_len();
    let gradient = input.gradient.map(|row| row.map(V::to_array));
    let elongation = input.mean_elongation.map(V::to_array);
    let mut responses: [Response; MAX_LANES] = std::array::from_fn(|_| Response::default());
    for (lane, response) in responses[..input.points].iter_mut().enumerate() {
        let point = PointInput {
            displacement_gradient: Matrix3::from_fn(|i, j| gradient[i][j][lane]),
            mean_elongation: elongation.map(|lanes| lanes[lane]),
            time_increment: input.time_increment,
            temperature: input.temperature,
        };
        let state = lane * n..(lane + 1) * n;
        law.evaluate(&point, &old[state.clone()], &mut new[state], request, response)
            .map_err(|source| LaneFailure { lane, source })?;
    }
    LaneResponse::gather(input.gradient[0][0], &responses[..input.points], out);
    Ok(())
}

impl Law for Box<dyn Law> {
    fn name(&self) -> &'static str {
        (**self).name()
    }

    fn state_variables(&self) -> &[StateVariable] {
        (**self).state_variables()
    }

    fn is_symmetric(&self) -> bool {
        (**self).is_symmetric()
    }

    fn has_potential(&self) -> bool {
        (**self).has_potential()
    }

    fn has_fibre_term(&self) -> bool {
        (**self).has_fibre_term()
    }

    fn modal_forces(&self, input: &PointInput, old: &[f64]) -> Result<Option<ConjugateForces>, LawError> {
        (**self).modal_forces(input, old)
    }

    fn evaluate(
        &self,
        input: &PointInput,
        old: &[f64],
        new: &mut [f64],
        request: Request,
        out: &mut Response,
    ) -> Result<(), LawError> {
        (**self).evaluate(input, old, new, request, out)
    }
}
