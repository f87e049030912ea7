//! Laws and elements in the lanes of a vector: the same answers as point by point, in every instruction set.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use nalgebra::{Rotation3, Vector3};
use pulp::{Arch, Scalar, Simd, WithSimd};
use subrope_fem::Request;
use subrope_fem::solid::{
    BrickGeometry, Buffers, ElementFailure, ElementInput, ElementResult, Formulation, Full, MeanElongation, MeanVolume,
    PointGroup, ReferenceGradients, Wide,
};
use subrope_geometry::{GeometryError, Hex8, Hexahedron};
use subrope_material::lanes::{Lanes, MAX_LANES};
use subrope_material::testkit::{Numbers, bundles};
use subrope_material::{
    BundleLaw, CompressibleNeoHooke, FibreNeoHooke, LaneFailure, LaneInput, LaneResponse, Law, PointInput,
    Request as LawRequest, Response, StVenantKirchhoff,
};

/// All lanes at once and one by one.
struct Compare<'a, L> {
    law: &'a L,
    inputs: &'a [PointInput],
    old: &'a [f64],
}

impl<L: Law> WithSimd for Compare<'_, L> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let points = self.inputs.len().min(S::F64_LANES);
        let witness = Wide::new(simd, 0.0);
        let of = |lane: usize| &self.inputs[lane.min(points - 1)];
        let entry = |i, j| witness.fill(|lane| of(lane).displacement_gradient[(i, j)]);
        let elongation = witness.fill(|lane| of(lane).mean_elongation.unwrap_or(0.0));
        let input = LaneInput {
            points,
            gradient: std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j))),
            mean_elongation: of(0).mean_elongation.map(|_| elongation),
            time_increment: 1.0,
            temperature: 293.15,
        };
        let n = self.law.state_len();
        let mut new = vec![0.0; points * n];
        let mut out = LaneResponse::zero(witness);
        let found = self.law.evaluate_lanes(&input, &self.old[..points * n], &mut new, LawRequest::Tangent, &mut out);
        for lane in 0..points {
            let (mut state, mut single) = (vec![0.0; n], Response::default());
            let old = &self.old[lane * n..(lane + 1) * n];
            match self.law.evaluate(of(lane), old, &mut state, LawRequest::Tangent, &mut single) {
                Err(source) => {
                    assert_eq!(found, Err(LaneFailure { lane, source }));
                    return;
                }
                Ok(()) if found.is_ok() => compare(&out, lane, &single, &new[lane * n..(lane + 1) * n], &state),
                Ok(()) => {}
            }
        }
        assert_eq!(found, Ok(()));
    }
}

fn compare<S: Simd>(out: &LaneResponse<Wide<S>>, lane: usize, single: &Response, new: &[f64], state: &[f64]) {
    let close = |found: Wide<S>, exact: f64, scale: f64, what: &str| {
        let found = found.to_array()[lane];
        assert!((found - exact).abs() <= 1e-12 * scale, "{what}, lane {lane}: {found:e} {exact:e}");
    };
    let scale = single.tangent.norm();
    for i in 0..6 {
        close(out.second_piola[i], single.second_piola[i], scale, "stress");
        for j in 0..6 {
            close(out.tangent[j][i], single.tangent[(i, j)], scale, "tangent");
        }
        close(out.fibre.stress_by_elongation[i], single.fibre.stress_by_elongation[i], scale, "coupling");
    }
    close(out.stored_energy, single.stored_energy, single.stored_energy.abs(), "energy");
    assert_eq!(out.incremental_potential.is_some(), single.incremental_potential.is_some());
    for (found, exact) in new.iter().zip(state) {
        assert!((found - exact).abs() <= 1e-12 * (1.0 + exact.abs()), "state, lane {lane}: {found:e} {exact:e}");
    }
}

fn compare_laws<L: Law>(law: &L, averaged: bool) {
    let mut numbers = Numbers::new(7);
    for case in 0..600 {
        // Lanes of very different strain, so that they take different branches; some are inverted.
        let size = |lane: usize| [1e-13, 1e-3, 0.02, 0.1, 0.3, 0.6, 1.0, 0.05][(lane * 5 + case) % 8];
        let inputs: Vec<_> = (0..1 + case % MAX_LANES)
            .map(|lane| {
                let point = PointInput::new(numbers.matrix(size(lane)));
                if averaged { point.with_mean_elongation(0.02 * numbers.signed()) } else { point }
            })
            .collect();
        let old: Vec<f64> = (0..inputs.len() * law.state_len())
            .map(|at| if case % 3 == 0 || at % 7 == 0 { 0.0 } else { 0.02 * numbers.signed().abs() })
            .collect();
        Arch::new().dispatch(Compare { law, inputs: &inputs, old: &old });
        Simd::vectorize(Scalar, Compare { law, inputs: &inputs, old: &old });
    }
}

#[test]
fn lanes_answer_as_points_do() {
    for law in bundles().unwrap() {
        compare_laws(&law, false);
        compare_laws(&law, true);
    }
    compare_laws(&StVenantKirchhoff::isotropic(100.0, 0.3).unwrap(), false);
    compare_laws(&CompressibleNeoHooke::new(100.0, 30.0).unwrap(), false);
    compare_laws(&FibreNeoHooke::new(10.0, 40.0, 300.0).unwrap(), false);
}

#[test]
fn a_number_that_is_missing_names_its_lane() {
    let law = &bundles().unwrap()[1];
    let mut numbers = Numbers::new(3);
    for bad in [f64::NAN, f64::INFINITY] {
        for lane in 0..MAX_LANES {
            let mut inputs: Vec<_> = (0..MAX_LANES).map(|_| PointInput::new(numbers.matrix(0.05))).collect();
            inputs[lane].displacement_gradient[(1, 2)] = bad;
            let old = vec![0.0; MAX_LANES * law.state_len()];
            Arch::new().dispatch(Compare { law, inputs: &inputs, old: &old });
            inputs[lane].displacement_gradient[(1, 2)] = 0.0;
            let mut spoilt = old.clone();
            spoilt[lane * law.state_len() + 2] = bad;
            Arch::new().dispatch(Compare { law, inputs: &inputs, old: &spoilt });
        }
    }
}

/// One element in the instruction set it is dispatched to.
struct Element<'a, F> {
    input: &'a ElementInput<'a, 8, BundleLaw>,
    formulation: std::marker::PhantomData<F>,
}

impl<F: Formulation<8>> WithSimd for Element<'_, F> {
    type Output = (Result<(), ElementFailure>, ElementResult<8>, Vec<f64>);

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let mut out = ElementResult::zero(8);
        let mut new = vec![0.0; self.input.old.len()];
        let mut buffers = Buffers::zero(simd);
        let done = F::evaluate::<BundleLaw, S, false>(simd, self.input, &mut new, &mut buffers, &mut out);
        (done, out, new)
    }
}

/// A distorted brick with fibres askew.
fn brick(reference: &ReferenceGradients<8>, numbers: &mut Numbers) -> Result<Vec<PointGroup>, GeometryError> {
    let x = Hex8::NODES.map(|node| Vector3::from(node) + Vector3::from_fn(|_, _| 0.2 * numbers.signed()));
    let frame = || Rotation3::from_scaled_axis(Vector3::from_fn(|_, _| numbers.signed())).into_inner();
    let frames: Vec<_> = std::iter::repeat_with(frame).take(8).collect();
    let mut groups = Vec::new();
    reference.add_brick::<Hex8>(&x, &frames, 1, &mut groups)?;
    Ok(groups)
}

fn compare_elements<F: Formulation<8>>(laws: &[BundleLaw]) {
    let mut numbers = Numbers::new(11);
    let reference = ReferenceGradients::new::<Hex8>();
    for law in laws {
        for _ in 0..20 {
            let groups = brick(&reference, &mut numbers).unwrap();
            let old = vec![0.0; 8 * law.state_len()];
            let input = ElementInput {
                law,
                brick: BrickGeometry::new(&reference, &groups),
                displacement: std::array::from_fn(|_| std::array::from_fn(|_| 0.02 * numbers.signed())),
                old: &old,
                time_increment: 1.0,
                temperature: 293.15,
                request: Request::Tangent,
            };
            let element = || Element::<F> { input: &input, formulation: std::marker::PhantomData };
            let (done, wide, state) = Arch::new().dispatch(element());
            let (same, narrow, expected) = Simd::vectorize(Scalar, element());
            assert!(done.is_ok() && same.is_ok());
            let flat = |of: &ElementResult<8>| of.stiffness.as_flattened().as_flattened().as_flattened().to_vec();
            near(&flat(&wide), &flat(&narrow));
            near(wide.force.as_flattened(), narrow.force.as_flattened());
            near(&[wide.energies.stored], &[narrow.energies.stored]);
            near(&state, &expected);
        }
    }
}

fn near(found: &[f64], expected: &[f64]) {
    let scale = expected.iter().fold(0.0, |largest: f64, number| largest.max(number.abs()));
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() <= 1e-12 * scale, "{found:e} {expected:e}");
    }
}

#[test]
fn instruction_sets_agree() {
    // All but the one that locks up.
    let laws = &bundles().unwrap()[..3];
    compare_elements::<Full>(laws);
    compare_elements::<MeanElongation>(laws);
    compare_elements::<MeanVolume>(laws);
}
