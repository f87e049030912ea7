//! Blind mutation of the corpus: millions of inputs at the full speed of an optimised build, as a complement to fuzzing that
//! looks at coverage. Every run takes some thousand; `SUBROPE_MUTATIONS=3000000` and a release of patience take more.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

#[allow(dead_code, reason = "the seeds need a helper of the other file")]
#[path = "../../fuzz/src/checksums.rs"]
mod checksums;
#[allow(dead_code, reason = "not every parser is driven by every test")]
#[path = "../../fuzz/src/parsers.rs"]
mod parsers;

use std::panic::catch_unwind;
use std::path::{Path, PathBuf};

use subrope_material::testkit::Numbers;

/// Numbers that break what was not thought of.
const TOKENS: [&[u8]; 32] = [
    b"0",
    b"-1",
    b"1e308",
    b"-1e308",
    b"1e-308",
    b"nan",
    b"inf",
    b"18446744073709551615",
    b"9223372036854775807",
    b"-9223372036854775808",
    b"4294967295",
    b"2147483648",
    b"1000000000000",
    b"0x7f",
    b"\xff\xff\xff\xff\xff\xff\xff\xff",
    b"\x00\x00\x00\x00\x00\x00\x00\x00",
    b"\x00\x00\x00\x00\x00\x00\xf0\x7f",
    b"\x01\x00\x00\x00\x00\x00\xf8\x7f",
    b"\n",
    b"\r\n",
    b"\"",
    b"'''",
    b"[",
    b"]",
    b"[[",
    b"{",
    b"}",
    b"=",
    b",",
    b"*",
    b"#",
    b"\xef\xbb\xbf",
];

/// Files to start from, and words to put in.
struct Corpus {
    files: Vec<Vec<u8>>,
    words: Vec<Vec<u8>>,
    longest: usize,
}

impl Corpus {
    fn of(target: &str, longest: usize) -> Self {
        let fuzz = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz");
        let mut paths: Vec<PathBuf> = ["corpus", "regressions", "seeds"]
            .iter()
            .filter_map(|folder| std::fs::read_dir(fuzz.join(folder).join(target)).ok())
            .flat_map(|entries| entries.flatten().map(|entry| entry.path()))
            .collect();
        paths.sort();
        let files: Vec<_> = paths.iter().map(|path| std::fs::read(path).unwrap()).collect();
        assert!(!files.is_empty(), "there are seeds for {target}");
        let dictionary = std::fs::read_to_string(fuzz.join("dictionaries").join(target)).unwrap_or_default();
        let plain = |line: &str| line.trim_matches('"').replace("\\\"", "\"").replace("\\x0a", "\n").into_bytes();
        let words = dictionary.lines().map(plain).chain(TOKENS.iter().map(|t| t.to_vec())).collect();
        Self { files, words, longest }
    }

    /// Another input: a file with one to six changes.
    fn input(&self, numbers: &mut Numbers) -> Vec<u8> {
        let mut input = self.files[numbers.index(self.files.len())].clone();
        for _ in 0..=numbers.index(6) {
            self.change(&mut input, numbers);
        }
        input.truncate(self.longest);
        input
    }

    fn change(&self, input: &mut Vec<u8>, numbers: &mut Numbers) {
        let at = numbers.index(input.len() + 1);
        let end = (at + 1 + numbers.index(16)).min(input.len());
        let word = &self.words[numbers.index(self.words.len())];
        match numbers.index(9) {
            0 => input.iter_mut().skip(at).take(1).for_each(|byte| *byte ^= 1 << numbers.index(8)),
            1 => input.iter_mut().skip(at).take(1).for_each(|byte| *byte = numbers.bits() as u8),
            2 => drop(input.drain(at..end)),
            3 => drop(input.splice(at..at, word.iter().copied())),
            4 => drop(input.splice(at..end, word.iter().copied())),
            5 => {
                // Lines doubled, moved, taken away.
                let line =
                    |from: usize| input[from..].iter().position(|b| *b == b'\n').map_or(input.len(), |n| from + n + 1);
                let (begin, finish) = (line(at), line(line(at)));
                let copy: Vec<u8> = input[begin..finish].to_vec();
                let to = if numbers.chance(0.3) { begin } else { at };
                drop(input.splice(to..to, copy));
            }
            6 => {
                let other = &self.files[numbers.index(self.files.len())];
                let from = numbers.index(other.len() + 1);
                let piece = other[from..(from + 1 + numbers.index(200)).min(other.len())].to_vec();
                drop(input.splice(at..end, piece));
            }
            7 => {
                // A number in a text becomes another one.
                let digit = |byte: &u8| byte.is_ascii_digit();
                let Some(begin) = input[at..].iter().position(digit).map(|n| at + n) else { return };
                let stop = input[begin..].iter().position(|b| !digit(b)).map_or(input.len(), |n| begin + n);
                let token = TOKENS[numbers.index(14)];
                drop(input.splice(begin..stop, token.iter().copied()));
            }
            _ => input.truncate(at),
        }
    }
}

/// How many inputs each parser gets.
fn count(usual: u64) -> u64 {
    std::env::var("SUBROPE_MUTATIONS").ok().and_then(|text| text.parse().ok()).unwrap_or(usual)
}

/// Drives a parser; an input on which it panics is kept.
fn drive(target: &str, usual: u64, parse: fn(&[u8])) {
    let corpus = Corpus::of(target, if target == "checkpoint" { 12_000 } else { 4096 });
    let start = subrope_io::cpu_time().unwrap_or_default();
    let seed = std::env::var("SUBROPE_SEED").ok().and_then(|text| text.parse().ok()).unwrap_or(0_u64);
    let mut numbers = Numbers::new(seed);
    let (count, mut slowest, mut failed) = (count(usual), 0.0_f64, 0);
    for _ in 0..count {
        let mut input = corpus.input(&mut numbers);
        if target == "checkpoint" && numbers.chance(0.9) {
            checksums::put_right(&mut input);
        }
        let begin = subrope_io::cpu_time().unwrap_or_default();
        if catch_unwind(|| parse(&input)).is_err() {
            failed += 1;
            let kept = std::env::temp_dir().join(format!("subrope_{target}_{failed}"));
            std::fs::write(&kept, &input).unwrap();
            println!("{target}: kept {}", kept.display());
            assert!(failed < 20, "{target}: enough");
        }
        let spent = (subrope_io::cpu_time().unwrap_or_default() - begin).as_secs_f64();
        slowest = slowest.max(spent);
        assert!(spent < 20.0, "{target}: {spent} s for {:?}", String::from_utf8_lossy(&input));
    }
    let spent = (subrope_io::cpu_time().unwrap_or_default() - start).as_secs_f64();
    println!("{target}: {count} inputs in {spent:.1} s of CPU, the slowest {slowest:.3} s, {failed} failed");
    assert!(failed == 0, "{target}: {failed} failed");
}

#[test]
fn scenes() {
    drive("scene", 2000, parsers::scene);
}

#[test]
fn decks() {
    drive("deck", 20_000, parsers::deck);
}

#[test]
fn tables() {
    drive("table", 20_000, parsers::table);
}

#[test]
fn checkpoints() {
    drive("checkpoint", 5000, parsers::checkpoint);
}
