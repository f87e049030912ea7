//! Lay relations, Frenet frames, nearest points, two-level yarns.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use nalgebra::Vector3;
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};
use subrope_geometry::{
    Axis, GeometryError, Handedness, Helix, Lay, Strand, StrandEnds, Yarn, touching_pair, touching_radius,
    touching_radius_at_angle,
};

fn close(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance * (1.0 + a.abs().max(b.abs()))
}

fn sample(axis: [f64; 3], radius: f64, pitch: f64, phase: f64) -> Helix {
    let axis = Axis::new(Vector3::new(3.0, -2.0, 1.0), axis.into()).unwrap();
    Helix::new(axis, radius, Lay::from_pitch(pitch).unwrap(), phase).unwrap()
}

#[test]
fn the_strand_of_thirty_degrees() {
    let lay = Lay::from_angle(2.5, PI / 6.0, Handedness::Right).unwrap();
    assert!(close(lay.pitch(), 27.206990463513265, 1e-14));
    assert_eq!(lay.handedness(), Some(Handedness::Right));
    assert_eq!(Lay::from_pitch(-20.0).unwrap().handedness(), Some(Handedness::Left));
    assert_eq!(Lay::PARALLEL.handedness(), None);
    assert_eq!(Lay::PARALLEL.lay_length(), f64::INFINITY);
    assert_eq!(Lay::PARALLEL.angle(3.0), 0.0);
}

#[test]
fn bad_lays_and_helices_are_refused() {
    assert!(Lay::from_pitch(0.0).is_err() && Lay::from_pitch(f64::NAN).is_err());
    assert!(Lay::from_lay_length(-3.0, Handedness::Right).is_err());
    assert!(Lay::from_angle(1.0, PI / 2.0, Handedness::Right).is_err());
    assert!(Lay::from_angle(0.0, 0.3, Handedness::Right).is_err());
    assert!(Lay::from_arc_length(1.0, TAU, Handedness::Right).is_err());
    assert!(Helix::new(Axis::default(), 0.0, Lay::PARALLEL, 0.0).is_err());
    assert!(Axis::new(Vector3::zeros(), Vector3::zeros()).is_err());
    assert!(Axis::with_reference(Vector3::zeros(), Vector3::z(), Vector3::z() * 2.0).is_err());
    let helix = sample([0.0, 0.0, 1.0], 2.0, 20.0, 0.0);
    let failure = helix.nearest(&Vector3::new(f64::NAN, 0.0, 0.0));
    assert!(matches!(failure, Err(GeometryError::NoNearestPoint { .. })));
}

#[test]
fn a_right_handed_helix_turns_right() {
    let helix = Helix::new(Axis::default(), 2.0, Lay::from_pitch(10.0).unwrap(), 0.0).unwrap();
    let quarter = helix.position(helix.arc_length(2.5));
    assert!((quarter - Vector3::new(0.0, 2.0, 2.5)).norm() < 1e-14);
    assert!(helix.torsion() > 0.0);
    let left = Helix::new(Axis::default(), 2.0, Lay::from_pitch(-10.0).unwrap(), 0.0).unwrap();
    assert!((left.position(left.arc_length(2.5)) - Vector3::new(0.0, -2.0, 2.5)).norm() < 1e-14);
    assert!(left.torsion() < 0.0);
}

fn check_frenet(helix: &Helix, s: f64) {
    let (h, frame) = (1e-4, helix.frenet(s));
    let (low, high) = (helix.frenet(s - h), helix.frenet(s + h));
    let slope = |f: fn(&subrope_geometry::FrenetFrame) -> Vector3<f64>| (f(&high) - f(&low)) / (2.0 * h);
    let (kappa, tau) = (helix.curvature(), helix.torsion());
    assert!((slope(|f| f.position) - frame.tangent).norm() < 1e-7);
    assert!((slope(|f| f.tangent) - frame.normal * kappa).norm() < 1e-7);
    assert!((slope(|f| f.normal) - (frame.binormal * tau - frame.tangent * kappa)).norm() < 1e-7);
    assert!((slope(|f| f.binormal) + frame.normal * tau).norm() < 1e-7);
    assert!((frame.tangent.norm() - 1.0).abs() < 1e-14 && (frame.normal.norm() - 1.0).abs() < 1e-14);
    assert!((frame.tangent.cross(&frame.normal) - frame.binormal).norm() < 1e-15);
}

/// No sampled point of the helix is nearer than the one found.
fn check_nearest(helix: &Helix, x: &Vector3<f64>) {
    let found = helix.nearest(x).unwrap();
    let distance = (helix.position(found) - x).norm();
    let turn = helix.lay().arc_length(helix.radius());
    for i in -400..=400 {
        let other = (helix.position(found + turn * f64::from(i) / 200.0) - x).norm();
        assert!(other >= distance - 1e-9, "{other} < {distance} at {i}");
    }
    let residual = (x - helix.position(found)).dot(&helix.tangent(found));
    assert!(residual.abs() < 1e-9 * (1.0 + distance), "{residual}");
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn relations_of_a_lay(radius in 0.01..50.0_f64, angle in 0.01..1.5_f64, left: bool) {
        let hand = if left { Handedness::Left } else { Handedness::Right };
        let lay = Lay::from_angle(radius, angle, hand).unwrap();
        prop_assert!(close(lay.angle(radius), angle, 1e-14));
        prop_assert!(close(lay.lay_length(), TAU * radius / angle.tan(), 1e-13));
        prop_assert!(close(lay.pitch(), hand.sign() * lay.lay_length(), 1e-14));
        prop_assert!(close(lay.arc_length(radius), TAU * radius / angle.sin(), 1e-13));
        let again = [
            Lay::from_pitch(lay.pitch()).unwrap(),
            Lay::from_lay_length(lay.lay_length(), hand).unwrap(),
            Lay::from_arc_length(radius, lay.arc_length(radius), hand).unwrap(),
        ];
        for other in again {
            prop_assert!((other.rate() / lay.rate() - 1.0).abs() < 1e-10);
        }
        let helix = Helix::new(Axis::default(), radius, lay, 0.3).unwrap();
        prop_assert!(close(helix.curvature(), angle.sin().powi(2) / radius, 1e-13));
        prop_assert!(close(helix.torsion(), hand.sign() * angle.sin() * angle.cos() / radius, 1e-13));
        prop_assert!(close(helix.stretch(), angle.cos().recip(), 1e-13));
        prop_assert!(close(helix.axial(helix.arc_length(7.0)), 7.0, 1e-14));
    }

    #[test]
    fn frenet_formulas(
        axis in prop::array::uniform3(-1.0..1.0_f64).prop_filter("direction", |d| Vector3::from(*d).norm() > 0.1),
        radius in 0.5..4.0_f64, pitch in 8.0..60.0_f64, left: bool, phase in -3.0..3.0_f64, s in -80.0..80.0_f64,
    ) {
        check_frenet(&sample(axis, radius, if left { -pitch } else { pitch }, phase), s);
    }

    #[test]
    fn nearest_points(
        radius in 0.2..6.0_f64, pitch in 2.0..60.0_f64, left: bool, phase in -3.0..3.0_f64,
        x in prop::array::uniform3(-15.0..15.0_f64),
    ) {
        let helix = sample([0.3, -0.2, 1.0], radius, if left { -pitch } else { pitch }, phase);
        check_nearest(&helix, &x.into());
    }

    #[test]
    fn points_near_a_helix_return_their_parameter(
        s in -200.0..200.0_f64, r in 0.0..2.0_f64, angle in -3.0..3.0_f64,
    ) {
        let helix = sample([0.0, 0.0, 1.0], 3.0, 40.0, 0.4);
        let frame = helix.frenet(s);
        let x = frame.position + frame.normal * (r * angle.cos()) + frame.binormal * (r * angle.sin());
        prop_assert!((helix.nearest(&x).unwrap() - s).abs() < 1e-11 * (1.0 + s.abs()));
    }

    #[test]
    fn yarn_tangents_match_differences(
        s in -50.0..50.0_f64, r in 0.0..2.5_f64, phase in -3.0..3.0_f64, pitch in 15.0..50.0_f64, left: bool,
    ) {
        let strand = sample([0.1, 0.7, -0.4], 3.1, 45.0, 0.2);
        let lay = Lay::from_pitch(if left { -pitch } else { pitch }).unwrap();
        let yarn = Yarn::new(strand, lay, r, phase).unwrap();
        let h = 1e-4;
        let difference = (yarn.position(s + h) - yarn.position(s - h)).normalize();
        prop_assert!((difference - yarn.tangent(s)).norm() < 1e-7);
    }
}

#[test]
fn nearest_point_of_a_steep_helix_far_out() {
    let helix = sample([0.0, 0.0, 1.0], 5.0, 1.0, 0.0);
    for i in 0..200 {
        let angle = f64::from(i) * TAU / 200.0;
        check_nearest(&helix, &Vector3::new(3.0 + 9.0 * angle.cos(), -2.0 + 9.0 * angle.sin(), 0.37 * angle));
    }
}

#[test]
fn a_straight_helix_is_a_line_beside_the_axis() {
    let helix = Helix::new(Axis::default(), 2.0, Lay::PARALLEL, 0.0).unwrap();
    assert_eq!((helix.curvature(), helix.torsion()), (0.0, 0.0));
    assert_eq!(helix.nearest(&Vector3::new(5.0, 1.0, 7.5)).unwrap(), 7.5);
    assert_eq!(helix.tangent(3.0), Vector3::z());
}

#[test]
fn yarns_thicker_than_the_curvature_are_refused() {
    let strand = sample([0.0, 0.0, 1.0], 3.0, 20.0, 0.0);
    let limit = strand.curvature().recip();
    assert!(Yarn::new(strand, Lay::PARALLEL, 1.01 * limit, 0.0).is_err());
    assert!(Yarn::new(strand, Lay::PARALLEL, 0.99 * limit, 0.0).is_ok());
}

/// Helix radius over tube radius of a triple helix, by an independent minimisation.
#[test]
fn three_strands_touch() {
    let table = [
        (0.0, 1.154700538),
        (10.0, 1.15928505),
        (20.0, 1.17562992),
        (25.0, 1.1910),
        (30.0, 1.21458713),
        (35.0, 1.2508),
        (45.0, 1.3887),
    ];
    for (degrees, ratio) in table {
        let angle = f64::to_radians(degrees);
        let a = touching_radius_at_angle(3, 2.785, angle).unwrap();
        let tolerance = if ratio.to_string().len() > 7 { 1e-8 } else { 5e-5 };
        assert!((a / 2.785 - ratio).abs() < tolerance, "{degrees}: {}", a / 2.785);
        let lay = Lay::from_angle(a, angle, Handedness::Left).unwrap();
        assert!(close(touching_radius(3, 2.785, lay).unwrap(), a, 1e-12));
    }
    assert_eq!(touching_radius_at_angle(2, 1.5, 0.0).unwrap(), 1.5);
}

/// The helices found are 2 r apart, by sampling one against the nearest point of the other.
#[test]
fn touching_helices_are_two_radii_apart() {
    for (strands, pitch) in [(3, 40.0), (4, 60.0), (2, 30.0)] {
        let lay = Lay::from_pitch(pitch).unwrap();
        let a = touching_radius(strands, 2.0, lay).unwrap();
        let other = Helix::new(Axis::default(), a, lay, TAU / strands as f64).unwrap();
        let x = Helix::new(Axis::default(), a, lay, 0.0).unwrap().position(0.0);
        assert!(((other.position(other.nearest(&x).unwrap()) - x).norm() - 4.0).abs() < 1e-12);
    }
    let short = touching_radius(3, 2.0, Lay::from_pitch(11.0).unwrap());
    assert!(matches!(short, Err(GeometryError::StrandsDoNotFit { strands: 3, .. })));
    assert!(touching_radius(1, 2.0, Lay::PARALLEL).is_err());
}

/// The least distance of neighbouring helices, 2 pi/n apart, by brute force: samples, then ever closer ones.
fn sampled_distance(radius: f64, angle: f64, strands: usize) -> f64 {
    let k = angle.tan() / radius;
    let [delta, pitch] = [TAU / strands as f64, k.recip()];
    let squared = |u: f64| 2.0 * radius * radius * (1.0 - u.cos()) + ((u - delta) * pitch).powi(2);
    let (mut centre, mut width) = (delta, TAU);
    for _ in 0..40 {
        let samples = (-200..=200).map(|i| centre + width * f64::from(i) / 200.0);
        centre = samples.min_by(|a, b| squared(*a).total_cmp(&squared(*b))).unwrap();
        width *= 0.5;
    }
    squared(centre).sqrt()
}

#[test]
fn touching_radius_against_brute_force() {
    for degrees in [5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0, 45.0] {
        for strands in [2, 3, 4, 6] {
            let angle = f64::to_radians(degrees);
            let a = touching_radius_at_angle(strands, 1.0, angle).unwrap();
            let distance = sampled_distance(a, angle, strands);
            assert!((distance - 2.0).abs() < 1e-12, "{strands} at {degrees} deg: {distance}");
        }
    }
}

/// Least distance of two helices, by walking along one with the nearest point of the other.
#[test]
fn two_unequal_strands_touch() {
    let radii = [2.0, 1.3];
    for lay_length in [30.0, 48.0, 400.0] {
        let lay = Lay::from_lay_length(lay_length, Handedness::Left).unwrap();
        let [a, b] = touching_pair(radii, lay).unwrap();
        let first = Helix::new(Axis::default(), a, lay, 0.3).unwrap();
        let second = Helix::new(Axis::default(), b, lay, 0.3 + PI).unwrap();
        let distance = (0..1000).map(|i| {
            let x = first.position(0.1 * f64::from(i));
            (second.position(second.nearest(&x).unwrap()) - x).norm()
        });
        assert!(close(distance.fold(f64::INFINITY, f64::min), 3.3, 1e-12));
        assert!(close(a * radii[0] * radii[0], b * radii[1] * radii[1], 1e-14), "tensions balance");
    }
    let equal = touching_pair([1.5, 1.5], Lay::from_lay_length(40.0, Handedness::Right).unwrap()).unwrap();
    assert!(close(equal[0], 1.5, 1e-14) && close(equal[1], 1.5, 1e-14));
    let short = Lay::from_lay_length(8.0, Handedness::Right).unwrap();
    assert!(matches!(touching_pair(radii, short), Err(GeometryError::StrandsDoNotFit { strands: 2, .. })));
    assert!(touching_pair([0.0, 1.0], short).is_err());
}

#[test]
fn a_strand_on_a_helix_has_the_length_of_the_rope() {
    let lay = Lay::from_lay_length(40.0, Handedness::Right).unwrap();
    let helix = Helix::new(Axis::default(), 2.0, lay, 0.0).unwrap();
    let strand = Strand { radius: 1.5, layers: 4, ..Strand::on_helix(helix, 20.0) };
    assert_eq!(strand.ends, StrandEnds::Flat);
    let mesh = strand.mesh().unwrap();
    let ends = ["END_A", "END_B"].map(|end| mesh.node_sets[end].iter().map(|&n| mesh.points[n as usize].z));
    for (z, expected) in ends.into_iter().zip([-10.0, 10.0]) {
        assert!(z.into_iter().all(|z| close(z, expected, 1e-12)));
    }
}
