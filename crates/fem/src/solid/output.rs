//! What a solid block tells about its integration points at the committed state.

use std::marker::PhantomData;

use nalgebra::Matrix3;
use pulp::{Simd, WithSimd};
use subrope_material::{Law, LawError, StateVariable, StrainModes, mandel};

use super::SolidBlock;
use super::formulation::{ElementFailure, ElementInput, ElementResult, Formulation, PointStrain};
use super::kernel::Buffers;
use crate::FemError;
use crate::contribution::{Energies, Request};

/// State of one integration point.
#[derive(Clone, Debug)]
pub struct PointSample<'a> {
    /// Reference volume \[mm^3\].
    pub volume: f64,
    /// Fibre frame in the reference configuration, columns e1 e2 e3.
    pub frame: Matrix3<f64>,
    /// Deformation gradient, global axes.
    pub deformation_gradient: Matrix3<f64>,
    /// Cauchy stress \[MPa\], global axes, as the element's equilibrium sees it (averaged parts included).
    pub cauchy_stress: Matrix3<f64>,
    /// Strain modes of the point itself.
    pub modes: StrainModes,
    /// State of the law.
    pub state: &'a [f64],
}

/// Energies of one element at the committed state \[mJ\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ElementEnergies {
    /// Stored now.
    pub stored: f64,
    /// Dissipated since the start by transverse and longitudinal sliding, mid-point values.
    pub dissipated_mid: [f64; 2],
}

impl ElementEnergies {
    /// Of a trial: what this increment dissipates.
    pub(super) fn of(energies: &Energies) -> Self {
        Self { stored: energies.stored, dissipated_mid: energies.dissipated_mid }
    }

    /// As they are kept.
    pub(super) fn numbers(&self) -> [f64; 3] {
        [self.stored, self.dissipated_mid[0], self.dissipated_mid[1]]
    }

    /// From how they are kept.
    pub(super) fn of_numbers(kept: &[f64; 3]) -> Self {
        Self { stored: kept[0], dissipated_mid: [kept[1], kept[2]] }
    }

    /// Commits a trial.
    pub(super) fn advance(&mut self, trial: &Self) {
        self.stored = trial.stored;
        self.dissipated_mid.iter_mut().zip(trial.dissipated_mid).for_each(|(sum, d)| *sum += d);
    }
}

/// Read access to the integration points of a block, whatever its element and law.
pub trait SolidFields {
    /// Number of elements.
    fn element_count(&self) -> usize;
    /// Integration points per element.
    fn points_per_element(&self) -> usize;
    /// Layout of the state of a point.
    fn state_variables(&self) -> &[StateVariable];
    /// Name of the law.
    fn law_name(&self) -> &'static str;
    /// Bytes of state per integration point, committed and trial.
    fn state_bytes_per_point(&self) -> usize;
    /// Committed state and reference volume of a point: cheap, no stresses.
    fn point_state(&self, element: usize, point: usize) -> (&[f64], f64);
    /// Energies of an element, as last committed: nothing is evaluated again.
    fn element_energies(&self, element: usize) -> ElementEnergies;
    /// Dissipated in an element since the start by transverse and longitudinal sliding \[mJ\], end values as in the
    /// state.
    fn element_dissipation(&self, element: usize) -> [f64; 2];
    /// Visits the points of one element at committed nodal displacements.
    ///
    /// # Errors
    /// As an assembly at the same displacements.
    fn sample(
        &self,
        element: usize,
        displacement: &[f64],
        visit: &mut dyn FnMut(usize, &PointSample<'_>),
    ) -> Result<(), FemError>;
}

impl<const N: usize, L: Law, F: Formulation<N>> SolidFields for SolidBlock<N, L, F> {
    fn element_count(&self) -> usize {
        crate::Contribution::element_count(self)
    }

    fn points_per_element(&self) -> usize {
        self.brick(0).points()
    }

    fn state_variables(&self) -> &[StateVariable] {
        self.law().state_variables()
    }

    fn law_name(&self) -> &'static str {
        self.law().name()
    }

    fn state_bytes_per_point(&self) -> usize {
        2 * size_of::<f64>() * self.law().state_len()
    }

    fn point_state(&self, element: usize, point: usize) -> (&[f64], f64) {
        (self.state(element, point), self.brick(element).volume(point))
    }

    fn element_energies(&self, element: usize) -> ElementEnergies {
        self.energies(element)
    }

    fn element_dissipation(&self, element: usize) -> [f64; 2] {
        SolidBlock::element_dissipation(self, element)
    }

    fn sample(
        &self,
        element: usize,
        displacement: &[f64],
        visit: &mut dyn FnMut(usize, &PointSample<'_>),
    ) -> Result<(), FemError> {
        let brick = self.brick(element);
        let n = self.law().state_len();
        let input = ElementInput {
            law: self.law(),
            brick,
            displacement: self.gather(element, displacement),
            old: self.element_state(element),
            time_increment: 0.0,
            temperature: crate::REFERENCE_TEMPERATURE,
            request: Request::Residual,
        };
        let mut result = Box::new(ElementResult::zero(brick.points()));
        let mut new = vec![0.0; brick.points() * n];
        let evaluation = Evaluation { input: &input, new: &mut new, out: &mut result, formulation: PhantomData::<F> };
        pulp::Arch::new().dispatch(evaluation).map_err(|f| self.failure(element, f, &input, displacement))?;
        for q in 0..brick.points() {
            let (frame, hr) = (brick.frame(q), brick.mixed_gradient(q, &input.displacement));
            let fr = frame + hr;
            let jacobian = fr.determinant() * frame.determinant();
            let stress = mandel::to_matrix(&result.second_piola[q]);
            let sample = PointSample {
                volume: brick.volume(q),
                frame,
                deformation_gradient: fr * frame.transpose(),
                cauchy_stress: fr * stress * fr.transpose() / jacobian,
                modes: StrainModes::from_displacement_gradient(&frame.tr_mul(&hr)).map_err(|source| {
                    self.failure(element, no_modes(q, source, &frame.tr_mul(&hr)), &input, displacement)
                })?,
                state: self.state(element, q),
            };
            visit(q, &sample);
        }
        Ok(())
    }
}

/// A point whose deformation has no strain modes.
fn no_modes(point: usize, source: LawError, gradient: &Matrix3<f64>) -> ElementFailure {
    let gradient = std::array::from_fn(|i| std::array::from_fn(|j| gradient[(i, j)]));
    ElementFailure::Law { point, source, at: Box::new(PointStrain { gradient, mean_elongation: None }) }
}

/// One element outside of an assembly.
struct Evaluation<'a, const N: usize, L, F> {
    input: &'a ElementInput<'a, N, L>,
    new: &'a mut [f64],
    out: &'a mut ElementResult<N>,
    formulation: PhantomData<F>,
}

impl<const N: usize, L: Law, F: Formulation<N>> WithSimd for Evaluation<'_, N, L, F> {
    type Output = Result<(), ElementFailure>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        F::evaluate::<L, S, true>(simd, self.input, self.new, &mut Buffers::zero(simd), self.out)
    }
}
