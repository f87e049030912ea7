//! Files that cannot be read or written, wrong decks, and runs that are broken off: exit codes, messages, what is kept.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]
#![cfg(feature = "cli")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

const COARSE: &str = include_str!("../templates/bent_strand_coarse.toml");

fn subrope(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_subrope")).args(arguments).current_dir(folder).output().unwrap()
}

/// Runs a command and compares its exit code and what it says.
fn expect(folder: &Path, arguments: &[&str], code: i32, fragments: &[&str]) {
    let output = subrope(folder, arguments);
    let answer = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {answer}");
    for fragment in fragments {
        assert!(answer.contains(fragment), "{arguments:?}: no {fragment:?} in\n{answer}");
    }
}

fn folder_with_scene() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("scene.toml"), COARSE).unwrap();
    folder
}

/// The coarse scene with a deck in place of its strand.
fn deck_scene(folder: &Path, deck: &str) {
    let (start, end) = (COARSE.find("[strand]").unwrap(), COARSE.find("[element]").unwrap());
    let entry = format!("[deck]\nfile = \"{deck}\"\nfibres = \"deck\"\n\n");
    fs::write(folder.join("deck.toml"), COARSE[..start].to_owned() + &entry + &COARSE[end..]).unwrap();
}

/// The coarse strand as a deck, changed line by line.
fn write_deck(folder: &Path, change: impl FnMut(&mut Vec<String>)) {
    assert!(subrope(folder, &["mesh", "scene.toml", "-o", "good.inp"]).status.success());
    let mut lines: Vec<_> = fs::read_to_string(folder.join("good.inp")).unwrap().lines().map(str::to_owned).collect();
    let mut change = change;
    change(&mut lines);
    fs::write(folder.join("a.inp"), lines.join("\n")).unwrap();
    deck_scene(folder, "a.inp");
}

/// The line of an element with its top and bottom exchanged, under another label.
fn inverted(line: &str, label: u64) -> String {
    let fields: Vec<&str> = line.split(',').map(str::trim).collect();
    format!("{label}, {}, {}", fields[5..9].join(", "), fields[1..5].join(", "))
}

#[test]
fn inputs_that_are_no_text() {
    let folder = folder_with_scene();
    let path = folder.path();
    fs::create_dir(path.join("folder")).unwrap();
    fs::write(path.join("binary.toml"), [0x89, b'H', b'D', b'F', 0xff, 0x00]).unwrap();
    fs::write(path.join("binary.json"), [0x89, b'H', b'D', b'F', 0xff, 0x00]).unwrap();
    for command in ["check", "run", "point"] {
        expect(path, &[command, "none.toml"], 2, &["cannot read", "none.toml", "No such file"]);
        expect(path, &[command, "folder"], 2, &["cannot read", "folder"]);
        expect(path, &[command, "binary.toml"], 2, &["binary.toml", "UTF-8"]);
    }
    expect(path, &["point", "binary.json"], 2, &["binary.json", "UTF-8"]);
}

#[test]
fn decks_that_cannot_be_read() {
    let folder = folder_with_scene();
    let path = folder.path();
    fs::create_dir(path.join("folder")).unwrap();
    fs::write(path.join("picture.png"), [0x89, b'P', b'N', b'G', 0xff, 0x00]).unwrap();
    for (deck, cause) in [
        ("none.inp", "cannot read the deck none.inp"),
        ("folder", "cannot read the deck folder"),
        ("picture.png", "picture.png is no deck: it holds no *NODE and no *ELEMENT"),
        ("scene.toml", "scene.toml is no deck"),
    ] {
        deck_scene(path, deck);
        expect(path, &["run", "deck.toml"], 2, &[cause, "--> deck.toml:8:8"]);
    }
    assert!(!path.join("out").exists());
}

#[test]
fn an_inverted_brick_is_named_by_its_label() {
    let folder = folder_with_scene();
    let path = folder.path();
    write_deck(path, |lines| {
        let start = lines.iter().position(|line| line.starts_with("*ELEMENT")).unwrap();
        // Brick 300 is last: a new label keeps the sets whole but for itself, and is no index.
        lines[start + 300] = inverted(&lines[start + 300], 300);
    });
    expect(path, &["run", "deck.toml"], 2, &["deck a.inp", "brick 300 is inverted", "Jacobian determinant -"]);
    assert!(!path.join("out").exists());
    let nodes: Vec<String> = (1..).zip(CUBE).map(|(i, [x, y, z])| format!("{i}, {x}, {y}, {z}")).collect();
    let brick = inverted("1, 1, 2, 3, 4, 5, 6, 7, 8", 4711);
    let sets = "*NSET, NSET=END_A\n1\n*NSET, NSET=END_B\n5";
    fs::write(path.join("a.inp"), format!("*NODE\n{}\n*ELEMENT, TYPE=C3D8\n{brick}\n{sets}\n", nodes.join("\n")))
        .unwrap();
    expect(path, &["check", "deck.toml"], 2, &["brick 4711 is inverted"]);
}

/// Corners of a brick.
const CUBE: [[u8; 3]; 8] = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];

#[test]
fn missing_fibre_directions_are_told() {
    let folder = folder_with_scene();
    write_deck(folder.path(), |lines| {
        let section = lines.iter().position(|line| line.starts_with("*SOLID SECTION")).unwrap();
        lines.truncate(section);
    });
    let fragments = ["300 element(s) of the deck have no orientation", "element 1", "*SOLID SECTION"];
    expect(folder.path(), &["run", "deck.toml"], 2, &fragments);
}

#[test]
fn wrong_numbers_in_a_deck_have_their_line() {
    let folder = folder_with_scene();
    for (text, cause) in [("nan", "\"nan\" is not finite"), ("1.0.0", "\"1.0.0\" is not a number")] {
        write_deck(folder.path(), |lines| lines[3] = format!("3, {text}, 0.0, 0.0"));
        expect(folder.path(), &["run", "deck.toml"], 2, &["a.inp:4", cause]);
    }
}

#[test]
fn rigid_motions_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let loose = COARSE[..COARSE.find("[[end]]").unwrap()].to_owned()
        + "[[step]]\nname = \"pull\"\n[[step.nodal_force]]\nset = \"END_B\"\nfz = 1.0\n";
    fs::write(folder.path().join("loose.toml"), loose).unwrap();
    let fragments = ["6 rigid motion(s)", "translation along z", "rotation about z", "help: give the part an [[end]]"];
    expect(folder.path(), &["check", "loose.toml"], 2, &fragments);
    expect(folder.path(), &["run", "loose.toml"], 2, &fragments);
    assert!(!folder.path().join("out").exists());
}

#[test]
fn results_that_cannot_be_written() {
    let folder = folder_with_scene();
    let path = folder.path();
    fs::write(path.join("file"), "mine").unwrap();
    expect(path, &["run", "scene.toml", "--out", "file"], 4, &["cannot make the folder file", "a file is in the way"]);
    expect(path, &["new", "file"], 4, &["cannot write file", "a file is in the way"]);
    assert_eq!(fs::read_to_string(path.join("file")).unwrap(), "mine");
    fs::create_dir(path.join("taken.inp")).unwrap();
    expect(path, &["mesh", "scene.toml", "-o", "taken.inp"], 4, &["taken.inp", "a folder is in the way"]);
    expect(path, &["mesh", "scene.toml", "-o", "none/a.inp"], 4, &["none/a.inp", "make the folder first"]);
}

/// A scene that is wrong does not touch the results of an earlier run.
#[test]
fn earlier_results_survive_a_wrong_scene() {
    let folder = folder_with_scene();
    let path = folder.path();
    fs::create_dir(path.join("kept")).unwrap();
    fs::write(path.join("kept/summary.json"), "{}").unwrap();
    fs::write(path.join("scene.toml"), COARSE.replacen("K_e = 2000.0", "K_e = nan", 1)).unwrap();
    expect(path, &["run", "scene.toml", "--out", "kept"], 2, &["`K_e` = NaN", "a finite number"]);
    assert_eq!(fs::read_to_string(path.join("kept/summary.json")).unwrap(), "{}");
}

#[cfg(unix)]
mod unix {
    use super::*;
    use std::os::unix::fs::PermissionsExt as _;
    use std::process::{Child, Stdio};
    use std::time::{Duration, Instant};

    fn set_mode(path: &Path, mode: u32) {
        fs::set_permissions(path, fs::Permissions::from_mode(mode)).unwrap();
    }

    #[test]
    fn permissions_are_told() {
        let folder = folder_with_scene();
        let path = folder.path();
        fs::write(path.join("secret.toml"), COARSE).unwrap();
        set_mode(&path.join("secret.toml"), 0o000);
        fs::create_dir(path.join("closed")).unwrap();
        set_mode(&path.join("closed"), 0o555);
        if fs::read(path.join("secret.toml")).is_ok() {
            println!("skipped: permissions do not bind this user (root)");
            return;
        }
        expect(path, &["run", "secret.toml"], 2, &["cannot read the scene secret.toml", "Permission denied"]);
        let fragments = ["cannot make the folder closed/r", "Permission denied", "a folder that you may write to"];
        expect(path, &["run", "scene.toml", "--out", "closed/r"], 4, &fragments);
        expect(path, &["run", "scene.toml", "--out", "closed"], 4, &["closed/history.csv", "Permission denied"]);
        set_mode(&path.join("closed"), 0o755);
    }

    /// `/dev/full` refuses every byte as a full disk does, for every user.
    #[test]
    #[cfg(target_os = "linux")]
    fn a_full_disk_is_told() {
        let folder = folder_with_scene();
        let path = folder.path();
        for file in ["history.csv", "results.vtkhdf"] {
            let out = path.join(format!("full_{file}"));
            fs::create_dir(&out).unwrap();
            std::os::unix::fs::symlink("/dev/full", out.join(file)).unwrap();
            let fragments: &[&str] =
                if file == "history.csv" { &[file, "No space left", "free some space"] } else { &[file] };
            expect(path, &["run", "scene.toml", "--out", out.to_str().unwrap()], 4, fragments);
        }
        let full = fs::File::options().write(true).open("/dev/full").unwrap();
        let mut schema = Command::new(env!("CARGO_BIN_EXE_subrope"));
        let output = schema.arg("schema").stdout(full).output().unwrap();
        assert_eq!(output.status.code(), Some(4));
        assert!(String::from_utf8_lossy(&output.stderr).contains("cannot write standard output"));
    }

    /// Starts a run long enough to be broken off, and waits until some increments are in its history.
    fn started(folder: &Path) -> Child {
        let long = COARSE.replacen("initial = 0.05, maximum = 0.1", "fixed = 2000", 1);
        fs::write(folder.join("long.toml"), long).unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_subrope"));
        command.args(["run", "long.toml", "--out", "r", "--threads", "1"]).current_dir(folder);
        let child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        let start = Instant::now();
        while rows(folder) < 4 {
            assert!(start.elapsed() < Duration::from_secs(120), "the run does not get on");
            std::thread::sleep(Duration::from_millis(5));
        }
        child
    }

    /// Complete rows of the history.
    fn rows(folder: &Path) -> usize {
        let text = fs::read_to_string(folder.join("r/history.csv")).unwrap_or_default();
        text.matches('\n').count().saturating_sub(1)
    }

    fn send(signal: &str, child: &Child) {
        assert!(Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap().success());
    }

    /// Steps in the result file, the one at the start included; the displacement of the last is read and checked.
    #[cfg(feature = "hdf5")]
    fn steps(folder: &Path) -> usize {
        use subrope_io::{Location, ResultReader};
        let reader = ResultReader::open(&folder.join("r/results.vtkhdf")).unwrap();
        let steps = reader.values().unwrap().len();
        let last = reader.field(Location::Point, "displacement", steps - 1).unwrap();
        assert!(last.iter().all(|u| u.is_finite()) && last.iter().any(|u| u.abs() > 1e-4), "{steps} steps");
        steps
    }

    #[test]
    fn a_killed_run_is_readable_up_to_its_last_increment() {
        let folder = tempfile::tempdir().unwrap();
        let mut child = started(folder.path());
        send("-KILL", &child);
        assert_eq!(child.wait().unwrap().code(), None);
        // The row of an increment is written before its frame.
        #[cfg(feature = "hdf5")]
        assert!((rows(folder.path())..=rows(folder.path()) + 1).contains(&steps(folder.path())));
        assert!(!folder.path().join("r/summary.json").exists());
    }

    #[test]
    fn an_interrupted_run_closes_its_files() {
        for signal in ["-INT", "-TERM"] {
            let folder = tempfile::tempdir().unwrap();
            let child = started(folder.path());
            send(signal, &child);
            let output = child.wait_with_output().unwrap();
            let answer = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), Some(3), "{signal}: {answer}");
            assert!(answer.contains("interrupted after increment"), "{answer}");
            #[cfg(feature = "hdf5")]
            assert_eq!(steps(folder.path()), rows(folder.path()) + 1);
            let summary = fs::read(folder.path().join("r/summary.json")).unwrap();
            let summary: serde_json::Value = serde_json::from_slice(&summary).unwrap();
            assert_eq!(summary["status"]["state"], "interrupted");
            assert_eq!(summary["counts"]["increments"], rows(folder.path()));
        }
    }
}
