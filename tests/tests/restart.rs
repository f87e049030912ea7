//! Runs that are stopped at any moment go on to the same bits.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use subrope::Error;
use subrope::progress::{IncrementRecord, Observer, Outcome, Silent};
use subrope::run::{RestartError, RunError, RunOptions, restart_scene, run_scene};
use subrope_io::{ResultReader, Writes, read_history};
use subrope_tests::{SET_C, rod_on_strand, short_rope};
use tempfile::TempDir;

/// A scene in a folder of its own.
struct Scene {
    folder: TempDir,
    threads: usize,
}

impl Scene {
    fn new(text: &str, threads: usize) -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("scene.toml"), text).unwrap();
        Self { folder, threads }
    }

    fn path(&self) -> PathBuf {
        self.folder.path().join("scene.toml")
    }

    fn out(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn run(&self, out: &Path, writes: Option<&Writes>, observer: &mut dyn Observer) -> Result<(), Error> {
        let options = RunOptions { folder: Some(out), threads: Some(self.threads), writes, ..RunOptions::default() };
        run_scene(&self.path(), options, observer).map(|_| ())
    }

    /// Goes on; says whether there was something to do.
    fn restart(&self, out: &Path) -> Result<bool, Error> {
        self.restart_with(out, None)
    }

    fn restart_with(&self, out: &Path, writes: Option<&Writes>) -> Result<bool, Error> {
        let options = RunOptions { folder: Some(out), threads: Some(self.threads), writes, ..RunOptions::default() };
        restart_scene(&self.path(), options, &mut Silent).map(|outcome| outcome.is_some())
    }
}

/// Copies the folder of a run after every n-th increment, as a process that is killed there would leave it.
struct Snapshots {
    from: PathBuf,
    every: usize,
    count: usize,
    taken: Vec<PathBuf>,
    cutbacks: usize,
}

impl Snapshots {
    fn new(from: &Path, every: usize) -> Self {
        Self { from: from.to_path_buf(), every, count: 0, taken: Vec::new(), cutbacks: 0 }
    }
}

impl Observer for Snapshots {
    fn on_increment(&mut self, record: &IncrementRecord) {
        self.cutbacks += usize::from(record.outcome == Outcome::CutBack);
        self.count += 1;
        if self.count.is_multiple_of(self.every) {
            let to = self.from.with_file_name(format!("killed_{}", self.count));
            copy(&self.from, &to);
            self.taken.push(to);
        }
    }
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        fs::copy(&path, to.join(path.file_name().unwrap())).unwrap();
    }
}

/// All files of a folder; of the summary everything but times, memory and threads.
fn content(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let files = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    files
        .map(|path| {
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            let bytes = fs::read(&path).unwrap();
            if name != "summary.json" {
                return (name, bytes);
            }
            let mut summary: serde_json::Value = serde_json::from_slice(&bytes).unwrap();
            let all = summary.as_object_mut().unwrap();
            all.remove("seconds");
            all.remove("peak_memory_mb");
            all["size"].as_object_mut().unwrap().remove("threads");
            all["plan"].as_array_mut().unwrap().retain(|part| part["part"] != "threads");
            (name, summary.to_string().into_bytes())
        })
        .collect()
}

#[track_caller]
fn same(reference: &BTreeMap<String, Vec<u8>>, folder: &Path) {
    let found = content(folder);
    assert_eq!(found.keys().collect::<Vec<_>>(), reference.keys().collect::<Vec<_>>(), "{}", folder.display());
    for (name, bytes) in reference {
        assert!(found[name] == *bytes, "{} differs in {}", name, folder.display());
    }
}

/// Whether there is no checkpoint.
fn is_missing(error: &Error) -> bool {
    matches!(error, Error::Run(RunError::Restart(cause)) if matches!(**cause, RestartError::Missing { .. }))
}

/// Kills a run after every n-th increment and lets each go on; all end like the one that was never stopped. Answers the
/// content of its folder, and the cutbacks.
fn check(text: &str, threads: usize, every: usize) -> (BTreeMap<String, Vec<u8>>, usize) {
    let scene = Scene::new(text, threads);
    let out = scene.out("out");
    let mut snapshots = Snapshots::new(&out, every);
    scene.run(&out, None, &mut snapshots).unwrap();
    let reference = content(&out);
    assert!(reference.contains_key("results.vtkhdf") && !reference.contains_key("checkpoint"));
    let mut restarted = 0;
    for killed in &snapshots.taken {
        match scene.restart(killed) {
            Ok(gone_on) => {
                assert!(gone_on);
                same(&reference, killed);
                restarted += 1;
            }
            Err(error) if is_missing(&error) => assert_eq!(restarted, 0),
            Err(error) => panic!("{}", error.plain()),
        }
    }
    assert!(restarted >= 2, "{restarted} of {} restarted", snapshots.taken.len());
    (reference, snapshots.cutbacks)
}

/// A strand of 96 bricks.
fn strand(steps: &str) -> String {
    format!(
        "title = \"a strand\"\n[strand]\nradius = 2.785\nlength = 16.0\nsurface_angle = 30.0\n[strand.mesh]\ncore = 2\n\
         rings = 1\nlayers = 8\n{SET_C}{steps}"
    )
}

const BEND: &str = "[[step]]\nname = \"bend\"\nincrements = { initial = 0.6, maximum = 0.6 }\nbend = { angle = 40.0 }\n\
    [[step]]\nname = \"back\"\nincrements = { initial = 0.1 }\nbend = { angle = 20.0 }\n";

#[test]
fn a_bent_strand_goes_on_within_a_step_that_was_cut() {
    for threads in [1, 2] {
        let (_, cutbacks) = check(&strand(&format!("{BEND}[output]\nevery = 2\ncheckpoint_every = 3\n")), threads, 1);
        assert!(cutbacks > 0, "the step is to be cut");
    }
}

const FOLLOW: &str = "[[step]]\nname = \"press\"\n\
    increments = { initial = 0.05, maximum = 0.1, control = \"arc_length\" }\ntension = { elongation = -0.08 }\n\
    [output]\ncheckpoint_every = 3\n";

/// A path with arc lengths, on which the fraction of the step is an unknown.
#[test]
fn a_path_goes_on() {
    assert!(check(&strand(FOLLOW), 1, 2).0 == check(&strand(FOLLOW), 2, 3).0, "the same on two threads");
}

const PRESS: &str = "[[step]]\nname = \"press\"\nincrements = { fixed = 8 }\ntension = { elongation = -0.12 }\n\
    [solver]\ntrust_region = \"always\"\n[output]\ncheckpoint_every = 1\n";

/// A strand that buckles, every state of which is found as a minimum.
#[test]
fn minima_go_on() {
    let one = check(&strand(PRESS), 1, 2).0;
    let two = check(&strand(PRESS), 2, 3).0;
    assert!(one == two, "the same on two threads");
    let summary: serde_json::Value = serde_json::from_slice(&one["summary.json"]).unwrap();
    assert_eq!(summary["counts"]["minimised"], 8);
}

const CYCLES: &str = r#"
[[step]]
name = "pull"
increments = { initial = 0.1 }
tension = { elongation = 0.01 }
[[step]]
name = "cycle"
increments = { initial = 0.5 }
cycles = { count = 2, low = 0.2, high = 1.0, every = 2 }
[output]
checkpoint_every = 4
"#;

#[test]
fn a_rope_with_friction_and_cycles_goes_on() {
    let one = check(&short_rope(CYCLES), 1, 5).0;
    let two = check(&short_rope(CYCLES), 2, 9).0;
    assert!(one == two, "the same on two threads");
}

/// The rope of the shipped slice, coarser.
fn slice(steps: &str) -> String {
    short_rope(steps).replace("[rope.mesh]", "symmetry = \"helical\"\n[rope.mesh]")
}

#[test]
fn a_slice_with_cycles_goes_on() {
    check(&slice(CYCLES), 1, 2);
}

#[test]
fn multipliers_and_a_rod_go_on() {
    let steps = "[[step]]\nname = \"press\"\nincrements = { initial = 0.2 }\n\
        prescribe = [{ point = \"ROD\", ux = -0.2 }]\n[output]\ncheckpoint_every = 2\n";
    let text = rod_on_strand(0.15, steps)
        .replace("friction = 0.15", "friction = 0.15\nmethod = \"augmented\"\npenetration = 1e-5");
    let reference = check(&text, 1, 3).0;
    let summary: serde_json::Value = serde_json::from_slice(&reference["summary.json"]).unwrap();
    assert!(summary["counts"]["augmentations"].as_u64().unwrap() > 0, "multipliers are to move");
}

/// A scene of five increments that writes little.
fn tiny() -> Scene {
    let text = strand(
        "[[step]]\nname = \"pull\"\nincrements = { fixed = 5 }\ntension = { elongation = 0.005 }\n[output]\n\
         fields = [\"displacement\"]\ncheckpoint_every = 2\n",
    );
    Scene::new(&text, 1)
}

/// Makes the n-th operation on a file fail, n = 1, 2, 3, ..., alone and with all that follow.
#[test]
fn no_failing_write_loses_anything() {
    let scene = tiny();
    let out = scene.out("out");
    scene.run(&out, None, &mut Silent).unwrap();
    let reference = content(&out);
    let (mut begun, mut gone_on) = (0, 0);
    for count in [1, u64::MAX] {
        for first in 1.. {
            let writes = Writes::failing(first, count);
            let out = scene.out(&format!("failing_{first}_{count}"));
            let ended = scene.run(&out, Some(&writes), &mut Silent);
            if writes.done() < first {
                ended.unwrap();
                break;
            }
            let message = ended.unwrap_err().plain();
            assert!(message.contains("storage") || message.contains("earlier write"), "{first}: {message}");
            // What another process finds: the library knows the files that it has open by their place on the disk.
            let left = scene.out(&format!("left_{first}_{count}"));
            copy(&out, &left);
            let kept = ["checkpoint", "checkpoint.previous"].iter().any(|name| left.join(name).exists());
            assert!(!message.contains("--restart") || kept, "{first}: {message}");
            match scene.restart(&left) {
                Ok(_) => gone_on += 1,
                Err(error) if is_missing(&error) => {
                    assert!(!kept && !message.contains("--restart"), "{first}: {message}");
                    scene.run(&left, None, &mut Silent).unwrap();
                    begun += 1;
                }
                Err(error) => panic!("{first}: {}", error.plain()),
            }
            same(&reference, &left);
            fs::remove_dir_all(&left).unwrap();
            fs::remove_dir_all(&out).unwrap();
        }
    }
    println!("{begun} begun anew, {gone_on} gone on");
    assert!(begun > 10 && gone_on > 30);
}

/// The same while a run goes on, at the files that are cut back among others.
#[test]
fn no_failing_write_of_a_restart_loses_anything() {
    let scene = tiny();
    let out = scene.out("out");
    let mut snapshots = Snapshots::new(&out, 3);
    scene.run(&out, None, &mut snapshots).unwrap();
    let reference = content(&out);
    for first in 1.. {
        let (failing, left) = (scene.out(&format!("failing_{first}")), scene.out(&format!("left_{first}")));
        copy(&snapshots.taken[0], &failing);
        let writes = Writes::failing(first, 1);
        let ended = scene.restart_with(&failing, Some(&writes));
        if writes.done() < first {
            assert!(ended.unwrap());
            break;
        }
        assert!(ended.is_err(), "{first}");
        copy(&failing, &left);
        assert!(scene.restart(&left).unwrap(), "{first}");
        same(&reference, &left);
        fs::remove_dir_all(&left).unwrap();
        fs::remove_dir_all(&failing).unwrap();
    }
}

fn interrupted(scene: &Scene, out: &Path, increments: usize) -> Error {
    struct Stop<'a>(&'a AtomicBool, usize);
    impl Observer for Stop<'_> {
        fn on_increment(&mut self, record: &IncrementRecord) {
            self.0.store(record.increment >= self.1, Ordering::Relaxed);
        }
    }
    let flag = AtomicBool::new(false);
    let options = RunOptions { folder: Some(out), threads: Some(1), interrupt: Some(&flag), ..RunOptions::default() };
    run_scene(&scene.path(), options, &mut Stop(&flag, increments)).unwrap_err()
}

const PULL: &str = "[[step]]\nname = \"pull\"\nincrements = { fixed = 6 }\ntension = { elongation = 0.01 }\n";

/// Stopped by the user, finished, finished twice; without a checkpoint; with that of another scene or version.
#[test]
fn what_is_found_is_told() {
    let scene = Scene::new(&strand(PULL), 1);
    let (out, straight) = (scene.out("out"), scene.out("straight"));
    scene.run(&straight, None, &mut Silent).unwrap();
    let told = |result: Result<bool, Error>| result.unwrap_err().plain();
    assert!(told(scene.restart(&out)).contains("there is no checkpoint in"));
    let message = interrupted(&scene, &out, 3).plain();
    assert!(message.contains("interrupted after increment 3") && message.contains("--restart"), "{message}");
    assert_eq!(read_history(&out.join("history.csv")).unwrap().rows.len(), 3);
    assert_eq!(ResultReader::open(&out.join("results.vtkhdf")).unwrap().steps(), 4);

    let other = Scene::new(&strand(&PULL.replace("0.01", "0.02")), 1);
    assert!(told(other.restart(&out)).contains("another scene"));
    let path = out.join("checkpoint");
    let good = fs::read(&path).unwrap();
    fs::write(&path, &good[..good.len() / 2]).unwrap();
    let message = told(scene.restart(&out));
    assert!(message.contains("ends too early") && message.contains("checkpoint.previous"), "{message}");
    fs::write(&path, &good).unwrap();

    let results = fs::read(out.join("results.vtkhdf")).unwrap();
    fs::write(out.join("results.vtkhdf"), &results[..1000]).unwrap();
    let message = told(scene.restart(&out));
    assert!(message.contains("results.vtkhdf") && message.contains("do not fit"), "{message}");
    fs::remove_file(out.join("results.vtkhdf")).unwrap();
    fs::write(out.join("results.vtkhdf"), &results).unwrap();

    assert!(scene.restart(&out).unwrap());
    same(&content(&straight), &out);
    let before = content(&out);
    assert!(!scene.restart(&out).unwrap(), "done already");
    same(&before, &out);
}

/// A folder that vanishes or may not be written to is told; what was written is kept.
#[cfg(unix)]
#[test]
fn a_folder_that_vanishes_is_told() {
    struct Vanish(PathBuf);
    impl Observer for Vanish {
        fn on_increment(&mut self, record: &IncrementRecord) {
            if record.increment == 3 {
                fs::rename(&self.0, self.0.with_file_name("elsewhere")).unwrap();
            }
        }
    }
    let scene = Scene::new(&strand(&format!("{PULL}[output]\ncheckpoint_every = 2\n")), 1);
    let (out, straight) = (scene.out("out"), scene.out("straight"));
    scene.run(&straight, None, &mut Silent).unwrap();
    let error = scene.run(&out, None, &mut Vanish(out.clone())).unwrap_err();
    assert!(error.plain().contains("out/checkpoint") && error.plain().contains("--restart"), "{}", error.plain());
    let elsewhere = scene.out("elsewhere");
    assert!(scene.restart(&elsewhere).unwrap());
    same(&content(&straight), &elsewhere);
}
