//! A block of equal bricks with one law: geometry formed once, states, evaluation in batches.

use nalgebra::{Matrix3, Vector3};
use pulp::{Simd, WithSimd};
use subrope_geometry::Hexahedron;
use subrope_material::{Law, StateKind};

use super::failure::FailedPoint;
use super::formulation::{ElementFailure, ElementInput, ElementResult, Formulation};
use super::geometry::{BrickGeometry, PointGroup, ReferenceGradients};
use super::kernel::{Buffers, NodeVector, mirror};
use super::{ElementEnergies, SolidFields};
use crate::contribution::{Configuration, Contribution, Energies, Request, Sink};
use crate::state::{StateError, StateReader, StateWriter};
use crate::{FemError, parallel};

/// Elements evaluated before their results are scattered, in index order: sums do not depend on threads. Few where one
/// thread works, so that their matrices are still in the nearest cache.
const BATCH: usize = 4;
/// The same where threads share the work.
const SHARED_BATCH: usize = 64;

/// What a block is made from.
#[derive(Clone, Copy, Debug)]
pub struct SolidMesh<'a> {
    /// Reference coordinates of all nodes \[mm\].
    pub positions: &'a [Vector3<f64>],
    /// Connectivity, flat, VTK order.
    pub cells: &'a [u32],
    /// Labels of the elements, for messages.
    pub labels: &'a [u64],
    /// Fibre frames (columns e1 e2 e3) at all integration points, element by element.
    pub frames: &'a [Matrix3<f64>],
}

/// Equal bricks with one law. `F` says what is averaged.
pub struct SolidBlock<const N: usize, L, F> {
    law: L,
    nodes: Vec<[u32; N]>,
    labels: Vec<u64>,
    reference: ReferenceGradients<N>,
    /// Geometry of the points, element by element.
    groups: Vec<PointGroup>,
    committed: Vec<f64>,
    trial: Vec<f64>,
    results: Vec<ElementResult<N>>,
    /// Energies of every element at the committed state.
    energies: Vec<ElementEnergies>,
    /// The same of the trial; dissipation of this increment only.
    trial_energies: Vec<ElementEnergies>,
    dissipation: [Option<usize>; 2],
    formulation: std::marker::PhantomData<F>,
}

impl<const N: usize, L: Law, F: Formulation<N>> SolidBlock<N, L, F> {
    /// Forms the geometry of every integration point.
    ///
    /// # Errors
    /// [`FemError::Count`] when frames, labels and cells do not fit, [`FemError::Geometry`] for an inverted element,
    /// [`FemError::NoFibreTerm`] when the formulation needs one and the law has none.
    pub fn new<H: Hexahedron<N>>(mesh: &SolidMesh<'_>, law: L) -> Result<Self, FemError> {
        if F::NEEDS_FIBRE_TERM && !law.has_fibre_term() {
            return Err(FemError::NoFibreTerm { law: law.name() });
        }
        let reference = ReferenceGradients::new::<H>();
        let count = mesh.cells.len() / N;
        expect_count("connectivity entries", mesh.cells.len(), count * N)?;
        expect_count("element labels", mesh.labels.len(), count)?;
        expect_count("fibre frames", mesh.frames.len(), count * reference.points())?;
        let mut nodes = Vec::with_capacity(count);
        let mut groups = Vec::with_capacity(count * reference.groups());
        let frames = mesh.frames.chunks_exact(reference.points());
        for ((cell, frames), &label) in mesh.cells.chunks_exact(N).zip(frames).zip(mesh.labels) {
            let cell: [u32; N] = std::array::from_fn(|a| cell[a]);
            let x = element_positions(mesh.positions, &cell)?;
            reference.add_brick::<H>(&x, frames, label, &mut groups)?;
            nodes.push(cell);
        }
        let states = count * reference.points() * law.state_len();
        Ok(Self {
            dissipation: dissipation_offsets(&law),
            law,
            nodes,
            labels: mesh.labels.to_vec(),
            reference,
            groups,
            committed: vec![0.0; states],
            trial: vec![0.0; states],
            results: vec![ElementResult::zero(0); SHARED_BATCH.min(count)],
            energies: vec![ElementEnergies::default(); count],
            trial_energies: vec![ElementEnergies::default(); count],
            formulation: std::marker::PhantomData,
        })
    }

    /// The law.
    pub fn law(&self) -> &L {
        &self.law
    }

    /// Energies of an element at the committed state.
    pub(super) fn energies(&self, element: usize) -> ElementEnergies {
        self.energies[element]
    }

    /// Dissipated in an element since the start by each sliding mode \[mJ\], end values.
    pub(super) fn element_dissipation(&self, element: usize) -> [f64; 2] {
        let states = self.element_state(element).chunks_exact(self.law.state_len().max(1));
        let mut out = [0.0; 2];
        let brick = self.brick(element);
        for (point, state) in states.enumerate() {
            for (sum, offset) in out.iter_mut().zip(self.dissipation) {
                *sum += offset.map_or(0.0, |o| brick.volume(point) * state[o]);
            }
        }
        out
    }

    /// Committed state of a point.
    pub(super) fn state(&self, element: usize, point: usize) -> &[f64] {
        let n = self.law.state_len();
        let first = (element * self.reference.points() + point) * n;
        &self.committed[first..first + n]
    }

    /// Committed state of all points of an element.
    pub(super) fn element_state(&self, element: usize) -> &[f64] {
        let stride = self.stride();
        &self.committed[element * stride..(element + 1) * stride]
    }

    /// Geometry of an element.
    pub(super) fn brick(&self, element: usize) -> BrickGeometry<'_, N> {
        let groups = self.reference.groups();
        let groups = &self.groups[element * groups..(element + 1) * groups];
        BrickGeometry::new(&self.reference, groups)
    }

    #[inline(always)]
    pub(super) fn gather(&self, element: usize, displacement: &[f64]) -> NodeVector<N> {
        let mut out = [[0.0; N]; 3];
        for (a, &node) in self.nodes[element].iter().enumerate() {
            for (k, line) in out.iter_mut().enumerate() {
                line[a] = displacement[3 * node as usize + k];
            }
        }
        out
    }

    /// Numbers of state per element.
    fn stride(&self) -> usize {
        self.reference.points() * self.law.state_len()
    }

    /// An element that failed, with what it was asked from the displacements `committed`.
    pub(super) fn failure(
        &self,
        element: usize,
        failure: ElementFailure,
        input: &ElementInput<'_, N, L>,
        committed: &[f64],
    ) -> FemError {
        let label = self.labels[element];
        let (point, source, at) = match failure {
            ElementFailure::Law { point, source, at } => (point, source, at),
            ElementFailure::MeanVolume(ratio) => return FemError::MeanVolume { element: label, ratio },
        };
        let frame = input.brick.frame(point);
        let before = input.brick.mixed_gradient(point, &self.gather(element, committed));
        let asked = FailedPoint {
            gradient: Matrix3::from_fn(|i, j| at.gradient[i][j]),
            mean_elongation: at.mean_elongation,
            committed_gradient: frame.tr_mul(&before),
            frame,
            state: self.state(element, point).to_vec(),
            time_increment: input.time_increment,
            temperature: input.temperature,
        };
        FemError::Law { element: label, point, source, asked: Box::new(asked) }
    }

    /// What an element is evaluated from.
    #[inline(always)]
    fn input(&self, element: usize, at: &Configuration<'_>, request: Request) -> ElementInput<'_, N, L> {
        ElementInput {
            law: &self.law,
            brick: self.brick(element),
            displacement: self.gather(element, at.displacement),
            old: self.element_state(element),
            time_increment: at.time_increment,
            temperature: at.temperature,
            request,
        }
    }

    fn elements(
        &self,
        first: usize,
        configuration: &Configuration<'_>,
        request: Request,
        trial: &mut [f64],
        out: &mut [ElementResult<N>],
    ) {
        // One dispatch per run of elements: everything below is inlined and compiled for each instruction set.
        pulp::Arch::new().dispatch(Run { block: self, first, configuration, request, trial, out });
    }

    fn batch(&self, first: usize, c: &Configuration<'_>, request: Request, work: Work<'_, N>) {
        let Work { trial, results } = work;
        if c.parallel && results.len() > 8 {
            let middle = results.len() / 2;
            let (left, right) = results.split_at_mut(middle);
            let (old, new) = trial.split_at_mut(middle * self.stride());
            parallel::join(
                || self.batch(first, c, request, Work { trial: old, results: left }),
                || self.batch(first + middle, c, request, Work { trial: new, results: right }),
            );
        } else {
            self.elements(first, c, request, trial, results);
        }
    }
}

/// A run of elements, in a form that is inlined into code for the instruction set at hand.
struct Run<'a, const N: usize, L, F> {
    block: &'a SolidBlock<N, L, F>,
    first: usize,
    configuration: &'a Configuration<'a>,
    request: Request,
    trial: &'a mut [f64],
    out: &'a mut [ElementResult<N>],
}

impl<const N: usize, L: Law, F: Formulation<N>> WithSimd for Run<'_, N, L, F> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { block, first, configuration, request, trial, out } = self;
        let stride = block.stride();
        let symmetric = block.law.is_symmetric();
        let mut buffers = Buffers::zero(simd);
        for (i, result) in out.iter_mut().enumerate() {
            let new = &mut trial[i * stride..(i + 1) * stride];
            let input = block.input(first + i, configuration, request);
            result.force = [[0.0; N]; 3];
            result.energies = Energies::default();
            let outcome = if symmetric {
                F::evaluate::<L, S, true>(simd, &input, new, &mut buffers, result)
            } else {
                F::evaluate::<L, S, false>(simd, &input, new, &mut buffers, result)
            };
            result.failure = outcome.err();
            if symmetric && request == Request::Tangent {
                mirror(&mut result.stiffness);
            }
        }
    }
}

/// Buffers of a batch.
struct Work<'a, const N: usize> {
    trial: &'a mut [f64],
    results: &'a mut [ElementResult<N>],
}

impl<const N: usize, L: Law, F: Formulation<N>> Contribution for SolidBlock<N, L, F> {
    fn element_count(&self) -> usize {
        self.nodes.len()
    }

    fn element_nodes(&self, element: usize) -> &[u32] {
        &self.nodes[element]
    }

    fn is_symmetric(&self) -> bool {
        self.law.is_symmetric()
    }

    fn has_potential(&self) -> bool {
        self.law.has_potential()
    }

    fn assemble(
        &mut self,
        configuration: &Configuration<'_>,
        request: Request,
        sink: &mut dyn Sink,
    ) -> Result<Energies, FemError> {
        let (mut trial, mut results) = (std::mem::take(&mut self.trial), std::mem::take(&mut self.results));
        let mut energies = std::mem::take(&mut self.trial_energies);
        let work = Work { trial: &mut trial, results: &mut results };
        let outcome = self.assemble_with(configuration, request, sink, work, &mut energies);
        (self.trial, self.results, self.trial_energies) = (trial, results, energies);
        outcome
    }

    fn commit(&mut self) {
        self.committed.copy_from_slice(&self.trial);
        self.energies.iter_mut().zip(&self.trial_energies).for_each(|(old, new)| old.advance(new));
    }

    fn save(&self, state: &mut dyn StateWriter) -> Result<(), StateError> {
        state.numbers("law", self.committed.len(), &mut self.committed.iter().copied())?;
        let mut energies = self.energies.iter().flat_map(ElementEnergies::numbers);
        state.numbers("energies", 3 * self.energies.len(), &mut energies)
    }

    fn restore(&mut self, state: &dyn StateReader) -> Result<(), StateError> {
        state.read_numbers("law", &mut self.committed)?;
        let energies = state.numbers("energies")?;
        StateError::expect("energies", energies.len(), 3 * self.energies.len())?;
        let (kept, _) = energies.as_chunks::<3>();
        self.energies.iter_mut().zip(kept).for_each(|(mine, kept)| *mine = ElementEnergies::of_numbers(kept));
        Ok(())
    }

    fn fields(&self) -> Option<&dyn SolidFields> {
        Some(self)
    }

    fn dissipated(&self) -> [f64; 2] {
        (0..self.nodes.len())
            .map(|element| self.element_dissipation(element))
            .fold([0.0; 2], |[t, l], [dt, dl]| [t + dt, l + dl])
    }
}

impl<const N: usize, L: Law, F: Formulation<N>> SolidBlock<N, L, F> {
    fn assemble_with(
        &self,
        configuration: &Configuration<'_>,
        request: Request,
        sink: &mut dyn Sink,
        work: Work<'_, N>,
        kept: &mut [ElementEnergies],
    ) -> Result<Energies, FemError> {
        let stride = self.stride();
        let mut energies = Energies::default();
        let mut first = 0;
        let batch = if configuration.parallel { SHARED_BATCH } else { BATCH };
        while first < self.nodes.len() {
            let count = batch.min(self.nodes.len() - first);
            let trial = &mut work.trial[first * stride..(first + count) * stride];
            let results = &mut work.results[..count];
            self.batch(first, configuration, request, Work { trial, results });
            for (i, result) in work.results[..count].iter_mut().enumerate() {
                if let Some(failure) = result.failure.take() {
                    let input = self.input(first + i, configuration, request);
                    return Err(self.failure(first + i, failure, &input, configuration.committed));
                }
                energies += result.energies;
                kept[first + i] = ElementEnergies::of(&result.energies);
                let stiffness = (request == Request::Tangent)
                    .then_some(result.stiffness.as_flattened().as_flattened().as_flattened());
                sink.add(first + i, result.force.as_flattened(), stiffness);
            }
            first += count;
        }
        Ok(energies)
    }
}

fn expect_count(what: &'static str, found: usize, expected: usize) -> Result<(), FemError> {
    if found == expected { Ok(()) } else { Err(FemError::Count { what, found, expected }) }
}

fn element_positions<const N: usize>(
    positions: &[Vector3<f64>],
    cell: &[u32; N],
) -> Result<[Vector3<f64>; N], FemError> {
    let mut x = [Vector3::zeros(); N];
    for (target, &node) in x.iter_mut().zip(cell) {
        *target = *positions
            .get(node as usize)
            .ok_or_else(|| FemError::UnknownNode { node: node as usize, name: "connectivity".into() })?;
    }
    // Differences to the first node: coordinates far from the origin lose no digits of the Jacobian.
    let origin = x[0];
    Ok(x.map(|p| p - origin))
}

fn dissipation_offsets<L: Law>(law: &L) -> [Option<usize>; 2] {
    [StateKind::TransverseDissipation, StateKind::LongitudinalDissipation]
        .map(|kind| law.state_variables().iter().find(|v| v.kind == kind).map(|v| v.offset))
}
