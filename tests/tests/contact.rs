//! Contact: patch test, Hertz, Coulomb friction, frame indifference.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::f64::consts::PI;

use nalgebra::{Matrix3, Rotation3, Vector3};
use subrope_contact::{Contact, ContactOptions, History, Smoothing, Surface};
use subrope_fem::analysis::{Analysis, Control, IncrementRecord, Increments, NewtonOptions, Observer, PathControl};
use subrope_fem::kinematics::{NodeRule, Section};
use subrope_fem::{Contribution, FemError};
use subrope_geometry::{CellKind, Face, Strand, strand::sets};
use subrope_material::StVenantKirchhoff;
use subrope_tests::{Bodies, Body, Brick, Problem, Recorder, Row, brick, close, constant_frames, rigid};

// ------------------------------------------------------------------------------------------------------------ helpers

/// Penalties and coefficient of friction; everything within `reach` may touch.
fn options(penalty: f64, friction: f64, reach: f64) -> ContactOptions {
    ContactOptions { penalty, tangential_penalty: penalty, friction, reach, ..ContactOptions::new(1.0, 1.0) }
}

/// Isotropic bodies with contacts.
fn problem(bodies: &Bodies, law: (f64, f64), contacts: Vec<Contact>, sections: Vec<Section>) -> Problem {
    let mesh = &bodies.mesh;
    let law = StVenantKirchhoff::isotropic(law.0, law.1).unwrap();
    let solid = brick(Brick::MeanVolume, mesh, &constant_frames(mesh, Matrix3::identity()), law).unwrap();
    let mut contributions = vec![solid];
    contributions.extend(contacts.into_iter().map(|c| Box::new(c) as Box<dyn Contribution>));
    let options = NewtonOptions { force_tolerance: 1e-9, ..NewtonOptions::default() };
    Problem::of(mesh, contributions, sections, options).unwrap()
}

/// The contact of a problem.
fn contact(problem: &Problem) -> &Contact {
    let contributions = &problem.analysis.model().contributions;
    contributions.iter().find_map(|c| c.as_any().and_then(|a| a.downcast_ref())).unwrap()
}

/// States of the touching points with their areas.
fn touching(problem: &Problem) -> Vec<(f64, History)> {
    contact(problem).points().filter(|p| p.state.pressure > 0.0).map(|p| (p.area, *p.state)).collect()
}

/// Nodes of no section.
fn free_nodes(problem: &Problem) -> Vec<u32> {
    let rules = problem.analysis.model().kinematics.rules().iter();
    (0..).zip(rules).filter(|(_, r)| matches!(r, NodeRule::Free { .. })).map(|(n, _)| n).collect()
}

fn automatic(initial: f64) -> Increments {
    Increments::Automatic { control: PathControl::Load, initial, minimum: 1e-3, maximum: 1.0, max_count: 100 }
}

// -------------------------------------------------------------------------------------------------------------- patch

/// A prism over a 36-gon of radius 5: a square lattice of `n` bricks along a side, turned by `turn`.
fn polygon(bodies: &mut Bodies, n: usize, turn: f64, [low, high]: [f64; 2]) -> Body {
    // Rings of the square become rings of the polygon; its sides are even parts of 10 degrees.
    let corner = |k: f64| {
        let part = k.floor();
        let at = |i: f64| Rotation3::from_axis_angle(&Vector3::z_axis(), (45.0 + 10.0 * i).to_radians() + turn);
        (at(part) * Vector3::x()).lerp(&(at(part + 1.0) * Vector3::x()), k - part)
    };
    bodies.add([n, n, 2], |[x, y, z]| {
        let (u, v) = (2.0 * x - 1.0, 2.0 * y - 1.0);
        let size = u.abs().max(v.abs());
        let round = if size == 0.0 {
            Vector3::zeros()
        } else {
            let (u, v) = (u / size, v / size);
            // Way around the square from the corner (1, 1), counter-clockwise, a side being 9 parts.
            let way = if v == 1.0 {
                0.5 * (1.0 - u)
            } else if u == -1.0 {
                1.0 + 0.5 * (1.0 - v)
            } else if v == -1.0 {
                2.0 + 0.5 * (1.0 + u)
            } else {
                3.0 + 0.5 * (1.0 + v)
            };
            corner(9.0 * way)
        };
        let square = Vector3::new(u, v, 0.0) * 0.7;
        let square = Rotation3::from_axis_angle(&Vector3::z_axis(), turn) * square;
        // The middle stays a square.
        let at = (round * size * size + square * (1.0 - size)) * 5.0;
        [at.x, at.y, low + (high - low) * z]
    })
}

/// Lowest and highest pressure over the mean: everywhere, and further than a quarter of the radius from the edge.
fn pressed_polygons(smoothing: Smoothing, points: usize) -> [[f64; 2]; 2] {
    let mut bodies = Bodies::new(CellKind::Hex8);
    let lower = polygon(&mut bodies, 9, 0.0, [0.0, 5.0]);
    let upper = polygon(&mut bodies, 18, 20_f64.to_radians(), [5.0, 9.0]);
    let surfaces = [(&lower, true), (&upper, false)].map(|(b, end)| bodies.surface(b, 2, end, smoothing));
    let [primary, secondary] = surfaces;
    let options = ContactOptions { points: [points; 2], ..options(1e4, 0.0, 1.0) };
    let pair = Contact::new("pair", primary, secondary, &bodies.mesh.points, options).unwrap();
    let (bottom, top) = (lower.face(2, false), upper.face(2, true));
    let mut problem = problem(&bodies, (100.0, 0.3), vec![pair], Vec::new());
    let mut step = problem.step(automatic(1.0)).nodes(&bottom, 2, 0.0).nodes(&top, 2, -0.09);
    for nodes in [&bottom, &top] {
        // Three motions in the plane.
        let x = |n: u32| bodies.mesh.points[n as usize];
        let far = |s: f64| {
            let at = Vector3::new(s * 5_f64.to_radians().cos(), 5_f64.to_radians().sin(), 0.0) * 5.0;
            *nodes.iter().min_by(|a, b| (x(**a) - at).xy().norm().total_cmp(&(x(**b) - at).xy().norm())).unwrap()
        };
        step = step.nodes(&[far(1.0)], 0, 0.0).nodes(&[far(1.0), far(-1.0)], 1, 0.0);
    }
    let step = step.build();
    let rows = problem.run(&step).unwrap();
    let states = touching(&problem);
    let area: f64 = contact(&problem).points().map(|p| p.area).sum();
    let force = problem.reaction(&bottom).z;
    let mean = force / area;
    let mut range = [[f64::INFINITY, 0.0_f64]; 2];
    let places = contact(&problem).places(problem.analysis.displacement());
    for (point, place) in contact(&problem).points().zip(places) {
        let p = point.state.pressure / mean;
        let inside = place.xy().norm() < 3.75;
        range.iter_mut().take(1 + usize::from(inside)).for_each(|r| *r = [r[0].min(p), r[1].max(p)]);
    }
    let approach = states.iter().map(|(a, s)| -s.gap * a).sum::<f64>() / area;
    println!(
        "{smoothing:?}, {points} points: pressure {:.4} to {:.4} (inside {:.4} to {:.4}) of {mean:.5}, penetration {approach:.4e}, p/eps {:.4e}, \
         {} of {} points, {} iterations",
        range[0][0],
        range[0][1],
        range[1][0],
        range[1][1],
        mean / 1e4,
        states.len(),
        contact(&problem).points().count(),
        rows[0].record.iterations
    );
    close("penetration", approach, mean / 1e4, 1e-2);
    range
}

#[test]
fn pressed_blocks_have_a_uniform_pressure() {
    let [everywhere, _] = pressed_polygons(Smoothing::None, 6);
    assert!(everywhere[0] > 0.98 && everywhere[1] < 1.02, "{everywhere:?}");
}

#[test]
fn a_spline_is_uniform_away_from_the_edges_of_flat_blocks() {
    // Uniform pressure loads its nodes by other shares than the bricks need where mesh lines end or have a kink: the outer
    // rows bend, and so do, less, those along the diagonals of this mesh.
    let [_, inside] = pressed_polygons(Smoothing::Spline, 6);
    assert!(inside[0] > 0.85 && inside[1] < 1.15, "{inside:?}");
}

// ----------------------------------------------------------------------------------------------------------- friction

/// A block of size 2 x 2 x 1 on a rigid plane: reference points 0 (top of the block, or all of it) and 1 (plane).
fn block_on_plane(stiff: bool, friction: f64, penalty: f64) -> Problem {
    let mut bodies = Bodies::new(CellKind::Hex8);
    let block = bodies.add([4, 4, 2], |[x, y, z]| [2.0 * x - 1.0, 2.0 * y - 1.0, z]);
    let frame = bodies.frame(Vector3::zeros(), &Matrix3::identity(), 1.0);
    let secondary = bodies.surface(&block, 2, false, Smoothing::None);
    let options = ContactOptions { points: [2, 2], ..options(penalty, friction, 1.0) };
    let primary = Surface::plane(frame, 1.0);
    let pair = Contact::new("pair", primary, secondary, &bodies.mesh.points, options).unwrap();
    let nodes = if stiff { block.nodes() } else { block.face(2, true) };
    let sections = vec![rigid("block", Vector3::new(0.0, 0.0, 1.0), &nodes), rigid("plane", Vector3::zeros(), &frame)];
    problem(&bodies, (1000.0, 0.3), vec![pair], sections)
}

#[test]
fn a_sliding_block_dissipates_its_loop() {
    let (mu, normal, amplitude, penalty) = (0.3, 20.0, 0.02, 1e3);
    let mut problem = block_on_plane(true, mu, penalty);
    let press = problem.step(automatic(1.0)).hold(1, &[]).hold(0, &[]).point(0, 2, -1e-3).build();
    problem.run(&press).unwrap();
    let load = problem.step(automatic(1.0)).hold(1, &[]).hold(0, &[2]).load(0, 2, 0.0, -normal).build();
    problem.run(&load).unwrap();
    let cycle = problem
        .step(Increments::Fixed(40))
        .hold(1, &[])
        .hold(0, &[0, 2])
        .point_path(0, 0, move |s| {
            amplitude * (1.0 - (4.0 * ((s + 0.25).fract() - 0.5).abs() - 1.0).mul_add(-1.0, 1.0))
        })
        .load(0, 2, -normal, -normal)
        .build();
    let mut work = [0.0; 3];
    for w in &mut work {
        let before = problem.analysis.totals().contact_friction;
        problem.run(&cycle).unwrap();
        *w = problem.analysis.totals().contact_friction - before;
    }
    let exact = 4.0 * mu * normal * (amplitude - mu * normal / (4.0 * penalty));
    println!("work per cycle {work:?}, exact {exact}, error {:e}", problem.analysis.totals().energy_error());
    close("work per cycle", work[2], exact, 1e-8);
}

/// A rigid block on a plane that `degrees` incline, its weight growing; the reason if it finds no equilibrium.
fn incline(mu: f64, degrees: f64) -> Result<f64, FemError> {
    let mut problem = block_on_plane(true, mu, 1e3);
    let press = problem.step(automatic(1.0)).hold(1, &[]).hold(0, &[]).point(0, 2, -1e-3).build();
    problem.run(&press)?;
    let (weight, angle) = (10.0, degrees.to_radians());
    let load = problem
        .step(automatic(0.5))
        .hold(1, &[])
        .hold(0, &[0, 2])
        .load(0, 2, 0.0, -weight * angle.cos())
        .load(0, 0, 0.0, weight * angle.sin())
        .build();
    problem.run(&load)?;
    let (displacement, _) = problem.analysis.model().kinematics.point_motion(0, problem.analysis.coordinates());
    Ok(displacement.x)
}

#[test]
fn a_block_sticks_to_an_incline_up_to_the_angle_of_friction() {
    let mu = 0.3_f64;
    let angle = mu.atan().to_degrees();
    let stuck = incline(mu, angle - 0.1).unwrap();
    close("elastic slip", stuck, 10.0 * (angle - 0.1).to_radians().sin() / (4.0 * 1e3), 1e-6);
    let error = incline(mu, angle + 0.1).unwrap_err();
    println!("beyond the angle of friction: {error}");
    // The first press fades over the step, and with it what it adds to the limit of friction.
    let (sine, cosine) = (angle + 0.1).to_radians().sin_cos();
    let slips = 4.0 * mu / (4.0 * mu + 10.0 * (sine - mu * cosine));
    assert!(
        matches!(error, FemError::IncrementTooShort { fraction, .. } if fraction <= slips && fraction > slips - 0.01),
        "{error}, expected at {slips}"
    );
}

/// A thin strip around half a rigid cylinder of radius 5, with straight ends; tensions of both ends in full slip.
fn capstan(mu: f64, cells: usize, smoothing: Smoothing) -> [f64; 2] {
    const THICKNESS: f64 = 0.05;
    const TAIL: f64 = 2.0;
    let (radius, arc) = (5.0, 5.0 * PI);
    let mut bodies = Bodies::new(CellKind::Hex8);
    let strip = bodies.add([cells, 1, 1], |[s, w, t]| {
        let (way, r) = ((arc + 2.0 * TAIL) * s - TAIL, radius + THICKNESS * t);
        let angle = (way / radius).clamp(0.0, PI);
        let tail = (-way).max(0.0) + (way - arc).max(0.0);
        [r * angle.cos(), r * angle.sin() - tail, w]
    });
    let axes = Matrix3::identity();
    let frame = bodies.frame(Vector3::zeros(), &axes, 1.0);
    let secondary = bodies.surface(&strip, 2, false, smoothing);
    let options = ContactOptions { points: [3, 2], tangential_penalty: 1e4, ..options(1e3, mu, 0.5) };
    let pair = Contact::new("pair", Surface::cylinder(frame, radius, 1.0), secondary, &bodies.mesh.points, options);
    let (first, last) = (strip.face(0, false), strip.face(0, true));
    let ends = [(&first, radius), (&last, -radius)].map(|(n, x)| rigid("end", Vector3::new(x, -TAIL, 0.5), n));
    let [one, two] = ends;
    let sections = vec![one, two, rigid("cylinder", Vector3::zeros(), &frame)];
    let mut problem = problem(&bodies, (5000.0, 0.0), vec![pair.unwrap()], sections);
    let inner: Vec<u32> = strip.nodes().into_iter().filter(|n| !first.contains(n) && !last.contains(n)).collect();
    let tighten = problem
        .step(automatic(0.1))
        .hold(2, &[])
        .hold(0, &[])
        .hold(1, &[])
        .nodes(&inner, 2, 0.0)
        .point(0, 1, -0.15)
        .point(1, 1, -0.15)
        .build();
    problem.run(&tighten).unwrap();
    let load = problem.step(automatic(0.2)).hold(2, &[]).hold(0, &[1]).point(1, 1, -0.15).nodes(&inner, 2, 0.0);
    let load = load.hold(1, &[1]).load(0, 1, 0.0, -10.0).build();
    problem.run(&load).unwrap();
    let pull = problem
        .step(automatic(0.1))
        .hold(2, &[])
        .hold(0, &[1])
        .hold(1, &[])
        .point(1, 1, -1.5)
        .nodes(&inner, 2, 0.0)
        .load(0, 1, -10.0, -10.0)
        .build();
    let rows = problem.run(&pull).unwrap();
    let tension = |row: &Row| [-row.reaction[0][0].y, -row.reaction[1][0].y];
    for row in &rows {
        println!("{:.3} {:?} {} iterations", row.record.fraction, tension(row), row.record.iterations);
    }
    println!("energy error {:e}", problem.analysis.totals().energy_error());
    tension(rows.last().unwrap())
}

#[test]
fn a_strip_around_a_cylinder_follows_the_capstan_equation() {
    let mu = 0.15;
    let [slack, taut] = capstan(mu, 60, Smoothing::None);
    let exact = (mu * PI).exp();
    println!("capstan {} of {exact}", taut / slack);
    close("tension ratio", taut / slack, exact, 0.02);
}

// -------------------------------------------------------------------------------------------------------------- Hertz

/// Graded parameter: 0 to 1 with small parts at 0.
fn graded(t: f64, beta: f64) -> f64 {
    (beta * t).sinh() / beta.sinh()
}

/// A slice of a cylinder of radius 5 about (0, 5 `side`), its apex at the origin, flat beyond its middle.
fn half_cylinder(bodies: &mut Bodies, side: f64, [around, deep]: [usize; 2], depth: f64) -> Body {
    const WIDEST: f64 = 1.0;
    bodies.add([around, deep, 1], |[s, t, w]| {
        // Counter-clockwise for both.
        let u = (2.0 * s - 1.0) * side;
        let angle = u.signum() * graded(u.abs(), 4.3) * WIDEST;
        let (low, high) = (5.0 - 5.0 * angle.cos(), depth);
        [5.0 * angle.sin(), side * (low + (high - low) * graded(t, 5.6)), 0.1 * w]
    })
}

/// What a pressed line contact shows.
struct Line {
    force: f64,
    half_width: f64,
    peak: f64,
    problem: Problem,
}

/// Two half cylinders of E 2000, nu .4, pressed by `approach`; the upper one carries the points, or the lower one.
fn two_cylinders(mesh: [[usize; 2]; 2], friction: f64, swapped: bool, approach: f64) -> Line {
    let mut bodies = Bodies::new(CellKind::Hex8);
    let lower = half_cylinder(&mut bodies, -1.0, mesh[0], 5.0);
    let upper = half_cylinder(&mut bodies, 1.0, mesh[1], 5.0);
    let [one, two] = [&lower, &upper].map(|b| bodies.surface(b, 1, false, Smoothing::Spline));
    let (primary, secondary) = if swapped { (two, one) } else { (one, two) };
    let options = ContactOptions { points: [6, 1], tangential_penalty: 1e6, ..options(1e6, friction, 0.2) };
    let pair = Contact::new("pair", primary, secondary, &bodies.mesh.points, options).unwrap();
    let sections =
        [(&lower, -5.0), (&upper, 5.0)].map(|(b, y)| rigid("flat", Vector3::new(0.0, y, 0.05), &b.face(1, true)));
    let inner: Vec<u32> = [&lower, &upper]
        .iter()
        .flat_map(|b| {
            let flat = b.face(1, true);
            b.nodes().into_iter().filter(move |n| !flat.contains(n))
        })
        .collect();
    let mut problem = problem(&bodies, (2000.0, 0.4), vec![pair], sections.to_vec());
    let step = problem.step(automatic(0.5)).hold(0, &[]).hold(1, &[]).point(1, 1, -approach).nodes(&inner, 2, 0.0);
    let step = step.build();
    let rows = problem.run(&step).unwrap();
    let states = touching(&problem);
    let force = states.iter().map(|(a, s)| a * s.pressure).sum::<f64>() / 0.1;
    let reaction = rows.last().unwrap().reaction[1][0] / 0.1;
    let carried = contact(&problem);
    let peak = states.iter().fold(0.0_f64, |m, (_, s)| m.max(s.pressure));
    // Second moment of an elliptic pressure: a^2/4.
    let moment: f64 = carried
        .points()
        .zip(carried.places(problem.analysis.displacement()))
        .map(|(p, x)| p.area * p.state.pressure * x.x * x.x)
        .sum();
    let half_width = 2.0 * (moment / 0.1 / force).sqrt();
    println!(
        "{} touch; force {force} N/mm, reaction {:?}, a {half_width}, p0 {peak}, iterations {:?}",
        states.len(),
        reaction.as_slice(),
        rows.iter().map(|r| r.record.iterations).collect::<Vec<_>>()
    );
    Line { force, half_width, peak, problem }
}

/// Half width and peak pressure of Hertz's line contact of two equal cylinders of radius 5, E 2000, nu .4.
fn hertz_line(force: f64) -> [f64; 2] {
    let (radius, modulus) = (2.5, 2000.0 / (2.0 * (1.0 - 0.16)));
    let a = (4.0 * force * radius / (PI * modulus)).sqrt();
    [a, 2.0 * force / (PI * a)]
}

#[test]
fn equal_cylinders_press_as_hertz_says() {
    let [a, p0] = hertz_line(10.0);
    close("formula", a, 0.163518, 1e-5);
    close("formula", p0, 38.9328, 1e-5);
    let line = two_cylinders([[56, 14], [60, 16]], 0.0, false, 0.0215);
    let [a, p0] = hertz_line(line.force);
    println!("half width {:.4} of Hertz, peak {:.4}", line.half_width / a, line.peak / p0);
    close("half width", line.half_width, a, 0.02);
    close("peak", line.peak, p0, 0.02);
    let mut pressed = line.problem;
    let load = pressed.step(automatic(0.5)).hold(0, &[]).hold(1, &[1]).load(1, 1, 0.0, -1.0);
    let load = load.nodes(&free_nodes(&pressed), 2, 0.0).build();
    pressed.run(&load).unwrap();
    let report = contact(&pressed).report();
    println!("under 10 N/mm: {report:?}, half width by area {}", report.area / 0.1 / 2.0);
    close("force", report.normal, 1.0, 1e-3);
    close("peak at 10 N/mm", report.pressure, 38.9328, 0.03);
    let swapped = two_cylinders([[56, 14], [60, 16]], 0.0, true, 0.0215);
    println!("exchanged: force {:.5}, peak {:.5}", swapped.force / line.force, swapped.peak / line.peak);
    close("exchanged, force", swapped.force, line.force, 0.01);
    close("exchanged, peak", swapped.peak, line.peak, 0.01);
}

/// A recorder that also follows a node along y.
#[derive(Default)]
struct Follow {
    recorder: Recorder,
    node: u32,
    path: Vec<f64>,
}

impl Observer for Follow {
    fn converged(&mut self, analysis: &Analysis, record: &IncrementRecord) -> Result<Control, FemError> {
        self.path.push(analysis.displacement()[3 * self.node as usize + 1]);
        self.recorder.converged(analysis, record)
    }
}

/// Force against approach of a cylinder on an equal rigid one across it: quarter model.
///
/// The approach is that to a point on the axis of the contact, well below it yet far from the ends of the body, plus what
/// a point force moves that point of a half-space.
fn crossed_cylinders(cells: [usize; 3], approach: f64, increments: usize) -> Vec<[f64; 2]> {
    const DEEP: f64 = 20.0;
    let mut bodies = Bodies::new(CellKind::Hex8);
    let [around, deep, along] = cells;
    let body = bodies.add([around, deep, along], |[s, t, w]| {
        let angle = graded(s, 4.3);
        let low = 5.0 - 5.0 * angle.cos();
        [5.0 * angle.sin(), low + (DEEP - low) * graded(t, 7.0), -5.0 * graded(1.0 - w, 4.3)]
    });
    let axes = Matrix3::from_columns(&[Vector3::y(), Vector3::z(), Vector3::x()]);
    let frame = bodies.frame(Vector3::new(0.0, -5.0, 0.0), &axes, 1.0);
    let secondary = bodies.surface(&body, 1, false, Smoothing::None);
    let options = ContactOptions { points: [4, 4], ..options(1e6, 0.0, 0.2) };
    let primary = Surface::cylinder(frame, 5.0, 1.0);
    let pair = Contact::new("pair", primary, secondary, &bodies.mesh.points, options).unwrap();
    let middle = *body
        .nodes()
        .iter()
        .find(|n| {
            let x = bodies.mesh.points[**n as usize];
            x.x == 0.0 && x.z == 0.0 && x.y > 1.5
        })
        .unwrap();
    let depth = bodies.mesh.points[middle as usize].y;
    let sections = vec![rigid("rod", Vector3::new(0.0, -5.0, 0.0), &frame)];
    let mut problem = problem(&bodies, (2000.0, 0.4), vec![pair], sections);
    let step = problem
        .step(Increments::Fixed(increments))
        .nodes(&body.face(1, true), 1, 0.0)
        .nodes(&body.face(0, false), 0, 0.0)
        .nodes(&body.face(2, true), 2, 0.0)
        .hold(0, &[])
        .point(0, 1, approach)
        .build();
    let mut deep = Follow { node: middle, ..Follow::default() };
    problem.analysis.run_step(&step, &mut deep).unwrap();
    let rows = &deep.recorder.rows;
    println!("depth {depth}, iterations {:?}", rows.iter().map(|r| r.record.iterations).collect::<Vec<_>>());
    let place = |(r, back): (&Row, &f64)| {
        let force = 4.0 * r.reaction[0][0].y;
        let sunk = force * 1.4 * 2.2 / (2.0 * PI * 2000.0 * depth);
        [r.motion[0][0].y - back + sunk, force]
    };
    rows.iter().zip(&deep.path).map(place).collect()
}

#[test]
fn crossed_cylinders_follow_the_power_of_three_halves() {
    // Of a rigid and an elastic cylinder: twice the modulus of two elastic ones.
    let modulus = 2000.0 / (1.0 - 0.16);
    let hertz = |approach: f64| 4.0 / 3.0 * modulus * 5.0_f64.sqrt() * approach.powf(1.5);
    close("formula", hertz(0.0199482), 20.0, 1e-5);
    let curve = crossed_cylinders([14, 14, 14], 0.02, 4);
    for [approach, force] in &curve {
        println!("approach {approach:.5}: force {force:.5}, {:.5} of Hertz", force / hertz(*approach));
    }
    let [first, .., last] = &curve[..] else { unreachable!() };
    let exponent = (last[1] / curve[1][1]).ln() / (last[0] / curve[1][0]).ln();
    println!("exponent {exponent}, from the first {}", (last[1] / first[1]).ln() / (last[0] / first[0]).ln());
    close("exponent", exponent, 1.5, 0.02);
    close("force", last[1], hertz(last[0]), 0.04);
}

#[test]
fn pressed_and_pulled_cylinders_stick_in_the_middle() {
    let mu = 0.5;
    let Line { mut problem, force, half_width, .. } = two_cylinders([[90, 12], [96, 13]], mu, false, 0.03);
    let free = free_nodes(&problem);
    let pull = problem
        .step(Increments::Fixed(6))
        .hold(0, &[])
        .hold(1, &[])
        .point(1, 1, -0.03)
        .point(1, 0, 0.018)
        .nodes(&free, 2, 0.0)
        .build();
    let rows = problem.run(&pull).unwrap();
    let row = rows.last().unwrap();
    let ratio = row.reaction[1][0].x / (-row.reaction[1][0].y * mu);
    let states = touching(&problem);
    let sticks = |s: &History| s.elastic_length * 1e6 < mu * s.pressure * (1.0 - 1e-9);
    let stuck: f64 = states.iter().filter(|(_, s)| sticks(s)).map(|(a, _)| a).sum();
    let zone = stuck / 0.1 / 2.0 / half_width;
    let iterations: Vec<usize> = rows.iter().map(|r| r.record.iterations).collect();
    println!(
        "Q/(mu P) {ratio:.5} (force {force}), c/a {zone:.5}, Cattaneo {:.5}, energy error {:e}, iterations {iterations:?}",
        (1.0 - ratio).sqrt(),
        problem.analysis.totals().energy_error()
    );
    close("stick zone", zone, (1.0 - ratio).sqrt(), 0.05);
}

// ----------------------------------------------------------------------------------------------------------- symmetry

#[test]
fn a_rigid_motion_of_the_scene_slips_nothing() {
    let mut problem = block_on_plane(false, 0.3, 1e4);
    let press = problem.step(automatic(1.0)).hold(1, &[]).hold(0, &[]).point(0, 2, -0.02).build();
    problem.run(&press).unwrap();
    let shear =
        problem.step(Increments::Fixed(5)).hold(1, &[]).hold(0, &[]).point(0, 2, -0.02).point(0, 0, 0.012).build();
    problem.run(&shear).unwrap();
    let before = *problem.analysis.totals();
    let (axis, centre) = (Vector3::new(0.3, -0.8, 0.5).normalize(), Vector3::new(3.0, -2.0, 5.0));
    let places = [Vector3::new(0.0, 0.0, 1.0), Vector3::zeros()];
    let mut step = problem.step(Increments::Fixed(12));
    for (index, place) in places.into_iter().enumerate() {
        let now = place + if index == 0 { Vector3::new(0.012, 0.0, -0.02) } else { Vector3::zeros() };
        for k in 0..3 {
            step = step
                .point_path(index, k, move |s| {
                    let turn = Rotation3::from_scaled_axis(axis * (s * 0.5 * PI));
                    (turn * (now - centre) + centre + Vector3::new(1.0, 2.0, -1.0) * s - place)[k as usize]
                })
                .point_path(index, 3 + k, move |s| axis[k as usize] * (s * 0.5 * PI));
        }
    }
    let step = step.build();
    let rows = problem.run(&step).unwrap();
    let after = *problem.analysis.totals();
    let iterations: Vec<usize> = rows.iter().map(|r| r.record.iterations).collect();
    println!(
        "friction {} before, {:e} more; stored {} and {:e} more; iterations {iterations:?}",
        before.contact_friction,
        after.contact_friction - before.contact_friction,
        before.stored,
        after.stored - before.stored
    );
    assert!(before.contact_friction > 1e-4);
    close("friction", after.contact_friction, before.contact_friction, 1e-9);
    close("stored", after.stored, before.stored, 1e-7);
}

#[test]
fn the_energy_balance_closes_with_the_increments() {
    let error = |increments: usize| {
        let mut problem = block_on_plane(false, 0.3, 1e4);
        let press = problem.step(Increments::Fixed(increments)).hold(1, &[]).hold(0, &[]).point(0, 2, -0.02).build();
        problem.run(&press).unwrap();
        let shear = problem
            .step(Increments::Fixed(4 * increments))
            .hold(1, &[])
            .hold(0, &[])
            .point(0, 2, -0.02)
            .point_path(0, 0, |s| 0.02 * (2.0 * PI * s).sin())
            .build();
        problem.run(&shear).unwrap();
        let totals = problem.analysis.totals();
        println!("{increments}: friction {}, error {:e}", totals.contact_friction, totals.energy_error());
        totals.energy_error().abs()
    };
    let errors = [4, 8, 16].map(error);
    assert!(errors[1] < 0.6 * errors[0] && errors[2] < 0.6 * errors[1], "{errors:?}");
}

/// A round cylinder of 16 facets over another, turned by a part of a facet: force along the line between them and across
/// it per length, at a fixed approach of their middles.
fn faceted(part: f64, approach: f64, points: usize, smoothing: Smoothing) -> [f64; 2] {
    let (radius, length) = (5.0, 1.0);
    let strand = Strand { radius, length, layers: 1, ..Strand::default() };
    let lower = strand.mesh().unwrap();
    let facets = lower.surfaces[sets::LATERAL].len();
    // Radius of the smooth surface, of polygons that of the nodes.
    let outer = lower.points.iter().map(|x| x.xy().norm()).fold(0.0, f64::max);
    let facet = 2.0 * PI / facets as f64;
    let smooth = if smoothing == Smoothing::Spline { outer * (1.0 - (1.0 - facet.cos()) / 3.0) } else { outer };
    let mut upper = lower.clone();
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), part * facet);
    let shift = Vector3::y() * (2.0 * smooth + 1e-3);
    upper.points.iter_mut().for_each(|x| *x = turn * *x + shift);
    let mut bodies = Bodies::new(CellKind::Hex8);
    let starts = [bodies.join(&lower), bodies.join(&upper)];
    let surface = |start: [u32; 2]| {
        let faces = &lower.surfaces[sets::LATERAL];
        let faces: Vec<Face> = faces.iter().map(|f| Face { cell: f.cell + start[1], face: f.face }).collect();
        Surface::new(&bodies.mesh, &faces, smoothing).unwrap()
    };
    let options = ContactOptions {
        penalty: 8000.0,
        tangential_penalty: 8000.0,
        points: [points, 3],
        ..ContactOptions::new(2000.0, radius)
    };
    let (primary, secondary) = (surface(starts[0]), surface(starts[1]));
    let pair = Contact::new("pair", primary, secondary, &bodies.mesh.points, options).unwrap();
    let core = |start: [u32; 2], centre: Vector3<f64>| {
        let nodes = (start[0]..start[0] + lower.points.len() as u32)
            .filter(|n| (bodies.mesh.points[*n as usize] - centre).xy().norm() < 0.5 * radius);
        rigid("core", centre, &nodes.collect::<Vec<u32>>())
    };
    let sections = vec![core(starts[0], Vector3::zeros()), core(starts[1], shift)];
    let held: Vec<u32> = sections.iter().flat_map(|s| s.nodes.clone()).collect();
    let free: Vec<u32> = (0..bodies.mesh.points.len() as u32).filter(|n| !held.contains(n)).collect();
    let mut problem = problem(&bodies, (2000.0, 0.4), vec![pair], sections);
    let step =
        problem.step(automatic(0.5)).hold(0, &[]).hold(1, &[]).point(1, 1, -approach - 1e-3).nodes(&free, 2, 0.0);
    let step = step.build();
    let rows = problem.run(&step).unwrap();
    let force = rows.last().unwrap().reaction[1][0] / length;
    println!("{facets} facets, turned by {part}: {:?}, {} touch", [-force.y, force.x], touching(&problem).len());
    [-force.y, force.x]
}

#[test]
fn faceted_cylinders_touch_as_smooth_ones() {
    for (approach, points, ripple, drift) in [(0.02, 24, 0.05, 0.005), (0.1, 24, 0.05, 0.005), (0.1, 6, 0.05, 0.02)] {
        let forces = [0.0, 0.125, 0.25, 0.375, 0.5].map(|part| faceted(part, approach, points, Smoothing::Spline));
        let (low, high) = forces.iter().fold((f64::INFINITY, 0.0_f64), |(l, h), f| (l.min(f[0]), h.max(f[0])));
        let lateral = forces.iter().map(|f| (f[1] / f[0]).abs()).fold(0.0, f64::max);
        let spread = (high - low) / (0.5 * (high + low));
        println!("approach {approach}, {points} points: ripple {spread:.4}, lateral {lateral:.2e}");
        assert!(spread < ripple, "approach {approach}, {points} points: ripple {spread}");
        assert!(lateral < drift, "approach {approach}, {points} points: lateral force {lateral} of the normal");
    }
}
