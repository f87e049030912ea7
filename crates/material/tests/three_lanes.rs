//! Laws in three lanes of plain arithmetic answer what they answer point by point, to the last bit.
#![allow(clippy::unwrap_used)]

use std::ops::{Add, AddAssign, BitAnd, BitOr, Div, Mul, Neg, Not, Sub, SubAssign};

use subrope_material::lanes::{Lanes, MAX_LANES};
use subrope_material::testkit::{Numbers, bundles};
use subrope_material::{
    CompressibleNeoHooke, FibreNeoHooke, IsochoricNeoHooke, LaneFailure, LaneInput, LaneResponse, Law, PointInput,
    Request, Response, StVenantKirchhoff,
};

const COUNT: usize = 3;

#[derive(Clone, Copy, Debug, PartialEq)]
struct Three([f64; COUNT]);

#[derive(Clone, Copy, Debug)]
struct Mask([bool; COUNT]);

fn each(f: impl Fn(usize) -> f64) -> Three {
    Three(std::array::from_fn(f))
}

fn mask(f: impl Fn(usize) -> bool) -> Mask {
    Mask(std::array::from_fn(f))
}

/// Operators of lanes with lanes, and of lanes with one number.
macro_rules! operators {
    ($($trait:ident $method:ident $operator:tt),*) => {$(
        impl $trait for Three {
            type Output = Self;

            fn $method(self, other: Self) -> Self {
                each(|i| self.0[i] $operator other.0[i])
            }
        }

        impl $trait<f64> for Three {
            type Output = Self;

            fn $method(self, other: f64) -> Self {
                each(|i| self.0[i] $operator other)
            }
        }
    )*};
}
operators!(Add add +, Sub sub -, Mul mul *, Div div /);

impl Neg for Three {
    type Output = Self;

    fn neg(self) -> Self {
        each(|i| -self.0[i])
    }
}

impl AddAssign for Three {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Three {
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl BitAnd for Mask {
    type Output = Self;

    fn bitand(self, other: Self) -> Self {
        mask(|i| self.0[i] && other.0[i])
    }
}

impl BitOr for Mask {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        mask(|i| self.0[i] || other.0[i])
    }
}

impl Not for Mask {
    type Output = Self;

    fn not(self) -> Self {
        mask(|i| !self.0[i])
    }
}

impl Lanes for Three {
    type Mask = Mask;

    const COUNT: usize = COUNT;

    fn splat(self, value: f64) -> Self {
        each(|_| value)
    }

    fn load(self, numbers: &[f64; MAX_LANES]) -> Self {
        each(|i| numbers[i])
    }

    fn to_array(self) -> [f64; MAX_LANES] {
        std::array::from_fn(|i| self.0.get(i).copied().unwrap_or(0.0))
    }

    fn mul_add(self, factor: Self, addend: Self) -> Self {
        self * factor + addend
    }

    fn sqrt(self) -> Self {
        each(|i| self.0[i].sqrt())
    }

    fn max(self, other: Self) -> Self {
        each(|i| Lanes::max(self.0[i], other.0[i]))
    }

    fn min(self, other: Self) -> Self {
        each(|i| Lanes::min(self.0[i], other.0[i]))
    }

    fn lt(self, other: Self) -> Mask {
        mask(|i| self.0[i] < other.0[i])
    }

    fn equal(self, other: Self) -> Mask {
        mask(|i| self.0[i] == other.0[i])
    }

    fn select(mask: Mask, yes: Self, no: Self) -> Self {
        each(|i| if mask.0[i] { yes.0[i] } else { no.0[i] })
    }

    fn any(mask: Mask) -> bool {
        mask.0.contains(&true)
    }
}

/// Number `lane` of the lanes.
fn of(lanes: Three, lane: usize) -> f64 {
    lanes.0[lane]
}

fn same(found: &LaneResponse<Three>, lane: usize, exact: &Response, averaged: bool) {
    for i in 0..6 {
        assert_eq!(of(found.second_piola[i], lane), exact.second_piola[i], "stress {i}");
        for j in 0..6 {
            assert_eq!(of(found.tangent[j][i], lane), exact.tangent[(i, j)], "tangent {i} {j}");
        }
        if averaged {
            assert_eq!(of(found.fibre.stress_by_elongation[i], lane), exact.fibre.stress_by_elongation[i]);
            assert_eq!(of(found.fibre.fibre_stress_by_strain[i], lane), exact.fibre.fibre_stress_by_strain[i]);
        }
    }
    if averaged {
        assert_eq!(of(found.fibre.fibre_stress, lane), exact.fibre.fibre_stress);
        assert_eq!(of(found.fibre.fibre_stiffness, lane), exact.fibre.fibre_stiffness);
    }
    assert_eq!(of(found.stored_energy, lane), exact.stored_energy);
    assert_eq!(found.incremental_potential.map(|w| of(w, lane)), exact.incremental_potential);
    assert_eq!(found.dissipated_mid.map(|d| of(d, lane)), exact.dissipated_mid);
}

/// One to three points of strains so different that they take different branches; the first that fails is named.
fn compare<L: Law>(law: &L, averaged: bool) {
    let (mut numbers, n, mut failures) = (Numbers::new(3), law.state_len(), 0);
    for case in 0..300 {
        let points = 1 + case % COUNT;
        let size = |lane: usize| [1e-13, 1e-3, 0.02, 0.1, 0.3, 0.6, 1.0, 0.05][(lane * 5 + case) % 8];
        let inputs: Vec<_> = (0..points)
            .map(|lane| {
                let point = PointInput::new(numbers.matrix(size(lane)));
                if averaged { point.with_mean_elongation(0.02 * numbers.signed()) } else { point }
            })
            .collect();
        let still = case % 3 == 0;
        let old: Vec<f64> = (0..points * n).map(|_| if still { 0.0 } else { 0.02 * numbers.unit() }).collect();
        let at = |lane: usize| &inputs[lane.min(points - 1)];
        let entry = |i, j| each(|lane| at(lane).displacement_gradient[(i, j)]);
        let input = LaneInput {
            points,
            gradient: std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j))),
            mean_elongation: averaged.then(|| each(|lane| at(lane).mean_elongation.unwrap())),
            time_increment: inputs[0].time_increment,
            temperature: inputs[0].temperature,
        };
        let (mut new, mut out) = (vec![0.0; points * n], LaneResponse::zero(each(|_| 0.0)));
        let found = law.evaluate_lanes(&input, &old, &mut new, Request::Tangent, &mut out);
        let single: Vec<_> = (0..points)
            .map(|lane| {
                let (mut state, mut out) = (vec![0.0; n], Response::default());
                let old = &old[lane * n..(lane + 1) * n];
                law.evaluate(&inputs[lane], old, &mut state, Request::Tangent, &mut out).map(|()| (state, out))
            })
            .collect();
        if let Some(lane) = single.iter().position(Result::is_err) {
            failures += 1;
            let source = single[lane].clone().unwrap_err();
            assert_eq!(found, Err(LaneFailure { lane, source }));
            continue;
        }
        assert_eq!(found, Ok(()));
        for (lane, (state, exact)) in single.into_iter().map(Result::unwrap).enumerate() {
            same(&out, lane, &exact, averaged);
            assert_eq!(new[lane * n..(lane + 1) * n], state, "state of lane {lane}");
        }
    }
    assert!((1..200).contains(&failures), "some are inverted, not all: {failures}");
}

#[test]
fn bundles_in_lanes() {
    for law in bundles().unwrap() {
        compare(&law, false);
        compare(&law, true);
    }
}

#[test]
fn elastic_laws_in_lanes() {
    compare(&StVenantKirchhoff::isotropic(1000.0, 0.3).unwrap(), false);
    compare(&CompressibleNeoHooke::new(0.5, 1.2).unwrap(), false);
    compare(&IsochoricNeoHooke::new(0.4, 0.9).unwrap(), false);
    let fibre = FibreNeoHooke::new(1.0, 1.0, 100.0).unwrap();
    compare(&fibre, false);
    compare(&fibre, true);
}
