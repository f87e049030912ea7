//! Forces against the potential, the tangent against differences of the forces.

#![allow(clippy::expect_used, reason = "a test fails by panicking")]

mod common;

use common::{Noise, contact, crossed, evaluate};
use subrope_contact::{Contact, ContactOptions, Method, Smoothing};
use subrope_fem::Contribution;
use subrope_geometry::{CellKind, Mesh};

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

fn shifted(u: &[f64], h: f64, d: &[f64]) -> Vec<f64> {
    u.iter().zip(d).map(|(x, y)| x + h * y).collect()
}

/// Worst relative error of `K d` against differences of the forces over some directions.
fn tangent_error(contact: &mut Contact, u: &[f64], committed: &[f64]) -> f64 {
    let mut noise = Noise(5);
    let mut worst = 0.0_f64;
    for _ in 0..6 {
        let d = noise.vector(u.len(), 1.0);
        let h = 1e-6;
        let product = evaluate(contact, u, committed, &d).expect("forces").1;
        let up = evaluate(contact, &shifted(u, h, &d), committed, &d).expect("forces").0;
        let down = evaluate(contact, &shifted(u, -h, &d), committed, &d).expect("forces").0;
        let slope: Vec<f64> = up.iter().zip(&down).map(|(a, b)| (a - b) / (2.0 * h)).collect();
        let error: Vec<f64> = slope.iter().zip(&product).map(|(a, b)| a - b).collect();
        worst = worst.max(norm(&error) / norm(&product));
    }
    worst
}

/// All nodes of the second body moved along the first axis.
fn pressed(mesh: &Mesh, by: f64, aside: [f64; 2]) -> Vec<f64> {
    let half = mesh.points.len() / 2;
    (0..mesh.points.len()).flat_map(|n| if n < half { [0.0; 3] } else { [-by, aside[0], aside[1]] }).collect()
}

fn add(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(x, y)| x + y).collect()
}

fn options(friction: f64) -> ContactOptions {
    let base = ContactOptions::new(100.0, 1.0);
    ContactOptions { friction, penalty: 2000.0, reach: 0.3, tangential_penalty: 700.0, points: [4, 4], ..base }
}

/// A contact with a history: pressed, moved aside, committed; then the trial displacements.
fn with_history(
    angle: f64,
    kind: CellKind,
    smoothing: Smoothing,
    options: ContactOptions,
    aside: f64,
) -> (Contact, Vec<f64>, Vec<f64>) {
    let mesh = crossed(angle, 0.02, kind);
    let mut contact = contact(&mesh, smoothing, options);
    let n = 3 * mesh.points.len();
    let mut noise = Noise(11);
    let committed = add(&pressed(&mesh, 0.06, [0.0, 0.0]), &noise.vector(n, 0.004));
    let rest = vec![0.0; n];
    contact.prepare(&rest).expect("a search");
    contact.prepare(&committed).expect("a search");
    evaluate(&mut contact, &committed, &rest, &rest).expect("forces");
    contact.commit();
    let trial = add(&pressed(&mesh, 0.1, [aside, 0.6 * aside]), &noise.vector(n, 0.004));
    contact.prepare(&trial).expect("a search");
    (contact, committed, trial)
}

#[test]
fn forces_without_friction_are_slopes_of_the_potential() {
    for smoothing in [Smoothing::Spline, Smoothing::None] {
        let (mut contact, committed, u) = with_history(0.5, CellKind::Hex8, smoothing, options(0.0), 0.01);
        let mut noise = Noise(3);
        for _ in 0..4 {
            let d = noise.vector(u.len(), 1.0);
            let h = 1e-6;
            let force = evaluate(&mut contact, &u, &committed, &d).expect("forces").0;
            let energy = |c: &mut Contact, s: f64| {
                evaluate(c, &shifted(&u, s, &d), &committed, &d).expect("energies").2.potential
            };
            let slope = (energy(&mut contact, h) - energy(&mut contact, -h)) / (2.0 * h);
            assert!(norm(&force) > 1.0, "it touches");
            assert!((slope - dot(&force, &d)).abs() < 1e-7 * norm(&force), "{slope} {}", dot(&force, &d));
        }
    }
}

#[test]
fn tangent_without_friction() {
    for (angle, kind) in [(0.0, CellKind::Hex8), (0.5, CellKind::Hex8), (0.5, CellKind::Hex27)] {
        for smoothing in [Smoothing::Spline, Smoothing::None] {
            let (mut contact, committed, u) = with_history(angle, kind, smoothing, options(0.0), 0.01);
            let error = tangent_error(&mut contact, &u, &committed);
            println!("{angle} {kind:?} {smoothing:?}: {error:e}");
            assert!(error < 1e-6, "{angle} {kind:?} {smoothing:?}: {error:e}");
        }
    }
}

#[test]
fn tangent_with_friction_that_sticks_slips_and_closes() {
    for (aside, friction) in [(1e-4, 5.0), (0.03, 0.3), (0.01, 0.5)] {
        let (mut contact, committed, u) =
            with_history(0.5, CellKind::Hex8, Smoothing::Spline, options(friction), aside);
        let error = tangent_error(&mut contact, &u, &committed);
        println!("aside {aside}, friction {friction}: {error:e}");
        assert!(error < 1e-6, "aside {aside}, friction {friction}: {error:e}");
    }
}

#[test]
fn tangent_with_multipliers() {
    let method = Method::Augmented { penetration: 1e-6, rounds: 50 };
    let options = ContactOptions { method, ..options(0.3) };
    let (mut contact, committed, u) = with_history(0.5, CellKind::Hex8, Smoothing::Spline, options, 0.02);
    evaluate(&mut contact, &u, &committed, &u).expect("forces");
    contact.review().expect("a round");
    let error = tangent_error(&mut contact, &u, &committed);
    assert!(error < 1e-6, "{error:e}");
}

#[test]
fn symmetric_tangent_is_the_symmetric_part() {
    let symmetric = ContactOptions { tangent: subrope_contact::FrictionTangent::Symmetric, ..options(0.5) };
    let make = |o| with_history(0.5, CellKind::Hex8, Smoothing::Spline, o, 0.02);
    let (mut exact, committed, u) = make(options(0.5));
    let (mut half, ..) = make(symmetric);
    let mut noise = Noise(9);
    let (a, b) = (noise.vector(u.len(), 1.0), noise.vector(u.len(), 1.0));
    let form = |c: &mut Contact, x: &[f64], y: &[f64]| dot(x, &evaluate(c, &u, &committed, y).expect("forces").1);
    let mean = 0.5 * (form(&mut exact, &a, &b) + form(&mut exact, &b, &a));
    let (ab, ba) = (form(&mut half, &a, &b), form(&mut half, &b, &a));
    assert!((ab - ba).abs() < 1e-10 * ab.abs() && (ab - mean).abs() < 1e-10 * mean.abs(), "{ab} {ba} {mean}");
    assert!(!half.has_products() && exact.has_products());
}

#[test]
fn action_is_reaction() {
    let (mut contact, committed, u) = with_history(0.5, CellKind::Hex8, Smoothing::Spline, options(0.4), 0.02);
    let mesh = crossed(0.5, 0.02, CellKind::Hex8);
    let force = evaluate(&mut contact, &u, &committed, &u).expect("forces").0;
    let mut sum = nalgebra::Vector3::zeros();
    let mut moment = nalgebra::Vector3::zeros();
    for (n, x) in mesh.points.iter().enumerate() {
        let f = nalgebra::Vector3::from_column_slice(&force[3 * n..3 * n + 3]);
        sum += f;
        moment += (x + nalgebra::Vector3::from_column_slice(&u[3 * n..3 * n + 3])).cross(&f);
    }
    assert!(sum.norm() < 1e-12 * norm(&force), "{sum}");
    assert!(moment.norm() < 1e-11 * norm(&force), "{moment}");
}

#[test]
fn a_rigid_motion_of_both_bodies_slips_nothing_and_turns_the_forces() {
    let (mut contact, committed, u) = with_history(0.5, CellKind::Hex8, Smoothing::Spline, options(0.4), 0.02);
    let mesh = crossed(0.5, 0.02, CellKind::Hex8);
    let force = evaluate(&mut contact, &u, &committed, &u).expect("forces").0;
    contact.commit();
    let before = contact.report().work;
    assert!(before > 0.0);
    let turn = nalgebra::Rotation3::from_scaled_axis(nalgebra::Vector3::new(0.7, -1.1, 0.4));
    let mut moved = u.clone();
    for (n, x) in mesh.points.iter().enumerate() {
        let at = turn * (x + nalgebra::Vector3::from_column_slice(&u[3 * n..3 * n + 3]));
        let du = at + nalgebra::Vector3::new(3.0, 2.0, -5.0) - x;
        moved[3 * n..3 * n + 3].copy_from_slice(du.as_slice());
    }
    let turned = evaluate(&mut contact, &moved, &u, &u).expect("forces").0;
    contact.commit();
    assert!((contact.report().work - before).abs() < 1e-10 * before, "{} {before}", contact.report().work);
    for n in 0..mesh.points.len() {
        let f = turn * nalgebra::Vector3::from_column_slice(&force[3 * n..3 * n + 3]);
        let g = nalgebra::Vector3::from_column_slice(&turned[3 * n..3 * n + 3]);
        assert!((f - g).norm() < 1e-9 * norm(&force));
    }
}

#[test]
fn faces_without_a_middle_are_refused() {
    for (kind, smoothing) in [(CellKind::Hex20, Smoothing::Spline), (CellKind::Hex20R, Smoothing::None)] {
        let refused = subrope_contact::Surface::of_faces(&[(0..8).collect()], kind, smoothing);
        assert!(matches!(refused, Err(subrope_contact::ContactError::Serendipity)));
    }
}
