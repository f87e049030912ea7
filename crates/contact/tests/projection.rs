//! The closest point of a surface against closed forms: planes, cylinders, a roof of two facets, a smooth lattice.

#![allow(clippy::expect_used, reason = "a test fails by panicking")]

mod common;

use nalgebra::{Rotation3, Vector3};
use subrope_contact::foot::{Foot, Place, Posture, project};
use subrope_contact::{Smoothing, Surface};
use subrope_geometry::CellKind;

fn at(patch: u32, xi: [f64; 2]) -> Place {
    Place { patch, xi }
}

/// Projects on a surface at rest.
fn onto(surface: &Surface, positions: &[Vector3<f64>], x: Vector3<f64>, from: Place) -> Option<Foot> {
    let displacement = vec![0.0; 3 * positions.len()];
    project(&Posture { surface, positions, displacement: &displacement }, &x, from)
}

/// Nodes of a rigid frame that is turned and displaced.
fn frame(arm: f64) -> (Vec<Vector3<f64>>, Vec<f64>, Rotation3<f64>, Vector3<f64>) {
    let turn = Rotation3::from_scaled_axis(Vector3::new(0.4, -0.9, 0.3));
    let origin = Vector3::new(2.0, -1.0, 0.5);
    let rest = vec![Vector3::zeros(), Vector3::x() * arm, Vector3::y() * arm, Vector3::z() * arm];
    let displacement = rest
        .iter()
        .flat_map(|x| {
            let u = origin + turn * x - x;
            [u.x, u.y, u.z]
        })
        .collect();
    (rest, displacement, turn, origin)
}

#[test]
fn a_plane_answers_coordinates_and_height() {
    let arm = 2.5;
    let (positions, displacement, turn, origin) = frame(arm);
    let surface = Surface::plane([0, 1, 2, 3], arm);
    let posture = Posture { surface: &surface, positions: &positions, displacement: &displacement };
    for [u, v, w] in [[30.0, -4.0, 0.7], [300.0, -4e3, 0.2], [-0.2, 0.1, -0.3], [0.0, 0.0, 0.0]] {
        let x = origin + turn * Vector3::new(u, v, w);
        let foot = project(&posture, &x, at(0, [5.0, 5.0])).expect("a plane has no edge");
        assert!((foot.gap - w).abs() < 1e-13 * (1.0 + v.abs()) && (foot.normal - turn * Vector3::z()).norm() < 1e-14);
        assert!(
            (foot.place.xi[0] - u).abs() + (foot.place.xi[1] - v).abs() < 1e-12 * (1.0 + v.abs()),
            "{:?}",
            foot.place
        );
        assert!((posture.position(&foot.place) + foot.normal * foot.gap - x).norm() < 1e-12 * (1.0 + v.abs()));
    }
}

/// `g = r - R`; the angle is that of the branch nearest to the last one.
#[test]
fn a_cylinder_answers_the_distance_from_its_axis() {
    let (arm, radius) = (0.5, 1.7);
    let (positions, displacement, turn, origin) = frame(arm);
    let surface = Surface::cylinder([0, 1, 2, 3], radius, arm);
    let posture = Posture { surface: &surface, positions: &positions, displacement: &displacement };
    for (distance, angle) in [(2.0, 0.3), (0.8, 2.9), (1.7, -2.0), (40.0, -3.1)] {
        let [u, v]: [f64; 2] = [distance * f64::cos(angle), distance * f64::sin(angle)];
        let x = origin + turn * Vector3::new(u, v, -3.0);
        for turns in [-2.0, 0.0, 3.0] {
            let last = angle + turns * std::f64::consts::TAU;
            for off in [-3.0, 0.4, 3.0] {
                let foot = project(&posture, &x, at(0, [last + off, 1.0])).expect("a cylinder has no edge");
                assert!((foot.gap - (distance - radius)).abs() < 1e-13 * distance);
                assert!((foot.place.xi[0] - last).abs() < 1e-13 * (1.0 + last.abs()), "{:?} {last}", foot.place);
                assert!((foot.place.xi[1] + 3.0).abs() < 1e-13);
                assert!((foot.normal - turn * Vector3::new(angle.cos(), angle.sin(), 0.0)).norm() < 1e-13);
            }
        }
    }
}

/// On the axis every direction is as close: the distance has no minimum, yet a foot is found.
#[test]
fn the_axis_of_a_cylinder_lies_a_radius_deep() {
    let positions = [Vector3::zeros(), Vector3::x(), Vector3::y(), Vector3::z()];
    let surface = Surface::cylinder([0, 1, 2, 3], 1.7, 1.0);
    let foot = onto(&surface, &positions, Vector3::new(0.0, 0.0, 0.4), at(0, [0.0, 0.0])).expect("a foot");
    assert!((foot.gap + 1.7).abs() < 1e-14 && (foot.place.xi[1] - 0.4).abs() < 1e-14);
}

/// Two facets, two wide and two long, that meet at a ridge along y and fall by `slope` \[rad\] to both sides (rise, where it
/// is negative); their corners begin anywhere.
fn roof(slope: f64, turned: [usize; 2]) -> (Surface, Vec<Vector3<f64>>) {
    let (c, s) = (2.0 * slope.cos(), -2.0 * slope.sin());
    let positions = [[-c, -1.0, s], [-c, 1.0, s], [0.0, -1.0, 0.0], [0.0, 1.0, 0.0], [c, -1.0, s], [c, 1.0, s]];
    let mut faces = vec![vec![0, 2, 3, 1], vec![2, 4, 5, 3]];
    faces.iter_mut().zip(turned).for_each(|(f, by)| f.rotate_left(by));
    let surface = Surface::of_faces(&faces, CellKind::Hex8, Smoothing::None).expect("a surface");
    (surface, positions.map(Vector3::from).to_vec())
}

/// All places that the two facets may be entered from.
fn starts() -> Vec<Place> {
    let corners = [[0.0, 0.0], [0.9, 0.2], [-0.9, -0.4], [0.3, 0.9], [-0.1, -0.9]];
    (0..2).flat_map(|patch| corners.map(|xi| at(patch, xi))).collect()
}

fn orders() -> impl Iterator<Item = [usize; 2]> {
    (0..4).flat_map(|a| (0..4).map(move |b| [a, b]))
}

/// Above a ridge both facets decline a point: the one that it leaves less takes it, up to half a facet away.
#[test]
fn the_facet_that_a_point_leaves_less_takes_it() {
    let slope = 0.4_f64;
    let along = [Vector3::new(slope.cos(), 0.0, slope.sin()), Vector3::new(-slope.cos(), 0.0, slope.sin())];
    for turned in orders() {
        let (surface, positions) = roof(slope, turned);
        for [u, v] in [
            [-0.1, 0.6],
            [0.1, 0.6],
            [-0.02, 0.2],
            [0.02, 0.2],
            [-0.3, 0.9],
            [0.3, 0.9],
            [-0.05, 1.1],
            [-0.35, 1.2],
            [0.6, 1.9],
        ] {
            let x = Vector3::new(u, 0.3, v);
            let over = along.map(|e| e.dot(&x));
            assert!(over[0] > 0.0 && over[1] > 0.0, "both decline it");
            let nearer = usize::from(u > 0.0);
            for from in starts() {
                let foot = onto(&surface, &positions, x, from).expect("a foot");
                assert_eq!(foot.place.patch as usize, nearer, "{turned:?} {x} from {from:?}");
                let expected = along[nearer] * over[nearer] + Vector3::y() * 0.3;
                assert!((foot.local.position - expected).norm() < 1e-12, "{} {expected}", foot.local.position);
                assert!((foot.gap - (x - expected).norm()).abs() < 1e-12);
            }
        }
        // v sin(slope) - |u| cos(slope) > 1/2: no facet has it.
        for x in [Vector3::new(-0.05, 0.3, 1.5), Vector3::new(0.05, -0.3, 1.5)] {
            assert!(starts().into_iter().all(|from| onto(&surface, &positions, x, from).is_none()));
        }
    }
}

/// A point above one facet of a roof, from wherever the search starts, the other facet too.
#[test]
fn facets_hand_over_a_point() {
    for slope in [0.4_f64, 0.0, -0.1] {
        let normal = Vector3::new(-slope.sin(), 0.0, slope.cos());
        let down = Vector3::new(-slope.cos(), 0.0, -slope.sin());
        for turned in orders() {
            let (surface, positions) = roof(slope, turned);
            for [s, y, g] in [[1.0, 0.0, 0.2], [0.2, 0.9, 0.1], [1.95, -0.8, 0.3], [0.6, 0.99, -0.05]] {
                let foot = down * s + Vector3::y() * y;
                for from in starts() {
                    let found = onto(&surface, &positions, foot + normal * g, from).expect("a foot");
                    assert_eq!(found.place.patch, 0);
                    assert!((found.local.position - foot).norm() < 1e-12 && (found.gap - g).abs() < 1e-12);
                }
            }
        }
    }
}

#[test]
fn beyond_the_edge_of_the_surface_there_is_no_foot() {
    for turned in orders() {
        let (surface, positions) = roof(0.0, turned);
        for out in [[2.01, 0.0], [-2.01, 0.3], [0.5, 1.01], [0.5, -1.01], [-9.0, 7.0]] {
            let x = Vector3::new(out[0], out[1], 0.1);
            assert!(starts().into_iter().all(|from| onto(&surface, &positions, x, from).is_none()), "{x}");
        }
        for inside in [[1.99, 0.0], [-1.99, 0.3], [0.5, 0.99], [0.5, -0.99], [2.0, 1.0]] {
            let x = Vector3::new(inside[0], inside[1], 0.1);
            assert!(starts().into_iter().all(|from| onto(&surface, &positions, x, from).is_some()), "{x}");
        }
    }
}

const CELLS: usize = 6;

/// A smooth surface over a lattice of unit cells, `z` a function of place.
fn lattice(z: impl Fn(f64, f64) -> f64) -> (Surface, Vec<Vector3<f64>>) {
    lattice_of(Smoothing::Spline, z)
}

fn lattice_of(smoothing: Smoothing, z: impl Fn(f64, f64) -> f64) -> (Surface, Vec<Vector3<f64>>) {
    let node = |i: usize, j: usize| (j * (CELLS + 1) + i) as u32;
    let cell = |k: usize| {
        let (i, j) = (k % CELLS, k / CELLS);
        vec![node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)]
    };
    let faces: Vec<Vec<u32>> = (0..CELLS * CELLS).map(cell).collect();
    let surface = Surface::of_faces(&faces, CellKind::Hex8, smoothing).expect("a surface");
    let place = |n: usize| ((n % (CELLS + 1)) as f64, (n / (CELLS + 1)) as f64);
    let positions = (0..(CELLS + 1) * (CELLS + 1)).map(place).map(|(x, y)| Vector3::new(x, y, z(x, y))).collect();
    (surface, positions)
}

/// The foot on a bent surface: orthogonal, the same from everywhere, and no sampled point is closer.
#[test]
fn the_foot_on_a_smooth_surface_is_the_closest_point() {
    let (surface, positions) = lattice(|x, y| 0.04 * (x - 3.0).powi(2) - 0.03 * (y - 3.0).powi(2) + 0.02 * x * y);
    let rest = vec![0.0; 3 * positions.len()];
    let posture = Posture { surface: &surface, positions: &positions, displacement: &rest };
    for [x, y, z] in [[2.7, 3.4, 1.0], [1.2, 4.6, -0.4], [4.1, 1.3, 1.5], [0.6, 0.7, 0.5], [5.2, 5.4, 0.2]] {
        let x = Vector3::new(x, y, z);
        let closest = |patch: u32| {
            let grid = (0..11 * 11).map(|k| [f64::from(k % 11) / 5.0 - 1.0, f64::from(k / 11) / 5.0 - 1.0]);
            grid.map(|xi| (posture.position(&at(patch, xi)) - x).norm()).fold(f64::INFINITY, f64::min)
        };
        let sampled = (0..surface.patch_count() as u32).map(closest).fold(f64::INFINITY, f64::min);
        let mut first: Option<Vector3<f64>> = None;
        for patch in 0..surface.patch_count() as u32 {
            let foot = project(&posture, &x, at(patch, [0.5, -0.5])).expect("a foot");
            let r = x - foot.local.position;
            assert!(foot.local.tangents.iter().all(|a| a.dot(&r).abs() < 1e-12), "{:?}", foot.place);
            assert!(foot.gap.abs() <= sampled && foot.gap.abs() > sampled - 0.02, "{} {sampled}", foot.gap);
            assert!((r - foot.normal * foot.gap).norm() < 1e-12, "the gap has a sign");
            let known = *first.get_or_insert(foot.local.position);
            assert!((known - foot.local.position).norm() < 1e-12);
        }
    }
}

/// Beyond the centre of curvature the distance has a maximum on top of the bowl; the foot is none of those.
#[test]
fn a_foot_is_a_minimum_of_the_distance() {
    let (surface, positions) = lattice(|x, y| 0.25 * (x - 3.0).powi(2) + 0.002 * (y - 3.0).powi(2));
    let rest = vec![0.0; 3 * positions.len()];
    let posture = Posture { surface: &surface, positions: &positions, displacement: &rest };
    // Radius of curvature 2 along x: from 2.8 up the bottom is a maximum along x.
    let x = Vector3::new(3.05, 3.2, 3.4);
    for xi in [[0.0, 0.0], [-0.9, 0.3], [0.2, -0.8]] {
        for patch in [14, 15, 20, 21] {
            let foot = project(&posture, &x, at(patch, xi)).expect("a foot");
            let p = foot.local.position;
            let hessian = foot.local.metric() - foot.local.bending(&(x - p));
            assert!(hessian[(0, 0)] > 0.0 && hessian.determinant() > 0.0, "{hessian}");
            assert!((p.x - 3.0).abs() > 0.5, "not at the bottom: {p}");
        }
    }
}

/// High above a dome the metric alone, without curvature, steps too far and back for ever. In any unit of length.
#[test]
fn a_dome_has_a_foot_for_points_high_above() {
    for unit in [1e-3, 1.0, 1e3] {
        let (surface, mut positions) = lattice(|x, y| -0.1 * ((x - 3.0).powi(2) + (y - 3.0).powi(2)));
        positions.iter_mut().for_each(|p| *p *= unit);
        for x in [Vector3::new(3.4, 2.8, 12.0), Vector3::new(2.1, 3.3, 20.0)] {
            for patch in [7, 14, 20, 28] {
                let foot = onto(&surface, &positions, x * unit, at(patch, [0.3, -0.3])).expect("a foot");
                let r = x - foot.local.position / unit;
                assert!(foot.local.tangents.iter().all(|a| a.dot(&r).abs() < 1e-11 * unit));
                assert!((foot.local.position / unit - Vector3::new(3.0, 3.0, 0.0)).norm() < 0.5, "near the top");
            }
        }
    }
}

/// A plane of facets that are no parallelograms, to its corners, from wherever the search starts.
#[test]
fn crooked_facets_find_every_point_of_a_plane() {
    let mut noise = common::Noise(7);
    for _ in 0..100 {
        let (surface, mut positions) = lattice_of(Smoothing::None, |_, _| 0.0);
        for p in &mut positions {
            let inside = |x: f64| x > 0.5 && x < CELLS as f64 - 0.5;
            p.x += if inside(p.x) { 0.2 * noise.next() } else { 0.0 };
            p.y += if inside(p.y) { 0.2 * noise.next() } else { 0.0 };
        }
        for [u, v] in [[0.01, 0.01], [5.99, 0.02], [0.02, 5.97], [5.98, 5.98], [3.1, 0.01], [2.2, 4.7]] {
            let x = Vector3::new(u, v, -0.001);
            for patch in 0..surface.patch_count() as u32 {
                let foot = onto(&surface, &positions, x, at(patch, [0.0; 2])).expect("a foot");
                assert!((foot.gap + 0.001).abs() < 1e-12 && (foot.local.position - x).norm() < 1.001e-3);
            }
        }
    }
}
