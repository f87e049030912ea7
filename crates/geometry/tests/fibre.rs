//! Fibre fields: closed forms, orthonormality, continuity on the axis, sampling on meshes.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use nalgebra::{Matrix3, Vector3};
use proptest::prelude::*;
use std::f64::consts::PI;
use subrope_geometry::fibre::frame_deviation;
use subrope_geometry::quality::fibre_angles;
use subrope_geometry::*;

const RADIUS: f64 = 2.785;

fn thirty_degrees() -> Lay {
    Lay::from_angle(RADIUS, PI / 6.0, Handedness::Right).unwrap()
}

#[test]
fn helical_fibres_follow_their_formula() {
    let field = HelicalFibres::new(Axis::default(), thirty_degrees());
    for (x, y, z) in [(0.3, 1.1, 4.0), (-2.0, 0.4, -9.0), (0.0, -2.785, 0.0), (1e-7, 2e-7, 3.0)] {
        let r = f64::hypot(x, y);
        let t = r / RADIUS * (PI / 6.0).tan();
        let e1 = Vector3::new(-t * y / r, t * x / r, 1.0) / t.hypot(1.0);
        let frame = field.frame(&Vector3::new(x, y, z), 0).unwrap();
        assert!((frame.column(0) - e1).amax() < 1e-15);
        assert!((frame.column(1) - Vector3::new(x / r, y / r, 0.0)).amax() < 1e-15);
        assert!((frame.column(2) - e1.cross(&Vector3::new(x / r, y / r, 0.0))).amax() < 1e-15);
    }
}

#[test]
fn the_fibre_is_continuous_on_the_axis() {
    let axis = Axis::new(Vector3::new(1e6, -1e6, 1e6), Vector3::new(1.0, 2.0, -0.5)).unwrap();
    let field = HelicalFibres::new(axis, thirty_degrees());
    let on_axis = field.frame(&axis.position(0.0, 0.0, 12.0), 0).unwrap();
    assert!((on_axis.column(0) - axis.direction()).amax() < 1e-9);
    assert!(frame_deviation(&on_axis) < 1e-15);
    for angle in [0.0, 1.0, 2.0, 4.0] {
        let near = axis.position(1e-3 * f64::cos(angle), 1e-3 * f64::sin(angle), 12.0);
        let frame = field.frame(&near, 0).unwrap();
        assert!((frame.column(0) - on_axis.column(0)).amax() < 1e-3 && frame_deviation(&frame) < 1e-14);
    }
}

#[test]
fn an_untwisted_field_is_parallel() {
    let field = HelicalFibres::new(Axis::default(), Lay::PARALLEL);
    assert_eq!(field.frame(&Vector3::new(1.0, 2.0, 3.0), 0).unwrap().column(0), Vector3::z());
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn frames_are_orthonormal(
        x in prop::array::uniform3(-2.0..2.0_f64), s in -100.0..100.0_f64, pitch in 10.0..60.0_f64, left: bool,
        direction in prop::array::uniform3(-1.0..1.0_f64).prop_filter("direction", |d| Vector3::from(*d).norm() > 0.1),
    ) {
        let lay = Lay::from_pitch(if left { -pitch } else { pitch }).unwrap();
        let axis = Axis::new(Vector3::new(0.1, 0.2, 0.3), direction.into()).unwrap();
        let straight = HelicalFibres::new(axis, lay).frame(&x.into(), 0).unwrap();
        prop_assert!(frame_deviation(&straight) < 1e-14);
        let helix = Helix::new(axis, 3.0, Lay::from_pitch(40.0).unwrap(), 0.5).unwrap();
        let near = helix.position(s) + Vector3::from(x);
        if let Ok(frame) = FibresAlongHelix::new(helix, lay).frame(&near, 0) {
            prop_assert!(frame_deviation(&frame) < 1e-13);
        }
    }

    /// The field of a strand with a helical axis is the tangent of the yarn through the point, by differences.
    #[test]
    fn fields_along_a_helix_are_tangent_to_yarns(
        s in -60.0..60.0_f64, r in 0.0..2.5_f64, phase in -3.0..3.0_f64, pitch in 15.0..50.0_f64,
        left: bool, back: bool,
    ) {
        let sign = |negative: bool| if negative { -1.0 } else { 1.0 };
        let lay = Lay::from_pitch(sign(left) * pitch).unwrap();
        let helix = Helix::new(Axis::default(), 3.2, Lay::from_pitch(sign(back) * 50.0).unwrap(), 0.7).unwrap();
        let yarn = Yarn::new(helix, lay, r, phase).unwrap();
        let frame = FibresAlongHelix::new(helix, lay).frame(&yarn.position(s), 0).unwrap();
        let h = 1e-4;
        let difference = (yarn.position(s + h) - yarn.position(s - h)).normalize();
        prop_assert!((frame.column(0) - difference).norm() < 1e-7);
        let offset = yarn.position(s) - helix.position(s);
        prop_assert!((frame.column(1) * r - offset).norm() < 1e-10);
    }
}

#[test]
fn a_helix_of_no_curvature_gives_helical_fibres() {
    let lay = thirty_degrees();
    let line = Helix::new(Axis::default(), 4.0, Lay::PARALLEL, 0.0).unwrap();
    let beside = Axis::new(Vector3::new(4.0, 0.0, 0.0), Vector3::z()).unwrap();
    let (a, b) = (FibresAlongHelix::new(line, lay), HelicalFibres::new(beside, lay));
    let x = Vector3::new(3.1, 1.2, 5.0);
    assert!((a.frame(&x, 0).unwrap() - b.frame(&x, 0).unwrap()).amax() < 1e-14);
}

#[test]
fn beyond_the_centre_of_curvature_is_an_error() {
    let helix = Helix::new(Axis::default(), 3.0, Lay::from_pitch(4.0).unwrap(), 0.0).unwrap();
    let frame = helix.frenet(0.0);
    let x = frame.position + frame.normal * (1.02 / helix.curvature());
    // Its nearest point may be another one; the axis of the helix itself is beyond every centre of a steep helix.
    let field = FibresAlongHelix::new(helix, Lay::PARALLEL);
    match field.frame(&x, 0) {
        Err(GeometryError::BeyondCurvature { distance, curvature_radius, .. }) => assert!(distance >= curvature_radius),
        other => assert!(frame_deviation(&other.unwrap()) < 1e-13),
    }
}

#[test]
fn frames_are_sampled_in_the_order_of_the_quadrature() {
    let strand = Strand { layers: 3, ..Strand::default() };
    let mesh = strand.mesh().unwrap();
    let frames = fibre_frames(&mesh, &strand.fibres()).unwrap();
    assert_eq!(frames.len(), 8 * mesh.cell_count());
    let (cell, point) = (77, 5);
    let nodes = mesh.cell_points::<8>(cell).unwrap();
    let at = map_point::<Hex8, 8>(&nodes, Hex8::quadrature()[point].xi).unwrap();
    assert_eq!(frames[8 * cell + point], strand.fibres().frame(&at.position, cell).unwrap());
    let centroids = centroid_frames(&mesh, &strand.fibres()).unwrap();
    assert_eq!(centroids.len(), mesh.cell_count());
    let constant = fibre_frames(&mesh, &PerCellFrames::new(centroids.clone()).unwrap()).unwrap();
    assert_eq!(constant[8 * cell + point], centroids[cell]);
    let angles = fibre_angles(&mesh, &frames, &Vector3::z()).unwrap();
    assert!(angles.least > 0.0 && angles.greatest < 31_f64.to_radians());
    // Mean over the circle of atan(t r/R): (tan a)^-2 ((1 + t^2) a - t), t = tan a.
    let (a, t) = (PI / 6.0, (PI / 6.0).tan());
    let mean = ((1.0 + t * t) * a - t) / (t * t);
    assert!((angles.mean / mean - 1.0).abs() < 5e-3, "{} against {mean}", angles.mean);
    assert!(fibre_angles(&mesh, &frames[1..], &Vector3::z()).is_err());
}

#[test]
fn bad_frames_are_refused() {
    assert!(PerCellFrames::new(vec![Matrix3::identity(), Matrix3::identity() * 1.1]).is_err());
    assert!(Parallel::new(Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, -1.0))).is_err());
    assert!(Parallel::new(Matrix3::from_element(f64::NAN)).is_err());
    assert!(PerCellFrames(vec![]).frame(&Vector3::zeros(), 0).is_err());
    assert!(frame_from_directions(&Vector3::x(), &Vector3::x()).is_err());
    let frame = frame_from_directions(&Vector3::new(0.0, 0.0, 2.0), &Vector3::new(1.0, 0.0, 5.0)).unwrap();
    assert!((frame - Matrix3::from_columns(&[Vector3::z(), Vector3::x(), Vector3::y()])).amax() < 1e-15);
}
