//! Bricks: patch test, zero eigenvalues, stiffness against differences, rigid motion, numbering, far coordinates, units.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::f64::consts::PI;

use nalgebra::{DVector, Matrix3, Rotation3, Vector3};
use subrope_fem::analysis::Increments;
use subrope_fem::kinematics::{Kinematics, Section, SectionKind, Slide};
use subrope_fem::{FemError, Request};
use subrope_geometry::{
    Axis, CellKind, HelicalFibres, Lay, Mesh, Section as SectionShape, Strand, fibre_frames, strand::sets,
};
use subrope_material::{
    BundleLaw, BundleParameters, CharmetantLaw, CharmetantParameters, Compaction, CompressibleNeoHooke,
    EngineeringConstants, FibreNeoHooke, Friction, Hardening, IsochoricNeoHooke, Law, ModeParameters,
    StVenantKirchhoff,
};
use subrope_tests::{
    Brick, Dense, Lattice, Problem, Worst, brick, constant_frames, elevated, fields_of, patch_cube, relative,
    renumbered, rotated_connectivity, serendipity,
};

// ---------------------------------------------------------------------------------------------------- laws and meshes

/// Reproducible numbers in [-1, 1].
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn vector(&mut self, n: usize, size: f64) -> DVector<f64> {
        DVector::from_fn(n, |_, _| size * self.next())
    }
}

/// A frame in general position.
fn frame() -> Matrix3<f64> {
    *Rotation3::from_scaled_axis(Vector3::new(0.4, -0.9, 0.7)).matrix()
}

fn bundle(mu: [f64; 2], x: [f64; 2], compaction: Compaction) -> BundleLaw {
    let mode =
        |k, tau, h, x, mu| ModeParameters::sliding(k, Friction { tau, hardening: Hardening::Linear { h }, x, mu });
    BundleLaw::new(BundleParameters {
        k_e: 650.0,
        k_ec: 65.0,
        w_e: 0.005,
        k_c: 45.0,
        nu: 0.5,
        compaction,
        transverse: mode(10.0, 0.05, 0.5, x[0], mu[0]),
        longitudinal: mode(8.0, 0.1, 1.0, x[1], mu[1]),
    })
    .unwrap()
}

fn elastic_bundle() -> BundleLaw {
    BundleLaw::new(bundle([0.0; 2], [0.0; 2], Compaction::Quadratic).parameters().without_friction()).unwrap()
}

fn frictional() -> BundleLaw {
    bundle([0.0; 2], [0.4, 0.7], Compaction::Power { k_p: 300.0, m: 3.0 })
}

fn pressing() -> BundleLaw {
    bundle([0.3, 0.15], [0.0; 2], Compaction::LockUp { z_lock: -0.9 })
}

fn charmetant() -> CharmetantLaw {
    CharmetantLaw::new(CharmetantParameters {
        k_elong: 650.0,
        k_elong_initial: 65.0,
        toe: 0.005,
        k_comp: 200.0,
        p: 3.0,
        k_rest: 45.0,
        k_dist: 10.0,
        k_sh: 8.0,
    })
    .unwrap()
}

fn orthotropic() -> StVenantKirchhoff {
    StVenantKirchhoff::orthotropic(&EngineeringConstants {
        e1: 300.0,
        e2: 60.0,
        e3: 50.0,
        nu12: 0.3,
        nu13: 0.25,
        nu23: 0.2,
        g12: 50.0,
        g13: 40.0,
        g23: 23.0,
    })
    .unwrap()
}

fn mesh_of(kind: Brick, mesh: &Mesh) -> Mesh {
    match kind {
        Brick::Plain | Brick::MeanVolume | Brick::MeanElongation => mesh.clone(),
        Brick::Serendipity | Brick::Reduced => serendipity(&elevated(mesh), kind.kind()),
        Brick::Quadratic => elevated(mesh),
    }
}

/// One brick, a cube or badly distorted.
fn single(distorted: bool) -> Mesh {
    let lattice = Lattice::new([1, 1, 1], CellKind::Hex8);
    let mut noise = Noise(7);
    let mut mesh = lattice.mesh(|x| x);
    if distorted {
        mesh.points.iter_mut().for_each(|p| *p += Vector3::from_fn(|_, _| 0.2 * noise.next()));
    }
    mesh
}

fn two_distorted() -> Mesh {
    let mut noise = Noise(11);
    let mut mesh = Lattice::new([1, 1, 2], CellKind::Hex8).mesh(|[x, y, z]| [x, y, 2.0 * z]);
    mesh.points.iter_mut().for_each(|p| *p += Vector3::from_fn(|_, _| 0.12 * noise.next()));
    mesh
}

fn free(mesh: &Mesh) -> Kinematics {
    Kinematics::new(mesh.points.clone(), Vec::new()).unwrap()
}

fn dense<L: Law + 'static>(kind: Brick, mesh: &Mesh, law: L) -> Dense {
    let mesh = mesh_of(kind, mesh);
    let solid = brick(kind, &mesh, &constant_frames(&mesh, frame()), law).unwrap();
    Dense::new(free(&mesh), solid)
}

/// Runs a check for every brick with every law that can fill it.
macro_rules! for_all {
    ($check:ident) => {
        for kind in Brick::ALL {
            for_all!($check, kind, "orthotropic", orthotropic());
            for_all!($check, kind, "isotropic", StVenantKirchhoff::isotropic(100.0, 0.3).unwrap());
            for_all!($check, kind, "neo-Hooke", CompressibleNeoHooke::new(0.5, 1.2).unwrap());
            for_all!($check, kind, "isochoric neo-Hooke", IsochoricNeoHooke::new(0.4225, 0.9).unwrap());
            for_all!($check, kind, "fibre neo-Hooke", FibreNeoHooke::new(1.0, 1.0, 100.0).unwrap());
            for_all!($check, kind, "Charmetant", charmetant());
            for_all!($check, kind, "elastic bundle", elastic_bundle());
            for_all!($check, kind, "bundle with friction", frictional());
            for_all!($check, kind, "bundle with pressure", pressing());
        }
    };
    ($check:ident, $kind:expr, $name:expr, $law:expr) => {
        if $kind.takes(&$law) {
            $check($kind, $name, || $law);
        }
    };
}

// ---------------------------------------------------------------------------------------------------------- patch test

/// Runs the patch with its outer nodes moved by `motion`.
fn patch<L: Law + 'static>(kind: Brick, law: L, motion: impl Fn(&Vector3<f64>) -> Vector3<f64>) -> (Mesh, Problem) {
    let mesh = mesh_of(kind, &patch_cube());
    let outside = |p: &Vector3<f64>| p.iter().any(|x| x.abs() < 1e-12 || (x - 1.0).abs() < 1e-12);
    let solid = brick(kind, &mesh, &constant_frames(&mesh, frame()), law).unwrap();
    let mut problem = Problem::new(&mesh, solid, Vec::new()).unwrap();
    let mut step = problem.step(Increments::Fixed(1));
    for (node, x) in mesh.points.iter().enumerate().filter(|(_, x)| outside(x)) {
        step = step.place(node as u32, &motion(x));
    }
    let step = step.build();
    problem.run(&step).unwrap();
    (mesh, problem)
}

/// Deformation gradient and Cauchy stress of every integration point.
fn samples(mesh: &Mesh, problem: &Problem) -> Vec<(Matrix3<f64>, Matrix3<f64>)> {
    let contributions = &problem.analysis.model().contributions;
    let mut out = Vec::new();
    for e in 0..mesh.cell_count() {
        let fields = fields_of(contributions);
        fields
            .sample(e, problem.analysis.displacement(), &mut |_, s| out.push((s.deformation_gradient, s.cauchy_stress)))
            .unwrap();
    }
    out
}

fn linear_motion(x: &Vector3<f64>) -> Vector3<f64> {
    Matrix3::new(2.0, 1.0, 1.0, 1.0, 2.0, 1.0, 1.0, 1.0, 2.0) * x * 0.5e-3
}

#[test]
fn linear_patch() {
    let sigma = Matrix3::from_fn(|i, j| if i == j { 2000.0 } else { 400.0 });
    // So small a motion that the law is linear: the numbers scale.
    let scale = 1e-7;
    for kind in Brick::ALL {
        let motion = |x: &Vector3<f64>| linear_motion(x) * scale;
        let (mesh, problem) = if kind == Brick::MeanElongation {
            // E = 1e6, nu = .25: mu = lambda = 4e5, with a fibre that carries nothing.
            patch(kind, FibreNeoHooke::new(4e5, 4e5, 1e-12).unwrap(), motion)
        } else {
            patch(kind, StVenantKirchhoff::isotropic(1e6, 0.25).unwrap(), motion)
        };
        let mut worst = Worst::default();
        for (node, x) in mesh.points.iter().enumerate() {
            let u = problem.displacement(node as u32) / scale;
            worst.see("nodes", (u - linear_motion(x)).norm() / 1e-3);
        }
        for (_, stress) in samples(&mesh, &problem) {
            worst.see("stress", (stress / scale - sigma).amax() / 2000.0);
        }
        println!("{kind:?}: {worst}");
        assert!(worst.largest() < 1e-8, "{kind:?}: {worst}");
    }
}

#[test]
fn finite_patch() {
    let f = Matrix3::new(1.3, 0.2, -0.1, 0.15, 0.9, 0.25, -0.05, 0.1, 1.1);
    let piola = Matrix3::new(
        0.4365671,
        0.13925838,
        -0.06327044,
        0.12587002,
        0.13482707,
        0.15596436,
        -0.05596436,
        0.12519915,
        0.29786166,
    );
    let energy = 0.14019847012063;
    for kind in Brick::ALL {
        let motion = |x: &Vector3<f64>| (f - Matrix3::identity()) * x;
        let (mesh, problem) = if kind == Brick::MeanElongation {
            patch(kind, FibreNeoHooke::new(0.5, 1.2, 1e-15).unwrap(), motion)
        } else {
            patch(kind, CompressibleNeoHooke::new(0.5, 1.2).unwrap(), motion)
        };
        let mut worst = Worst::default();
        for (node, x) in mesh.points.iter().enumerate() {
            worst.see("nodes", (problem.displacement(node as u32) + x - f * x).norm());
        }
        for (gradient, cauchy) in samples(&mesh, &problem) {
            worst.see("F", (gradient - f).amax());
            let first = cauchy * f.try_inverse().unwrap().transpose() * f.determinant();
            // Given to eight decimals.
            worst.see("P", ((first - piola).amax() - 0.5e-8).max(0.0));
        }
        worst.see("W", relative(problem.analysis.totals().stored, energy));
        println!("{kind:?}: {worst}");
        assert!(worst.largest() < 1e-10, "{kind:?}: {worst}");
    }
}

#[test]
fn finite_patch_with_fibres() {
    let f = Matrix3::new(1.3, 0.2, -0.1, 0.15, 0.9, 0.25, -0.05, 0.1, 1.1);
    fn check<L: Law + 'static>(kind: Brick, name: &str, law: impl Fn() -> L, f: &Matrix3<f64>) {
        let (mesh, problem) = patch(kind, law(), |x| (f - Matrix3::identity()) * x);
        let mut worst = Worst::default();
        for (node, x) in mesh.points.iter().enumerate() {
            worst.see("nodes", (problem.displacement(node as u32) + x - f * x).norm());
        }
        let all = samples(&mesh, &problem);
        for (gradient, cauchy) in &all {
            worst.see("F", (gradient - f).amax());
            worst.see("stress", (cauchy - all[0].1).amax() / all[0].1.amax());
        }
        println!("{kind:?}, {name}: {worst}");
        assert!(worst.largest() < 1e-9, "{kind:?}, {name}: {worst}");
    }
    for kind in Brick::ALL {
        check(kind, "fibre neo-Hooke", || FibreNeoHooke::new(1.0, 1.0, 100.0).unwrap(), &f);
        check(kind, "elastic bundle", elastic_bundle, &f);
        check(kind, "Charmetant", charmetant, &f);
    }
}

#[test]
fn patch_energy_with_fibres_is_that_of_a_point() {
    let f = Matrix3::new(1.3, 0.2, -0.1, 0.15, 0.9, 0.25, -0.05, 0.1, 1.1);
    for kind in Brick::ALL {
        // I4 - 1 of the fibre adds k/2 (I4 - 1)^2 to the energy of the plain patch.
        let k = 1e-3;
        let law = FibreNeoHooke::new(0.5, 1.2, k).unwrap();
        let (_, problem) = patch(kind, law, |x| (f - Matrix3::identity()) * x);
        let i4 = (f * frame().column(0)).norm_squared();
        let reference = 0.14019847012063 + 0.5 * k * (i4 - 1.0).powi(2);
        let error = relative(problem.analysis.totals().stored, reference);
        assert!(error < 1e-10, "{kind:?}: {error:e}");
    }
}

// --------------------------------------------------------------------------------------------------------- eigenvalues

/// Checks that so many eigenvalues of a free body are zero, and no more.
fn zeros(count: usize, mut dense: Dense, name: &str) {
    let n = dense.kinematics.coordinate_count();
    let stiffness = dense.stiffness(&DVector::zeros(n));
    let symmetry = (&stiffness - stiffness.transpose()).amax() / stiffness.amax();
    assert!(symmetry < 1e-13, "{name}: unsymmetric by {symmetry:e}");
    let mut eigenvalues: Vec<f64> = stiffness.symmetric_eigenvalues().iter().copied().collect();
    eigenvalues.sort_by(f64::total_cmp);
    let largest = eigenvalues[n - 1];
    let zero = eigenvalues[..count].iter().fold(0.0_f64, |m, v| m.max(v.abs())) / largest;
    let next = eigenvalues[count] / largest;
    println!("{name}: {count} zeros {zero:.1e}, the next {next:.1e}");
    assert!(zero < 1e-13, "{name}: {count} zeros are {zero:e}");
    assert!(next > 1e-9, "{name}: the one after {count} is {next:e}");
}

/// 2 x 2 x 2 points see 48 of the 60 motions of a brick of 20 nodes: six beside the rigid ones cost nothing.
fn six_zeros<L: Law + 'static>(kind: Brick, name: &str, law: impl Fn() -> L) {
    let count = if kind == Brick::Reduced { 12 } else { 6 };
    for distorted in [false, true] {
        zeros(count, dense(kind, &single(distorted), law()), &format!("{kind:?}, {name}, distorted {distorted}"));
    }
}

/// The motions that cost a reduced brick nothing go on along a row of straight bricks, three in two of them; not where
/// bricks are distorted, nor where four meet at an edge.
fn zeros_of_rows<L: Law + 'static>(kind: Brick, name: &str, law: impl Fn() -> L) {
    if kind != Brick::Reduced {
        return;
    }
    let block = |cells| Lattice::new(cells, CellKind::Hex8).mesh(|[x, y, z]| [x, y, z]);
    zeros(9, dense(kind, &block([1, 1, 2]), law()), &format!("a row of two, {name}"));
    zeros(6, dense(kind, &two_distorted(), law()), &format!("a distorted row of two, {name}"));
    zeros(6, dense(kind, &block([2, 2, 1]), law()), &format!("four about an edge, {name}"));
}

#[test]
fn exactly_six_zero_eigenvalues() {
    for_all!(six_zeros);
    for_all!(zeros_of_rows);
}

// ----------------------------------------------------------------------------------------------------------- stiffness

fn stiffness_is_derivative<L: Law + 'static>(kind: Brick, name: &str, law: impl Fn() -> L) {
    let mut dense = dense(kind, &single(true), law());
    let n = dense.kinematics.coordinate_count();
    let mut noise = Noise(3);
    let q = noise.vector(n, 0.06);
    dense.commit(&(&q * 0.7));
    // Loading goes on in some points and turns back in others.
    let q = q + noise.vector(n, 0.03);
    let exact = dense.stiffness(&q);
    let differences = dense.differenced_stiffness(&q, 2e-6);
    let error = (&exact - &differences).amax() / exact.amax();
    println!("{kind:?}, {name}: {error:.1e}");
    assert!(error < 1e-7, "{kind:?}, {name}: stiffness off by {error:e}");
}

#[test]
fn stiffness_is_the_derivative_of_the_forces() {
    for_all!(stiffness_is_derivative);
}

fn forces_are_slopes<L: Law + 'static>(kind: Brick, name: &str, law: impl Fn() -> L) {
    if !law().has_potential() {
        return;
    }
    let mut dense = dense(kind, &single(true), law());
    let n = dense.kinematics.coordinate_count();
    let mut noise = Noise(5);
    let q = noise.vector(n, 0.06);
    dense.commit(&(&q * 0.7));
    let q = q + noise.vector(n, 0.02);
    let residual = dense.residual(&q);
    let mut worst = 0.0_f64;
    for c in 0..n {
        let mut energy = |step: f64| {
            let mut moved = q.clone();
            moved[c] += step;
            dense.evaluate(&moved, Request::Residual).unwrap().1.potential
        };
        let h = 1e-5;
        let slope = (8.0 * (energy(h) - energy(-h)) - (energy(2.0 * h) - energy(-2.0 * h))) / (12.0 * h);
        worst = worst.max((slope - residual[c]).abs() / residual.amax());
    }
    println!("{kind:?}, {name}: {worst:.1e}");
    assert!(worst < 1e-8, "{kind:?}, {name}: forces off by {worst:e}");
}

#[test]
fn forces_are_the_slopes_of_the_incremental_potential() {
    for_all!(forces_are_slopes);
}

// ---------------------------------------------------------------------------------------------------------------- ties

#[derive(Clone, Copy, Debug)]
enum Ends {
    Rigid,
    Radial,
    /// Two parts that slide obliquely, and a strip between them that does not.
    Sliding,
}

impl Ends {
    const ALL: [Self; 3] = [Self::Rigid, Self::Radial, Self::Sliding];

    fn kind(self, mesh: &Mesh, nodes: &[u32]) -> SectionKind {
        let part = |x: f64, y: f64| {
            let direction = Vector3::new(x, y, 0.4);
            let nodes = nodes.iter().copied().filter(|&n| x * (mesh.points[n as usize].x - 0.5) > 0.2).collect();
            Slide { direction, nodes }
        };
        match self {
            Self::Rigid => SectionKind::Rigid,
            Self::Radial => SectionKind::Radial,
            Self::Sliding => SectionKind::Sliding(vec![part(1.0, 0.3), part(-1.0, 0.5)]),
        }
    }
}

fn ends(mesh: &Mesh, kind: Ends) -> Vec<Section> {
    let centre = |z: f64| Vector3::new(0.45, 0.55, z);
    [("low", 0.0, false), ("high", 2.0, true)]
        .map(|(name, z, top)| {
            let all = 0..mesh.point_count() as u32;
            let nodes: Vec<u32> = all.filter(|&n| is_end(&mesh.points[n as usize], top)).collect();
            let kind = kind.kind(mesh, &nodes);
            Section { name: name.into(), position: centre(z), axis: Vector3::z(), nodes, kind }
        })
        .into()
}

fn is_end(x: &Vector3<f64>, top: bool) -> bool {
    if top { x.z > 1.6 } else { x.z < 0.4 }
}

/// Two bricks between sections turned by large angles.
fn tied<L: Law + 'static>(kind: Brick, section: Ends, law: L) -> (Dense, DVector<f64>) {
    let mesh = mesh_of(kind, &two_distorted());
    let solid = brick(kind, &mesh, &constant_frames(&mesh, frame()), law).unwrap();
    let kinematics = Kinematics::new(mesh.points.clone(), ends(&mesh, section)).unwrap();
    let mut dense = Dense::new(kinematics, solid);
    let n = dense.kinematics.coordinate_count();
    let mut noise = Noise(23);
    // The whole body turned by 100 degrees, so that the ends turn much and strain little.
    let turn = Vector3::new(0.9, -1.1, 1.0);
    let rotation = Rotation3::from_scaled_axis(turn);
    let mut q = noise.vector(n, 0.02);
    for (node, x) in mesh.points.iter().enumerate() {
        if let subrope_fem::kinematics::NodeRule::Free { first } = dense.kinematics.rules()[node] {
            let u = rotation * x - x;
            (0..3).for_each(|k| q[first as usize + k] += u[k]);
        }
    }
    for point in dense.kinematics.points() {
        let (first, u) = (point.first as usize, rotation * point.position - point.position);
        (0..3).for_each(|k| q[first + k] += u[k]);
        (0..3).for_each(|k| q[first + 3 + k] += turn[k]);
    }
    dense.commit(&(&q + noise.vector(n, 0.02)));
    (dense, q)
}

#[test]
fn stiffness_of_ties_is_the_derivative_of_the_residual() {
    fn check<L: Law + 'static>(kind: Brick, name: &str, law: impl Fn() -> L) {
        for section in Ends::ALL {
            let (mut dense, q) = tied(kind, section, law());
            let exact = dense.stiffness(&q);
            let differences = dense.differenced_stiffness(&q, 2e-6);
            let error = (&exact - &differences).amax() / exact.amax();
            println!("{kind:?}, {section:?}, {name}: {error:.1e}");
            assert!(error < 1e-7, "{kind:?}, {section:?}, {name}: stiffness off by {error:e}");
        }
    }
    for kind in Brick::ALL {
        check(kind, "fibre neo-Hooke", || FibreNeoHooke::new(1.0, 1.0, 100.0).unwrap());
        check(kind, "bundle with friction", frictional);
        check(kind, "bundle with pressure", pressing);
    }
}

#[test]
fn parts_slide_on_directions_that_turn_with_the_section() {
    let mesh = mesh_of(Brick::Plain, &two_distorted());
    let kinematics = Kinematics::new(mesh.points.clone(), ends(&mesh, Ends::Sliding)).unwrap();
    let (point, turn, shift) = (&kinematics.points()[1], Vector3::new(0.3, -0.8, 1.1), Vector3::new(0.1, 0.2, 0.3));
    let mut q = vec![0.0; kinematics.coordinate_count()];
    q[point.first as usize..point.first as usize + 6].copy_from_slice(&[shift.as_slice(), turn.as_slice()].concat());
    q[point.slides[0] as usize] = 0.25;
    let mut u = vec![0.0; 3 * mesh.point_count()];
    kinematics.displacements(&q, &mut u);
    let rotation = Rotation3::from_scaled_axis(turn);
    let direction = Vector3::new(1.0, 0.3, 0.4).normalize();
    for &node in &point.nodes {
        let x = mesh.points[node as usize];
        let slid = if x.x - 0.5 > 0.2 { direction * 0.25 } else { Vector3::zeros() };
        let moved = x + Vector3::from_column_slice(&u[3 * node as usize..3 * node as usize + 3]);
        let expected = point.position + shift + rotation * (x - point.position + slid);
        assert!((moved - expected).norm() < 1e-14, "{moved} {expected}");
    }
    let refused = |change: fn(&mut Vec<Slide>)| {
        let mut sections = ends(&mesh, Ends::Sliding);
        let SectionKind::Sliding(parts) = &mut sections[1].kind else { unreachable!() };
        change(parts);
        let error = Kinematics::new(mesh.points.clone(), sections).err();
        assert!(matches!(error, Some(FemError::BadSlide { part: 2, .. })), "{error:?}");
    };
    refused(|parts| parts[1].direction = Vector3::zeros());
    refused(|parts| parts[1].nodes.clear());
    refused(|parts| parts[1].nodes = parts[0].nodes.clone());
    refused(|parts| parts[1].nodes.push(0));
}

/// The moment on a reference point is spatial: it works on a turn about fixed axes through its current position.
#[test]
fn reaction_moments_are_slopes_of_the_energy() {
    for kind in Brick::ALL {
        for section in Ends::ALL {
            let (mut dense, q) = tied(kind, section, FibreNeoHooke::new(1.0, 1.0, 100.0).unwrap());
            dense.evaluate(&q, Request::Residual).unwrap();
            for point in 0..2 {
                let nodal = dense.nodal_forces().to_vec();
                let (force, moment) = dense.kinematics.section_resultant(point, q.as_slice(), &nodal);
                let first = dense.kinematics.points()[point].first as usize;
                let mut energy = |k: usize, step: f64| {
                    let mut moved = q.clone();
                    if k < 3 {
                        moved[first + k] += step;
                    } else {
                        let now = Rotation3::from_scaled_axis(q.fixed_rows::<3>(first + 3).into_owned());
                        let turned = Rotation3::from_scaled_axis(Vector3::ith(k - 3, step)) * now;
                        moved.rows_mut(first + 3, 3).copy_from(&turned.scaled_axis());
                    }
                    dense.evaluate(&moved, Request::Residual).unwrap().1.potential
                };
                let h = 1e-5;
                let slope = |energy: &mut dyn FnMut(usize, f64) -> f64, k: usize| {
                    let (near, far) = (energy(k, h) - energy(k, -h), energy(k, 2.0 * h) - energy(k, -2.0 * h));
                    (8.0 * near - far) / (12.0 * h)
                };
                let slopes: Vec<f64> = (0..6).map(|k| slope(&mut energy, k)).collect();
                let value = [force.x, force.y, force.z, moment.x, moment.y, moment.z];
                let size = force.amax().max(moment.amax());
                let error = slopes.iter().zip(value).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / size;
                println!("{kind:?}, {section:?}, point {point}: {error:.1e}");
                assert!(error < 1e-7, "{kind:?}, {section:?}, point {point}: {slopes:?} and {value:?}");
            }
        }
    }
}

// -------------------------------------------------------------------------------------------------------- rigid motion

fn rigid_motion<L: Law + 'static>(kind: Brick, name: &str, law: impl Fn() -> L) {
    let mesh = mesh_of(kind, &patch_cube());
    let solid = || brick(kind, &mesh, &constant_frames(&mesh, frame()), law()).unwrap();
    let mut dense = Dense::new(free(&mesh), solid());
    let rotation = Rotation3::from_scaled_axis(Vector3::new(1.2, -2.0, 0.8));
    let shift = Vector3::new(3.0, -5.0, 2.0);
    let n = 3 * mesh.point_count();
    let moved = |u: &DVector<f64>| {
        let mut out = DVector::zeros(n);
        for (a, x) in mesh.points.iter().enumerate() {
            let place = x + u.fixed_rows::<3>(3 * a);
            out.fixed_rows_mut::<3>(3 * a).copy_from(&(rotation * place + shift - x));
        }
        out
    };
    // Rigid motion of the undeformed body: no forces, no energy.
    let stiffness = dense.stiffness(&DVector::zeros(n)).amax();
    let (residual, energies) = dense.evaluate(&moved(&DVector::zeros(n)), Request::Residual).unwrap();
    assert!(residual.amax() < 1e-13 * stiffness, "{kind:?}, {name}: forces {:e}", residual.amax() / stiffness);
    assert!(energies.stored.abs() < 1e-24 * stiffness, "{kind:?}, {name}: energy {:e}", energies.stored);
    // Rigid motion of a deformed body: the forces turn, the energies stay.
    let u = Noise(9).vector(n, 0.01);
    let (forces, energies) = dense.evaluate(&u, Request::Residual).unwrap();
    let (turned, same) = dense.evaluate(&moved(&u), Request::Residual).unwrap();
    let mut worst = Worst::default();
    for a in 0..mesh.point_count() {
        let expected = rotation * forces.fixed_rows::<3>(3 * a);
        worst.see("forces", (turned.fixed_rows::<3>(3 * a) - expected).norm() / forces.amax());
    }
    worst.see("stored", relative(same.stored, energies.stored));
    for mode in 0..2 {
        let size = energies.dissipated_mid[mode].max(1e-9 * energies.stored);
        worst.see("dissipated", (same.dissipated_mid[mode] - energies.dissipated_mid[mode]).abs() / size);
    }
    println!("{kind:?}, {name}: {worst}");
    assert!(worst.largest() < 1e-10, "{kind:?}, {name}: {worst}");
}

#[test]
fn rigid_motion_leaves_no_trace() {
    for_all!(rigid_motion);
}

// ----------------------------------------------------------------------------------------------------------- numbering

fn numbering<L: Law + 'static>(kind: Brick, name: &str, law: impl Fn() -> L) {
    let mesh = mesh_of(kind, &patch_cube());
    let (n, nodes) = (3 * mesh.point_count(), mesh.point_count());
    let evaluate = |mesh: &Mesh, u: &DVector<f64>| {
        let solid = brick(kind, mesh, &constant_frames(mesh, frame()), law()).unwrap();
        Dense::new(free(mesh), solid).evaluate(u, Request::Residual).unwrap()
    };
    let reversed = |v: &DVector<f64>| DVector::from_fn(n, |i, _| v[3 * (nodes - 1 - i / 3) + i % 3]);
    let u = Noise(13).vector(n, 0.02);
    let (forces, energies) = evaluate(&mesh, &u);
    let mut worst = Worst::default();
    let (turned, same) = evaluate(&rotated_connectivity(&mesh), &u);
    worst.see("forces of turned bricks", (turned - &forces).amax() / forces.amax());
    worst.see("energy of turned bricks", relative(same.stored, energies.stored));
    let (other, same) = evaluate(&renumbered(&mesh), &reversed(&u));
    worst.see("forces of other numbers", (reversed(&other) - &forces).amax() / forces.amax());
    worst.see("energy of other numbers", relative(same.stored, energies.stored));
    println!("{kind:?}, {name}: {worst}");
    assert!(worst.largest() < 1e-12, "{kind:?}, {name}: {worst}");
}

#[test]
fn numbering_does_not_matter() {
    for_all!(numbering);
}

// ------------------------------------------------------------------------------------- far coordinates, units, turning

/// A short twisted strand, bent, stretched and turned, with friction; lengths times `length`, stresses times `stress`,
/// everything moved by `offset` and turned by `rotation` in its reference configuration.
struct Bent {
    length: f64,
    stress: f64,
    offset: Vector3<f64>,
    rotation: Rotation3<f64>,
    kind: Brick,
}

impl Bent {
    fn plain(kind: Brick) -> Self {
        Self { length: 1.0, stress: 1.0, offset: Vector3::zeros(), rotation: Rotation3::identity(), kind }
    }

    fn law(&self) -> BundleLaw {
        let s = self.stress;
        let mode = |k: f64, tau: f64, h: f64| ModeParameters::sliding(k * s, Friction::isotropic(tau * s, h * s));
        BundleLaw::new(BundleParameters {
            k_e: 650.0 * s,
            k_ec: 65.0 * s,
            w_e: 0.005,
            k_c: 45.0 * s,
            nu: 0.5,
            compaction: Compaction::Quadratic,
            transverse: mode(10.0, 0.05, 0.5),
            longitudinal: mode(8.0, 0.2, 1.0),
        })
        .unwrap()
    }

    /// Dimensionless moment, force, energies and displacements, turned back.
    fn solve(&self) -> Vec<f64> {
        let l = self.length;
        let strand = Strand {
            layers: 8,
            length: 16.0,
            kind: self.kind.kind(),
            section: SectionShape { core_cells: 2, rings: 1, ..SectionShape::default() },
            ..Strand::default()
        };
        let mut mesh = strand.mesh().unwrap();
        let place = |x: Vector3<f64>| self.rotation * x * l + self.offset;
        mesh.points.iter_mut().for_each(|x| *x = place(*x));
        let axis = Axis::new(self.offset, self.rotation * Vector3::z()).unwrap();
        let field = HelicalFibres::new(axis, Lay::from_rate((PI / 6.0).tan() / (2.785 * l)).unwrap());
        let frames = fibre_frames(&mesh, &field).unwrap();
        let solid = brick(self.kind, &mesh, &frames, self.law()).unwrap();
        let section = |name: &str, z: f64| Section {
            name: name.into(),
            position: place(Vector3::new(0.0, 0.0, z)),
            axis: self.rotation * Vector3::z(),
            nodes: mesh.node_sets[name].clone(),
            kind: SectionKind::Rigid,
        };
        let sections = vec![section(sets::END_A, -8.0), section(sets::END_B, 8.0)];
        let mut problem = Problem::new(&mesh, solid, sections).unwrap();
        let mut step = problem.step(Increments::Fixed(4)).hold(0, &[]).hold(1, &[]);
        let turns = [Vector3::new(0.25, 0.0, 0.0), Vector3::new(-0.25, 0.05, 0.1)].map(|v| self.rotation * v);
        let shift = self.rotation * Vector3::new(0.1, -0.1, 0.1) * l;
        for k in 0..3 {
            step = step.point(0, 3 + k, turns[0][k as usize]).point(1, 3 + k, turns[1][k as usize]);
            step = step.point(1, k, shift[k as usize]);
        }
        let step = step.build();
        let rows = problem.run(&step).unwrap();
        let (row, back) = (rows.last().unwrap(), self.rotation.inverse());
        let (s, v) = (self.stress, self.stress * l * l * l);
        let mut out = Vec::new();
        for [force, moment] in &row.reaction {
            out.extend((back * force / (s * l * l)).iter());
            out.extend((back * moment / v).iter());
        }
        let t = &row.totals;
        out.extend([t.stored, t.dissipated[0], t.dissipated[1], t.external_work].map(|e| e / v));
        for node in (0..mesh.point_count() as u32).step_by(7) {
            out.extend((back * problem.displacement(node) / l).iter());
        }
        out
    }
}

/// Largest difference of the second list over the size of the numbers of the first.
fn deviation(a: &[f64], b: &[f64]) -> f64 {
    let part = |r: std::ops::Range<usize>| {
        let size = a[r.clone()].iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        r.map(|i| (a[i] - b[i]).abs()).fold(0.0, f64::max) / size
    };
    // Forces and moments together, each energy for itself, displacements together.
    [part(0..12), part(12..13), part(13..14), part(14..15), part(15..16), part(16..a.len())]
        .into_iter()
        .fold(0.0, f64::max)
}

#[test]
fn far_from_the_origin() {
    for kind in Brick::ALL {
        let near = Bent::plain(kind).solve();
        let far = Bent { offset: Vector3::new(1e6, -1e6, 1e6), ..Bent::plain(kind) }.solve();
        let error = deviation(&near, &far);
        println!("{kind:?}: {error:.1e}");
        assert!(error < 1e-7, "{kind:?}: {error:e}");
    }
}

#[test]
fn units_do_not_matter() {
    for kind in Brick::ALL {
        let millimetre = Bent::plain(kind).solve();
        // N-m: lengths over 1000, stresses in Pa. kN-mm: stresses in GPa.
        for (length, stress) in [(1e-3, 1e6), (1.0, 1e-3)] {
            let other = Bent { length, stress, ..Bent::plain(kind) }.solve();
            let error = deviation(&millimetre, &other);
            println!("{kind:?}, length {length:e}, stress {stress:e}: {error:.1e}");
            assert!(error < 1e-9, "{kind:?}, length {length:e}, stress {stress:e}: {error:e}");
        }
    }
}

#[test]
fn a_turned_strand_gives_turned_reactions() {
    for kind in Brick::ALL {
        let straight = Bent::plain(kind).solve();
        let rotation = Rotation3::from_scaled_axis(Vector3::new(0.7, -1.3, 0.4));
        let turned = Bent { rotation, offset: Vector3::new(3.0, -2.0, 1.0), ..Bent::plain(kind) }.solve();
        let error = deviation(&straight, &turned);
        println!("{kind:?}: {error:.1e}");
        assert!(error < 1e-8, "{kind:?}: {error:e}");
    }
}
