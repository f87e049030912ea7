//! Malformed and hostile decks: a typed error with file, line and text, never a panic, never unbounded memory.
// Helpers of tests may fail like tests.
#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout)]

use proptest::prelude::*;
use std::fs;
use std::path::Path;
use subrope_io::{DeckError, DeckErrorKind as Kind, IoError, parse_deck, read_deck};

const CUBE: &str = "*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n\
                    *ELEMENT,TYPE=C3D8,ELSET=E\n1,1,2,3,4,5,6,7,8\n";
const LINES: u32 = 11;

fn error_of(text: &str) -> DeckError {
    match parse_deck(Path::new("deck.inp"), text) {
        Err(IoError::Deck(error)) => error,
        other => panic!("{other:?}"),
    }
}

/// The error of a cube followed by `more`, whose line is counted from the end of the cube.
fn after_cube(more: &str) -> (u32, Kind) {
    let error = error_of(&format!("{CUBE}{more}"));
    (error.line - LINES, error.kind)
}

#[test]
fn messages_hold_file_line_and_text() {
    let error = error_of(&CUBE.replace("4,0,1,0", "4, 0, NaN, 0"));
    assert_eq!(error.to_string(), "deck.inp:5: \"NaN\" is not finite in \"4, 0, NaN, 0\"");
    assert!(matches!(error.kind, Kind::NotFinite { .. }));
}

#[test]
fn nodes() {
    let with = |line: &str| error_of(&CUBE.replace("4,0,1,0", line));
    assert!(matches!(with("4,0,1e999,0").kind, Kind::NotFinite { .. }));
    assert!(matches!(with("4,0,one,0").kind, Kind::BadNumber { .. }));
    assert!(matches!(with("4,0,1").kind, Kind::FieldCount { expected: 4, got: 3 }));
    assert!(matches!(with("4,0,1,0,7").kind, Kind::FieldCount { expected: 4, got: 5 }));
    assert!(matches!(with("-4,0,1,0").kind, Kind::BadLabel { .. }));
    let twice = with("3,0,1,0");
    assert!(matches!(twice.kind, Kind::DuplicateNode { label: 3, line: 4, .. }));
    assert_eq!(twice.line, 5);
}

#[test]
fn elements() {
    let with = |line: &str| error_of(&CUBE.replace("1,1,2,3,4,5,6,7,8", line));
    assert!(matches!(with("1,1,2,3,4,5,6,7,9").kind, Kind::UndefinedNode { label: 9 }));
    assert!(matches!(with("1,1,2,3,4,5,6,7,7").kind, Kind::RepeatedNode { element: 1, label: 7 }));
    assert!(matches!(with("1,1,2,3,4,5,6,7").kind, Kind::FieldCount { expected: 9, got: 8 }));
    assert!(matches!(with("1,1,2,3,4,5,6,7,8,1").kind, Kind::FieldCount { expected: 9, got: 10 }));
    assert!(matches!(with("1,1,2,3,4,").kind, Kind::FieldCount { expected: 9, got: 5 }));
    assert!(matches!(with("** none").kind, Kind::NoElements));
    let (line, kind) = after_cube("1,1,2,3,4,5,6,7,8\n");
    assert!(matches!((line, kind), (1, Kind::DuplicateElement { label: 1, line: LINES, .. })));
    let error = error_of(&CUBE.replace("C3D8", "C3D10"));
    assert_eq!(error.line, 10);
    assert!(matches!(error.kind, Kind::UnsupportedElement { element_type } if element_type == "C3D10"));
    assert!(matches!(after_cube("*ELEMENT,TYPE=C3D27\n").1, Kind::MixedElements { nodes: 8, .. }));
    assert!(matches!(after_cube("*ELEMENT\n").1, Kind::MissingParameter { parameter: "TYPE" }));
}

#[test]
fn sets() {
    assert!(matches!(after_cube("*NSET,NSET=A\n1\nB\n"), (3, Kind::UnknownNodeSet { .. })));
    assert!(matches!(after_cube("*NSET,NSET=A\nA\n"), (2, Kind::UnknownNodeSet { .. })));
    assert!(matches!(after_cube("*NSET,NSET=A\n9\n"), (2, Kind::UndefinedNode { label: 9 })));
    assert!(matches!(after_cube("*ELSET,ELSET=A\n9\n"), (2, Kind::UndefinedElement { label: 9 })));
    assert!(matches!(after_cube("*ELSET,ELSET=A\nB\n"), (2, Kind::UnknownElementSet { .. })));
    assert!(matches!(after_cube("*NSET,NSET=A,ELSET=B\n"), (1, Kind::UnknownElementSet { .. })));
    assert!(matches!(after_cube("*NSET,NSET=\n1\n"), (1, Kind::MissingParameter { parameter: "NSET" })));
    assert!(matches!(after_cube("*NSET,NSET=A,GENERATE\n5,1\n"), (2, Kind::BadRange { .. })));
    assert!(matches!(after_cube("*NSET,NSET=A,GENERATE\n1,5,0\n"), (2, Kind::BadLabel { .. })));
    assert!(matches!(after_cube("*NSET,NSET=A,GENERATE\n1\n"), (2, Kind::FieldCount { .. })));
}

#[test]
fn surfaces() {
    assert!(matches!(after_cube("*SURFACE,NAME=A\n1,S7\n"), (2, Kind::BadFace { .. })));
    assert!(matches!(after_cube("*SURFACE,NAME=A\nE\n"), (2, Kind::FieldCount { expected: 2, got: 1 })));
    assert!(matches!(after_cube("*SURFACE,NAME=A\nF,S1\n"), (2, Kind::UnknownElementSet { .. })));
    assert!(matches!(after_cube("*SURFACE,NAME=A\n*SURFACE,NAME=a\n"), (2, Kind::DuplicateName { .. })));
}

#[test]
fn orientations_and_sections() {
    let section = "*SOLID SECTION,ELSET=E,ORIENTATION=O\n";
    let with = |text: &str| after_cube(&format!("{section}*ORIENTATION,NAME=O\n{text}"));
    assert!(matches!(after_cube(section), (1, Kind::UnknownOrientation { .. })));
    assert!(matches!(with(""), (2, Kind::NoData)));
    assert!(matches!(with("1,0,0,2,0,0\n"), (2, Kind::DegenerateAxes)));
    assert!(matches!(with("1,0,0,2,0\n"), (3, Kind::FieldCount { expected: 6, got: 5 })));
    assert!(matches!(with("1,0,0,0,1,0\n4,90.\n"), (4, Kind::UnsupportedParameter { .. })));
    assert!(matches!(with("D\n"), (2, Kind::UnknownDistribution { .. })));
    assert!(matches!(with("D\n*DISTRIBUTION,NAME=D\n"), (2, Kind::MissingAxes { element: 1, .. })));
    assert!(matches!(with("D\n*DISTRIBUTION,NAME=D\n1,1,0,0\n"), (5, Kind::FieldCount { expected: 7, got: 4 })));
    assert!(matches!(with("D\n*DISTRIBUTION,NAME=D,LOCATION=NODE\n"), (2, Kind::UnsupportedDistribution { .. })));
    assert!(matches!(with("D\n*DISTRIBUTION,NAME=D,TABLE=T\n"), (2, Kind::UnsupportedDistribution { .. })));
    assert!(matches!(after_cube("*ORIENTATION,NAME=O,SYSTEM=CYLINDRICAL\n"), (1, Kind::UnsupportedParameter { .. })));
    assert!(matches!(after_cube("*SOLID SECTION,ELSET=F\n"), (1, Kind::UnknownElementSet { .. })));
    let twice = "*SOLID SECTION,ELSET=E\n*SOLID SECTION,ELSET=E\n";
    assert!(matches!(after_cube(twice), (2, Kind::SecondSection { element: 1 })));
}

#[test]
fn keywords() {
    assert!(matches!(error_of("1,2,3\n").kind, Kind::NoKeyword));
    assert!(matches!(after_cube("*NSET,NSET=\"A\n1\n").1, Kind::OpenQuote));
    assert!(matches!(after_cube("*NSET,NSET=A,\n1,2,3\n").1, Kind::BadParameter { .. }));
    for keyword in ["*NGEN", "*SYSTEM", "*N FILL", "*ELGEN"] {
        assert!(matches!(after_cube(&format!("{keyword}\n")).1, Kind::UnsupportedKeyword { .. }), "{keyword}");
    }
    assert!(matches!(after_cube("*NODE,SYSTEM=C\n").1, Kind::UnsupportedParameter { parameter: "SYSTEM", .. }));
    assert!(matches!(after_cube("*INSTANCE,NAME=A\n1.,0.,0.\n"), (2, Kind::UnsupportedKeyword { .. })));
    assert!(parse_deck(Path::new("x"), &format!("{CUBE}*INSTANCE,NAME=A\n*END INSTANCE\n")).is_ok());
}

#[test]
fn ranges_and_labels_do_not_cost_memory() {
    let max = u64::MAX;
    let (line, kind) = after_cube(&format!("*NSET,NSET=A,GENERATE\n1,{max}\n"));
    assert!(matches!((line, kind), (2, Kind::LongRange { count, defined: 8 }) if count == max));
    let (_, kind) = after_cube(&format!("*NSET,NSET=A,GENERATE\n{},{max},{}\n", max - 2, max - 3));
    assert!(matches!(kind, Kind::UndefinedNode { .. }));
    let deck = parse_deck(
        Path::new("x"),
        &CUBE.replace("8,0,1,1", &format!("{max},0,1,1")).replace(",8\n", &format!(",{max}\n")),
    );
    assert_eq!(deck.unwrap().mesh.point_labels[7], max);
}

#[test]
fn nested_sets_do_not_multiply_without_bound() {
    let mut text = String::from("*NODE\n");
    for i in 1..=1000 {
        text.push_str(&format!("{i},{i},0,0\n"));
    }
    text.push_str(
        CUBE.split_once("*ELEMENT").map(|(_, rest)| rest).map(|rest| format!("*ELEMENT{rest}")).unwrap().as_str(),
    );
    text.push_str("*NSET,NSET=A,GENERATE\n1,1000\n");
    for i in 0..60_000 {
        text.push_str(&format!("*NSET,NSET=S{i}\nA\n"));
    }
    assert!(matches!(error_of(&text).kind, Kind::TooManyMembers { .. }));
}

#[test]
fn long_lines_are_refused() {
    assert!(matches!(error_of(&"x".repeat(100_000)).kind, Kind::LineTooLong { .. }));
    assert!(matches!(error_of(&format!("*NODE,\n{}", "a=b,\n".repeat(50_000))).kind, Kind::LineTooLong { .. }));
}

#[test]
fn includes() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let error_at = |name: &str| match read_deck(&path(name)) {
        Err(IoError::Deck(error)) => error,
        other => panic!("{other:?}"),
    };
    fs::create_dir(path("sub")).unwrap();
    fs::write(path("a.inp"), "*HEADING\n*INCLUDE, INPUT=sub/b.inp\n").unwrap();
    fs::write(path("sub/b.inp"), "** back\n*INCLUDE, INPUT=../a.inp\n").unwrap();
    let error = error_at("a.inp");
    assert!(matches!(error.kind, Kind::IncludeCycle { .. }));
    assert!(error.file.ends_with("sub/b.inp") && error.line == 2 && &*error.text == "*INCLUDE, INPUT=../a.inp");
    fs::write(path("c.inp"), "*INCLUDE, INPUT=none.inp\n").unwrap();
    assert!(matches!(error_at("c.inp").kind, Kind::Unreadable { .. }));
    fs::write(path("d.inp"), "*INCLUDE, INPUT=sub\n").unwrap();
    assert!(matches!(error_at("d.inp").kind, Kind::NotAFile { .. }));
    fs::write(path("e.inp"), "*INCLUDE\n").unwrap();
    assert!(matches!(error_at("e.inp").kind, Kind::MissingParameter { parameter: "INPUT" }));
    assert!(matches!(error_at("sub").kind, Kind::NotAFile { .. }));
}

#[test]
#[cfg(unix)]
fn endless_devices_are_refused() {
    assert!(matches!(error_of("*INCLUDE, INPUT=/dev/zero\n").kind, Kind::NotAFile { .. }));
}

#[test]
fn includes_that_double_are_bounded() {
    let folder = tempfile::tempdir().unwrap();
    for i in 0..30 {
        let line = format!("*INCLUDE, INPUT={}.inp\n", i + 1);
        fs::write(folder.path().join(format!("{i}.inp")), format!("{line}{line}")).unwrap();
    }
    fs::write(folder.path().join("30.inp"), "** nothing\n").unwrap();
    let error = read_deck(&folder.path().join("0.inp")).unwrap_err();
    assert!(matches!(error, IoError::Deck(DeckError { kind: Kind::TooManyIncludes { .. }, .. })), "{error}");
}

#[test]
fn data_continue_in_an_included_file() {
    let folder = tempfile::tempdir().unwrap();
    let (first, rest) = CUBE.split_at(CUBE.find("3,1,1,0").unwrap());
    let (middle, last) = rest.split_at(rest.find("*ELEMENT").unwrap());
    fs::write(folder.path().join("more.inp"), middle).unwrap();
    let main = folder.path().join("main.inp");
    fs::write(&main, format!("{first}*INCLUDE, INPUT=more.inp,\n{last}")).unwrap();
    assert_eq!(read_deck(&main).unwrap().mesh, parse_deck(Path::new("x"), CUBE).unwrap().mesh);
}

#[test]
fn a_truncated_deck_is_an_error_or_a_smaller_deck() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/strand_300/strand_300.inp");
    let text = fs::read_to_string(path).unwrap();
    for end in (0..text.len()).step_by(997) {
        if let Ok(deck) = parse_deck(Path::new("x"), &text[..end]) {
            deck.mesh.validate().unwrap();
            assert!(deck.mesh.cell_count() <= 300);
        }
    }
}

/// Lines that a deck is made of, and some that spoil it.
fn line() -> impl Strategy<Value = String> {
    prop_oneof![
        prop::sample::select(vec![
            "*NODE",
            "*NODE,NSET=A",
            "*ELEMENT,TYPE=C3D8,ELSET=E",
            "*ELEMENT,TYPE=C3D27",
            "*NSET,NSET=A",
            "*ELSET,ELSET=E",
            "*NSET,NSET=B,GENERATE",
            "*SURFACE,NAME=S",
            "*ORIENTATION,NAME=O",
            "*DISTRIBUTION,NAME=D",
            "*HEADING",
            "D",
            "A",
            "*SOLID SECTION,ELSET=E,ORIENTATION=O",
            "*DISTRIBUTION TABLE,NAME=T",
            "1,1,2,3,4,5,6,7,8",
            "1,S1",
            "**",
            ",",
            "1,0,0,0",
            "2,1,0,0",
            "3,1,1,0",
            "4,0,1,0",
            "5,0,0,1",
            "6,1,0,1",
            "7,1,1,1",
            "8,0,1,1",
            "1,2,3,",
            "*",
            "*,=",
        ])
        .prop_map(str::to_owned),
        "\\PC{0,40}",
        "[*,=\" a-eA-E0-9.+-]{0,40}",
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_deck_panics(lines in prop::collection::vec(line(), 0..40), cube in any::<bool>()) {
        let text = format!("{}{}", if cube { CUBE } else { "" }, lines.join("\n"));
        if let Ok(deck) = parse_deck(Path::new("x"), &text) {
            prop_assert!(deck.mesh.validate().is_ok());
            prop_assert_eq!(deck.frames.len(), deck.mesh.cell_count());
        }
    }

    #[test]
    fn no_text_panics(text in "(?s).{0,400}") {
        let _ = parse_deck(Path::new("x"), &text);
    }
}
