//! Point files: the reference paths reproduced, round trips, interpolation, errors.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use std::path::PathBuf;

use subrope::point::{self, PathFile, PathScene, PointError};

fn reference() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../material/tests/data/law/law_paths.json")
}

/// Numbers agree to a tolerance relative to the largest of a group.
fn close(found: &[f64], expected: &[f64], tolerance: f64, what: &str) -> f64 {
    assert_eq!(found.len(), expected.len(), "{what}");
    let scale = expected.iter().fold(0.0_f64, |m, v| m.max(v.abs())).max(1e-12);
    let error = found.iter().zip(expected).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs())) / scale;
    assert!(error <= tolerance, "{what}: {error:e}\n{found:?}\n{expected:?}");
    error
}

#[test]
fn reference_paths_are_reproduced() {
    let expected = point::load(&reference()).unwrap();
    let computed = point::compute("law_paths.json", &expected, true).unwrap();
    assert_eq!(computed.paths.len(), 39);
    let (mut worst, mut worst_difference) = (0.0_f64, 0.0_f64);
    for (path, reference) in computed.paths.iter().zip(&expected.paths) {
        for (index, (step, old)) in path.steps.iter().zip(&reference.steps).enumerate() {
            let what = |key: &str| format!("{} step {index} {key}", path.name);
            let errors = [
                close(&step.I.unwrap(), &old.I.unwrap(), 1e-12, &what("I")),
                close(&step.q.unwrap(), &old.q.unwrap(), 1e-10, &what("q")),
                close(&step.S_fibre.unwrap(), &old.S_fibre.unwrap(), 1e-10, &what("S_fibre")),
                close(&step.S_global.unwrap(), &old.S_global.unwrap(), 1e-10, &what("S_global")),
                close(step.D_fibre.unwrap().as_flattened(), old.D_fibre.unwrap().as_flattened(), 1e-10, &what("D")),
                close(step.state.as_ref().unwrap(), old.state.as_ref().unwrap(), 1e-10, &what("state")),
                close(&[step.W.unwrap()], &[old.W.unwrap()], 1e-10, &what("W")),
            ];
            worst = errors.into_iter().fold(worst, f64::max);
            assert_eq!(step.slip, old.slip, "{}", what("slip"));
            let (own, quotient) = (step.D_fibre.unwrap(), step.D_difference.unwrap());
            worst_difference =
                worst_difference.max(close(quotient.as_flattened(), own.as_flattened(), 1e-4, &what("D_difference")));
        }
    }
    println!("worst relative error {worst:e}, worst difference quotient {worst_difference:e}");
}

/// Random paths with kinematic and saturating hardening, pressure, lock-up, large shear and strains of 1e-14.
#[test]
fn random_paths_are_reproduced() {
    let expected = point::load(&reference().with_file_name("law_random.json")).unwrap();
    let computed = point::compute("law_random.json", &expected, false).unwrap();
    assert_eq!(computed.paths.len(), 35);
    let mut worst = 0.0_f64;
    for (path, reference) in computed.paths.iter().zip(&expected.paths) {
        for (index, (step, known)) in path.steps.iter().zip(&reference.steps).enumerate() {
            let mut see = |key: &str, found: &[f64], expected: &[f64]| {
                // Relative to the largest entry, however small that is.
                let scale = expected.iter().fold(f64::MIN_POSITIVE, |m, v| m.max(v.abs()));
                let error = found.iter().zip(expected).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs())) / scale;
                assert!(error < 1e-10, "{} step {index} {key}: {error:e}", path.name);
                worst = worst.max(error);
            };
            see("I", &step.I.unwrap(), &known.I.unwrap());
            see("q", &step.q.unwrap(), &known.q.unwrap());
            see("W", &[step.W.unwrap()], &[known.W.unwrap()]);
            see("S_fibre", &step.S_fibre.unwrap(), &known.S_fibre.unwrap());
            see("S_global", &step.S_global.unwrap(), &known.S_global.unwrap());
            see("D_fibre", step.D_fibre.unwrap().as_flattened(), known.D_fibre.unwrap().as_flattened());
            see("state", step.state.as_ref().unwrap(), known.state.as_ref().unwrap());
        }
    }
    println!("worst relative error {worst:e}");
}

/// Single steps in general position, strains from 1e-14 to 3 and distortions from 1 to 8, each with a law of its own: what
/// double precision can know. A stretch of `exp(+-D)` beside one of 1 loses the digits of `exp(2 D)` in the entries of the
/// displacement gradient alone.
#[test]
fn the_whole_range_is_reproduced() {
    let expected = point::load(&reference().with_file_name("law_range.json")).unwrap();
    let computed = point::compute("law_range.json", &expected, false).unwrap();
    assert_eq!(computed.paths.len(), 60);
    for (path, reference) in computed.paths.iter().zip(&expected.paths) {
        let (step, known) = (&path.steps[0], &reference.steps[0]);
        let distortion = path.name.strip_prefix("distortion ").map_or(0.0, |d| d.parse::<f64>().unwrap());
        let tolerance = 2e-13 * (2.0 * distortion).exp();
        let mut worst = [0.0_f64; 2];
        for (slot, key, found, expected) in [
            (0, "I", step.I.unwrap().to_vec(), known.I.unwrap().to_vec()),
            (0, "q", step.q.unwrap().to_vec(), known.q.unwrap().to_vec()),
            (0, "W", vec![step.W.unwrap()], vec![known.W.unwrap()]),
            (0, "S", step.S_fibre.unwrap().to_vec(), known.S_fibre.unwrap().to_vec()),
            (1, "D", step.D_fibre.unwrap().as_flattened().to_vec(), known.D_fibre.unwrap().as_flattened().to_vec()),
            (0, "state", step.state.clone().unwrap(), known.state.clone().unwrap()),
        ] {
            let scale = expected.iter().fold(f64::MIN_POSITIVE, |m, v| m.max(v.abs()));
            let error = found.iter().zip(&expected).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs())) / scale;
            assert!(error < tolerance, "{} {key}: {error:e}, allowed {tolerance:e}", path.name);
            worst[slot] = worst[slot].max(error);
        }
        println!("{:16} answers {:.1e}, tangent {:.1e}", path.name, worst[0], worst[1]);
    }
}

#[test]
fn layout_and_numbers_survive() {
    let text = std::fs::read_to_string(reference()).unwrap();
    let file = point::load(&reference()).unwrap();
    let written = String::from_utf8(point::to_json(&file).unwrap()).unwrap();
    let (old, new): (serde_json::Value, serde_json::Value) =
        (serde_json::from_str(&text).unwrap(), serde_json::from_str(&written).unwrap());
    assert_eq!(old, new);
    assert!(text.trim_end() == written, "not the same bytes");
}

#[test]
fn other_keys_are_kept_and_the_gradient_keeps_its_digits() {
    let text = r#"{"author": "me", "paths": [{"name": "tiny", "source": "x", "params": {"K_e": 2000.0, "K_ec": 100.0,
        "K_c": 60.0, "K_t": 15.0, "K_l": 20.0, "friction": 0}, "steps": [{"note": 1,
        "H": [[0, 0, 0], [0, 0, 1e-13], [0, 0, 0]]}, {"modes": [0.01, 0, 0, 0, 0.2, 0]}]}]}"#;
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("tiny.json");
    std::fs::write(&file, text).unwrap();
    let computed = point::compute("tiny.json", &point::load(&file).unwrap(), false).unwrap();
    let [small, large] = computed.paths[0].steps.as_slice() else { panic!("two steps") };
    assert!((small.I.unwrap()[3] / 0.5e-13 - 1.0).abs() < 1e-12, "{:?}", small.I);
    assert!((large.I.unwrap()[4] - 0.2).abs() < 1e-15);
    let written: serde_json::Value = serde_json::from_slice(&point::to_json(&computed).unwrap()).unwrap();
    assert_eq!(written["author"], "me");
    assert_eq!(written["paths"][0]["source"], "x");
    assert_eq!(written["paths"][0]["steps"][0]["note"], 1);
    let again: PathFile = serde_json::from_value(written).unwrap();
    assert_eq!(again.paths[0].steps, computed.paths[0].steps);
}

#[test]
fn a_parameter_of_another_type_is_told_from_a_missing_one() {
    let file = |value: &str| {
        let text = format!(
            r#"{{"paths": [{{"name": "p", "params": {{"K_e": {value}, "K_ec": 1.0, "K_c": 1.0, "K_t": 1.0, "K_l": 1.0,
            "friction": 0}}, "steps": [{{"modes": [0.01, 0, 0, 0, 0, 0]}}]}}]}}"#
        );
        point::compute("p.json", &serde_json::from_str::<PathFile>(&text).unwrap(), false)
    };
    assert!(file("1.0").is_ok());
    let message = file("\"x\"").unwrap_err().to_string();
    assert!(message.contains("K_e = \"x\" must be a number") && message.contains("p.json"), "{message}");
}

const LOOP: &str = r#"
title = "shear loop"
cycles = 2
fibre = [0.0, 0.0, 2.0]
[law]
kind = "bundle"
K_e = 2000.0
K_ec = 100.0
K_c = 60.0
K_t = 15.0
K_l = 10.0
tau_t = 1.0
tau_l = 1.0
[[path]]
modes = [0.0, 0.0, 0.0, 0.0, 0.5, 0.0]
steps = 10
[[path]]
modes = [0.0, 0.0, 0.0, 0.0, -0.5, 0.0]
steps = 20
[[path]]
modes = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
steps = 10
"#;

/// Stiffness 10, threshold 1, amplitude 0.5: a full loop dissipates 4 (0.5 - 0.1) 1 = 1.6.
#[test]
fn a_friction_loop_dissipates() {
    let paths = PathScene::from_toml("loop.toml", LOOP).unwrap().path_file("loop.toml").unwrap();
    assert_eq!(paths.paths[0].steps.len(), 80);
    let computed = point::compute("loop.toml", &paths, false).unwrap();
    let at = |step: usize| computed.paths[0].steps[step - 1].clone();
    let dissipated = |step: usize| at(step).state.unwrap()[7];
    assert!((dissipated(70) - dissipated(30) - 1.6).abs() < 1e-12);
    assert!((at(10).q.unwrap()[4] - 1.0).abs() < 1e-12);
    assert_eq!(at(80).slip, Some([false, true]));
    let table = point::to_csv(&computed);
    assert_eq!(table.lines().count(), 81);
    let columns: Vec<_> = table.lines().map(|l| l.split(',').count()).collect();
    assert!(columns.iter().all(|c| *c == columns[0]), "{columns:?}");
    let number: f64 = table.lines().nth(3).unwrap().split(',').nth(15).unwrap().parse().unwrap();
    assert_eq!(number.to_bits(), at(3).I.unwrap()[4].to_bits());
}

#[test]
fn wrong_toml_is_answered_with_its_place() {
    let answer = |from: &str, to: &str| match PathScene::from_toml("loop.toml", &LOOP.replacen(from, to, 1)) {
        Err(PointError::Invalid(document)) => document.plain(),
        other => panic!("{other:?}"),
    };
    assert!(answer("tau_l = 1.0\n", "").contains("[law] needs the key `tau_l`"));
    assert!(answer("cycles = 2", "cycle = 2").contains("did you mean `cycles`?"));
    assert!(answer("steps = 10", "steps = 10\nF = [[1.0]]").contains("loop.toml:17:5"));
    let both = "modes = [0.0, 0.0, 0.0, 0.0, 0.5, 0.0]\nH = [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]";
    assert!(answer("modes = [0.0, 0.0, 0.0, 0.0, 0.5, 0.0]", both).contains("exactly one of `H`, `F`, `modes`"));
    assert!(answer("[0.0, 0.0, 2.0]", "[0.0, 0.0, 0.0]").contains("cannot be zero"));
}

#[test]
fn wrong_json_names_the_entry() {
    let answer = |text: &str| {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("bad.json");
        std::fs::write(&file, text).unwrap();
        let error = point::load(&file).and_then(|paths| point::compute("bad.json", &paths, false)).unwrap_err();
        let cause = std::error::Error::source(&error).map(ToString::to_string).unwrap_or_default();
        format!("{error} {cause}")
    };
    let path = |params: &str, step: &str| {
        format!(r#"{{"paths": [{{"name": "n", "params": {{{params}}}, "steps": [{step}]}}]}}"#)
    };
    let good = r#""K_e": 1, "K_ec": 1, "K_c": 1, "K_t": 1, "K_l": 1, "friction": 0"#;
    let rest = r#"{"F": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}"#;
    assert!(answer("{\"paths\": [}").contains("line 1"));
    assert!(answer("{}").contains("missing field `paths`"));
    assert!(answer(&path(good, "{}")).contains("paths[0] \"n\", steps[0]: the step needs one of the keys F, H, modes"));
    let short = answer(&path(good, r#"{"F": [[1, 0], [0, 1]]}"#));
    assert!(short.contains("paths[0]: steps[0]: invalid length 2") && short.contains("at line 1 column"), "{short}");
    assert!(answer(&path(good, rest).replace("[{\"name", "[{\"state0\": [0], \"name")).contains("must hold 8 numbers"));
    assert!(answer(&path("", rest)).contains("`params` needs K_e"));
    assert!(answer(&path(&format!("{good}, \"Kt\": 1"), rest)).contains("unknown key Kt"));
    assert!(answer(&path(&good.replace("\"K_e\": 1", "\"K_e\": -1"), rest)).contains("K_e"));
    let inverted = r#"{"F": [[-1, 0, 0], [0, 1, 0], [0, 0, 1]]}"#;
    assert!(answer(&path(good, inverted)).contains("the volume ratio J"));
}
