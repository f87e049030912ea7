//! A strand of 2400 plain bricks, orthotropic, bent to a half circle: the numbers on which four independent codes agree.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::{Matrix3, Vector3};
use subrope_fem::analysis::{Increments, NewtonOptions};
use subrope_fem::kinematics::{Section, SectionKind};
use subrope_geometry::{CellKind, Mesh};
use subrope_tests::{Brick, Problem, brick, peer_law, relative};

const RADIUS: f64 = 2.785;
const LENGTH: f64 = 60.0;
const LAYERS: usize = 50;
const SIDE: usize = 4;
const RINGS: usize = 2;

/// The section: a bulged core of 4 x 4 cells inside two rings of 16, nodes on the circle.
struct Disc {
    points: Vec<[f64; 2]>,
    quads: Vec<[usize; 4]>,
}

fn disc() -> Disc {
    let (half, bulge) = (0.55 * RADIUS / 2_f64.sqrt(), 0.15);
    let grid = |i: usize| 2.0 * i as f64 / SIDE as f64 - 1.0;
    let core = |i: usize, j: usize| j * (SIDE + 1) + i;
    let mut points = Vec::new();
    for (j, i) in (0..=SIDE).flat_map(|j| (0..=SIDE).map(move |i| (j, i))) {
        let (x, y) = (grid(i), grid(j));
        points.push([half * x * (1.0 + bulge * (1.0 - y * y)), half * y * (1.0 + bulge * (1.0 - x * x))]);
    }
    let boundary: Vec<usize> = (0..SIDE)
        .map(|i| core(i, 0))
        .chain((0..SIDE).map(|j| core(SIDE, j)))
        .chain((1..=SIDE).rev().map(|i| core(i, SIDE)))
        .chain((1..=SIDE).rev().map(|j| core(0, j)))
        .collect();
    let around = boundary.len();
    let mut rings = vec![boundary.clone()];
    for k in 1..=RINGS {
        let weight = k as f64 / RINGS as f64;
        let ring = boundary.iter().enumerate().map(|(q, &inner)| {
            let angle = -0.75 * PI + 2.0 * PI * q as f64 / around as f64;
            let [x, y] = points[inner];
            let (sin, cos) = angle.sin_cos();
            points.push([x + (RADIUS * cos - x) * weight, y + (RADIUS * sin - y) * weight]);
            points.len() - 1
        });
        let ring = ring.collect();
        rings.push(ring);
    }
    let mut quads: Vec<[usize; 4]> = (0..SIDE)
        .flat_map(|j| (0..SIDE).map(move |i| (i, j)))
        .map(|(i, j)| [core(i, j), core(i + 1, j), core(i + 1, j + 1), core(i, j + 1)])
        .collect();
    for pair in rings.windows(2) {
        for q in 0..around {
            let next = (q + 1) % around;
            quads.push([pair[0][next], pair[0][q], pair[1][q], pair[1][next]]);
        }
    }
    Disc { points, quads }
}

fn sweep(disc: &Disc) -> Mesh {
    let size = disc.points.len();
    let height = |level: usize| LENGTH * level as f64 / LAYERS as f64;
    let level = |l: usize| disc.points.iter().map(move |p| Vector3::new(p[0], p[1], height(l)));
    let points = (0..=LAYERS).flat_map(level).collect();
    let cell = |l: usize, quad: &[usize; 4]| {
        let bottom = quad.map(|n| (n + l * size) as u32);
        bottom.into_iter().chain(bottom.map(|n| n + size as u32)).collect::<Vec<_>>()
    };
    let cells = (0..LAYERS).flat_map(|l| disc.quads.iter().flat_map(move |q| cell(l, q))).collect();
    Mesh::new(CellKind::Hex8, points, cells)
}

/// Fibre frame at the centroid of a column of bricks: `tan(a) = tan(30 deg) r/R`.
fn column_frame(disc: &Disc, quad: &[usize; 4]) -> Matrix3<f64> {
    let mean = |k: usize| quad.iter().map(|&n| disc.points[n][k]).sum::<f64>() / 4.0;
    let (x, y) = (mean(0), mean(1));
    let angle = y.atan2(x);
    let slope = (PI / 6.0).tan() * x.hypot(y) / RADIUS;
    let cos = 1.0 / (1.0 + slope * slope).sqrt();
    let e1 = Vector3::new(-slope * cos * angle.sin(), slope * cos * angle.cos(), cos);
    let e2 = Vector3::new(angle.cos(), angle.sin(), 0.0);
    Matrix3::from_columns(&[e1, e2, e1.cross(&e2)])
}

fn end(name: &str, z: f64, nodes: std::ops::Range<usize>) -> Section {
    Section {
        name: name.into(),
        position: Vector3::new(0.0, 0.0, z),
        axis: Vector3::z(),
        nodes: nodes.map(|n| n as u32).collect(),
        kind: SectionKind::Rigid,
    }
}

fn strand() -> Problem {
    let disc = disc();
    let mesh = sweep(&disc);
    assert_eq!((mesh.cell_count(), mesh.point_count()), (2400, 2907));
    let columns: Vec<Matrix3<f64>> = disc.quads.iter().map(|q| column_frame(&disc, q)).collect();
    let frames: Vec<Matrix3<f64>> =
        (0..LAYERS).flat_map(|_| columns.iter().flat_map(|f| std::iter::repeat_n(*f, 8))).collect();
    let solid = brick(Brick::Plain, &mesh, &frames, peer_law()).unwrap();
    let size = disc.points.len();
    let sections = vec![end("BOT", 0.0, 0..size), end("TOP", LENGTH, size * LAYERS..size * (LAYERS + 1))];
    let options = NewtonOptions { force_tolerance: 1e-9, ..NewtonOptions::default() };
    Problem::with(&mesh, solid, sections, options).unwrap()
}

#[test]
fn end_moment_and_approach() {
    const MOMENT_X: [f64; 10] =
        [50.75814, 101.35372, 151.62442, 201.40840, 250.54450, 298.87251, 346.23332, 392.46909, 437.42335, 480.94100];
    let moment = Vector3::new(480.94100, -48.90258, -37.28037);
    let approach = 22.006372;

    let mut problem = strand();
    let step = problem.step(Increments::Fixed(10)).hold(0, &[]).hold(1, &[2]);
    let step = step.point(0, 3, FRAC_PI_2).point(1, 3, -FRAC_PI_2).build();
    let rows = problem.run(&step).unwrap();

    for (row, reference) in rows.iter().zip(MOMENT_X) {
        let value = row.reaction[0][1].x;
        println!("{:3.0} deg: {value:.5}, {reference:.5}", 90.0 * row.record.fraction);
        // The reference is rounded to 5 decimals.
        assert!((value - reference).abs() <= 1e-6 * reference + 0.5e-5, "{value} instead of {reference}");
    }
    let last = rows.last().unwrap();
    let error = (last.reaction[0][1] - moment).norm() / moment.norm();
    println!("moment {:?}, off by {error:.2e}", last.reaction[0][1].as_slice());
    assert!(error <= 1e-6, "moment {:?}", last.reaction[0][1]);
    let value = -last.motion[1][0].z;
    println!("approach {value:.6}, {} iterations", last.totals.iterations);
    assert!(relative(value, approach) <= 1e-6, "approach {value} instead of {approach}");
}
