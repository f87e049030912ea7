//! Forces and tangent of one point between two curved patches, entry by entry, against differences.

#![allow(clippy::expect_used, reason = "a test fails by panicking")]

use nalgebra::{DMatrix, DVector, Vector3};
use subrope_contact::foot::{Foot, Local, Place, Posture, project};
use subrope_contact::kernel::{PairBuffer, terms};
use subrope_contact::law::{Friction, Normal, Slip, friction};
use subrope_contact::patch::{PATCH_NODES, PatchKind};
use subrope_contact::{Smoothing, Surface};
use subrope_geometry::CellKind;

/// Nodes of the secondary patch, of the primary one, of both.
const OWN: usize = 4;
const OTHER: usize = 9;
const N: usize = OWN + OTHER;
const AREA: f64 = 0.7;
const NORMAL: Normal = Normal { penalty: 40.0, toe: 0.01 };
const STICKS: f64 = 9.0;
const SLIPS: f64 = 0.02;

/// Numbers between -1 and 1 that follow no pattern.
fn scattered(k: usize) -> f64 {
    (12.9898 * (k as f64 + 1.0)).sin()
}

/// Nodes of a curved primary patch below and of a secondary one that dips into it.
fn rest() -> DVector<f64> {
    let primary = [[-1, -1], [1, -1], [1, 1], [-1, 1], [0, -1], [1, 0], [0, 1], [-1, 0], [0, 0]];
    let secondary = [[-1, -1], [1, -1], [1, 1], [-1, 1]];
    let place = |[i, j]: [i32; 2], z: f64, tilt: f64| {
        let (x, y) = (f64::from(i), 1.2 * f64::from(j) + 0.1 * f64::from(i));
        [x, y, z + tilt * x - 0.15 * x * x + 0.1 * x * y - 0.08 * y * y * (1.0 - tilt)]
    };
    let nodes = secondary.map(|at| place(at, 0.07, 0.1));
    let points: Vec<[f64; 3]> = nodes.into_iter().chain(primary.map(|at| place(at, 0.0, 0.0))).collect();
    DVector::from_fn(3 * N, |at, _| points[at % N][at / N] + 0.02 * scattered(at))
}

fn moved(size: f64) -> DVector<f64> {
    rest() + DVector::from_fn(3 * N, |at, _| size * scattered(7 * at + 3))
}

fn node(u: &DVector<f64>, a: usize) -> Vector3<f64> {
    Vector3::from_fn(|k, _| u[k * N + a])
}

/// Shape functions of the point on the secondary patch.
fn own() -> [f64; PATCH_NODES] {
    PatchKind::Bilinear.shape([0.3, -0.2]).value
}

fn primary() -> Surface {
    Surface::of_faces(&[(0..9).collect()], CellKind::Hex27, Smoothing::None).expect("a facet")
}

fn foot(u: &DVector<f64>) -> Foot {
    let x: Vector3<f64> = (0..OWN).map(|a| node(u, a) * own()[a]).sum();
    let positions: Vec<Vector3<f64>> = (OWN..N).map(|a| node(u, a)).collect();
    let posture = Posture { surface: &primary(), positions: &positions, displacement: &[0.0; 3 * OTHER] };
    project(&posture, &x, Place { patch: 0, xi: [0.0; 2] }).expect("a foot")
}

fn nodal(u: &DVector<f64>) -> [Vector3<f64>; PATCH_NODES] {
    std::array::from_fn(|a| if a < OTHER { node(u, OWN + a) } else { Vector3::zeros() })
}

/// Friction of a point that stood at `old` before.
fn sliding(old: &DVector<f64>, foot: &Foot, coefficient: f64) -> Friction {
    let (before, now) = (crate::foot(old), Local::new(foot.local.shape.clone(), &nodal(old)));
    let elastic = before.local.tangents[0] * 2e-3;
    let slip = Slip { local: &now, way: now.position - before.local.position, elastic, share: (1.0, 0.0) };
    friction(&slip, &foot.local.metric(), 25.0, coefficient, NORMAL.pressure(0.0, foot.gap))
}

/// Nodal forces and, in full, the stiffness.
fn evaluate(u: &DVector<f64>, coefficient: f64, symmetric: bool) -> (DVector<f64>, DMatrix<f64>) {
    let foot = foot(u);
    let friction = (coefficient > 0.0).then(|| sliding(&moved(-0.02), &foot, coefficient));
    let third = foot.local.third(&nodal(u));
    let terms = terms(&foot, NORMAL.pressure(0.0, foot.gap), friction.as_ref().map(|f| (f, &third)), symmetric)
        .expect("a unique foot");
    let mut buffer = PairBuffer::default();
    buffer.reset(N, true);
    buffer.spread(&terms, &own(), OWN, &foot, AREA);
    let mut alone = PairBuffer::default();
    alone.reset(N, false);
    alone.spread(&terms, &own(), OWN, &foot, AREA);
    assert!(alone.force == buffer.force && alone.stiffness.is_empty() && alone.products().next().is_none());
    assert_eq!(buffer.products().count(), if coefficient > 0.0 && !symmetric { 4 } else { 0 });
    let mut stiffness = DMatrix::from_fn(3 * N, 3 * N, |row, column| {
        let ((k, a), (m, b)) = ((row / N, row % N), (column / N, column % N));
        let at = if a <= b { row * 3 * N + column } else { (m * N + b) * 3 * N + k * N + a };
        buffer.stiffness[at]
    });
    for product in buffer.products() {
        stiffness += DVector::from_column_slice(product.row) * DVector::from_column_slice(product.column).transpose();
    }
    (DVector::from_column_slice(&buffer.force), stiffness)
}

/// Largest entry of the difference of the stiffness and the slopes of the forces, relative to the largest entry.
fn worst(u: &DVector<f64>, coefficient: f64) -> f64 {
    let h = 1e-6;
    let stiffness = evaluate(u, coefficient, false).1;
    let at = |column: usize, step: f64| {
        let mut u = u.clone();
        u[column] += step;
        evaluate(&u, coefficient, false).0
    };
    let slopes: Vec<_> = (0..3 * N).map(|column| (at(column, h) - at(column, -h)) / (2.0 * h)).collect();
    (DMatrix::from_columns(&slopes) - &stiffness).amax() / stiffness.amax()
}

#[test]
fn force_is_the_slope_of_the_potential() {
    let (u, h) = (moved(0.01), 1e-6);
    let force = evaluate(&u, 0.0, false).0;
    let energy = |at: usize, step: f64| {
        let mut u = u.clone();
        u[at] += step;
        AREA * NORMAL.potential(0.0, foot(&u).gap)
    };
    assert!(force.amax() > 0.1, "it touches");
    for at in 0..3 * N {
        let slope = (energy(at, h) - energy(at, -h)) / (2.0 * h);
        assert!((slope - force[at]).abs() < 1e-8 * force.amax(), "{at}: {slope} {}", force[at]);
    }
}

#[test]
fn stiffness_is_the_slope_of_the_force() {
    let u = moved(0.01);
    for coefficient in [0.0, STICKS, SLIPS] {
        let error = worst(&u, coefficient);
        assert!(error < 1e-7, "coefficient {coefficient}: {error:e}");
    }
    let at = foot(&u);
    let slipped = |coefficient| sliding(&moved(-0.02), &at, coefficient).slipped;
    let both = (slipped(STICKS), slipped(SLIPS));
    assert!(both.0 == 0.0 && both.1 > 0.0, "both states: {both:?} at gap {}", at.gap);
}

#[test]
fn the_symmetric_tangent_is_the_symmetric_part() {
    let u = moved(0.01);
    for coefficient in [STICKS, SLIPS] {
        let ((force, exact), (same, half)) = (evaluate(&u, coefficient, false), evaluate(&u, coefficient, true));
        assert_eq!(force, same);
        assert!((&half - (&exact + exact.transpose()) * 0.5).amax() < 1e-13 * exact.amax());
    }
}

/// No force on the pair as a whole and no moment; on the point the pressure, and friction along the surface.
#[test]
fn the_pair_is_in_balance() {
    let u = moved(0.01);
    for coefficient in [0.0, STICKS, SLIPS] {
        let force = evaluate(&u, coefficient, false).0;
        let sum: Vector3<f64> = (0..N).map(|a| node(&force, a)).sum();
        let moment: Vector3<f64> = (0..N).map(|a| node(&u, a).cross(&node(&force, a))).sum();
        assert!(sum.norm() < 1e-12 && moment.norm() < 1e-12, "{sum} {moment}");
        let on_point: Vector3<f64> = (0..OWN).map(|a| node(&force, a)).sum();
        let foot = foot(&u);
        let pressing = AREA * NORMAL.pressure(0.0, foot.gap).0;
        assert!((on_point.dot(&foot.normal) + pressing).abs() < 1e-12, "internal force is minus the pressure");
        let aside = on_point + foot.normal * pressing;
        let mut expected = Vector3::zeros();
        if coefficient > 0.0 {
            // The work t . dxi of the foot, whose way is that of the point over the curvature between them.
            let inverse = (foot.local.metric() - foot.local.bending(&foot.normal) * foot.gap).try_inverse();
            let raised = inverse.expect("a unique foot") * sliding(&moved(-0.02), &foot, coefficient).traction * AREA;
            expected = foot.local.tangents[0] * raised[0] + foot.local.tangents[1] * raised[1];
        }
        assert!((aside - expected).norm() < 1e-12, "{aside} {expected}");
    }
}
