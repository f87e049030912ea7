//! Contact that starts badly: strands that overlap or stand apart, hardly any or much friction, loads that turn.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use subrope_contact::{Contact, contacts};
use subrope_tests::{Run, rod_on_strand, run_scene, short_rope};

/// A short rope of set C with a gap over its radius, pulled and taken to compression and back.
fn reversed(gap: f64, friction: f64) -> Run {
    let steps = r#"
[[step]]
name = "pull"
tension = { elongation = 0.015 }
[[step]]
name = "cycle"
increments = { maximum = 0.25 }
[step.cycles]
count = 2
of = "elongation"
low = -0.005
high = 0.015
"#;
    let text = short_rope(steps)
        .replace("friction = 0.15", &format!("friction = {friction:?}"))
        .replace("lay_angle", &format!("gap = {gap:?}\nlay_angle"));
    run_scene(&text, None)
}

/// Largest penetration in the four layers in the middle of ten \[mm\].
fn deepest_between_ends(contact: &Contact) -> f64 {
    let middle = contact.points().filter(|p| (3..7).contains(&(contact.secondary().face(p.patch) / 8)));
    middle.filter(|p| p.state.pressure > 0.0).map(|p| -p.state.gap).fold(0.0, f64::max)
}

#[test]
fn overlapping_and_distant_strands_converge_through_reversals() {
    for gap in [-0.05, 0.05] {
        for friction in [0.0, 0.5, 2.0] {
            let run = reversed(gap, friction);
            let totals = run.model.analysis.totals();
            let iterations: usize = run.rows.iter().map(|r| r.record.iterations).sum();
            let most = run.rows.iter().map(|r| r.record.iterations).max().unwrap();
            println!(
                "gap {gap}, friction {friction}: {} increments, {} cut back, {iterations} iterations, at most {most}; interference {:.3} mJ, \
                 friction {:.4} mJ, stored {:.3} mJ, energy error {:.1e}",
                run.rows.len(),
                run.failures.len(),
                totals.interference,
                totals.contact_friction,
                totals.stored,
                totals.energy_error()
            );
            // What pressing the overlap apart puts in stands by itself.
            assert_eq!(totals.interference > 0.0, gap < 0.0);
            assert_eq!(totals.contact_friction > 0.0, friction > 0.0);
            // Increments are long: twice as many bring a quarter of this.
            assert!(totals.energy_error().abs() < 0.04, "energy error {}", totals.energy_error());
            // Between the ends, which are held where they overlap, no more than the penalty allows is left of it.
            let deepest = contacts(&run.model.analysis).map(deepest_between_ends).fold(0.0, f64::max);
            assert!(deepest < 0.01 * 2.785, "penetration {deepest}");
            // Contact settles: increments converge well within the iterations allowed, and hardly any is repeated.
            assert!(most <= 15 && run.failures.len() <= 3, "{most} iterations, {:?}", run.failures);
        }
    }
}

/// A rod pressed by half the radius of a strand and taken back, twice, with friction: it converges.
#[test]
fn a_rod_is_pressed_deep_and_taken_back() {
    for friction in [0.0, 2.0] {
        let steps = r#"
[[step]]
name = "press"
increments = { maximum = 0.25 }
prescribe = [{ point = "ROD", ux = -1.39 }]
[[step]]
name = "lift"
increments = { maximum = 0.25 }
prescribe = [{ point = "ROD", ux = -0.5 }]
[[step]]
name = "press again"
increments = { maximum = 0.25 }
prescribe = [{ point = "ROD", ux = -1.39 }]
"#;
        let text = rod_on_strand(friction, steps);
        let run = run_scene(&text, None);
        let rod = run.point("ROD");
        let force = -run.model.analysis.point_reaction(rod).0.x;
        let most = run.rows.iter().map(|r| r.record.iterations).max().unwrap();
        println!(
            "friction {friction}: {force} N, {} increments, at most {most} iterations, {:?}",
            run.rows.len(),
            run.failures
        );
        assert!(force > 1.0 && most <= 15);
    }
}

/// With the pressure of the last iterate as its limit, friction has a potential: where minimising it ends is the state that
/// Newton's method finds with the exact tangent.
#[test]
fn friction_minimised_is_friction() {
    let steps = r#"
[[step]]
name = "press"
increments = { fixed = 3 }
prescribe = [{ point = "ROD", ux = -0.3 }]
[[step]]
name = "rub"
increments = { fixed = 2 }
prescribe = [{ point = "ROD", uz = 0.13 }]
"#;
    let exact = rod_on_strand(0.3, steps);
    let minimised = exact.replace("friction = 0.3", "friction = 0.3\ntangent = \"symmetric\"")
        + "\n[solver]\ntrust_region = \"always\"\n";
    let [exact, minimised] = [exact, minimised].map(|text| run_scene(&text, None));
    let force = |run: &Run| run.model.analysis.point_reaction(run.point("ROD")).0;
    let (wanted, found) = (force(&exact), force(&minimised));
    let lost = |run: &Run| run.model.analysis.totals().contact_friction;
    println!(
        "{wanted:?} N with the exact tangent, {found:?} N minimised; {} and {} mJ",
        lost(&exact),
        lost(&minimised)
    );
    assert!(minimised.model.analysis.totals().minimised >= 5 && lost(&exact) > 0.0);
    assert!((found - wanted).norm() < 1e-6 * wanted.norm());
    assert!((lost(&minimised) - lost(&exact)).abs() < 1e-6 * lost(&exact));
}
