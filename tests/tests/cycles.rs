//! Cycles of tension of a short rope, and a strand against a rod: whole scenes with files.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::path::Path;

use subrope::scene::{Component, Motion, MotionPath, MotionTarget, Program, Scene};
use subrope_tests::{rod_on_strand, run_with_files, short_rope};

fn column(file: &Path, name: &str) -> Vec<f64> {
    let text = std::fs::read_to_string(file).unwrap();
    let mut lines = text.lines();
    let at = lines.next().unwrap().split(',').position(|h| h.starts_with(name)).unwrap();
    lines.map(|l| l.split(',').nth(at).unwrap().parse().unwrap()).collect()
}

#[test]
fn cycles_go_between_fractions_of_the_peak() {
    let steps = r#"
[[step]]
name = "pull"
increments = { initial = 0.02 }
tension = { elongation = 0.02 }
[[step]]
name = "cycle"
increments = { maximum = 0.1 }
[step.cycles]
count = 2
low = 0.1
high = 1.0
"#;
    let (folder, outcome) = run_with_files(&short_rope(steps));
    let rows = &outcome.summary.cycles;
    assert_eq!(rows.len(), 2);
    let history = folder.path().join("out/history.csv");
    let force = column(&history, "END_B_fz");
    let pulled = column(&history, "step [").iter().filter(|s| **s == 1.0).count();
    let peak = force[pulled - 1];
    println!("peak {peak} N, {rows:?}, energy error {:e}", outcome.summary.energies.energy_error);
    for row in rows {
        assert!((row.low_force_n / peak - 0.1).abs() < 1e-6 && (row.high_force_n / peak - 1.0).abs() < 1e-6);
        assert!(row.low_elongation < row.high_elongation && row.secant_stiffness_n > 0.0);
        let lost = row.dissipated_transverse_mj + row.dissipated_longitudinal_mj + row.contact_friction_mj;
        assert!(row.hysteresis_mj > 0.0 && lost > 0.0);
    }
    assert_eq!(rows[0].permanent_elongation, 0.0);
    // From one peak to the next nearly as much is stored as before: the loop is what was lost.
    let last = rows[1];
    let lost = last.dissipated_transverse_mj + last.dissipated_longitudinal_mj + last.contact_friction_mj;
    assert!((last.hysteresis_mj / lost - 1.0).abs() < 0.3, "{last:?}");
    assert!(outcome.summary.energies.energy_error.abs() < 0.01);
    assert_eq!(column(&folder.path().join("out/cycles.csv"), "cycle"), [1.0, 2.0]);
}

#[test]
fn cycles_of_elongation_follow_a_sine() {
    let steps = r#"
[[step]]
name = "cycle"
increments = { initial = 0.02 }
[step.cycles]
count = 1
of = "elongation"
low = 0.002
high = 0.01
waveform = "sine"
"#;
    let (folder, outcome) = run_with_files(&short_rope(steps));
    let row = outcome.summary.cycles[0];
    assert!((row.low_elongation - 0.002).abs() < 1e-12 && (row.high_elongation - 0.01).abs() < 1e-12, "{row:?}");
    let history = folder.path().join("out/history.csv");
    let rows =
        column(&history, "END_B_uz").into_iter().zip(column(&history, "step [")).zip(column(&history, "step_fraction"));
    let middle: Vec<f64> =
        rows.filter(|((_, step), fraction)| *step == 2.0 && *fraction == 0.5).map(|((u, _), _)| u / 16.0).collect();
    assert!(middle.len() == 1 && (middle[0] - 0.006).abs() < 1e-12, "{middle:?}");
}

#[test]
fn cycles_that_make_no_sense_are_refused() {
    let refused = |cycles: &str, cause: &str| {
        let text = short_rope(&format!("[[step]]\nname = \"cycle\"\n[step.cycles]\ncount = 1\n{cycles}\n"));
        let error = format!("{:?}", Scene::from_toml("test.toml", &text).unwrap_err());
        assert!(error.contains(cause), "{error}");
    };
    refused("of = \"force\"\nlow = 2.0\nhigh = 1.0", "reversed");
    refused("low = 0.1\nhigh = 1.0", "peak");
    refused("of = \"force\"\nlow = 0.1\nhigh = 1.0\npoint = \"END_X\"", "END_X");
    refused("of = \"elongation\"\nlow = -1.5\nhigh = 1.0", "low");
    refused("of = \"force\"\nlow = 0.1\nhigh = 1.0\n[step.tension]\nelongation = 0.1", "prescribed twice");
    refused(
        "of = \"force\"\nlow = 0.1\nhigh = 1.0\n[step.tension]\npoint = \"END_A\"\ntwist = 1.0",
        "different points",
    );
}

/// What cycles of the peak tension leave acting must end before the end is held again; a twist in their step is not lost.
#[test]
fn cycles_and_what_stands_beside_them() {
    let pull = "[[step]]\nname = \"pull\"\ntension = { elongation = 0.01 }\n";
    let cycle = "[[step]]\nname = \"cycle\"\ncycles = { count = 2, low = 0.1, high = 1.0 }\n";
    let hold = "[[step]]\nname = \"hold\"\ntension = { elongation = 0.0 }\n";
    let error = Scene::from_toml("test.toml", &short_rope(&format!("{pull}{cycle}{hold}"))).unwrap_err();
    assert!(format!("{error:?}").contains("of an earlier step acts"), "{error:?}");
    let twisted = "[[step]]\nname = \"cycle\"\ncycles = { count = 2, of = \"force\", low = 1.0, high = 2.0 }\n\
        tension = { twist = \"free\" }\n";
    let scene = Scene::from_toml("test.toml", &short_rope(twisted)).unwrap();
    let program = Program::new(&scene);
    assert_eq!(program.steps.len(), 4);
    for step in &program.steps {
        let turns = |m: &&Motion| m.component == Component::Rz && m.target == MotionTarget::Point("END_B".into());
        assert_eq!(step.motions.iter().find(turns).unwrap().path, MotionPath::Free);
    }
}

/// The rod is pressed to a quarter of the radius and lifted again: it leaves a groove.
#[test]
fn a_rod_leaves_a_groove() {
    let steps = r#"
[[step]]
name = "press"
prescribe = [{ point = "ROD", ux = -0.7 }]
[[step]]
name = "lift"
prescribe = [{ point = "ROD", ux = 0.0 }]
"#;
    let text = rod_on_strand(0.15, steps);
    let (folder, outcome) = run_with_files(&text);
    let history = folder.path().join("out/history.csv");
    let (force, travel, step) = (column(&history, "ROD_fx"), column(&history, "ROD_ux"), column(&history, "step ["));
    let pressed = step.iter().rposition(|s| *s == 2.0).unwrap();
    println!("{} N pressed, energy error {:e}", force[pressed], outcome.summary.energies.energy_error);
    assert!(force[pressed] < -1.0, "the strand pushes the rod back");
    assert!(force.last().unwrap().abs() < 1e-9, "it is free again");
    // At the same travel the way back carries less.
    let at = |range: std::ops::Range<usize>| {
        let near = range.min_by(|a, b| (travel[*a] + 0.5).abs().total_cmp(&(travel[*b] + 0.5).abs())).unwrap();
        force[near]
    };
    let start = step.iter().position(|s| *s == 2.0).unwrap();
    let (down, up) = (at(start..pressed + 1), at(pressed + 1..force.len()));
    assert!(up > down, "press {down} N, lift {up} N");
    assert!(outcome.summary.energies.energy_error.abs() < 0.01);
}
