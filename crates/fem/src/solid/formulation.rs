//! Element formulations: what of the strain is taken at the point and what is averaged over the element.

use nalgebra::Vector6;
use pulp::{NullaryFnOnce, Simd};
use subrope_material::lanes::Lanes;
use subrope_material::{LaneFailure, LaneInput, LaneResponse, Law, LawError, Request as LawRequest};

use super::geometry::BrickGeometry;
use super::kernel::{self, Buffers, NodeMatrix, NodeVector};
use super::pack::Pack;
use super::wide::Wide;
use crate::contribution::{Energies, Request};

/// What one element is evaluated from.
pub struct ElementInput<'a, const N: usize, L> {
    /// The law.
    pub law: &'a L,
    /// Integration points.
    pub brick: BrickGeometry<'a, N>,
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
#[repr(align(64))] // No vector of the stiffness lies across two cache lines.
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
        buffers: &mut Buffers<S, N>,
        out: &mut ElementResult<N>,
    ) -> Result<(), ElementFailure>;
}

impl<const N: usize, L: Law> ElementInput<'_, N, L> {
    /// What the law is asked at the points of a pack.
    #[inline(always)]
    pub(super) fn strain<V>(&self, points: usize, gradient: [[V; 3]; 3], mean_elongation: Option<V>) -> LaneInput<V> {
        let (time_increment, temperature) = (self.time_increment, self.temperature);
        LaneInput { points, gradient, mean_elongation, time_increment, temperature }
    }

    /// Calls the law at the points of a pack from `first` on.
    #[inline(always)]
    pub(super) fn call<S: Simd>(
        &self,
        simd: S,
        (first, strain): (usize, &LaneInput<Wide<S>>),
        new: &mut [f64],
        response: &mut LaneResponse<Wide<S>>,
    ) -> Result<(), ElementFailure> {
        let n = self.law.state_len();
        let states = first * n..(first + strain.points) * n;
        let request = match self.request {
            Request::Residual => LawRequest::Stress,
            Request::Tangent => LawRequest::Tangent,
        };
        let (old, new) = (&self.old[states.clone()], &mut new[states]);
        ask(simd, self.law, (strain, old), new, request, response)
            .map_err(|failure| ElementFailure::in_lane((first, failure), &strain.gradient, strain.mean_elongation))
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
        buffers: &mut Buffers<S, N>,
        out: &mut ElementResult<N>,
    ) -> Result<(), ElementFailure> {
        let Buffers { group, response } = buffers;
        for first in (0..input.brick.points()).step_by(S::F64_LANES) {
            let mut pack = Pack::at(simd, input.brick, first);
            pack.deform(&input.displacement);
            let strain = input.strain(pack.points, pack.gradient, None);
            input.call(simd, (first, &strain), new, response)?;
            out.keep_stress(first, &response.second_piola);
            pack.add_force(&response.second_piola, pack.volume, &mut out.force);
            if input.request == Request::Tangent {
                let (s, d) = (&response.second_piola, &response.tangent);
                pack.put_elasticity::<SYMMETRIC>(s, d, group);
                if pack.ends_group() {
                    let at = (input.brick, pack.group_start());
                    kernel::add_group::<S, N, SYMMETRIC>(simd, at, group, &mut out.stiffness);
                }
            }
            out.add_energies(&pack, response);
        }
        Ok(())
    }
}
