//! Published and semi-analytic solutions: bending at large rotation, locking, twisted cylinders.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::f64::consts::{FRAC_PI_4, PI};

use nalgebra::{Matrix3, Vector3};
use subrope_fem::FemError;
use subrope_fem::analysis::{Increments, NewtonOptions, PathControl};
use subrope_fem::kinematics::{Section, SectionKind};
use subrope_geometry::{CellKind, Mesh, frame_from_directions};
use subrope_material::{FibreNeoHooke, IsochoricNeoHooke, StVenantKirchhoff};
use subrope_tests::{
    Brick, Lattice, Problem, Recorder, Run, brick, close, constant_frames, relative, run_scene, scientific,
};

fn automatic(initial: f64) -> Increments {
    Increments::Automatic { control: PathControl::Load, initial, minimum: 1e-6, maximum: 1.0, max_count: 1000 }
}

fn isotropic(young: f64) -> StVenantKirchhoff {
    StVenantKirchhoff::isotropic(young, 0.0).unwrap()
}

fn identity(mesh: &Mesh) -> Vec<Matrix3<f64>> {
    constant_frames(mesh, Matrix3::identity())
}

// ---------------------------------------------------------------------------------------------------------------- Cook

/// Vertical displacement of the middle of the right edge of Cook's membrane with n x n bricks \[mm\].
fn cook(kind: Brick, n: usize) -> f64 {
    let lattice = Lattice::new([n, n, 1], kind.kind());
    let mesh = lattice.mesh(|[x, y, z]| [48.0 * x, 44.0 * x + y * (44.0 - 28.0 * x), z]);
    let law = IsochoricNeoHooke::new(0.4225, 0.915_416_67).unwrap();
    let solid = brick(kind, &mesh, &identity(&mesh), law).unwrap();
    let mut problem = Problem::new(&mesh, solid, Vec::new()).unwrap();
    let (left, right) = (lattice.face(0, false), lattice.face(0, true));
    let all: Vec<u32> = (0..mesh.point_count() as u32).collect();
    let step = problem
        .step(automatic(0.25))
        .nodes(&all, 2, 0.0)
        .nodes(&left, 0, 0.0)
        .nodes(&left, 1, 0.0)
        .force(&right, &lattice.face_shares(0), Vector3::y())
        .build();
    problem.run(&step).unwrap();
    let [_, ny, _] = lattice.nodes();
    let node = lattice.node([lattice.nodes()[0] - 1, (ny - 1) / 2, 0]);
    assert!((mesh.points[node as usize] - Vector3::new(48.0, 52.0, 0.0)).norm() < 1e-12);
    problem.displacement(node).y
}

#[test]
fn cook_membrane() {
    let table = [(4, 12.07123), (8, 13.86320), (16, 14.48526), (32, 14.66727), (64, 14.71903)];
    for (n, reference) in table {
        let value = cook(Brick::Plain, n);
        println!("plain, n = {n}: {value:.5}, {reference:.5}");
        assert!((value - reference).abs() <= 0.6e-5, "n = {n}: {value} instead of {reference}");
    }
    let averaged: Vec<f64> = table[..4].iter().map(|(n, _)| cook(Brick::MeanVolume, *n)).collect();
    println!("mean volume: {averaged:?}");
    for (value, (n, plain)) in averaged.iter().zip(table) {
        assert!(*value > plain, "n = {n}: {value} is below {plain}");
    }
    let quadratic = cook(Brick::Quadratic, 16);
    println!("quadratic, n = 16: {quadratic:.5}");
    let error = |value: f64| (value - quadratic).abs();
    assert!(error(averaged[1]) < error(table[1].1), "averaged no better than plain");
    assert!(averaged.windows(2).all(|pair| pair[1] > pair[0]));
}

// ---------------------------------------------------------------------------------------------------------- cantilever

/// Tip displacement of a cantilever 10 x 1 x 0.1 under a dead force at its end.
fn cantilever(kind: Brick, cells: [usize; 3], force: f64) -> Vector3<f64> {
    let lattice = Lattice::new(cells, kind.kind());
    let mesh = lattice.mesh(|[x, y, z]| [10.0 * x, y, 0.1 * z]);
    let solid = brick(kind, &mesh, &identity(&mesh), isotropic(1.2e6)).unwrap();
    let options = NewtonOptions { force_tolerance: 1e-8, ..NewtonOptions::default() };
    let mut problem = Problem::with(&mesh, solid, Vec::new(), options).unwrap();
    let (root, tip) = (lattice.face(0, false), lattice.face(0, true));
    let mut step = problem.step(automatic(0.1));
    for k in 0..3 {
        step = step.nodes(&root, k, 0.0);
    }
    let step = step.force(&tip, &lattice.face_shares(0), Vector3::z() * force).build();
    problem.run(&step).unwrap();
    tip.iter().zip(lattice.face_shares(0)).map(|(&n, s)| problem.displacement(n) * s).sum()
}

#[test]
fn cantilever_under_a_tip_force() {
    for (force, shortening, deflection) in [(4.0, 3.2893, 6.6999), (2.0, 1.6064, 4.9346)] {
        let u = cantilever(Brick::Quadratic, [40, 1, 1], force);
        println!("force {force}: {:.4} {:.4}, {shortening} {deflection}", -u.x, u.z);
        close("shortening", -u.x, shortening, 0.01);
        close("deflection", u.z, deflection, 0.01);
    }
}

/// Eight nodes lock: no reason to use them here, but the number is known.
#[test]
fn plain_brick_locks_in_bending() {
    println!("mean volume: {:.4}", cantilever(Brick::MeanVolume, [100, 1, 2], 4.0).z);
    let u = cantilever(Brick::Plain, [100, 1, 2], 4.0);
    println!("plain: {:.4} {:.4}", -u.x, u.z);
    assert!((u.z - 5.74).abs() < 0.02, "deflection {} instead of 5.74", u.z);
}

#[test]
fn end_moment_bends_to_a_full_circle() {
    let (length, thickness, young) = (12.0, 0.1, 1.2e6);
    let lattice = Lattice::new([40, 1, 1], CellKind::Hex27);
    let mesh = lattice.mesh(|[x, y, z]| [length * x, y, thickness * z]);
    let solid = brick(Brick::Quadratic, &mesh, &identity(&mesh), isotropic(young)).unwrap();
    let section = |name: &str, end: bool| Section {
        name: name.into(),
        position: Vector3::new(if end { length } else { 0.0 }, 0.5, 0.5 * thickness),
        axis: Vector3::x(),
        nodes: lattice.face(0, end),
        kind: SectionKind::Rigid,
    };
    let options = NewtonOptions { force_tolerance: 1e-8, ..NewtonOptions::default() };
    let mut problem = Problem::with(&mesh, solid, vec![section("root", false), section("tip", true)], options).unwrap();
    // Free in the plane of bending; a positive turn about y lowers the tip.
    let step = problem.step(Increments::Fixed(24)).hold(0, &[]).hold(1, &[0, 2]).point(1, 4, 2.0 * PI).build();
    let rows = problem.run(&step).unwrap();
    let row = rows.last().unwrap();
    let moment = young * thickness.powi(3) / 12.0 * 2.0 * PI / length;
    println!("moment {:.4} of {moment:.4}, tip moved by {:?}", row.reaction[1][1].y, row.motion[1][0].as_slice());
    close("moment", row.reaction[1][1].y, moment, 0.01);
    let tip = row.motion[1][0] + Vector3::new(length, 0.0, 0.0);
    assert!(tip.norm() < 0.01 * length, "the circle does not close: {tip}");
    assert!(row.reaction[1][0].norm() < 1e-5 * moment / length, "force {:?}", row.reaction[1][0]);
    // Half way: a half circle, its ends a diameter apart.
    let half = &rows[11];
    let tip = half.motion[1][0] + Vector3::new(length, 0.0, 0.0);
    assert!((tip - Vector3::new(0.0, 0.0, -2.0 * length / PI)).norm() < 0.01 * length, "half circle ends at {tip}");
}

/// Tip of a cantilever bent to an eighth of a circle in the x-y plane under a dead force across that plane.
fn bend_tip(cells: [usize; 3]) -> Vector3<f64> {
    let radius = 100.0;
    let lattice = Lattice::new(cells, CellKind::Hex27);
    let mesh = lattice.mesh(|[s, a, b]| {
        let (angle, r) = (s * FRAC_PI_4, radius - 0.5 + a);
        [radius - r * angle.cos(), r * angle.sin(), b - 0.5]
    });
    let solid = brick(Brick::Quadratic, &mesh, &identity(&mesh), isotropic(1e7)).unwrap();
    let options = NewtonOptions { force_tolerance: 1e-8, ..NewtonOptions::default() };
    let mut problem = Problem::with(&mesh, solid, Vec::new(), options).unwrap();
    let (root, tip) = (lattice.face(0, false), lattice.face(0, true));
    let mut step = problem.step(automatic(0.2));
    for k in 0..3 {
        step = step.nodes(&root, k, 0.0);
    }
    let step = step.force(&tip, &lattice.face_shares(0), Vector3::z() * 600.0).build();
    problem.run(&step).unwrap();
    let centre = lattice.node([2 * cells[0], cells[1], cells[2]]);
    println!("{cells:?}: {} iterations", problem.analysis.totals().iterations);
    mesh.points[centre as usize] + problem.displacement(centre)
}

/// Slender curved bricks need many along the axis, and two across or the section cannot warp in torsion.
#[test]
fn bend_of_45_degrees() {
    let tip = bend_tip([32, 2, 2]);
    println!("tip at {:?}", tip.as_slice());
    for (value, reference) in tip.iter().zip([15.558, 46.892, 53.608]) {
        close("tip", *value, reference, 0.003);
    }
}

// -------------------------------------------------------------------------------------------- straight strand, bending

/// Bends a straight strand of radius 1, `E = 1000`, `nu = 0`, to a half circle.
fn straight_strand(length: f64, layers: usize) -> Run {
    let text = format!(
        r#"title = "straight strand"
[strand]
radius = 1.0
length = {length:?}
surface_angle = 0.0
mesh = {{ core = 2, rings = 1, layers = {layers} }}
[element]
formulation = "hex27"
[law]
kind = "isotropic"
E = 1000.0
nu = 0.0
[[end]]
name = "END_A"
[[end]]
name = "END_B"
[[step]]
name = "bend"
increments = {{ fixed = 4 }}
[step.bend]
angle = 90.0
[solver]
residual_tolerance = 1e-10
"#
    );
    run_scene(&text, None)
}

/// Moment over `E I pi/L`.
fn straight_strand_moment(run: &Run, length: f64) -> f64 {
    let row = run.rows.last().unwrap();
    row.reaction[run.point("END_A")][1].norm() / (1000.0 * PI / 4.0 * PI / length)
}

#[test]
fn straight_isotropic_strand_bends_to_a_half_circle() {
    let length = 200.0;
    let run = straight_strand(length, 60);
    let moment = straight_strand_moment(&run, length);
    println!("moment {moment:.6} EI pi/L");
    assert!((moment - 1.0).abs() < 1e-3, "moment {moment} EI pi/L");
    // Uniform curvature: every node of the axis on one circle about the same centre, none out of the plane.
    let mesh = &run.model.mesh.mesh;
    let u = run.model.analysis.displacement();
    let place = |n: u32| mesh.points[n as usize] + Vector3::from_column_slice(&u[3 * n as usize..3 * n as usize + 3]);
    let places: Vec<Vector3<f64>> = mesh.node_sets["AXIS"].iter().map(|&n| place(n)).collect();
    let out_of_plane = (0..mesh.point_count()).map(|n| u[3 * n].abs()).fold(0.0, f64::max);
    let axis_out_of_plane = places.iter().map(|p| p.x.abs()).fold(0.0, f64::max);
    println!("out of plane {:.1e} L, the axis {:.1e} L", out_of_plane / length, axis_out_of_plane / length);
    assert!(axis_out_of_plane < 1e-8 * length, "out of plane by {axis_out_of_plane:e}");
    let centre = 0.5 * (places[0] + places[places.len() - 1]);
    let radii: Vec<f64> = places.iter().map(|p| (p - centre).norm()).collect();
    let (least, most) = radii.iter().fold((f64::MAX, 0.0_f64), |(a, b), &r| (a.min(r), b.max(r)));
    println!("radius of the arc {least:.5} to {most:.5}, L/pi {:.5}", length / PI);
    assert!(most / least - 1.0 < 1e-3, "radii from {least} to {most}");
    close("radius of the arc", 0.5 * (least + most), length / PI, 1e-3);
}

/// St. Venant-Kirchhoff in bending, exact to the second order in k = curvature x radius: `M/(E I kappa) = 1 - 3/2 k^2`.
/// Sections that keep their shape give 7/8 (extension of the axis and the cubic terms of the fibre stress); the fibre
/// stresses on the curved axis press the section together, and the plane problem of the disc under the body force
/// `-E kappa^2 y` (cubic displacements, `nu = 0`) lets go of energy that lowers the moment by another 5/8.
#[test]
fn moment_of_st_venant_kirchhoff_to_the_second_order() {
    let length = 100.0;
    let moment = straight_strand_moment(&straight_strand(length, 160), length);
    let coefficient = (1.0 - moment) / (PI / length).powi(2);
    println!("moment {moment:.6} EI pi/L: 1 - {coefficient:.4} k^2");
    // The rigid ends keep their sections from changing over about a radius.
    close("coefficient", coefficient, 1.5, 0.03);
}

// ------------------------------------------------------------------------------------------------------- fibre locking

/// Block 2 x 1 x 0.1 with fibres at 45 degrees in its plane.
fn fibre_block(kind: Brick, n: usize, k: f64, increments: Increments) -> (Result<f64, FemError>, Recorder) {
    let options = NewtonOptions { force_tolerance: 1e-11, ..NewtonOptions::default() };
    fibre_block_with(kind, n, k, increments, options)
}

fn fibre_block_with(
    kind: Brick,
    n: usize,
    k: f64,
    increments: Increments,
    options: NewtonOptions,
) -> (Result<f64, FemError>, Recorder) {
    let lattice = Lattice::new([2 * n, n, 1], kind.kind());
    let mesh = lattice.mesh(|[x, y, z]| [2.0 * x, y, 0.1 * z]);
    let frame = frame_from_directions(&Vector3::new(1.0, 1.0, 0.0), &Vector3::z()).unwrap();
    let law = FibreNeoHooke::new(1.0, 1.0, k).unwrap();
    let solid = brick(kind, &mesh, &constant_frames(&mesh, frame), law).unwrap();
    let mut problem = Problem::with(&mesh, solid, Vec::new(), options).unwrap();
    let (left, right) = (lattice.face(0, false), lattice.face(0, true));
    let all: Vec<u32> = (0..mesh.point_count() as u32).collect();
    let step = problem
        .step(increments)
        .nodes(&all, 2, 0.0)
        .nodes(&left, 0, 0.0)
        .nodes(&left, 1, 0.0)
        .nodes(&right, 0, 0.1)
        .nodes(&right, 1, 0.0)
        .build();
    let mut recorder = Recorder::default();
    let outcome = problem.analysis.run_step(&step, &mut recorder);
    (outcome.map(|()| problem.reaction(&right).x / 0.1), recorder)
}

fn edge_force(kind: Brick, n: usize, k: f64) -> f64 {
    fibre_block(kind, n, k, automatic(0.25)).0.unwrap()
}

fn to_the_digits(kind: Brick, k: f64, table: &[(usize, f64)], digits: i32) {
    for &(n, reference) in table {
        let value = edge_force(kind, n, k);
        println!("{kind:?}, k = {k}, n = {n}: {value:.5}, {reference}");
        let half_a_digit = 0.5 * 10_f64.powi(-digits);
        assert!((value - reference).abs() <= 1.01 * half_a_digit, "n = {n}: {value} instead of {reference}");
    }
}

#[test]
fn fibre_locking_of_the_plain_brick() {
    to_the_digits(Brick::Plain, 100.0, &[(2, 1.147), (4, 0.571), (8, 0.319), (16, 0.229), (32, 0.200)], 3);
}

#[test]
fn mean_elongation_does_not_lock() {
    let table = [(2, 0.1822), (4, 0.1844), (8, 0.1849), (16, 0.1846), (32, 0.1842)];
    to_the_digits(Brick::MeanElongation, 100.0, &table, 4);
    to_the_digits(Brick::MeanElongation, 1e4, &[(4, 0.1863), (8, 0.1880)], 4);
    // No reference on the other meshes: near that of the finest which has one.
    for (n, tolerance) in [(2, 0.03), (16, 0.01), (32, 0.01)] {
        close(&format!("k = 1e4, n = {n}"), edge_force(Brick::MeanElongation, n, 1e4), 0.1880, tolerance);
    }
    close("n = 4", edge_force(Brick::MeanElongation, 4, 100.0), 0.184, 0.01);
}

/// Compressed fibres buckle in such a block: its tangent is indefinite from the first hundredth of the motion, states
/// are not unique, and no value is known. What counts: the step is finished, by cutting where plain Newton diverges.
#[test]
fn nearly_inextensible_fibres_in_plain_bricks_end_by_cutting_steps() {
    nearly_inextensible(&[2, 4, 8]);
}

#[test]
#[ignore = "minutes: a finer mesh of the same"]
fn nearly_inextensible_fibres_in_fine_plain_bricks() {
    nearly_inextensible(&[16]);
}

fn nearly_inextensible(meshes: &[usize]) {
    for &n in meshes {
        for line_search in [true, false] {
            let options = NewtonOptions { force_tolerance: 1e-11, line_search, ..NewtonOptions::default() };
            let (force, recorder) = fibre_block_with(Brick::Plain, n, 1e4, automatic(1.0), options);
            let (rows, failures) = (&recorder.rows, recorder.failures.len());
            println!("n = {n}, line search {line_search}: {force:?}, {} increments, {failures} failures", rows.len());
            assert!(force.unwrap() > 1.0);
            let last = &rows[rows.len() - 1].record;
            assert!(last.fraction == 1.0 && last.residual().is_some_and(|r| r <= 1e-11), "{last:?}");
            assert!(line_search || n < 4 || failures > 0, "n = {n}: undamped Newton converged at once");
        }
    }
}

/// Full integration of 27 nodes locks too, but far less than eight nodes: no claim of 1 % at n = 4, only convergence.
#[test]
fn quadratic_brick_locks_little() {
    let [coarse, fine] = [4, 8].map(|n| edge_force(Brick::Quadratic, n, 100.0));
    println!("quadratic, k = 100: {coarse:.5} {fine:.5}");
    assert!(coarse < 0.229, "n = 4 is no better than plain bricks with n = 16: {coarse}");
    assert!(fine < coarse && fine > 0.18, "{coarse} {fine}");
}

// ----------------------------------------------------------------------------------- helically fibred cylinder

const CYLINDER_RADIUS: f64 = 2.5;

fn cylinder_scene(mesh: &str, formulation: &str, length: f64, [stretch, twist]: [f64; 2]) -> String {
    let (uz, rz) = ((stretch - 1.0) * length, (twist * length).to_degrees());
    format!(
        r#"title = "helically fibred cylinder"
[strand]
radius = {CYLINDER_RADIUS:?}
length = {length:?}
pitch = 27.206990
mesh = {mesh}
[element]
formulation = "{formulation}"
[law]
kind = "bundle"
K_e = 2000.0
K_ec = 2000.0
K_c = 50.0
K_t = 20.0
K_l = 20.0
friction = false
[[end]]
name = "END_A"
kind = "radial"
[[end]]
name = "END_B"
kind = "radial"
[[step]]
name = "pull"
increments = {{ initial = 0.5, maximum = 0.5 }}
[[step.prescribe]]
point = "END_B"
uz = {uz:?}
rz = {rz:?}
[solver]
residual_tolerance = 1e-9
"#
    )
}

struct Cylinder {
    case: [f64; 2],
    force: f64,
    moment: f64,
    /// Radius and energy per length, where known.
    more: Option<[f64; 2]>,
}

const CYLINDER: [Cylinder; 5] = [
    Cylinder { case: [1.01, 0.0], force: 190.179_784, moment: 87.530_398, more: Some([2.452_188_94, 0.944_662_81]) },
    Cylinder {
        case: [1.05, 0.0],
        force: 1_013.010_338,
        moment: 403.221_964,
        more: Some([2.282_649_14, 24.724_625_34]),
    },
    Cylinder { case: [1.0, 0.01], force: 85.763_542, moment: 86.332_128, more: None },
    Cylinder { case: [1.0, -0.01], force: -92.732_121, moment: -93.187_814, more: None },
    Cylinder { case: [1.02, 0.02], force: 541.230_226, moment: 314.425_376, more: Some([2.321_041_38, 8.724_781_30]) },
];

/// Largest relative deviation over all cases.
fn cylinder(mesh: &str, formulation: &str, length: f64) -> f64 {
    let mut worst = 0.0_f64;
    for Cylinder { case, force, moment, more } in &CYLINDER {
        let run = run_scene(&cylinder_scene(mesh, formulation, length, *case), None);
        let row = run.rows.last().unwrap();
        let [f, m] = row.reaction[run.point("END_B")];
        let mut errors = vec![relative(f.z, *force), relative(m.z, *moment)];
        if let Some([radius, energy]) = more {
            let model = &run.model.mesh.mesh;
            let u = run.model.analysis.displacement();
            // The polygon of exact area stands a little outside the circle: compare the change of radius.
            let nodes = &model.node_sets["SURFACE_NODES"];
            let growth: f64 = nodes
                .iter()
                .map(|&n| {
                    let (x, at) = (model.points[n as usize], 3 * n as usize);
                    (x.x + u[at]).hypot(x.y + u[at + 1]) / x.x.hypot(x.y)
                })
                .sum();
            errors.push(relative(growth / nodes.len() as f64 * CYLINDER_RADIUS, *radius));
            errors.push(relative(row.totals.stored / length, *energy));
        }
        println!("{formulation}, {mesh}, {case:?}: {}", scientific(&errors));
        worst = errors.into_iter().fold(worst, f64::max);
    }
    worst
}

#[test]
fn helically_fibred_cylinder_of_2400_bricks() {
    let worst = cylinder("{ core = 4, rings = 2, layers = 50 }", "hex8", 30.0);
    assert!(worst < 0.02, "plain: {worst:e}");
}

/// An averaged elongation does not vary over the radius of a brick: more rings, fewer layers.
#[test]
fn helically_fibred_cylinder_of_2400_averaging_bricks() {
    let worst = cylinder("{ core = 4, rings = 5, layers = 25 }", "hex8_mean_elongation", 30.0);
    assert!(worst < 0.02, "mean elongation: {worst:e}");
}

#[test]
fn helically_fibred_cylinder_refined() {
    for (mesh, formulation) in [
        ("{ core = 4, rings = 2, layers = 4 }", "hex27"),
        ("{ core = 8, rings = 4, layers = 8 }", "hex8"),
        ("{ core = 8, rings = 10, layers = 4 }", "hex8_mean_elongation"),
    ] {
        let worst = cylinder(mesh, formulation, 4.0);
        assert!(worst < 0.005, "{formulation}: {worst:e}");
    }
}

// ------------------------------------------------------------------------------------ torsion of a bundle with friction

#[test]
fn torsion_of_a_bundle_with_longitudinal_friction() {
    torsion("hex27", "{ core = 6, rings = 4, layers = 1 }");
    torsion("hex8", "{ core = 8, rings = 8, layers = 1 }");
    torsion("hex8_mean_elongation", "{ core = 8, rings = 8, layers = 1 }");
}

fn torsion(formulation: &str, mesh: &str) {
    let (length, amplitude) = (2.0_f64, 0.002);
    let angle = (amplitude * length).to_degrees();
    let step = |name: &str, angle: f64, count: usize| {
        format!(
            "[[step]]\nname = \"{name}\"\nincrements = {{ fixed = {count} }}\n[[step.prescribe]]\npoint = \"END_B\"\nrz = {angle:?}\n"
        )
    };
    let run = run_scene(
        &format!(
            r#"title = "torsion of a bundle"
[strand]
radius = {CYLINDER_RADIUS:?}
length = {length:?}
surface_angle = 0.0
mesh = {mesh}
[element]
formulation = "{formulation}"
[law]
kind = "bundle"
K_e = 1000.0
K_ec = 1000.0
K_c = 50.0
K_t = 20.0
K_l = 20.0
tau_l = 0.01
tau_t = 1e6
[[end]]
name = "END_A"
kind = "radial"
[[end]]
name = "END_B"
kind = "radial"
{}{}{}[solver]
residual_tolerance = 1e-9
"#,
            step("there", angle, 10),
            step("back", -angle, 20),
            step("again", angle, 20),
        ),
        None,
    );
    let end = run.point("END_B");
    let most = run.rows.iter().map(|r| r.reaction[end][1].z.abs()).fold(0.0, f64::max);
    let dissipated = |row: usize| run.rows[row].totals.dissipated[1] / length;
    let cycle = dissipated(run.rows.len() - 1) - dissipated(9);
    // With gamma = phi r and the yield radius r_y = tau/(G phi):
    // M = 2 pi tau (a^3/3 - r_y^3/12), D = 8 pi tau int_(r_y)^a (phi r - tau/G) r dr.
    let (a, tau, g) = (CYLINDER_RADIUS, 0.01, 20.0);
    let r = tau / (g * amplitude);
    let moment = 2.0 * PI * tau * (a.powi(3) / 3.0 - r.powi(3) / 12.0);
    let slid = amplitude * (a.powi(3) - r.powi(3)) / 3.0 - tau / g * (a * a - r * r) / 2.0;
    let dissipation = 8.0 * PI * tau * slid;
    close("closed form of the moment", moment, 0.327_167_42, 1e-7);
    close("closed form of the dissipation", dissipation, 2.226_603_8e-3, 1e-7);
    println!(
        "{formulation}: largest moment {most:.8} of {moment:.8}, dissipated {cycle:.7e} of {dissipation:.7e} per mm and cycle"
    );
    close("largest moment", most, moment, 0.005);
    close("dissipated per cycle", cycle, dissipation, 0.005);
}
