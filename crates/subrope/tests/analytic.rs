//! The line load of laid strands in closed form.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::f64::consts::TAU;

use subrope::analytic::LaidStrands;

fn rope(strands: usize, degrees: f64) -> LaidStrands {
    LaidStrands::touching(strands, 2.785, degrees.to_radians()).unwrap()
}

/// How far the line load is above the textbook's, over the latter.
fn departure(degrees: f64) -> f64 {
    let rope = rope(3, degrees);
    rope.line_load(500.0) / rope.textbook_line_load(500.0) - 1.0
}

/// Departures of 3, 6 and 19 % of the textbook's value, stated to the percent; they grow as the square of the angle from
/// nothing.
#[test]
fn the_textbook_is_the_limit_of_a_small_lay() {
    for (degrees, stated) in [(15.0, 0.03), (20.0, 0.06), (30.0, 0.19)] {
        let found = departure(degrees);
        assert!((found - stated).abs() < 0.005, "{degrees} degrees: {found} instead of {stated}");
    }
    let small = departure(0.1);
    assert!(small.abs() < 1e-5, "{small}");
    let order = (departure(2.0) / departure(1.0)).log2();
    assert!(order > 1.9, "order {order}");
}

/// The radial parts of both lines carry the strand's pull inwards; two axes are 2 r apart where they touch.
#[test]
fn touching_points_and_balance() {
    for strands in [2, 3, 4, 6] {
        for degrees in [5.0, 15.0, 25.0] {
            let rope = rope(strands, degrees);
            let (a, u) = (rope.helix_radius, rope.touching_angle());
            let offset = u - TAU / strands as f64;
            let rise = a * offset / rope.lay_angle.tan();
            let apart = (2.0 * a * (0.5 * u).sin()).hypot(rise);
            assert!((apart / (2.0 * rope.tube_radius) - 1.0).abs() < 1e-12, "{strands} {degrees}: {apart}");
            let lines = if strands == 2 { 1.0 } else { 2.0 };
            let inward = rope.lay_angle.sin().powi(2) / a;
            let carried = lines * rope.line_load(1.0) * rope.radial_part();
            assert!((carried / inward - 1.0).abs() < 1e-14);
        }
    }
}
