//! Everything that fuzzing has found worth keeping goes through the parsers again: none of it may panic, or take long.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

#[path = "../../fuzz/src/parsers.rs"]
mod parsers;

use std::path::{Path, PathBuf};

use subrope_fem::{StateError, StateReader};
use subrope_io::CheckpointReader;

/// Runs every file in the folders of a target; answers how many there are.
fn run(target: &str, parse: fn(&[u8])) -> usize {
    let fuzz = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz");
    let mut files: Vec<PathBuf> = ["corpus", "regressions", "seeds"]
        .iter()
        .filter_map(|folder| std::fs::read_dir(fuzz.join(folder).join(target)).ok())
        .flat_map(|entries| entries.flatten().map(|entry| entry.path()))
        .collect();
    files.sort();
    for file in &files {
        let start = subrope_io::cpu_time().unwrap_or_default().as_secs_f64();
        parse(&std::fs::read(file).unwrap());
        let spent = subrope_io::cpu_time().unwrap_or_default().as_secs_f64() - start;
        assert!(spent < 20.0, "{} took {spent} s", file.display());
    }
    files.len()
}

#[test]
fn scenes() {
    assert!(run("scene", parsers::scene) > 15);
}

#[test]
fn decks() {
    assert!(run("deck", parsers::deck) > 0);
}

#[test]
fn tables() {
    assert!(run("table", parsers::table) > 4);
}

#[test]
fn checkpoints() {
    assert!(run("checkpoint", parsers::checkpoint) > 0);
}

#[test]
fn the_seeds_are_what_they_should_be() {
    // A seed that is refused at its first line would be no seed.
    let seed = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/seeds/checkpoint/tiny");
    let reader = CheckpointReader::open(&seed).unwrap();
    parsers::taken_up(&parsers::Sections(&reader)).unwrap();
    for (name, index, bad) in [("progress", 0, u64::MAX), ("total_counts", 3, u64::MAX), ("nanoseconds", 1, u64::MAX)] {
        let error = parsers::taken_up(&Doctored { reader: &reader, name, index, bad }).unwrap_err();
        assert!(error.to_string().contains(name), "{error}");
    }
    for (index, bad) in [(4, f64::NAN), (4, 1.5), (5, 0.0), (5, -1.0), (5, f64::INFINITY), (3, f64::NAN)] {
        let error = parsers::taken_up(&Doctored { reader: &reader, name: "scalars", index, bad: bad.to_bits() });
        assert!(error.unwrap_err().to_string().contains("scalars"), "{index} {bad}");
    }
}

/// A checkpoint with one value replaced.
struct Doctored<'a> {
    reader: &'a CheckpointReader,
    name: &'a str,
    index: usize,
    bad: u64,
}

impl StateReader for Doctored<'_> {
    fn numbers(&self, name: &str) -> Result<Vec<f64>, StateError> {
        parsers::Sections(self.reader).numbers(name)
    }

    fn read_numbers(&self, name: &str, into: &mut [f64]) -> Result<(), StateError> {
        parsers::Sections(self.reader).read_numbers(name, into)?;
        if name == self.name {
            into[self.index] = f64::from_bits(self.bad);
        }
        Ok(())
    }

    fn counts(&self, name: &str) -> Result<Vec<u64>, StateError> {
        let mut counts = parsers::Sections(self.reader).counts(name)?;
        if name == self.name {
            counts[self.index] = self.bad;
        }
        Ok(counts)
    }
}
