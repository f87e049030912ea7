//! Hertz and Mindlin beyond the tests of equal bodies: two materials, and the loop of a sheared contact.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::f64::consts::PI;

use nalgebra::{Matrix3, Vector3};
use subrope_contact::{Contact, ContactOptions, Smoothing, Surface};
use subrope_fem::Contribution;
use subrope_fem::analysis::{Increments, NewtonOptions, PathControl};
use subrope_geometry::{CellKind, Mesh};
use subrope_material::StVenantKirchhoff;
use subrope_tests::{Bodies, Body, Brick, Problem, brick, close, constant_frames, rigid};

/// Graded parameter: 0 to 1 with small parts at 0.
fn graded(t: f64, beta: f64) -> f64 {
    (beta * t).sinh() / beta.sinh()
}

fn contact(problem: &Problem) -> &Contact {
    let contributions = &problem.analysis.model().contributions;
    contributions.iter().find_map(|c| c.as_any().and_then(|a| a.downcast_ref())).unwrap()
}

/// Bricks of some of the cells of a mesh.
fn solid(mesh: &Mesh, cells: std::ops::Range<usize>, law: (f64, f64)) -> Box<dyn Contribution> {
    let law = StVenantKirchhoff::isotropic(law.0, law.1).unwrap();
    let part = Mesh::new(mesh.kind, mesh.points.clone(), mesh.cells[8 * cells.start..8 * cells.end].to_vec());
    brick(Brick::MeanVolume, &part, &constant_frames(&part, Matrix3::identity()), law).unwrap()
}

fn problem(
    bodies: &Bodies,
    solids: Vec<Box<dyn Contribution>>,
    pair: Contact,
    sections: Vec<subrope_fem::kinematics::Section>,
) -> Problem {
    let mut contributions = solids;
    contributions.push(Box::new(pair));
    let options = NewtonOptions { force_tolerance: 1e-9, ..NewtonOptions::default() };
    Problem::of(&bodies.mesh, contributions, sections, options).unwrap()
}

// ----------------------------------------------------------------------------------------------- a cylinder on a plane

/// Thickness of the slice \[mm\].
const SLICE: f64 = 1.0;

/// A body that touches the plane y = 0 from the side of `side`, of height `depth`, its surface `rise` above it at arc `s`.
fn slice(bodies: &mut Bodies, side: f64, cells: [usize; 2], width: f64, depth: f64, radius: Option<f64>) -> Body {
    bodies.add([cells[0], cells[1], 1], |[s, t, w]| {
        let u = (2.0 * s - 1.0) * side;
        let way = u.signum() * graded(u.abs(), 4.5) * width;
        let (x, low) = match radius {
            Some(r) => (r * (way / r).sin(), r - r * (way / r).cos()),
            None => (way, 0.0),
        };
        [x, side * (low + (depth - low) * graded(t, 5.0)), SLICE * w]
    })
}

/// Steel (E 210 GPa) of radius 50 mm on a block of aluminium (70 GPa), plane strain: force \[N/mm\], half width \[mm\], peak
/// \[MPa\].
fn steel_on_aluminium(cells: usize, force: f64, penalty: f64) -> [f64; 3] {
    let mut bodies = Bodies::new(CellKind::Hex8);
    let plane = slice(&mut bodies, -1.0, [cells, cells / 4], 50.0, 50.0, None);
    let cylinder = slice(&mut bodies, 1.0, [cells + 6, cells / 4], 48.0, 50.0, Some(50.0));
    let cells_of_plane = cells * (cells / 4);
    let [primary, secondary] = [&plane, &cylinder].map(|b| bodies.surface(b, 1, false, Smoothing::Spline));
    let options = ContactOptions { penalty, points: [6, 1], reach: 2.0, ..ContactOptions::new(7e4, 50.0) };
    let pair = Contact::new("pair", primary, secondary, &bodies.mesh.points, options).unwrap();
    let solids = vec![
        solid(&bodies.mesh, 0..cells_of_plane, (7e4, 0.3)),
        solid(&bodies.mesh, cells_of_plane..bodies.mesh.cell_count(), (2.1e5, 0.3)),
    ];
    let sections = [(&plane, -50.0), (&cylinder, 50.0)]
        .map(|(b, y)| rigid("flat", Vector3::new(0.0, y, 0.5 * SLICE), &b.face(1, true)));
    let held: Vec<u32> = sections.iter().flat_map(|s| s.nodes.clone()).collect();
    let free: Vec<u32> = (0..bodies.mesh.points.len() as u32).filter(|n| !held.contains(n)).collect();
    let mut problem = problem(&bodies, solids, pair, sections.to_vec());
    let automatic = |initial| Increments::Automatic {
        control: PathControl::Load,
        initial,
        minimum: 1e-4,
        maximum: 1.0,
        max_count: 100,
    };
    let touch = problem.step(automatic(0.5)).hold(0, &[]).hold(1, &[]).point(1, 1, -0.05).nodes(&free, 2, 0.0).build();
    problem.run(&touch).unwrap();
    let load = problem.step(automatic(0.2)).hold(0, &[]).hold(1, &[1]).nodes(&free, 2, 0.0);
    let load = load.load(1, 1, 0.0, -force * SLICE).build();
    let rows = problem.run(&load).unwrap();
    let contact = contact(&problem);
    let report = contact.report();
    let pressed = report.normal / SLICE;
    // Second moment of an elliptic pressure: a^2/4.
    let moment: f64 = contact
        .points()
        .zip(contact.places(problem.analysis.displacement()))
        .map(|(p, x)| p.area * p.state.pressure * x.x * x.x)
        .sum();
    let half_width = 2.0 * (moment / report.normal).sqrt();
    println!(
        "{cells} cells, {force} N/mm, penalty {penalty}: pressed {pressed:.2} N/mm, a {half_width:.5} mm, p0 {:.2} MPa, penetration {:.4}, {} touch, iterations {:?}",
        report.pressure,
        report.penetration,
        report.touching,
        rows.iter().map(|r| r.record.iterations).collect::<Vec<_>>()
    );
    [pressed, half_width, report.pressure]
}

fn hertz_steel_on_aluminium(force: f64) -> [f64; 2] {
    let compliance = 0.91 / 2.1e5 + 0.91 / 7e4;
    let a = (4.0 * force * 50.0 * compliance / PI).sqrt();
    [a, 2.0 * force / (PI * a)]
}

#[test]
fn a_steel_cylinder_presses_on_aluminium_as_hertz_says() {
    let [a, p0] = hertz_steel_on_aluminium(35e3);
    close("formula", a, 6.2146, 1e-4);
    close("formula", p0, 3585.4, 1e-4);
    // A tenth of the load stays within the small strains of the formula; the full one strains aluminium by five per cent.
    for (force, tolerance) in [(3.5e3, 0.02), (35e3, 0.03)] {
        let [pressed, half_width, peak] = steel_on_aluminium(64, force, 5e6);
        let [a, p0] = hertz_steel_on_aluminium(force);
        println!("{:.4} of Hertz's half width, {:.4} of his peak", half_width / a, peak / p0);
        close("force", pressed, force, 0.01);
        close("half width", half_width, a, tolerance);
        close("peak", peak, p0, tolerance);
    }
}

// -------------------------------------------------------------------------------------------------------------- Mindlin

/// What a loop of tangential displacement of a pressed contact shows.
#[derive(Debug)]
struct Loop {
    /// Normal force \[N\].
    normal: f64,
    /// Amplitude of the tangential force over the limit of friction.
    amplitude: f64,
    /// Friction work of one cycle \[mJ\].
    work: f64,
}

const YOUNG: f64 = 2000.0;
/// Nearly incompressible: nothing couples pressing to shearing of an elastic and a rigid body.
const POISSON: f64 = 0.49;
const RADIUS: f64 = 5.0;
const FRICTION: f64 = 0.3;

/// Unit of length \[mm\]. Lengths in it, an approach in its square and the same mesh give the same contact, ever flatter: at 1
/// strains of five per cent soften what shears, and a cycle loses 1.2 of Mindlin's at an amplitude of half the limit.
const SCALE: f64 = 0.1;
/// Nodes of a line through the contact \[units\]: even parts of .07 over `fine` to beyond its edge, then each twice as long.
fn line(fine: usize) -> Vec<f64> {
    let part = 0.07 / fine as f64;
    let mut nodes: Vec<f64> = (0..=6 * fine).map(|i| part * i as f64).collect();
    let mut growing = part;
    while nodes[nodes.len() - 1] < 4.5 {
        growing *= 2.0;
        nodes.push(nodes[nodes.len() - 1] + growing);
    }
    nodes
}

/// An elastic cylinder across an equal rigid one, half of it modelled, pressed by `approach` and sheared to and
/// fro by `way`.
fn sheared(fine: usize, approach: f64, way: f64, penalty: f64, increments: usize) -> Loop {
    const DEEP: f64 = 10.0 * SCALE;
    let mut bodies = Bodies::new(CellKind::Hex8);
    let (nodes, deep) = (line(fine), 4 + 4 * fine);
    let cells = nodes.len() - 1;
    // The place on that line of a parameter of an even lattice.
    let on_line = |t: f64| SCALE * nodes[(t * cells as f64).round() as usize];
    let body = bodies.add([2 * cells, deep, cells], |[s, t, w]| {
        let u = 2.0 * s - 1.0;
        let angle = u.signum() * on_line(u.abs()) / RADIUS;
        let low = RADIUS - RADIUS * angle.cos();
        [RADIUS * angle.sin(), low + (DEEP - low) * graded(t, 6.0), -on_line(1.0 - w)]
    });
    let axes = Matrix3::from_columns(&[Vector3::y(), Vector3::z(), Vector3::x()]);
    let frame = bodies.frame(Vector3::new(0.0, -RADIUS, 0.0), &axes, 1.0);
    let secondary = bodies.surface(&body, 1, false, Smoothing::None);
    let options = ContactOptions {
        penalty,
        tangential_penalty: penalty,
        friction: FRICTION,
        points: [5, 5],
        reach: 0.2 * SCALE,
        ..ContactOptions::new(YOUNG, RADIUS)
    };
    let primary = Surface::cylinder(frame, RADIUS, 1.0);
    let pair = Contact::new("pair", primary, secondary, &bodies.mesh.points, options).unwrap();
    let sections = vec![rigid("rod", Vector3::new(0.0, -RADIUS, 0.0), &frame)];
    let solids = vec![solid(&bodies.mesh, 0..bodies.mesh.cell_count(), (YOUNG, POISSON))];
    let mut problem = problem(&bodies, solids, pair, sections);
    let top = body.face(1, true);
    // The middle plane does not move across; its edge is fixed with the top.
    let middle: Vec<u32> = body.face(2, true).into_iter().filter(|n| !top.contains(n)).collect();
    let mut run = |increments: usize, from: f64, to: f64| {
        let mut step = problem.step(Increments::Fixed(increments)).nodes(&middle, 2, 0.0).hold(0, &[]);
        for k in 0..3 {
            step = step.nodes(&top, k, 0.0);
        }
        let step = step.point(0, 1, approach).point_path(0, 0, move |s| from + (to - from) * s).build();
        let before = problem.analysis.totals().contact_friction;
        let rows = problem.run(&step).unwrap();
        let row = rows.last().unwrap();
        println!(
            "to {to}: P {:.5} Q/(mu P) {:.5}, iterations {:?}",
            2.0 * row.reaction[0][0].y,
            row.reaction[0][0].x / (FRICTION * row.reaction[0][0].y),
            rows.iter().map(|r| r.record.iterations).collect::<Vec<_>>()
        );
        let force = row.reaction[0][0] * 2.0;
        (force, 2.0 * (problem.analysis.totals().contact_friction - before))
    };
    run(2, 0.0, 0.0);
    run(increments, 0.0, way);
    let (low, there) = run(2 * increments, way, -way);
    let (high, back) = run(2 * increments, -way, way);
    let normal = 0.5 * (low.y + high.y);
    Loop { normal, amplitude: 0.5 * (high.x - low.x) / (FRICTION * normal), work: there + back }
}

/// Mindlin's `D/(K mu P)` at the amplitude `q mu P`.
fn mindlin(q: f64) -> f64 {
    4.8 * (1.0 - (1.0 - q).powf(5.0 / 3.0) - 5.0 * q / 6.0 * (1.0 + (1.0 - q).powf(2.0 / 3.0)))
}

/// Loss of a cycle and amplitude, over what Mindlin says of them.
fn loss(fine: usize, way: f64) -> [f64; 2] {
    let sheared = sheared(fine, 0.03 * SCALE * SCALE, way * SCALE * SCALE, 2e5 / SCALE, 4);
    let Loop { normal, amplitude, work } = sheared;
    let modulus = YOUNG / (1.0 - POISSON * POISSON);
    let a = (0.75 * normal * RADIUS / modulus).cbrt();
    let shear = YOUNG / (2.0 * (1.0 + POISSON));
    let scale = 3.0 * FRICTION * normal / (16.0 * a) * (2.0 - POISSON) / shear * FRICTION * normal;
    let lost = work / scale;
    println!(
        "P {normal} N, a {a} mm, q {amplitude}: D/(K mu P) {lost:.6}, Mindlin {:.6}, {:.4}",
        mindlin(amplitude),
        lost / mindlin(amplitude)
    );
    [lost / mindlin(amplitude), amplitude]
}

/// The ring that slips must hold more than one brick: at an amplitude of .53 it does not with these, and 10 % too much is lost.
#[test]
#[ignore = "half a minute"]
fn a_sheared_contact_loses_what_mindlin_says() {
    close("formula", mindlin(0.5), 0.028_173_69, 1e-6);
    let [ratio, amplitude] = loss(1, 0.0094);
    assert!((0.6..0.75).contains(&amplitude), "amplitude {amplitude}");
    close("loss of a cycle", ratio, 1.0, 0.05);
}

#[test]
#[ignore = "some minutes"]
fn a_sheared_contact_loses_what_mindlin_says_at_half_the_limit() {
    let [ratio, amplitude] = loss(2, 0.0066);
    assert!((0.45..0.55).contains(&amplitude), "amplitude {amplitude}");
    close("loss of a cycle", ratio, 1.0, 0.05);
}
