//! Decks written by hand and by other programs.
// Helpers of tests may fail like tests.
#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout)]

use approx::assert_relative_eq;
use nalgebra::{Matrix3, Vector3};
use std::path::{Path, PathBuf};
use subrope_geometry::{CellKind, Face, Hex8, Hexahedron, Mesh, map_point};
use subrope_io::{Deck, ErrorClass, parse_deck, read_deck};

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}

fn two_bricks() -> Deck {
    read_deck(&data("two_bricks/deck.inp")).unwrap()
}

fn volume(mesh: &Mesh) -> f64 {
    let of_cell = |cell| {
        let nodes = mesh.cell_points::<8>(cell).unwrap();
        let weights = Hex8::quadrature().iter();
        weights.map(|q| q.weight * map_point::<Hex8, 8>(&nodes, q.xi).unwrap().determinant).sum::<f64>()
    };
    (0..mesh.cell_count()).map(of_cell).sum()
}

#[test]
fn a_strand_of_300_bricks() {
    let deck = read_deck(&data("strand_300/strand_300.inp")).unwrap();
    let mesh = &deck.mesh;
    mesh.validate().unwrap();
    assert_eq!((mesh.kind, mesh.cell_count(), mesh.point_count()), (CellKind::Hex8, 300, 442));
    assert!(deck.ignored.is_empty() && deck.unused_nodes.is_empty() && deck.dropped_sets.is_empty());
    assert!(deck.frames.iter().all(Option::is_none) && deck.material(0).is_none());
    assert_eq!(mesh.element_sets["STRAND"].len(), 300);
    for (name, z) in [("END_A", -30.0), ("END_B", 30.0)] {
        assert_eq!(mesh.node_sets[name].len(), 17);
        assert!(mesh.node_sets[name].iter().all(|&node| mesh.points[node as usize].z == z));
    }
    // The outer ring is a regular octagon inscribed in the circle of radius R: area 2 sqrt(2) R^2, length 60.
    assert_relative_eq!(volume(mesh), 60.0 * 8.0_f64.sqrt() * 2.785_f64.powi(2), max_relative = 1e-12);
    assert_eq!(mesh.points[1], Vector3::new(0.0, -1.4317281053672728, -30.0));
}

#[test]
fn mesh_and_sets() {
    let deck = two_bricks();
    let mesh = &deck.mesh;
    mesh.validate().unwrap();
    assert_eq!((mesh.cell_count(), mesh.point_count()), (2, 12));
    assert_eq!(mesh.cell_labels, [10, 20]);
    assert_eq!(mesh.cell(0), [0, 1, 4, 3, 6, 7, 10, 9]);
    assert_relative_eq!(volume(mesh), 2.0, max_relative = 1e-14);
    let sets: Vec<(&str, Vec<u32>)> = mesh.node_sets.iter().map(|(name, set)| (name.as_str(), set.clone())).collect();
    let expected: [(&str, Vec<u32>); 5] = [
        ("BOTTOM", (0..6).collect()),
        ("EVERY", (0..12).collect()),
        ("MIXED", vec![0, 1, 2, 3, 4, 5, 11]),
        ("ODD", vec![0, 2, 4, 6, 8, 10]),
        ("OFLEFT", vec![0, 1, 3, 4, 6, 7, 9, 10]),
    ];
    assert_eq!(sets, expected);
    assert_eq!(mesh.element_sets.keys().collect::<Vec<_>>(), ["ALL", "LEFT", "RIGHT"]);
    assert_eq!(mesh.element_sets["ALL"], [0, 1]);
}

#[test]
fn surfaces_keep_their_order() {
    let deck = two_bricks();
    let face = |cell, face| Face { cell, face };
    assert_eq!(deck.mesh.surfaces["FLOOR"], [face(0, 0), face(1, 0)]);
    assert_eq!(deck.mesh.surfaces["SIDES"], [face(1, 3), face(0, 5)]);
}

#[test]
fn unused_nodes_and_empty_sets_are_reported() {
    let deck = two_bricks();
    assert_eq!(deck.unused_nodes, [(100, [5.0, 5.0, 5.0])]);
    assert_eq!(deck.dropped_sets, ["REF"]);
}

#[test]
fn ignored_keywords_are_reported_with_their_line() {
    let deck = two_bricks();
    let ignored: Vec<(u32, &str)> = deck.ignored.iter().map(|i| (i.line, i.keyword.as_str())).collect();
    let expected = [(30, "SURFACE"), (46, "MATERIAL"), (47, "ELASTIC"), (49, "STEP"), (50, "STATIC"), (52, "END STEP")];
    assert_eq!(ignored, expected);
    assert!(deck.ignored[0].file.ends_with("two_bricks/deck.inp"));
}

#[test]
fn sections_give_materials_and_frames() {
    let deck = two_bricks();
    assert_eq!(deck.material_names, ["PA6", "COATED YARN"]);
    assert_eq!((deck.material(0), deck.material(1), deck.material(2)), (Some("PA6"), Some("COATED YARN"), None));
    let h = 0.5_f64.sqrt();
    let diagonal = Matrix3::new(h, -h, 0.0, h, h, 0.0, 0.0, 0.0, 1.0);
    assert_relative_eq!(deck.frames[0].unwrap(), diagonal, epsilon = 1e-15);
    // e1 = z, e2 = y, e3 = -x, then turned by 90 degrees about e3: e1 = y, e2 = -z, e3 = -x.
    let turned = Matrix3::from_columns(&[Vector3::y(), -Vector3::z(), -Vector3::x()]);
    assert_relative_eq!(deck.frames[1].unwrap(), turned, epsilon = 1e-15);
}

const CUBE: &str = "*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n\
                    *ELEMENT,TYPE=C3D8,ELSET=E\n1,1,2,3,4,5,6,7,8\n";

#[test]
fn windows_line_ends_and_marks_are_read() {
    let deck = parse_deck(Path::new("cube"), &format!("\u{feff}{}", CUBE.replace('\n', "\r\n"))).unwrap();
    assert_eq!(deck.mesh, parse_deck(Path::new("cube"), CUBE).unwrap().mesh);
}

#[test]
fn an_origin_moves_the_points_of_an_orientation() {
    let text = format!("{CUBE}*ORIENTATION,NAME=O\n1,1,2,1,2,1,1,1,1\n*SOLID SECTION,ELSET=E,ORIENTATION=O\n");
    let deck = parse_deck(Path::new("cube"), &text).unwrap();
    let expected = Matrix3::from_columns(&[Vector3::z(), Vector3::y(), -Vector3::x()]);
    assert_relative_eq!(deck.frames[0].unwrap(), expected, epsilon = 1e-15);
}

#[test]
fn a_missing_deck_is_an_input_error() {
    let error = read_deck(Path::new("no/such/deck.inp")).unwrap_err();
    assert_eq!(error.class(), ErrorClass::Input);
    assert!(error.to_string().starts_with("no/such/deck.inp: cannot be read"), "{error}");
}
