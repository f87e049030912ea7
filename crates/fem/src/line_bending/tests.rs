//! The energy of lines against that of rods, its derivatives against differences, its invariance.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector, Rotation3, Vector3};

use super::{BendingLine, LineBending};
use crate::FemError;
use crate::contribution::{Configuration, Contribution, Energies, Product, Request, Sink};

const EI: f64 = 7.0;

/// A point of a line, an arm that moves with the matter beside it, and another one.
type Station = [Vector3<f64>; 3];

/// Energy, forces and stiffness of all coordinates.
struct Whole {
    nodes: Vec<Vec<u32>>,
    force: DVector<f64>,
    stiffness: DMatrix<f64>,
}

impl Sink for Whole {
    fn add(&mut self, element: usize, force: &[f64], stiffness: Option<&[f64]>) {
        let nodes = &self.nodes[element];
        let n = nodes.len();
        let at = |i: usize| 3 * nodes[i % n] as usize + i / n;
        for (i, f) in force.iter().enumerate() {
            self.force[at(i)] += f;
        }
        for (i, k) in stiffness.unwrap_or_default().iter().enumerate() {
            self.stiffness[(at(i / (3 * n)), at(i % (3 * n)))] += k;
        }
    }

    fn add_products(&mut self, _: usize, _: &[Product<'_>]) {}
}

/// Nodes of stations: the line, then both rows beside.
fn positions(stations: &[Station]) -> Vec<Vector3<f64>> {
    let row = |k: usize| stations.iter().map(move |s| if k == 0 { s[0] } else { s[0] + s[k] });
    (0..3).flat_map(row).collect()
}

fn line(count: usize, clamped: [bool; 2]) -> BendingLine {
    let n = count as u32;
    let beside = (0..n).map(|i| [n + i, 2 * n + i]).collect();
    BendingLine { nodes: (0..n).collect(), beside, stiffness: EI, clamped }
}

fn assemble(bending: &mut LineBending, displacement: &[f64]) -> Result<(f64, Whole), FemError> {
    let nodes = (0..bending.element_count()).map(|e| bending.element_nodes(e).to_vec()).collect();
    let n = displacement.len();
    let mut whole = Whole { nodes, force: DVector::zeros(n), stiffness: DMatrix::zeros(n, n) };
    let at = Configuration {
        displacement,
        committed: displacement,
        time_increment: 1.0,
        time: 1.0,
        temperature: 293.15,
        predicting: false,
        parallel: false,
    };
    let energies: Energies = bending.assemble(&at, Request::Tangent, &mut whole)?;
    Ok((energies.stored, whole))
}

fn displacement(rest: &[Station], now: &[Station]) -> Vec<f64> {
    positions(rest).iter().zip(positions(now)).flat_map(|(x, y)| <[f64; 3]>::from(y - x)).collect()
}

/// Energy of a line of `edges` edges, clamped or not, that goes from one curve to another \[mJ\]; both are given over
/// 0 to 1.
fn energy(edges: usize, clamped: bool, rest: impl Fn(f64) -> Station, now: impl Fn(f64) -> Station) -> f64 {
    let stations =
        |curve: &dyn Fn(f64) -> Station| -> Vec<_> { (0..=edges).map(|i| curve(i as f64 / edges as f64)).collect() };
    let (rest, now) = (stations(&rest), stations(&now));
    let mut bending = LineBending::new(&positions(&rest), &[line(edges + 1, [clamped; 2])]).unwrap();
    assemble(&mut bending, &displacement(&rest, &now)).unwrap().0
}

/// A straight line of a length along z.
fn straight(length: f64) -> impl Fn(f64) -> Station {
    move |s| [length * s * Vector3::z(), 0.3 * Vector3::x(), 0.2 * Vector3::y()]
}

/// An arc of a length and a curvature in the plane of z and a direction normal to it; sections turn with it.
fn arc(length: f64, curvature: f64, towards: Vector3<f64>) -> impl Fn(f64) -> Station {
    move |s| {
        let angle = curvature * length * s;
        let turned = Rotation3::from_scaled_axis(angle * Vector3::z().cross(&towards));
        let place = (angle.sin() * Vector3::z() + (1.0 - angle.cos()) * towards) / curvature;
        [place, turned * (0.3 * Vector3::x()), turned * (0.2 * Vector3::y())]
    }
}

/// A yarn at radius `a` of a strand that is `length` long and turns it by `turn`; sections turn about z with it.
fn helix(a: f64, length: f64, turn: f64) -> impl Fn(f64) -> Station {
    move |s| {
        let turned = Rotation3::from_scaled_axis(turn * s * Vector3::z());
        [
            turned * (a * Vector3::x()) + length * s * Vector3::z(),
            turned * (0.3 * Vector3::x()),
            turned * (0.2 * Vector3::y()),
        ]
    }
}

/// Coordinates that have nothing to do with each other, in -1 to 1.
fn scattered(seed: f64, count: usize) -> Vec<f64> {
    (0..count).map(|i| 2.0 * ((seed + 12.9898 * (i as f64 + 1.0)).sin() * 43758.5453).rem_euclid(1.0) - 1.0).collect()
}

/// Converges with second order.
fn converges(exact: f64, energy: impl Fn(usize) -> f64) {
    let error = |edges| (energy(edges) - exact).abs() / exact;
    let (coarse, fine) = (error(40), error(80));
    assert!(fine < 2e-3, "{fine:e} of {exact}");
    assert!((3.5..4.5).contains(&(coarse / fine)), "from {coarse:e} to {fine:e}");
}

#[test]
fn a_straight_line_bent_to_an_arc_has_the_energy_of_a_rod() {
    let (length, curvature) = (20.0, 0.1);
    converges(0.5 * EI * curvature * curvature * length, |edges| {
        energy(edges, true, straight(length), arc(length, curvature, Vector3::x()))
    });
}

#[test]
fn a_yarn_of_a_twisted_strand_has_the_energy_of_its_change_of_curvature() {
    let (a, length, turns) = (2.5, 30.0, [1.5 * PI, 2.6 * PI]);
    let stretch = |turn: f64| 1.0_f64.hypot(a * turn / length);
    let curvature = |turn: f64| a * (turn / length).powi(2) / stretch(turn).powi(2);
    // Turning by length at rest.
    let change = curvature(turns[1]) * stretch(turns[1]) / stretch(turns[0]) - curvature(turns[0]);
    let exact = 0.5 * EI * change * change * length * stretch(turns[0]);
    // Sections that stay plane while yarns change their angle are no clamps; the half edges at the ends do not count
    // then.
    converges(exact, |edges| {
        let counted = (edges - 1) as f64 / edges as f64;
        energy(edges, false, helix(a, length, turns[0]), helix(a, length, turns[1])) / counted
    });
}

#[test]
fn a_curvature_that_keeps_its_size_and_turns_in_the_matter_costs_energy() {
    // What an energy of the angle alone would miss: 1/2 EI |k e_y - k e_x|^2.
    let (length, curvature) = (20.0, 0.08);
    let now = arc(length, curvature, Vector3::y());
    converges(EI * curvature * curvature * length, |edges| {
        energy(edges, true, arc(length, curvature, Vector3::x()), &now)
    });
}

#[test]
fn nothing_at_rest_and_nothing_under_rigid_motion() {
    let rest: Vec<_> = (0..=12).map(|i| helix(2.5, 20.0, 4.0)(f64::from(i) / 12.0)).collect();
    let mut bending = LineBending::new(&positions(&rest), &[line(13, [true; 2])]).unwrap();
    let (energy, whole) = assemble(&mut bending, &vec![0.0; 117]).unwrap();
    assert!(energy < 1e-28 && whole.force.amax() < 1e-13);
    let rotation = Rotation3::from_scaled_axis(Vector3::new(1.1, -2.0, 0.7));
    let moved: Vec<_> = rest
        .iter()
        .map(|s| [rotation * s[0] + Vector3::new(5.0, -3.0, 80.0), rotation * s[1], rotation * s[2]])
        .collect();
    let (energy, moved) = assemble(&mut bending, &displacement(&rest, &moved)).unwrap();
    assert!(energy < 1e-24 && moved.force.amax() < 1e-12, "{energy:e}, {:e}", moved.force.amax());
}

#[test]
fn energy_and_forces_turn_with_the_body() {
    let rest: Vec<_> = (0..=8).map(|i| helix(2.5, 20.0, 4.0)(f64::from(i) / 8.0)).collect();
    let points = positions(&rest);
    let mut bending = LineBending::new(&points, &[line(9, [true, false])]).unwrap();
    let shift = scattered(1.0, 81).iter().map(|v| 0.08 * v).collect::<Vec<_>>();
    let rotation = Rotation3::from_scaled_axis(Vector3::new(-0.4, 1.9, 1.2));
    let at = |u: &[f64], i: usize| Vector3::from_column_slice(&u[3 * i..3 * i + 3]);
    let turned: Vec<f64> =
        (0..27).flat_map(|i| <[f64; 3]>::from(rotation * (points[i] + at(&shift, i)) - points[i])).collect();
    let (energy, plain) = assemble(&mut bending, &shift).unwrap();
    let (other, rotated) = assemble(&mut bending, &turned).unwrap();
    assert!((energy - other).abs() < 1e-12 * energy);
    for i in 0..27 {
        let off = rotation * at(plain.force.as_slice(), i) - at(rotated.force.as_slice(), i);
        assert!(off.norm() < 1e-11 * plain.force.amax(), "node {i}");
    }
    // No resultant force and no moment: the body can be turned for nothing.
    let forces = (0..27).map(|i| at(plain.force.as_slice(), i));
    assert!(forces.clone().sum::<Vector3<f64>>().norm() < 1e-11 * plain.force.amax());
    let moment: Vector3<f64> = forces.enumerate().map(|(i, f)| (points[i] + at(&shift, i)).cross(&f)).sum();
    assert!(moment.norm() < 1e-9 * plain.force.amax());
}

#[test]
fn forces_and_stiffness_are_derivatives_of_the_energy() {
    let rest: Vec<_> = (0..=4).map(|i| helix(2.5, 6.0, 2.0)(f64::from(i) / 4.0)).collect();
    let mut bending = LineBending::new(&positions(&rest), &[line(5, [true; 2])]).unwrap();
    for (seed, amplitude) in [(1.0, 0.0), (2.0, 0.02), (3.0, 0.1), (4.0, 0.15)] {
        let at: Vec<f64> = scattered(seed, 45).iter().map(|v| amplitude * v).collect();
        let (_, here) = assemble(&mut bending, &at).unwrap();
        let (mut worst_force, mut worst_stiffness) = (0.0_f64, 0.0_f64);
        for i in 0..45 {
            let step = 1e-5;
            let mut moved = |by: f64| {
                let mut u = at.clone();
                u[i] += by;
                assemble(&mut bending, &u).unwrap()
            };
            let (low, high) = (moved(-step), moved(step));
            worst_force = worst_force.max(((high.0 - low.0) / (2.0 * step) - here.force[i]).abs());
            let column = (high.1.force - low.1.force) / (2.0 * step);
            worst_stiffness = worst_stiffness.max((column - here.stiffness.column(i)).amax());
        }
        let scale = here.stiffness.amax();
        assert!(worst_force < 1e-7 * scale, "amplitude {amplitude}: force off by {worst_force:e} of {scale:e}");
        assert!(
            worst_stiffness < 1e-7 * scale,
            "amplitude {amplitude}: stiffness off by {worst_stiffness:e} of {scale:e}"
        );
        assert!((&here.stiffness - here.stiffness.transpose()).amax() < 1e-12 * scale);
    }
}

#[test]
fn a_line_that_folds_back_asks_for_a_shorter_increment() {
    let rest: Vec<_> = (0..3).map(|i| straight(2.0)(0.5 * f64::from(i))).collect();
    let mut bending = LineBending::new(&positions(&rest), &[line(3, [false; 2])]).unwrap();
    let mut folded = vec![0.0; 27];
    folded[8] = -2.0;
    let error = assemble(&mut bending, &folded).err().unwrap();
    assert!(matches!(error, FemError::FoldedLine { node: 1 }) && error.is_recoverable());
}

#[test]
fn lines_without_direction_are_refused() {
    let mut rest: Vec<_> = (0..3).map(|i| straight(2.0)(0.5 * f64::from(i))).collect();
    let short = LineBending::new(&positions(&rest), &[line(2, [false; 2])]);
    assert!(matches!(short, Err(FemError::Count { found: 2, expected: 3, .. })));
    let mut strange = line(3, [false; 2]);
    strange.nodes[2] = 100;
    assert!(matches!(LineBending::new(&positions(&rest), &[strange]), Err(FemError::UnknownNode { node: 100, .. })));
    rest[2][0] = rest[1][0];
    let error = LineBending::new(&positions(&rest), &[line(3, [false; 2])]).err();
    assert!(matches!(error, Some(FemError::FoldedLine { node: 1 })));
}
