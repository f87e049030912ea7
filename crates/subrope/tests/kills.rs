//! The program killed at random moments, and going on.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test fails by panicking, and tells what it saw")]
#![cfg(all(unix, feature = "cli", feature = "hdf5"))]

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use subrope_material::testkit::Numbers;

const STRAND: &str = r#"
title = "a strand bent with friction"
[strand]
radius = 2.785
length = 16.0
surface_angle = 30.0
mesh = { core = 2, rings = 1, layers = 8 }
[[end]]
name = "END_A"
[[end]]
name = "END_B"
[[step]]
name = "bend"
increments = { fixed = 24 }
bend = { angle = 40.0 }
[output]
checkpoint_every = 1
precision = "f64"
"#;

const ROPE: &str = r#"
title = "three short strands, cycles"
[rope]
radius = 2.785
length = 16.0
lay_angle = 20.0
yarns = { surface_angle = 30.0 }
mesh = { core = 2, rings = 1, layers = 10 }
[[end]]
name = "END_A"
[[end]]
name = "END_B"
[[contact]]
name = "strands"
friction = 0.15
points = [8, 2]
[[step]]
name = "pull"
increments = { initial = 0.1 }
tension = { elongation = 0.01 }
[[step]]
name = "cycle"
increments = { initial = 0.5 }
cycles = { count = 2, low = 0.2, high = 1.0 }
[output]
checkpoint_every = 2
"#;

const LAW: &str = r#"
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
"#;

fn command(scene: &Path, out: &Path, more: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_subrope"));
    command.arg("run").arg(scene).arg("--out").arg(out).args(more);
    command
}

fn run(scene: &Path, out: &Path, more: &[&str]) -> Output {
    command(scene, out, more).output().unwrap()
}

/// All files of a folder; of the summary everything but times, memory and threads.
fn content(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut files: BTreeMap<String, Vec<u8>> =
        entries.map(|p| (p.file_name().unwrap().to_string_lossy().into_owned(), fs::read(&p).unwrap())).collect();
    let text = files.get_mut("summary.json").unwrap();
    let mut summary: serde_json::Value = serde_json::from_slice(text).unwrap();
    summary.as_object_mut().unwrap().retain(|key, _| key != "seconds" && key != "peak_memory_mb");
    summary["size"].as_object_mut().unwrap().remove("threads");
    summary["plan"].as_array_mut().unwrap().retain(|part| part["part"] != "threads");
    *text = summary.to_string().into_bytes();
    files
}

/// What happened to some runs.
#[derive(Debug, Default)]
struct Told {
    kills: usize,
    begun_again: usize,
    gone_on: usize,
    results_spoilt: usize,
}

/// Kills a run, and what goes on with it, at random moments until it comes to its end.
fn kill_until_done(scene: &Path, out: &Path, time: Duration, numbers: &mut Numbers, told: &mut Told) {
    let mut restart = false;
    // Ever later, so that it ends.
    for round in 1.. {
        let more: &[&str] = if restart { &["--restart", "--threads", "2"] } else { &["--threads", "1"] };
        let mut child = command(scene, out, more).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        sleep(time.mul_f64(numbers.unit() * (0.7 + 0.3 * f64::from(round))));
        if let Some(status) = child.try_wait().unwrap() {
            assert!(status.success(), "{status}");
            return;
        }
        child.kill().unwrap();
        child.wait().unwrap();
        told.kills += 1;
        restart = ["checkpoint", "checkpoint.previous"].iter().any(|name| out.join(name).exists());
        let results = out.join("results.vtkhdf");
        told.results_spoilt += usize::from(results.exists() && subrope_io::ResultReader::open(&results).is_err());
        told.gone_on += usize::from(restart);
        told.begun_again += usize::from(!restart);
    }
}

fn check(text: &str, least: usize, seed: u64) -> Told {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.toml");
    fs::write(&scene, format!("{text}{LAW}")).unwrap();
    let reference = folder.path().join("reference");
    let start = Instant::now();
    let ended = run(&scene, &reference, &["--threads", "1"]);
    let time = start.elapsed();
    assert!(ended.status.success(), "{}", String::from_utf8_lossy(&ended.stderr));
    let reference = content(&reference);
    let (mut told, mut numbers) = (Told::default(), Numbers::new(seed));
    let mut runs = 0;
    while told.kills < least {
        let out = folder.path().join(format!("run_{runs}"));
        kill_until_done(&scene, &out, time, &mut numbers, &mut told);
        let found = content(&out);
        assert_eq!(found.keys().collect::<Vec<_>>(), reference.keys().collect::<Vec<_>>());
        for (name, bytes) in &reference {
            assert!(found[name] == *bytes, "{name} differs in {} after {told:?}", out.display());
        }
        fs::remove_dir_all(&out).unwrap();
        runs += 1;
    }
    println!("{runs} runs of {time:?}: {told:?}");
    told
}

/// A hundred kills, one half where files are written most of the time.
#[test]
#[ignore = "takes minutes"]
fn kills_at_random_moments_lose_nothing() {
    let strand = check(STRAND, 60, 1);
    let rope = check(ROPE, 40, 2);
    assert!(strand.gone_on + rope.gone_on >= 50, "{strand:?} {rope:?}");
}

/// The words and exit codes of `--restart`.
#[test]
fn restart_says_what_it_does() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, out) = (folder.path().join("scene.toml"), folder.path().join("out"));
    let short = STRAND.replace("fixed = 24", "fixed = 2").replace("angle = 40.0", "angle = 2.0");
    fs::write(&scene, format!("{short}{LAW}")).unwrap();
    let none = run(&scene, &out, &["--restart"]);
    assert_eq!(none.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&none.stderr).contains("there is no checkpoint in"));
    assert!(!out.exists(), "nothing is touched");
    assert!(run(&scene, &out, &[]).status.success());
    let done = run(&scene, &out, &["--restart"]);
    assert_eq!(done.status.code(), Some(0));
    assert!(String::from_utf8_lossy(&done.stdout).contains("done already"));
}
