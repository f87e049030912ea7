//! Every shipped scene parses, validates and has a program; templates are the shipped scenes.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use std::path::{Path, PathBuf};

use subrope::scene::{MotionPath, Program, SceneFile};

fn templates() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("templates");
    let entries = std::fs::read_dir(folder).unwrap();
    let mut files: Vec<_> =
        entries.map(|e| e.unwrap().path()).filter(|p| p.extension().is_some_and(|e| e == "toml")).collect();
    files.sort();
    files
}

fn load(path: &Path) -> SceneFile {
    SceneFile::load(path).unwrap_or_else(|error| panic!("{}", error.plain()))
}

#[test]
fn every_template_validates() {
    let files = templates();
    assert!(files.len() >= 6);
    for file in files {
        let loaded = load(&file);
        assert_eq!(loaded.hash.len(), 64);
        let program = Program::new(&loaded.scene);
        let parts = |s: &subrope::scene::Step| s.cycles.as_ref().map_or(1, |c| 2 * c.count);
        assert_eq!(program.steps.len(), loaded.scene.step.iter().map(parts).sum::<usize>());
        let moving = program.steps.iter().flat_map(|s| &s.motions);
        assert!(moving.into_iter().any(|m| matches!(&m.path, MotionPath::Linear(p) if !p.knots.is_empty())));
    }
}

#[test]
fn templates_equal_the_shipped_scenes() {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    if !scenes.is_dir() {
        return; // a published package holds the templates alone
    }
    for file in templates() {
        let shipped = scenes.join(file.file_name().unwrap());
        assert_eq!(std::fs::read(&file).unwrap(), std::fs::read(&shipped).unwrap(), "{}", shipped.display());
    }
}

#[test]
fn the_shipped_point_file_gives_its_loop() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/points/friction_loop.toml");
    if !file.is_file() {
        return; // a published package holds the templates alone
    }
    let computed = subrope::point::compute("loop", &subrope::point::load(&file).unwrap(), false).unwrap();
    let dissipated: Vec<f64> = computed.paths[0].steps.iter().map(|s| s.state.as_ref().unwrap()[7]).collect();
    assert!((dissipated[179] - dissipated[99] - 1.6).abs() < 1e-12);
}
