//! Runs that find no equilibrium: what they leave.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]
#![cfg(feature = "hdf5")]

use subrope::run::{RunOptions, run_scene};
use subrope::{Error, ExitCode};
use subrope_io::{Location, ResultReader};

const SCENE: &str = include_str!("../../../scenes/bent_strand_coarse.toml");
const INCREMENTS: &str = "increments = { initial = 0.05, maximum = 0.1 }";
const ANGLE: &str = "angle = 45.0";

#[test]
fn the_last_trial_can_be_looked_at_and_goes_with_the_next_run() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    let run = |text: &str| {
        std::fs::write(&path, text).unwrap();
        run_scene(&path, RunOptions { threads: Some(1), ..RunOptions::default() }, &mut subrope::progress::Silent)
    };
    assert!(SCENE.contains(INCREMENTS) && SCENE.contains(ANGLE));
    let at_once = SCENE.replace(INCREMENTS, "increments = { fixed = 1 }").replace(ANGLE, "angle = 80.0");
    let error = run(&(at_once + "\n[solver]\nmax_iterations = 2\n")).unwrap_err();
    assert!(matches!(error, Error::Run(_)), "{error}");
    assert_eq!(error.exit_code(), ExitCode::NotConverged);
    let trial = folder.path().join("out/scene/last_trial.vtkhdf");
    let file = ResultReader::open(&trial).unwrap();
    assert_eq!(file.steps(), 2);
    let residual = file.field(Location::Point, "residual", 1).unwrap();
    assert!(residual.iter().any(|r| r.abs() > 0.0) && residual.iter().all(|r| r.is_finite()));
    run(&SCENE.replace(ANGLE, "angle = 1.0")).unwrap();
    assert!(!trial.exists());
}
