//! Pressure and friction of a contact point against closed forms, and their derivatives against differences.

use nalgebra::{Matrix2, Vector2, Vector3};
use subrope_contact::Surface;
use subrope_contact::foot::Local;
use subrope_contact::law::{Friction, Normal, Slip, friction, friction_potential};
use subrope_contact::patch::PATCH_NODES;

const PENALTY: f64 = 700.0;
const COEFFICIENT: f64 = 0.3;

/// Two tangents at an oblique angle and of different lengths.
const TANGENTS: [[f64; 3]; 2] = [[1.5, 0.2, 0.0], [-0.4, 0.8, 0.3]];

fn tangents() -> [Vector3<f64>; 2] {
    TANGENTS.map(Vector3::from)
}

/// A flat surface with these tangents.
fn flat() -> Local {
    let arm = 2.0;
    let mut nodal = [Vector3::zeros(); PATCH_NODES];
    let [a, b] = tangents();
    (nodal[1], nodal[2], nodal[3]) = (a * arm, b * arm, a.cross(&b));
    Local::new(Surface::plane([0, 1, 2, 3], arm).shape(0, [0.3, -0.2]), &nodal)
}

fn flat_slip<'a>(local: &'a Local, way: [f64; 2], elastic: [f64; 2], share: (f64, f64)) -> Slip<'a> {
    let spatial = |c: [f64; 2]| local.tangents[0] * c[0] + local.tangents[1] * c[1];
    Slip { local, way: spatial(way), elastic: spatial(elastic), share }
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-13 * (1.0 + a.abs().max(b.abs()))
}

#[test]
fn pressure_and_energy_of_a_toe() {
    let (penalty, toe) = (300.0, 0.02);
    let normal = Normal { penalty, toe };
    for (depth, pressure, energy) in [
        (-0.01, 0.0, 0.0),
        (0.0, 0.0, 0.0),
        (0.5 * toe, penalty * toe / 8.0, penalty * toe * toe / 48.0),
        (toe, 0.5 * penalty * toe, penalty * toe * toe / 6.0),
        (3.0 * toe, 2.5 * penalty * toe, penalty * toe * toe * (3.0 + 1.0 / 6.0)),
    ] {
        assert!(close(normal.pressure(0.0, -depth).0, pressure), "{depth}");
        assert!(close(normal.energy(depth), energy), "{depth}: {} {energy}", normal.energy(depth));
        assert!(close(normal.potential(0.0, -depth), energy), "without a multiplier");
    }
    assert_eq!(normal.pressure(0.0, 0.01), (0.0, 0.0), "an open gap has no stiffness");
}

#[test]
fn pressure_without_a_toe_is_linear() {
    let normal = Normal { penalty: 300.0, toe: 0.0 };
    assert_eq!(normal.pressure(2.0, -0.01), (5.0, -300.0));
    assert_eq!(normal.pressure(2.0, 0.01), (0.0, 0.0));
    assert!(close(normal.energy(0.01), 0.5 * 300.0 * 1e-4));
    // lambda g of the multiplier less half eps g^2.
    assert!(close(normal.potential(2.0, -0.004), 2.0 * 0.004 + 0.5 * 300.0 * 0.004 * 0.004));
}

#[test]
fn a_multiplier_in_the_toe_is_the_pressure_of_closed_surfaces() {
    let normal = Normal { penalty: 300.0, toe: 0.02 };
    for multiplier in [0.0, 0.3, 2.9, 3.0, 3.1, 40.0] {
        assert!(close(normal.pressure(multiplier, 0.0).0, multiplier), "{multiplier}");
        assert!(normal.potential(multiplier, 0.0).abs() < 1e-15, "no energy where the surfaces meet");
    }
}

#[test]
fn friction_potential_is_quadratic_up_to_the_limit_and_straight_beyond() {
    let h = 1e-6;
    for (trial, slope) in [(0.5, 0.5), (1.9, 1.9), (2.1, 2.0), (30.0, 2.0)] {
        let along =
            (friction_potential(trial + h, 2.0, PENALTY) - friction_potential(trial - h, 2.0, PENALTY)) / (2.0 * h);
        assert!((along * PENALTY - slope).abs() < 1e-7, "{trial}: {along}");
    }
    assert_eq!(friction_potential(0.0, 2.0, PENALTY), 0.0);
    assert!(close(friction_potential(1.0, 2.0, PENALTY), 0.5 / PENALTY));
}

/// `t = eps s`, all of it stored.
#[test]
fn what_sticks_is_elastic() {
    let local = flat();
    let slip = flat_slip(&local, [0.002, -0.001], [0.0005, 0.0004], (0.5, 0.0));
    let f = friction(&slip, &local.metric(), PENALTY, COEFFICIENT, (100.0, -2000.0));
    let s = slip.elastic + slip.way * 0.5;
    for i in 0..2 {
        assert!(close(f.traction[i], PENALTY * s.dot(&tangents()[i])), "{i}");
    }
    assert!(close(f.magnitude, PENALTY * s.norm()));
    assert!((f.elastic - Vector2::new(0.0015, -0.0001)).norm() < 1e-15);
    assert!(close(f.stored, 0.5 * PENALTY * s.norm_squared()));
    assert_eq!((f.slipped, f.by_gap), (0.0, Vector2::zeros()));
}

/// `|t| = mu p` along the trial slip; the potential is what is stored and what is dissipated.
#[test]
fn what_slips_pulls_at_the_limit() {
    let local = flat();
    let slip = flat_slip(&local, [0.02, -0.01], [0.005, 0.004], (1.0, 0.0));
    let limit = COEFFICIENT * 10.0;
    let f = friction(&slip, &local.metric(), PENALTY, COEFFICIENT, (10.0, -2000.0));
    let s = slip.elastic + slip.way;
    assert!(close(f.magnitude, limit));
    for i in 0..2 {
        assert!(close(f.traction[i], limit * s.normalize().dot(&tangents()[i])), "{i}");
        // More pressure pulls more: dp/dg < 0.
        assert!(close(f.by_gap[i], -2000.0 / 10.0 * f.traction[i]), "{i}");
    }
    assert!((f.elastic - Vector2::new(0.025, -0.006) * (limit / (PENALTY * s.norm()))).norm() < 1e-15);
    assert!(close(f.stored, 0.5 * limit * limit / PENALTY));
    assert!(close(f.slipped, s.norm() - limit / PENALTY));
    let potential = friction_potential(PENALTY * s.norm(), limit, PENALTY);
    assert!(close(f.stored + limit * f.slipped, potential));
}

/// Stretched alike in both directions by `k`, the same components make a traction `k` times as large, until it slips.
#[test]
fn the_limit_holds_in_the_current_metric() {
    let local = flat();
    let slip = flat_slip(&local, [0.002, -0.001], [0.0, 0.0], (1.0, 0.0));
    let at =
        |stretch: f64, p| friction(&slip, &(local.metric() * stretch * stretch), PENALTY, COEFFICIENT, (p, -2000.0));
    let length = slip.way.norm();
    assert!(close(at(1.5, 100.0).magnitude, 1.5 * PENALTY * length));
    let edge = 1.5 * PENALTY * length / COEFFICIENT;
    assert_eq!(at(1.5, 1.001 * edge).slipped, 0.0);
    let sliding = at(1.5, 0.999 * edge);
    assert!(close(sliding.magnitude, COEFFICIENT * 0.999 * edge) && sliding.slipped > 0.0);
}

#[test]
fn a_point_at_rest_pulls_nothing() {
    let local = flat();
    for p in [0.0, 10.0] {
        let f = friction(
            &flat_slip(&local, [0.0; 2], [0.0; 2], (1.0, 0.0)),
            &local.metric(),
            PENALTY,
            COEFFICIENT,
            (p, -1.0),
        );
        assert_eq!((f.traction, f.magnitude, f.slipped, f.stored), (Vector2::zeros(), 0.0, 0.0, 0.0));
        assert!((f.by_place - local.metric() * PENALTY).norm() < 1e-9, "it sticks: {}", f.by_place);
        assert!(f.by_metric.iter().all(|m| m.norm() == 0.0) && f.by_gap.norm() == 0.0);
    }
}

/// A curved patch, at a place.
fn curved(xi: [f64; 2]) -> Local {
    let surface =
        Surface::of_faces(&[(0..9).collect()], subrope_geometry::CellKind::Hex27, subrope_contact::Smoothing::None);
    let Ok(surface) = surface else { unreachable!("nine nodes are a facet") };
    let places = [[-1, -1], [1, -1], [1, 1], [-1, 1], [0, -1], [1, 0], [0, 1], [-1, 0], [0, 0]];
    let mut nodal = [Vector3::zeros(); PATCH_NODES];
    for (x, [i, j]) in nodal.iter_mut().zip(places) {
        let (u, v) = (f64::from(i), f64::from(j));
        *x = Vector3::new(
            u + 0.2 * v,
            1.3 * v - 0.1 * u * v,
            0.3 * u * u - 0.2 * u * v + 0.15 * v * v + 0.05 * u * u * v,
        );
    }
    Local::new(surface.shape(0, xi), &nodal)
}

/// Friction of a point that came from a place of the curved patch, `gap` with its pressure and share.
fn on_curved(xi: [f64; 2], gap: f64, metric: &Matrix2<f64>, way: f64) -> Friction {
    let local = curved(xi);
    let from = curved([0.2 - way, -0.3 + 0.5 * way]);
    let (old, p, slope) = (0.01, -2000.0 * gap, -2000.0);
    let closing = old - gap;
    let share = (-gap / closing, -old / (closing * closing));
    let slip =
        Slip { local: &local, way: local.position - from.position, elastic: Vector3::new(1e-4, -2e-4, 1e-4), share };
    friction(&slip, metric, PENALTY, COEFFICIENT, (p, slope))
}

/// By place, gap and metric, in the two states.
#[test]
fn derivatives_of_friction_agree_with_differences() {
    let (xi, gap, h) = ([0.2, -0.3], -0.02, 1e-6);
    let metric = curved(xi).metric() + Matrix2::new(0.2, -0.1, -0.1, 0.3);
    for (way, slips) in [(0.001, false), (0.1, true)] {
        let f = on_curved(xi, gap, &metric, way);
        assert_eq!(f.slipped > 0.0, slips);
        let scale = PENALTY * metric.norm();
        let slope = |up: Friction, down: Friction| (up.traction - down.traction) / (2.0 * h);
        for k in 0..2 {
            let at = |s: f64| std::array::from_fn(|i| xi[i] + if i == k { s } else { 0.0 });
            let by_place = slope(on_curved(at(h), gap, &metric, way), on_curved(at(-h), gap, &metric, way));
            assert!((by_place - f.by_place.column(k)).norm() < 1e-7 * scale, "{way}, place {k}");
            for j in 0..2 {
                let bent = |s: f64| {
                    let mut m = metric;
                    m[(j, k)] += s;
                    m[(k, j)] = m[(j, k)];
                    m
                };
                let by_metric = slope(on_curved(xi, gap, &bent(h), way), on_curved(xi, gap, &bent(-h), way));
                for i in 0..2 {
                    let own = f.by_metric[i][(j, k)] + if j == k { 0.0 } else { f.by_metric[i][(k, j)] };
                    assert!((by_metric[i] - own).abs() < 1e-7 * scale, "{way}, metric {j} {k}: {} {own}", by_metric[i]);
                }
            }
        }
        let by_gap = slope(on_curved(xi, gap + h, &metric, way), on_curved(xi, gap - h, &metric, way));
        assert!((by_gap - f.by_gap).norm() < 1e-7 * scale, "{way}, gap: {by_gap} {}", f.by_gap);
        assert!(f.by_gap.norm() > 1.0, "the pressure shows");
    }
}
