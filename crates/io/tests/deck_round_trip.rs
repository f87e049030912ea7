//! Writing a deck and reading it back.
// Helpers of tests may fail like tests.
#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout)]

use approx::assert_relative_eq;
use nalgebra::{Matrix3, Rotation3, Vector3};
use proptest::prelude::*;
use std::fs;
use std::path::{Path, PathBuf};
use subrope_geometry::{CellKind, Face, Hex20, Hex27, Hexahedron, Mesh};
use subrope_io::{DeckView, ErrorClass, IoError, NumberFormat, ValueError, read_deck, write_deck};

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}

fn again(view: &DeckView<'_>, format: NumberFormat) -> subrope_io::Deck {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("deck.inp");
    write_deck(&path, view, format).unwrap();
    read_deck(&path).unwrap()
}

fn rotations(cells: usize) -> Vec<Option<Matrix3<f64>>> {
    let frame = |i: usize| Rotation3::from_euler_angles(0.1 * i as f64, 0.7, -0.3 * i as f64).into_inner();
    (0..cells).map(|i| (i % 3 != 1).then(|| frame(i))).collect()
}

#[test]
fn decks_of_other_hands_survive() {
    for name in ["strand_300/strand_300.inp", "two_bricks/deck.inp"] {
        let deck = read_deck(&data(name)).unwrap();
        let back = again(&DeckView::from(&deck), NumberFormat::RoundTrip);
        assert_eq!(back.mesh, deck.mesh, "{name}");
        assert_eq!((&back.materials, &back.unused_nodes), (&deck.materials, &deck.unused_nodes), "{name}");
        assert_eq!(back.material_names, deck.material_names, "{name}");
        assert!(back.ignored.is_empty() && back.dropped_sets.is_empty(), "{name}: {:?}", back.ignored);
    }
}

#[test]
fn frames_and_materials_survive() {
    let mut deck = read_deck(&data("strand_300/strand_300.inp")).unwrap();
    deck.frames = rotations(300);
    deck.material_names = vec!["PA6".to_owned(), "COATED YARN, 2".to_owned()];
    deck.materials = (0..300).map(|i| (i % 4 != 3).then_some((i % 2) as u32)).collect();
    let back = again(&DeckView::from(&deck), NumberFormat::RoundTrip);
    assert_eq!(back.mesh, deck.mesh);
    for (cell, (a, b)) in deck.frames.iter().zip(&back.frames).enumerate() {
        assert_eq!(back.material(cell), deck.material(cell));
        match (a, b) {
            (Some(a), Some(b)) => assert_relative_eq!(a, b, epsilon = 4e-16),
            (None, None) => {}
            other => panic!("{other:?}"),
        }
    }
}

fn brick_27() -> Mesh {
    let point = |&x: &[f64; 3]| Vector3::from(x) + Vector3::new(0.1 * x[1] * x[2], 0.05 * x[0] * x[0], 10.0);
    let mut mesh = Mesh::new(CellKind::Hex27, Hex27::NODES.iter().map(point).collect(), (0..27).collect());
    mesh.surfaces.insert("TOP".to_owned(), vec![Face { cell: 0, face: 1 }]);
    mesh.node_sets.insert("SOME NODES".to_owned(), vec![0, 26]);
    mesh
}

#[test]
fn bricks_of_27_nodes_survive() {
    let mesh = brick_27();
    assert_eq!(again(&DeckView::of_mesh(&mesh), NumberFormat::RoundTrip).mesh, mesh);
}

#[test]
fn bricks_of_20_nodes_survive_with_their_integration() {
    for (kind, name) in [(CellKind::Hex20, "TYPE=C3D20\n"), (CellKind::Hex20R, "TYPE=C3D20R\n")] {
        let points = Hex20::NODES.iter().map(|&x| Vector3::from(x) * 2.0).collect();
        let mut mesh = Mesh::new(kind, points, (0..20).collect());
        mesh.surfaces.insert("TOP".to_owned(), vec![Face { cell: 0, face: 1 }]);
        mesh.node_sets.insert("SOME".to_owned(), vec![0, 19]);
        assert_eq!(again(&DeckView::of_mesh(&mesh), NumberFormat::RoundTrip).mesh, mesh);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("deck.inp");
        write_deck(&path, &DeckView::of_mesh(&mesh), NumberFormat::RoundTrip).unwrap();
        assert!(fs::read_to_string(&path).unwrap().contains(name));
    }
}

#[test]
fn numbers_of_twenty_columns() {
    let mut mesh = brick_27();
    mesh.points.iter_mut().for_each(|x| *x *= -std::f64::consts::PI * 1e-9);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("deck.inp");
    write_deck(&path, &DeckView::of_mesh(&mesh), NumberFormat::Columns20).unwrap();
    let text = fs::read_to_string(&path).unwrap();
    assert!(text.lines().skip(1).take(27).flat_map(|line| line.split(", ")).all(|number| number.len() <= 20));
    for (a, b) in mesh.points.iter().zip(&read_deck(&path).unwrap().mesh.points) {
        assert_relative_eq!(a, b, max_relative = 1e-11);
    }
}

#[test]
fn what_cannot_be_written_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("deck.inp");
    let write = |view: &DeckView<'_>| write_deck(&path, view, NumberFormat::RoundTrip).unwrap_err();
    let mesh = brick_27();
    let view = DeckView::of_mesh(&mesh);
    let frames = [Some(Matrix3::identity() * 2.0)];
    assert!(matches!(write(&DeckView { frames: &frames, ..view }), IoError::Value(ValueError::Frame { .. })));
    let error = write(&DeckView { materials: &[None, None], ..view });
    assert!(matches!(error, IoError::Value(ValueError::Count { expected: 1, got: 2 })));
    let error = write(&DeckView { materials: &[Some(0)], ..view });
    assert!(matches!(error, IoError::Value(ValueError::Material { index: 0, names: 0 })));
    for name in ["", "1A", "a\"b", "a\nb"] {
        let mut mesh = brick_27();
        mesh.node_sets.insert(name.to_owned(), vec![0]);
        assert!(matches!(write(&DeckView::of_mesh(&mesh)), IoError::Value(ValueError::Name { .. })), "{name:?}");
    }
    let mut mesh = brick_27();
    mesh.node_sets.insert("some nodes".to_owned(), vec![0]);
    assert!(matches!(write(&DeckView::of_mesh(&mesh)), IoError::Value(ValueError::DuplicateName { .. })));
    let mut mesh = brick_27();
    mesh.points[3].y = f64::NAN;
    assert!(matches!(write(&DeckView::of_mesh(&mesh)), IoError::Mesh(_)));
    assert!(fs::read_dir(folder.path()).unwrap().next().is_none());
    let error = write_deck(&folder.path().join("no/deck.inp"), &view, NumberFormat::RoundTrip).unwrap_err();
    assert_eq!(error.class(), ErrorClass::Output);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn coordinates_survive_bit_by_bit(x in prop::array::uniform3(any::<f64>())) {
        prop_assume!(x.iter().all(|c| c.is_finite()));
        let points = (0..8).map(|i| Vector3::repeat(f64::from(i))).collect();
        let mut mesh = Mesh::new(CellKind::Hex8, points, (0..8).collect());
        mesh.points[5] = Vector3::from(x);
        let back = again(&DeckView::of_mesh(&mesh), NumberFormat::RoundTrip).mesh;
        prop_assert_eq!(back.points[5].map(f64::to_bits), mesh.points[5].map(f64::to_bits));
    }
}
