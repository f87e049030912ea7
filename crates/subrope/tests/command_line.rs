//! The binary: exit codes, templates, schema, plain errors.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]
#![cfg(feature = "cli")]

use std::path::Path;
use std::process::{Command, Output};

fn subrope(arguments: &[&str], folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_subrope")).args(arguments).current_dir(folder).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

#[test]
fn new_writes_a_scene_once() {
    let folder = tempfile::tempdir().unwrap();
    let out = subrope(&["new", "rope", "--template", "bent_strand"], folder.path());
    assert_eq!(out.status.code(), Some(0), "{}", text(&out.stderr));
    let scene = folder.path().join("rope/bent_strand.toml");
    subrope::scene::SceneFile::load(&scene).unwrap();
    assert!(folder.path().join("rope/README.md").is_file());
    let again = subrope(&["new", "rope", "--template", "bent_strand"], folder.path());
    assert_eq!(again.status.code(), Some(2));
    assert!(text(&again.stderr).contains("exists already"));
}

#[test]
fn templates_are_listed_and_suggested() {
    let folder = tempfile::tempdir().unwrap();
    let list = subrope(&["new", "--list"], folder.path());
    assert_eq!(list.status.code(), Some(0));
    assert!(text(&list.stdout).contains("tension_twist"));
    let wrong = subrope(&["new", "x", "--template", "bent_stand"], folder.path());
    assert_eq!(wrong.status.code(), Some(2));
    assert!(text(&wrong.stderr).contains("did you mean \"bent_strand\"?"), "{}", text(&wrong.stderr));
    assert!(!folder.path().join("x").exists());
}

#[test]
fn a_wrong_scene_is_explained_with_exit_code_2() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("bad.toml"), "title = \"x\"\n[strand]\nradus = 1.0\n").unwrap();
    for command in ["check", "run"] {
        let out = subrope(&[command, "bad.toml"], folder.path());
        assert_eq!(out.status.code(), Some(2));
        let answer = text(&out.stderr);
        assert!(answer.contains("--> bad.toml:3:1") && answer.contains("did you mean `radius`?"), "{answer}");
    }
    let missing = subrope(&["check", "none.toml"], folder.path());
    assert_eq!(missing.status.code(), Some(2));
    assert!(text(&missing.stderr).contains("cannot read the scene none.toml"));
}

#[test]
fn usage_errors_have_exit_code_2() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(subrope(&[], folder.path()).status.code(), Some(2));
    assert_eq!(subrope(&["run", "a.toml", "--threads", "0"], folder.path()).status.code(), Some(2));
}

#[test]
fn schemas_are_json() {
    let folder = tempfile::tempdir().unwrap();
    for arguments in [&["schema"][..], &["schema", "--point"], &["schema", "--study"]] {
        let out = subrope(arguments, folder.path());
        assert_eq!(out.status.code(), Some(0));
        let schema: serde_json::Value = serde_json::from_slice(&out.stdout).unwrap();
        assert_eq!(schema["additionalProperties"], false);
    }
}

#[test]
fn point_writes_tables() {
    let folder = tempfile::tempdir().unwrap();
    let path = "title = \"loop\"\n[law]\nkind = \"neo_hooke\"\nmu = 1.0\nlambda = 2.0\n[[path]]\nH = [[0.1, 0.0, 0.0], \
                [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]\nsteps = 4\n";
    std::fs::write(folder.path().join("loop.toml"), path).unwrap();
    let out = subrope(&["point", "loop.toml"], folder.path());
    assert_eq!(out.status.code(), Some(0), "{}", text(&out.stderr));
    assert_eq!(text(&out.stdout).lines().count(), 5);
    let unwritable = subrope(&["point", "loop.toml", "-o", "none/out.csv"], folder.path());
    assert_eq!(unwritable.status.code(), Some(4));
    assert!(text(&unwritable.stderr).contains("cannot write none/out.csv"));
}

#[test]
fn an_unknown_mesh_format_is_named() {
    let folder = tempfile::tempdir().unwrap();
    subrope(&["new", ".", "--template", "bent_strand_coarse"], folder.path());
    let out = subrope(&["mesh", "bent_strand_coarse.toml", "-o", "x.stl"], folder.path());
    assert_eq!(out.status.code(), Some(2));
    assert!(text(&out.stderr).contains(".inp (Abaqus)"), "{}", text(&out.stderr));
}
