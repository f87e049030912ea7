//! Runs that find no equilibrium: what they leave.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]
#![cfg(feature = "hdf5")]

use subrope::point::{self, Asked, PointFile};
use subrope::run::{RunError, RunOptions, run_scene};
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

/// A run that ends because a law has no answer leaves the point, and the law asked again says the same, digit by digit.
#[test]
fn a_point_that_fails_is_dumped_and_replayed() {
    let lock_up = ("nu = 0.5", "nu = 0.5\ncompaction = \"lock_up\"\nz_lock = -0.002");
    let cases = [
        ("hex8", None),
        ("hex8_mean_elongation", None),
        ("hex8_mean_elongation", Some(lock_up)),
        ("hex8", Some(lock_up)),
        ("hex8_mean_volume", Some(lock_up)),
        ("hex20r", None),
        ("hex20r", Some(lock_up)),
    ];
    for (formulation, change) in cases {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.toml");
        let (increments, angle) =
            if change.is_some() { ("fixed = 2", "angle = 60.0") } else { ("fixed = 1", "angle = 170.0") };
        let mut text = SCENE.replace(INCREMENTS, &format!("increments = {{ {increments} }}")).replace(ANGLE, angle);
        text = text.replace("hex8_mean_elongation", formulation);
        if let Some((from, to)) = change {
            assert!(text.contains(from), "{from}");
            text = text.replace(from, to);
        }
        std::fs::write(&path, text).unwrap();
        let options = || RunOptions { threads: Some(1), ..RunOptions::default() };
        let error = run_scene(&path, options(), &mut subrope::progress::Silent).unwrap_err();
        let told = error.to_string();
        let Error::Run(RunError::Solver { cause, point: Some(file), .. }) = error else { panic!("{told}") };
        assert!(told.contains("failed_point.toml: subrope point"), "{told}");
        let PointFile::Failed(failed) = point::read(&file).unwrap() else { panic!("no failed point") };
        let (element, number, asked, source) = cause.failed_point().unwrap();
        assert_eq!((failed.failure.element, failed.failure.point), (element, number));
        assert_eq!(bits(&failed.asked), bits(&Asked::of(asked)), "{formulation}");
        let again = failed.replay().unwrap_err().to_string();
        assert_eq!(again, format!("element {element}, integration point {number}: {source}"), "{formulation}");
        assert!(told.contains(&again), "{again} in {told}");
    }
}

fn bits(asked: &Asked) -> Vec<u64> {
    let Asked { H, H_committed, mean_elongation, frame, state, time_increment, temperature } = asked;
    let tensors = [H, H_committed, frame].into_iter().flat_map(|tensor| tensor.as_flattened());
    let others = mean_elongation.iter().chain(state).chain([time_increment, temperature]);
    tensors.chain(others).map(|number| number.to_bits()).collect()
}
