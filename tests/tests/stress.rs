//! Stress lists: verdicts on whole scenes, planted failures, scenes in other units and far from the origin, snaps that are
//! told. The whole table is docs/stress.md.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use subrope::stress::{
    Ended, Quiet, Run, StressList, StressReport, Twin, Verdict, csv, difference, markdown, run_lists,
};
use subrope_fem::analysis::Totals;
use subrope_tests::{run_scene, try_run};

const STRAND: &str = r#"
[scene.bent]
title = "bent"
[scene.bent.strand]
radius = 2.785
length = 20.0
surface_angle = 30.0
mesh = { core = 2, rings = 1, layers = 4 }
[scene.bent.law]
kind = "bundle"
K_e = 2000.0
K_ec = 100.0
w_e = 0.005
nu = 0.5
K_c = 60.0
K_t = 15.0
tau_t = 0.05
H_t = 0.1
K_l = 20.0
tau_l = 1.0
H_l = 0.3
[[scene.bent.end]]
name = "END_A"
[[scene.bent.end]]
name = "END_B"
[[scene.bent.step]]
name = "bend"
increments = { initial = 0.05, maximum = 0.1 }
bend = { angle = 10.0 }
[scene.bent.solver]
residual_tolerance = 1e-11
"#;

fn list(families: &str) -> StressList {
    let text = format!("title = \"test\"\n{STRAND}\n{families}");
    StressList::from_toml("list", &text).unwrap_or_else(|e| panic!("{e:?}"))
}

fn run(families: &str) -> StressReport {
    run_lists(&[list(families)], &[], None, &mut Quiet).unwrap()
}

fn family(name: &str, rest: &str) -> String {
    format!("[[family]]\nname = \"{name}\"\nquestion = \"q\"\nscene = \"bent\"\n{rest}\n")
}

#[test]
fn what_holds_holds_in_other_units_and_far_away() {
    let units = "within = 1e-9\ntwins = [{}, { length = 1e-6, stress = 1.0 }, { length = 1e6, stress = 1.0 }, \
        { length = 1e-3, stress = 1e6 }]";
    let far = "within = 1e-7\ntwins = [{ length = 1.0, stress = 1.0, shift = [1e6, -1e6, 1e6] }]";
    let pressure = "within = 1e-9\nset = { \"law.mu_t\" = 0.2, \"law.mu_l\" = 0.1 }";
    let report = run(&[family("units", units), family("far", far), family("pressure", pressure)].concat());
    assert_eq!(report.rows().count(), 6);
    for (family, row) in report.rows() {
        println!("{} {}: {:?} {:?}", family.name, row.member, row.difference, row.condition);
        assert_eq!(row.verdict, Verdict::Holds, "{}: {:?}", row.member, row.verdict);
        assert!(row.condition.unwrap() > 1.0 && row.condition.unwrap() < 1e12);
        assert_eq!(row.inertia_changes.is_some(), family.name != "pressure");
    }
    // A condition scaled to a unit diagonal knows no units.
    let conditions: Vec<f64> = report.families[0].rows.iter().filter_map(|r| r.condition).collect();
    assert!(conditions.windows(2).all(|w| (w[0] / w[1] - 1.0).abs() < 1e-6), "{conditions:?}");
    let table = markdown(&report);
    assert!(table.starts_with("6 members in 3 families: 6 hold, 0 stop as explained, 0 FAIL."), "{table}");
    assert_eq!(csv(&report).lines().count(), 7);
}

#[test]
fn planted_failures_are_found() {
    let impossible = "\"step[0].increments\" = { initial = 0.5, minimum = 0.4, maximum = 0.5 }\n\
        \"solver.max_iterations\" = 2\n\"solver.trust_region\" = \"off\"";
    let stops = format!("[family.set]\n{impossible}");
    let explained = format!("limits = {{ \"*\" = \"two iterations are too few\" }}\n{stops}");
    let wrong = "[family.set]\n\"law.K_e\" = -1.0";
    // Longer increments of sliding: the trapezoidal rule leaves more open than is allowed here.
    let open = "energy = 1e-12\n[family.set]\n\"step[0].increments\" = { fixed = 10 }";
    let exact = "within = 0.0\n";
    let report = run(&[
        family("stops", &stops),
        family("explained", &explained),
        family("refused", wrong),
        family("energy", open),
        family("digits", exact),
    ]
    .concat());
    let verdict = |name: &str| {
        let found = report.rows().find(|(family, _)| family.name == name).map(|(_, row)| row.verdict.clone());
        found.unwrap_or_else(|| panic!("{name}"))
    };
    for (name, expected) in
        [("stops", "increment fell below"), ("refused", "K_e"), ("energy", "energy balance"), ("digits", "differ by")]
    {
        let Verdict::Fails { causes } = verdict(name) else { panic!("{name}: {:?}", verdict(name)) };
        assert!(causes.iter().any(|c| c.contains(expected)), "{name}: {causes:?}");
    }
    assert!(matches!(verdict("explained"), Verdict::Stops { .. }), "{:?}", verdict("explained"));
    assert_eq!(report.failures().len(), 4);
}

#[test]
fn lists_that_are_wrong_are_told() {
    let bad = [
        (family("a", "[family.limits]\n\"nobody\" = \"x\""), "there is no member \"nobody\""),
        (family("a", "members = [\"x\"]\n[family.levels]\n\"law.K_e\" = [1.0, 2.0]"), "of one length"),
        (family("a", "[family.set]\n\"title.x\" = 1.0"), "no table"),
        (family("a", "").replace("\"bent\"", "\"straight\""), "no [scene.straight]"),
    ];
    for (text, expected) in bad {
        let error = run_lists(&[list(&text)], &[], None, &mut Quiet).unwrap_err();
        assert!(error.to_string().contains(expected), "{error}");
    }
    let only = ["nothing of that kind".to_owned()];
    let error = run_lists(&[list(&family("a", ""))], &only, None, &mut Quiet).unwrap_err();
    assert!(error.to_string().contains("there is no family"), "{error}");
    assert!(StressList::from_toml("list", "title = \"x\"\n[[family]]\nnam = 1\n").is_err());
}

/// A slender elastic strand, buckled to one side by its ends and pushed to the other by a load.
const ARCH: &str = r#"
title = "arch"
[strand]
radius = 2.0
length = 120.0
surface_angle = 0.0
mesh = { core = 2, rings = 1, layers = 16 }
[law]
kind = "bundle"
K_e = 1000.0
K_ec = 1000.0
K_c = 100.0
K_t = 100.0
K_l = 100.0
friction = false
[[end]]
name = "END_A"
[[end]]
name = "END_B"
[[step]]
name = "buckle"
increments = { initial = 0.005, maximum = 0.02, minimum = 1e-6 }
tension = { elongation = -0.03 }
traction = [{ surface = "LATERAL", ty = 0.01 }]
[[step]]
name = "push through"
increments = { initial = 0.01, maximum = 0.01, minimum = 1e-6 }
traction = [{ surface = "LATERAL", ty = -0.05 }]
"#;

fn totals(text: &str) -> Totals {
    let totals = *run_scene(text, None).model.analysis.totals();
    println!(
        "{} snaps, {:.3e} mJ, open {:.3e} mJ of {:.3e} mJ, error {:.2e}, damped {:.3e} mJ, {} changes of inertia",
        totals.jumps,
        totals.released,
        totals.open,
        totals.work_scale,
        totals.energy_error(),
        totals.stabilising,
        totals.inertia_changes
    );
    totals
}

/// Whatever goes to the other side, it is told: by the work of damping, or, jumped over in one increment, as too long to
/// tell.
#[test]
fn a_snap_is_told() {
    let damped = totals(&format!("{ARCH}[solver]\nstabilisation = {{ viscosity = 1e-3 }}\n"));
    assert!(damped.energy_error().abs() < 0.01 && damped.stabilising > 0.1 * damped.work_scale);
    assert!(!damped.is_unresolved());
    let once = "initial = 1.0, maximum = 1.0";
    // Where Newton's method goes from there hangs on roundings: to the other side, or nowhere.
    match try_run(&ARCH.replace("initial = 0.01, maximum = 0.01", once), None, 1) {
        Ok(Ok(run)) => {
            let jumped = run.model.analysis.totals();
            assert!(jumped.energy_error().abs() > 0.1, "it did not jump");
            assert!(jumped.jumps > 0 || jumped.is_unresolved());
        }
        Ok(Err(error)) => assert!(error.to_string().contains("step push through"), "{error}"),
        Err(error) => panic!("{error}"),
    }
}

/// Short increments up to the largest load: the tangent becomes singular, and the run says so before it ends there.
#[test]
fn the_largest_load_is_told_by_the_inertia() {
    let newton = &format!("{ARCH}[solver]\ntrust_region = \"off\"\n");
    let Ok(Err(error)) = try_run(newton, None, 1) else { panic!("a load beyond the largest was carried") };
    assert!(error.to_string().contains("step push through"), "{error}");
    let run = Run::of(newton, Twin::NONE, 60.0, None);
    assert!(matches!(run.ended, Ended::Stopped(_)), "{:?}", run.ended);
    assert!(run.measured.inertia_changes > 0 && run.measured.symmetric);
    assert!(run.measured.energy_error.abs() < 1e-2);
}

#[test]
fn smooth_paths_release_nothing() {
    let first = |text: &str| text.split("[[step]]\nname = \"push").next().map(str::to_owned).unwrap();
    let straight = first(ARCH).replace("elongation = -0.03", "elongation = 0.03");
    for text in [straight, first(ARCH)] {
        let totals = totals(&text);
        assert_eq!(totals.jumps, 0);
        assert!(!totals.is_unresolved());
    }
}

#[test]
fn a_run_survives_what_it_is_given() {
    let text = "title = \"x\"\n";
    assert!(matches!(Run::of(text, Twin::NONE, 1.0, None).ended, Ended::Refused(_)));
    let run = Run::of(ARCH, Twin::NONE, 1e-9, None);
    assert_eq!(run.ended, Ended::OutOfTime);
    assert!(run.measured.increments > 0 && run.measured.reached > 0.0);
    assert_eq!(difference(&run, &run, Twin::NONE), 0.0);
}
