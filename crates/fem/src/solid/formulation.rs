//! Element formulations: what of the strain is taken at the point and what is averaged over the element.

use nalgebra::{Matrix3, Vector6};
use pulp::{NullaryFnOnce, Simd};
use subrope_material::lanes::Lanes;
use subrope_material::{LaneFailure, LaneInput, LaneResponse, Law, LawError, Request as LawRequest};

use super::kernel::{NodeMatrix, NodeVector, PointGeometry, PointProducts, Stiffness};
use super::pack::{self, Pack};
use super::wide::Wide;
use crate::contribution::{Energies, Request};

/// What one element is evaluated from.
pub struct ElementInput<'a, const N: usize, L> {
    /// The law.
    pub law: &'a L,
    /// Integration points.
    pub points: &'a [PointGeometry<N>],
    /// Nodal displacements.
    pub displacement: NodeVector<N>,
    /// Committed state of all points.
    pub old: &'a [f64],
    /// Length of the time increment \[s\].
    pub time_increment: f64,
    /// Temperature \[K\].
    pub temperature: f64,
    /// What is wanted.
    pub request: Request,
}

/// Why an element has no answer.
#[derive(Clone, Debug)]
pub enum ElementFailure {
    /// The law failed at a point.
    Law {
        /// Integration point.
        point: usize,
        /// Why.
        source: LawError,
        /// What it was asked at.
        at: Box<PointStrain>,
    },
    /// The mean volume ratio is not positive.
    MeanVolume(f64),
}

/// The strain that a law was asked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointStrain {
    /// Displacement gradient in the fibre frame \[-\].
    pub gradient: [[f64; 3]; 3],
    /// Mean elongation \[-\], for an element that averages it.
    pub mean_elongation: Option<f64>,
}

impl ElementFailure {
    /// At a lane of a pack of which the first point has a number.
    #[cold]
    #[inline(never)]
    pub(super) fn in_lane<S: Simd>(
        (first, failure): (usize, LaneFailure),
        gradient: &[[Wide<S>; 3]; 3],
        mean_elongation: Option<Wide<S>>,
    ) -> Self {
        let LaneFailure { lane, source } = failure;
        let at = PointStrain {
            gradient: gradient.map(|row| row.map(|entry| entry.to_array()[lane])),
            mean_elongation: mean_elongation.map(|mean| mean.to_array()[lane]),
        };
        Self::Law { point: first + lane, source, at: Box::new(at) }
    }
}

/// Forces, stiffness and energies of one element.
#[derive(Clone, Debug)]
pub struct ElementResult<const N: usize> {
    /// Stiffness, component-major.
    pub stiffness: NodeMatrix<N>,
    /// Forces \[N\].
    pub force: NodeVector<N>,
    /// Energies \[mJ\].
    pub energies: Energies,
    /// Effective second Piola-Kirchhoff stress of every point \[MPa\], Mandel, fibre frame; written as far as there is
    /// room.
    pub second_piola: Vec<Vector6<f64>>,
    /// Why there is none.
    pub failure: Option<ElementFailure>,
}

impl<const N: usize> ElementResult<N> {
    /// All zero, with room for the stresses of some points.
    pub fn zero(stresses: usize) -> Self {
        Self {
            second_piola: vec![Vector6::zeros(); stresses],
            stiffness: [[[[0.0; N]; 3]; N]; 3],
            force: [[0.0; N]; 3],
            energies: Energies::ZERO,
            failure: None,
        }
    }

    /// Keeps the stresses of a pack whose first point has a number, if they are wanted.
    #[inline(always)]
    pub(super) fn keep_stress<S: Simd>(&mut self, first: usize, stress: &[Wide<S>; 6]) {
        if self.second_piola.is_empty() {
            return;
        }
        for (i, component) in stress.iter().enumerate() {
            let lanes = component.to_array();
            for (stress, value) in self.second_piola[first..].iter_mut().zip(lanes).take(S::F64_LANES) {
                stress[i] = value;
            }
        }
    }

    /// Adds the energies of a pack.
    #[inline(always)]
    pub(super) fn add_energies<S: Simd>(&mut self, pack: &Pack<'_, S, N>, response: &LaneResponse<Wide<S>>) {
        pack.integrate(response.stored_energy, &mut self.energies.stored);
        if let Some(potential) = response.incremental_potential {
            pack.integrate(potential, &mut self.energies.potential);
        }
        pack.integrate(response.dissipated_mid[0], &mut self.energies.dissipated_mid[0]);
        pack.integrate(response.dissipated_mid[1], &mut self.energies.dissipated_mid[1]);
    }
}

/// How an element turns displacements into strains.
pub trait Formulation<const N: usize>: Send + Sync + 'static {
    /// Whether it needs the law's fibre term.
    const NEEDS_FIBRE_TERM: bool;

    /// Evaluates one element into `out` (forces and energies zeroed by the caller) and the new state, with
    /// a buffer. `SYMMETRIC` leaves entries whose row
    /// component is behind their column component to `kernel::mirror`.
    ///
    /// # Errors
    /// [`ElementFailure`].
    fn evaluate<L: Law, S: Simd, const SYMMETRIC: bool>(
        simd: S,
        input: &ElementInput<'_, N, L>,
        new: &mut [f64],
        product: &mut PointProducts<N>,
        out: &mut ElementResult<N>,
    ) -> Result<(), ElementFailure>;
}

impl<const N: usize, L: Law> ElementInput<'_, N, L> {
    /// `HR` of a point.
    #[inline(always)]
    pub fn gradient(&self, point: usize) -> Matrix3<f64> {
        pack::mixed_gradient(&self.displacement, &self.points[point].gradient)
    }

    /// Reference volume \[mm^3\].
    #[inline(always)]
    pub(super) fn volume(&self) -> f64 {
        self.points.iter().map(|point| point.volume).sum()
    }

    /// Calls the law at a pack.
    #[inline(always)]
    pub(super) fn call<S: Simd>(
        &self,
        simd: S,
        strain: &PackStrain<S>,
        new: &mut [f64],
        response: &mut LaneResponse<Wide<S>>,
    ) -> Result<(), ElementFailure> {
        let &PackStrain { first, points, gradient, mean_elongation } = strain;
        let n = self.law.state_len();
        let states = first * n..(first + points) * n;
        let input = LaneInput {
            points,
            gradient,
            mean_elongation,
            time_increment: self.time_increment,
            temperature: self.temperature,
        };
        let request = match self.request {
            Request::Residual => LawRequest::Stress,
            Request::Tangent => LawRequest::Tangent,
        };
        let (old, new) = (&self.old[states.clone()], &mut new[states]);
        ask(simd, self.law, (&input, old), new, request, response)
            .map_err(|failure| ElementFailure::in_lane((first, failure), &gradient, mean_elongation))
    }
}

/// Calls a law in the vectors of an instruction set.
#[inline(always)]
pub(super) fn ask<L: Law, S: Simd>(
    simd: S,
    law: &L,
    (input, old): (&LaneInput<Wide<S>>, &[f64]),
    new: &mut [f64],
    request: LawRequest,
    response: &mut LaneResponse<Wide<S>>,
) -> Result<(), LaneFailure> {
    simd.vectorize(LawCall { law, input, old, new, request, response })
}

/// What a law is asked at a pack.
pub(super) struct PackStrain<S: Simd> {
    /// Number of the first point.
    pub(super) first: usize,
    /// How many points.
    pub(super) points: usize,
    /// Displacement gradient in the fibre frame.
    pub(super) gradient: [[Wide<S>; 3]; 3],
    pub(super) mean_elongation: Option<Wide<S>>,
}

/// A law at a pack: a function of its own for every law and instruction set, whatever the element.
struct LawCall<'a, S: Simd, L> {
    law: &'a L,
    input: &'a LaneInput<Wide<S>>,
    old: &'a [f64],
    new: &'a mut [f64],
    request: LawRequest,
    response: &'a mut LaneResponse<Wide<S>>,
}

impl<S: Simd, L: Law> NullaryFnOnce for LawCall<'_, S, L> {
    type Output = Result<(), LaneFailure>;

    #[inline(always)]
    fn call(self) -> Self::Output {
        self.law.evaluate_lanes(self.input, self.old, self.new, self.request, self.response)
    }
}

/// Every strain at the point: full integration.
#[derive(Clone, Copy, Debug)]
pub struct Full;

impl<const N: usize> Formulation<N> for Full {
    const NEEDS_FIBRE_TERM: bool = false;

    #[inline(always)]
    fn evaluate<L: Law, S: Simd, const SYMMETRIC: bool>(
        simd: S,
        input: &ElementInput<'_, N, L>,
        new: &mut [f64],
        product: &mut PointProducts<N>,
        out: &mut ElementResult<N>,
    ) -> Result<(), ElementFailure> {
        let mut response = LaneResponse::zero(Wide::new(simd, 0.0));
        for (number, points) in input.points.chunks(S::F64_LANES).enumerate() {
            let (first, pack) = (number * S::F64_LANES, Pack::new(simd, points, &input.displacement));
            let strain = PackStrain { first, points: points.len(), gradient: pack.gradient, mean_elongation: None };
            input.call(simd, &strain, new, &mut response)?;
            out.keep_stress(first, &response.second_piola);
            pack.add_force(&response.second_piola, pack.volume, &mut out.force);
            if input.request == Request::Tangent {
                let (s, d) = (&response.second_piola, &response.tangent);
                let stiffness = Stiffness { matrix: &mut out.stiffness, product: &mut *product };
                pack.add_stiffness::<SYMMETRIC>(s, d, number == 0, stiffness);
            }
            out.add_energies(&pack, &response);
        }
        Ok(())
    }
}
