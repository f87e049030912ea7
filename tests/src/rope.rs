//! Scenes run in memory.

use std::path::Path;

use subrope::model::{ModelError, RopeModel};
use subrope::progress::Silent;
use subrope::run::{RunOptions, RunOutcome};
use subrope::scene::Scene;
use subrope_fem::FemError;
use tempfile::TempDir;

use crate::problem::{Recorder, Row};

/// A scene that ran.
pub struct Run {
    /// The model in its last state.
    pub model: RopeModel,
    /// One row per increment, steps one after another.
    pub rows: Vec<Row>,
    /// Causes of failed attempts.
    pub failures: Vec<String>,
}

impl Run {
    /// Index of a reference point.
    #[must_use]
    pub fn point(&self, name: &str) -> usize {
        self.model.analysis.model().kinematics.point_index(name).unwrap()
    }
}

/// Reads a scene that must be correct.
#[must_use]
pub fn scene(text: &str) -> Scene {
    Scene::from_toml("test.toml", text).unwrap_or_else(|e| panic!("{e:?}"))
}

/// Builds and runs all steps of a scene on so many threads.
///
/// # Errors
/// What the model answers; what the run answers.
pub fn try_run(text: &str, deck: Option<&Path>, threads: usize) -> Result<Result<Run, FemError>, ModelError> {
    let mut model = RopeModel::from_scene(&scene(text), deck, Some(threads))?;
    let mut recorder = Recorder::default();
    for step in model.steps.clone() {
        if let Err(error) = model.analysis.run_step(&step, &mut recorder) {
            return Ok(Err(error));
        }
    }
    Ok(Ok(Run { model, rows: recorder.rows, failures: recorder.failures }))
}

/// Runs a scene that must succeed, on one thread.
#[must_use]
pub fn run_scene(text: &str, deck: Option<&Path>) -> Run {
    try_run(text, deck, 1).unwrap_or_else(|e| panic!("{e}")).unwrap_or_else(|e| panic!("{e}"))
}

/// The text of a scene that is shipped.
#[must_use]
pub fn scene_file(name: &str) -> String {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    std::fs::read_to_string(folder.join(name)).unwrap()
}

/// Runs a scene with files on one thread; they are in `out` of the folder.
#[must_use]
pub fn run_with_files(text: &str) -> (TempDir, RunOutcome) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, text).unwrap();
    let out = folder.path().join("out");
    let options = RunOptions { folder: Some(&out), threads: Some(1), ..RunOptions::default() };
    let outcome = subrope::run::run_scene(&path, options, &mut Silent).unwrap();
    (folder, outcome)
}

/// Set C of the law and two rigid ends.
pub const SET_C: &str = r#"
[law]
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
[[end]]
name = "END_A"
[[end]]
name = "END_B"
"#;

/// The scene of a short coarse rope of three strands with friction between them, with these steps.
#[must_use]
pub fn short_rope(steps: &str) -> String {
    format!(
        r#"
title = "three short strands"
[rope]
radius = 2.785
length = 16.0
lay_angle = 20.0
yarns = {{ surface_angle = 30.0 }}
[rope.mesh]
core = 2
rings = 1
layers = 10
{SET_C}
[[contact]]
name = "strands"
friction = 0.15
points = [8, 2]
{steps}
"#
    )
}

/// The scene of a short strand stretched by 1 % against a rigid rod across it that just touches, its reference point ROD, with
/// these steps then.
#[must_use]
pub fn rod_on_strand(friction: f64, steps: &str) -> String {
    format!(
        r#"
title = "rod"
[strand]
radius = 2.785
length = 16.0
surface_angle = 30.0
origin = "middle"
[strand.mesh]
core = 2
rings = 2
layers = 16
{SET_C}
[[rigid]]
name = "ROD"
shape = "cylinder"
point = [7.785, 0.0, 0.0]
axis = [0.0, 1.0, 0.0]
radius = 5.0
[[contact]]
name = "rod"
primary = "ROD"
secondary = "LATERAL"
friction = {friction:?}
[[step]]
name = "pull"
tension = {{ elongation = 0.01 }}
{steps}
"#
    )
}
