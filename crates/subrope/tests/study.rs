//! Studies end to end: the binary runs members, survives those that fail, and compares the others.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]
#![cfg(feature = "cli")]

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value as Json;
use subrope::Error;
use subrope::study::{Study, StudyFile};

const SCENE: &str = r#"
title = "A strand in tension"
[strand]
radius = 2.785
length = 10.0
surface_angle = 30.0
mesh = { core = 2, rings = 1, layers = 2 }
[law]
kind = "bundle"
K_e = 2000.0
K_ec = 100.0
K_c = 60.0
K_t = 15.0
K_l = 20.0
nu = 0.5
tau_t = 0.05
tau_l = 0.2
H_t = 0.1
H_l = 0.3
[[end]]
name = "END_A"
[[end]]
name = "END_B"
[[step]]
name = "pull"
increments = { fixed = 2 }
tension = { elongation = 0.01 }
"#;

const STUDY: &str = r#"title = "Tension"
scene = "strand.toml"
repeats = 2
target = 0.05
[set]
"step[0].tension.elongation" = 0.005
[reference]
kind = "extrapolated"
series = "mean"
[[quantity]]
name = "tension"
[[quantity]]
name = "half_way"
from = "history:END_B_fz"
unit = "N"
at = { column = "time", value = 0.5 }
[[series]]
name = "mean"
[series.levels]
"strand.mesh.layers" = [2, 4, 6]
[[series]]
name = "plain"
set = { "element.formulation" = "hex8" }
[series.levels]
"strand.mesh.layers" = [2, 4]
[[series]]
name = "fails"
set = { "solver.max_iterations" = 1, "solver.residual_tolerance" = 1e-15 }
"#;

/// A folder with the scene and a study.
fn folder(study: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("strand.toml"), SCENE).unwrap();
    std::fs::write(folder.path().join("study.toml"), study).unwrap();
    folder
}

fn subrope(arguments: &[&str], folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_subrope")).args(arguments).current_dir(folder).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

fn report(folder: &Path) -> Json {
    serde_json::from_slice(&std::fs::read(folder.join("out/study/study.json")).unwrap()).unwrap()
}

/// The plain text of what is wrong with a study.
fn wrong(study: &str) -> String {
    let folder = folder(study);
    let error = StudyFile::load(&folder.path().join("study.toml")).unwrap_err();
    assert!(matches!(error, Error::Study(_) | Error::Scene(_)), "{error:?}");
    error.plain()
}

#[test]
fn a_study_compares_what_ends_well_and_tells_what_fails() {
    let folder = folder(STUDY);
    let out = subrope(&["study", "study.toml", "--target", "2%"], folder.path());
    let told = text(&out.stdout);
    assert_eq!(out.status.code(), Some(0), "{}{told}", text(&out.stderr));
    assert!(told.contains("1 of 6 members failed") && told.contains("to 2 %"), "{told}");
    let report = report(folder.path());
    assert_eq!(report["target"], 0.02);
    assert_eq!(report["complete"], true);
    let members = report["members"].as_array().unwrap();
    assert_eq!(members.len(), 6);
    for member in &members[..5] {
        assert_eq!(member["status"]["state"], "done", "{member}");
        assert_eq!(member["time"]["all"].as_array().unwrap().len(), 2);
        assert!(member["time"]["min"].as_f64().unwrap() > 0.0);
        assert!(member["values"][0]["value"].as_f64().unwrap() > 0.0);
        let value = &member["values"][0];
        assert!(value["is_reference"] == true || value["error"].as_f64().unwrap().is_finite(), "{member}");
        let whole = member["values"][0]["value"].as_f64().unwrap();
        assert!(member["values"][1]["value"].as_f64().unwrap() < whole, "half the way takes less force");
    }
    assert_eq!(members[5]["status"]["state"], "failed");
    assert!(members[5]["status"]["reason"].as_str().unwrap().contains("iteration"), "{}", members[5]["status"]);
    assert_eq!(members[0]["settings"]["step[0].tension.elongation"], 0.005);
    let quantities = report["quantities"].as_array().unwrap();
    assert!(!quantities[0]["front"].as_array().unwrap().is_empty());
    files_of_a_study(&folder.path().join("out/study"));
    resumed(folder.path());
}

fn files_of_a_study(folder: &Path) {
    let table = std::fs::read_to_string(folder.join("study.csv")).unwrap();
    assert_eq!(table.lines().count(), 7, "{table}");
    assert!(table.starts_with("member,series,level,element.formulation,") && table.contains("tension [N]"), "{table}");
    assert!(table.lines().last().unwrap().contains("failed"), "{table}");
    let told = std::fs::read_to_string(folder.join("study.md")).unwrap();
    assert!(told.contains("**fails** failed: ") && told.contains("| mean, level 1 |"), "{told}");
    for name in ["tension_time.svg", "tension_memory.svg", "half_way_time.svg"] {
        let chart = std::fs::read_to_string(folder.join(name)).unwrap();
        assert!(chart.contains("<svg") && chart.ends_with("</svg>\n") && chart.contains("plain"), "{chart}");
    }
}

/// What has run is kept, what failed runs again, and an old report is gone.
fn resumed(folder: &Path) {
    let run = folder.join("out/study/members/01_mean_level_1/run_1/summary.json");
    let before = std::fs::metadata(&run).unwrap().modified().unwrap();
    let out = subrope(&["study", "study.toml", "--resume", "--repeats", "1"], folder);
    assert_eq!(out.status.code(), Some(0), "{}", text(&out.stderr));
    assert!(text(&out.stdout).contains("an earlier one is replaced"), "{}", text(&out.stdout));
    assert_eq!(std::fs::metadata(&run).unwrap().modified().unwrap(), before);
    assert_eq!(report(folder)["repeats"], 1);
}

#[test]
fn a_member_that_takes_too_long_is_stopped() {
    let (head, _) = STUDY.split_once("[[series]]").unwrap();
    let head = head.replacen("repeats = 2", "repeats = 1\ntime_limit = 2.0", 1);
    let slow = r#"
[[series]]
name = "mean"
[series.levels]
"strand.mesh.core" = [2, 2, 6]
"strand.mesh.layers" = [2, 4, 60]
"step[0].increments" = [{ fixed = 2 }, { fixed = 2 }, { fixed = 100 }]
"#;
    // The third level, 3600 bricks in a hundred increments, needs more than two seconds on any machine.
    let folder = folder(&(head + slow));
    let out = subrope(&["study", "study.toml"], folder.path());
    assert_eq!(out.status.code(), Some(0), "{}", text(&out.stderr));
    let report = report(folder.path());
    assert_eq!(report["members"][2]["status"]["reason"], "stopped after the time limit of 2 s");
    let note = report["quantities"][0]["reference"]["note"].as_str().unwrap();
    assert!(note.contains("2 of three levels gave a value"), "{note}");
}

/// A signal from the keyboard reaches all processes of the group: the member stops after its increment, the study reports
/// what there is.
#[test]
#[cfg(unix)]
fn a_study_can_be_interrupted() {
    use std::os::unix::process::CommandExt as _;
    let (head, _) = STUDY.split_once("[[series]]").unwrap();
    let head = head.replacen("repeats = 2", "repeats = 1", 1).replacen("extrapolated", "finest", 1);
    let levels = "[[series]]\nname = \"mean\"\n[series.levels]\n\"strand.mesh.layers\" = [2, 900]\n";
    let more = "\"step[0].increments\" = [{ fixed = 2 }, { fixed = 1000 }]\n";
    let folder = folder(&(head + levels + more));
    let mut study = Command::new(env!("CARGO_BIN_EXE_subrope"))
        .args(["study", "study.toml"])
        .current_dir(folder.path())
        .process_group(0)
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::null())
        .spawn()
        .unwrap();
    let history = folder.path().join("out/study/members/02_mean_level_2/run_1/history.csv");
    let begun = || std::fs::read_to_string(&history).is_ok_and(|text| text.lines().count() > 2);
    for _ in 0..1000 {
        if begun() {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    assert!(begun(), "the second member does not begin");
    let group = format!("-{}", study.id());
    assert!(Command::new("kill").args(["-INT", "--", &group]).status().unwrap().success());
    assert_eq!(study.wait().unwrap().code(), Some(3));
    let report = report(folder.path());
    assert_eq!(report["complete"], false);
    assert_eq!(report["members"][0]["status"]["state"], "done");
    assert_eq!(report["members"][1]["status"]["state"], "not_run");
}

#[test]
fn a_study_of_which_nothing_runs_is_an_error() {
    let (head, _) = STUDY.split_once("[[series]]").unwrap();
    let (_, fails) = STUDY.split_once("name = \"fails\"").unwrap();
    let reference = "[reference]\nkind = \"extrapolated\"\nseries = \"mean\"";
    let study = head.replacen(reference, "[reference]\nkind = \"finest\"", 1) + "[[series]]\nname = \"fails\"" + fails;
    let folder = folder(&study);
    let out = subrope(&["study", "study.toml"], folder.path());
    assert_eq!(out.status.code(), Some(3), "{}", text(&out.stdout));
    assert!(text(&out.stderr).contains("all 1 members failed"), "{}", text(&out.stderr));
    assert_eq!(report(folder.path())["members"][0]["status"]["state"], "failed");
}

#[test]
fn problems_have_their_place() {
    let cases = [
        ("repeats = 2", "repets = 2", "study.toml:3:1", "did you mean `repeats`?"),
        ("scene = \"strand.toml\"", "scene = \"none.toml\"", "study.toml:2:9", "cannot read the scene"),
        ("[2, 4]\n", "[]\n", "study.toml:25:24", "at least one entry"),
        ("name = \"tension\"", "name = \"tensoin\"", "study.toml:11:8", "did you mean `tension`?"),
        ("series = \"mean\"", "series = \"man\"", "study.toml:9:10", "there is no series named \"man\""),
        ("step[0].tension", "step[1].tension", "study.toml:6:32", "`step` of the scene has 1 entries"),
        ("step[0].tension", "step[0.tension", "study.toml:6:31", "is no path of keys"),
        ("history:END_B_fz", "histroy:END_B_fz", "study.toml:14:8", "`from` cannot be"),
    ];
    for (good, bad, place, message) in cases {
        assert!(STUDY.contains(good), "{good}");
        let told = wrong(&STUDY.replacen(good, bad, 1));
        assert!(told.contains(place) && told.contains(message), "{bad}: {told}");
    }
}

#[test]
fn lists_of_levels_have_one_length() {
    let two = STUDY.replacen("[2, 4, 6]\n", "[2, 4, 6]\n\"strand.mesh.rings\" = [1, 1]\n", 1);
    let told = wrong(&two);
    assert!(told.contains("`strand.mesh.rings` must hold 3 entries, as many as `strand.mesh.layers`, not 2"), "{told}");
    let sizes = STUDY.replacen("name = \"plain\"", "name = \"plain\"\nsizes = [1.0, 2.0]", 1);
    assert!(wrong(&sizes).contains("fall from level to level"));
}

#[test]
fn a_wrong_scene_of_a_member_is_told_with_its_series_and_level() {
    let told = wrong(&STUDY.replacen("\"strand.mesh.layers\" = [2, 4]\n", "\"strand.mesh.layrs\" = [2, 4]\n", 1));
    assert!(told.contains("plain, level 2: unknown key `layrs`") && told.contains("did you mean `layers`?"), "{told}");
    let told = wrong(&STUDY.replacen("[2, 4, 6]", "[2, -4, 6]", 1));
    assert!(told.contains("mean, level 2: ") && !told.contains("level 3"), "{told}");
}

#[test]
fn each_repeats_a_series() {
    let each = STUDY.replacen(
        "set = { \"element.formulation\" = \"hex8\" }",
        "each = { \"element.formulation\" = [\"hex8\", \"hex8_mean_volume\"], \"solver.growth\" = [1.5, 2.0] }",
        1,
    );
    let folder = folder(&each);
    let file = StudyFile::load(&folder.path().join("study.toml")).unwrap();
    let names: Vec<_> = file.families.iter().map(|f| f.name.as_str()).collect();
    assert_eq!(names.len(), 6);
    assert_eq!(names[2], "plain, formulation hex8, growth 2.0");
    assert_eq!(file.members.len(), 3 + 8 + 1);
    assert!(file.members[5].text.contains("hex8"), "{}", file.members[5].text);
}

#[test]
fn the_schema_states_units() {
    let schema = Study::schema();
    assert_eq!(schema["additionalProperties"], false);
    let limit = schema["properties"]["time_limit"]["description"].as_str().unwrap();
    assert!(limit.contains("[s]"), "{limit}");
    let set = schema["properties"]["set"]["description"].as_str().unwrap();
    assert!(set.contains("step[0].bend.angle"), "{set}");
}

#[test]
fn shipped_studies_are_in_order() {
    let studies = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../studies");
    if !studies.is_dir() {
        return; // a published package holds no studies
    }
    let files = std::fs::read_dir(studies).unwrap().map(|e| e.unwrap().path());
    let files: Vec<_> = files.filter(|p| p.extension().is_some_and(|e| e == "toml")).collect();
    assert!(files.len() >= 5);
    for file in files {
        let loaded = StudyFile::load(&file).unwrap_or_else(|error| panic!("{}", error.plain()));
        assert!(loaded.members.len() >= 6, "{}", file.display());
    }
}
