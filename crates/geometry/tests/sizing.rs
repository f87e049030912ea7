//! Sizing: the published hierarchy, and what any hierarchy must obey.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use proptest::prelude::*;
use std::f64::consts::PI;
use subrope_geometry::sizing::{Check, Origin, Relation, strand_contraction};
use subrope_geometry::{Hierarchy, Quantity, SizingReport};

/// Civier, Bles, Davies, Marco (MARINE 2023), Table 1, and the surface angle of its bent strand.
fn published() -> Hierarchy {
    Hierarchy {
        filament_dtex: Some(6.7),
        filaments_per_yarn: Some(280),
        yarn_tex: Some(188.0),
        yarns_per_rope_yarn: Some(13),
        rope_yarns_per_strand: Some(10),
        strands: 3,
        density: Some(1140.0),
        strand_angle: Some(PI / 6.0),
        rope_tex: Some(90_000.0),
        ..Hierarchy::default()
    }
}

fn value(report: &SizingReport, quantity: Quantity) -> f64 {
    report.value(quantity).unwrap()
}

#[test]
fn the_published_rope() {
    let report = published().report();
    assert!((value(&report, Quantity::FibreTex) / 73_320.0 - 1.0).abs() < 1e-12);
    assert_eq!(report.known[&Quantity::FibreTex].origin, Origin::Derived(Relation::Fibre));
    assert!((90_000.0 / value(&report, Quantity::FibreTex) - 1.2275).abs() < 1e-5);
    assert!((value(&report, Quantity::FilamentDiameter) - 0.027).abs() < 4e-4);
    // 6.7 dtex x 280 is 187.6 tex, 188 tex are told.
    let told_twice: Vec<&Check> = report.contradictions(1e-3).collect();
    assert_eq!((told_twice.len(), told_twice[0].relation), (1, Relation::Yarn));
    assert!((told_twice[0].implied.unwrap() - 187.6).abs() < 1e-10);
    assert!((told_twice[0].difference - 0.4 / 187.6).abs() < 1e-12);
    assert_eq!(report.contradictions(1e-2).count(), 0);
    // Coating and lay angle share one relation.
    let open = report.open.iter().find(|open| open.relation == Relation::Contraction).unwrap();
    assert_eq!(open.unknown, [Quantity::Coating, Quantity::LayAngle]);
    assert!(report.missing().any(|quantity| quantity == Quantity::LayAngle));
    assert!(report.to_string().contains("open: give all but one of mass of coating over mass of fibre, lay angle"));
}

/// Between no coating and 8 % the lay angle runs from 28.5 to 18 deg; at a packing of 0.8 circles have 13.4 to 13.7 mm.
#[test]
fn lay_angle_and_diameter_follow_from_coating_and_packing() {
    for (coating, degrees, diameter) in [(0.0, 28.5, 13.4), (0.08, 18.3, 13.7)] {
        let hierarchy = Hierarchy { coating: Some(coating), packing: Some(0.8), ..published() };
        let report = hierarchy.report();
        assert!((value(&report, Quantity::LayAngle).to_degrees() - degrees).abs() < 0.06, "{report}");
        assert!((value(&report, Quantity::OuterDiameter) - diameter).abs() < 0.02, "{report}");
        assert!(report.open.is_empty() && report.impossible.is_empty() && report.inadmissible.is_empty(), "{report}");
    }
}

/// Circles of this mass in 12 mm would have to be more than solid.
#[test]
fn circles_do_not_fit_in_twelve_millimetres() {
    let hierarchy = Hierarchy { coating: Some(0.06), outer_diameter: Some(12.0), ..published() };
    let report = hierarchy.report();
    let packing = value(&report, Quantity::Packing);
    assert!(packing > 1.0 && packing < 1.1, "{report}");
    assert_eq!(report.inadmissible, [(Quantity::Packing, packing)]);
}

#[test]
fn contradictions_carry_both_values() {
    let angle = 20_f64.to_radians();
    let hierarchy = Hierarchy { coating: Some(0.3), lay_angle: Some(angle), ..published() };
    let report = hierarchy.report();
    let check = report.contradictions(0.01).next().unwrap();
    let implied = 73_320.0 * 1.3 * strand_contraction(PI / 6.0) / angle.cos();
    assert_eq!((check.quantity, check.value), (Quantity::RopeTex, 90_000.0));
    assert!((check.implied.unwrap() / implied - 1.0).abs() < 1e-12);
    // More coating than mass: no lay angle fits.
    let report = Hierarchy { lay_angle: None, ..hierarchy }.report();
    assert_eq!(report.impossible, [(Relation::Contraction, Quantity::LayAngle)]);
    let senseless = Hierarchy { strands: 1, coating: Some(-0.5), density: Some(f64::NAN), ..published() }.report();
    assert_eq!(senseless.inadmissible.len(), 3);
    assert!(senseless.value(Quantity::Density).is_none());
}

/// A lay length or a diameter binds radius and lay angle together: two relations with the same two unknowns.
#[test]
fn radius_and_lay_angle_follow_together() {
    let angle = 22_f64.to_radians();
    let known = Hierarchy { packing: Some(0.75), lay_angle: Some(angle), gap: Some(0.02), ..published() };
    let full = known.report();
    let [radius, diameter, lay_length] =
        [Quantity::StrandRadius, Quantity::OuterDiameter, Quantity::LayLength].map(|q| value(&full, q));
    let open = Hierarchy { lay_angle: None, ..known };
    for part in [
        Hierarchy { lay_length: Some(lay_length), ..open },
        Hierarchy { outer_diameter: Some(diameter), ..open },
        Hierarchy { rope_tex: None, lay_length: Some(lay_length), outer_diameter: Some(diameter), ..open },
    ] {
        let report = part.report();
        assert!((value(&report, Quantity::StrandRadius) / radius - 1.0).abs() < 1e-9, "{report}");
        assert!((value(&report, Quantity::LayAngle) / angle - 1.0).abs() < 1e-9, "{report}");
        assert!(report.checks.iter().all(|check| check.relation == Relation::Yarn), "{report}");
    }
    // The helix radius of flattened strands is another one.
    let flattened = Hierarchy { gap: None, lay_length: Some(lay_length), ..open }.report();
    assert_eq!(flattened.value(Quantity::LayAngle), None);
    let sources = full.sources(Quantity::OuterDiameter);
    assert!(sources.contains(&Quantity::Packing) && !sources.contains(&Quantity::YarnTex), "{sources:?}");
    // Straight strands have no lay length, which is no contradiction.
    let straight = Hierarchy { lay_angle: Some(0.0), ..known }.report();
    assert!(straight.impossible.is_empty() && straight.value(Quantity::OuterDiameter).is_some(), "{straight}");
}

#[test]
fn contraction_of_a_twisted_strand() {
    let (n, t) = (200_000, (PI / 6.0).tan());
    let mean = (0..n).map(|i| f64::hypot(1.0, t * ((f64::from(i) + 0.5) / f64::from(n)).sqrt())).sum::<f64>();
    assert!((strand_contraction(PI / 6.0) - mean / f64::from(n)).abs() < 1e-9);
    assert_eq!(strand_contraction(0.0), 1.0);
    assert!((strand_contraction(1e-5) - 1.0 - 2.5e-11).abs() < 1e-15);
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever one of the values of a consistent rope is left out, it follows again.
    #[test]
    fn what_is_left_out_follows(
        angle in 0.05..0.6_f64, coating in 0.01..0.2_f64, packing in 0.5..0.95_f64, tex in 20.0..500.0_f64,
        strands in 2..7_u32, left_out in 0..6_usize,
    ) {
        let start = Hierarchy {
            lay_angle: Some(angle), coating: Some(coating), packing: Some(packing), yarn_tex: Some(tex), strands,
            rope_tex: None, filament_dtex: None, ..published()
        };
        let full = start.report();
        prop_assert!(full.open.is_empty() && full.checks.is_empty(), "{full}");
        let all = Hierarchy {
            rope_tex: full.value(Quantity::RopeTex),
            strand_radius: full.value(Quantity::StrandRadius),
            outer_diameter: full.value(Quantity::OuterDiameter),
            ..start
        };
        let (quantity, part) = [
            (Quantity::LayAngle, Hierarchy { lay_angle: None, ..all }),
            (Quantity::Coating, Hierarchy { coating: None, ..all }),
            (Quantity::Packing, Hierarchy { packing: None, ..all }),
            (Quantity::YarnTex, Hierarchy { yarn_tex: None, ..all }),
            (Quantity::StrandRadius, Hierarchy { strand_radius: None, ..all }),
            (Quantity::OuterDiameter, Hierarchy { outer_diameter: None, ..all }),
        ][left_out];
        let report = part.report();
        let (found, exact) = (value(&report, quantity), value(&full, quantity));
        prop_assert!((found / exact - 1.0).abs() < 1e-9, "{quantity}: {found} {exact}");
        prop_assert!(report.checks.iter().all(|check| check.difference < 1e-9), "{report}");
    }
}
