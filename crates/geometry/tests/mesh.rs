//! Validation of meshes, exterior faces, and quality on known cells.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use nalgebra::Vector3;
use subrope_geometry::quality::{check_orientation, inverted_cells, mesh_quality, volume};
use subrope_geometry::{CellKind, Face, GeometryError, Hex27, Hexahedron, Mesh, exterior_faces, surface_area};

/// Cuboids of 2 x 3 x 4 mm in a row along x.
fn row(count: u32) -> Mesh {
    let corner = |i: u32, y: f64, z: f64| Vector3::new(2.0 * f64::from(i), y, z);
    let points = (0..=count)
        .flat_map(|i| [corner(i, 0.0, 0.0), corner(i, 3.0, 0.0), corner(i, 3.0, 4.0), corner(i, 0.0, 4.0)])
        .collect();
    let cells = (0..count).flat_map(|i| [0, 4, 5, 1, 3, 7, 6, 2].map(|n| 4 * i + n)).collect();
    Mesh::new(CellKind::Hex8, points, cells)
}

#[test]
fn a_row_of_cuboids() {
    let mesh = row(3);
    mesh.validate().unwrap();
    check_orientation(&mesh).unwrap();
    let quality = mesh_quality(&mesh).unwrap().unwrap();
    assert!((quality.least_determinant.value - 3.0).abs() < 1e-14);
    assert!((quality.least_scaled_jacobian.value - 1.0).abs() < 1e-14);
    assert_eq!(quality.largest_aspect_ratio.value, 2.0);
    assert!(quality.largest_skew.value < 1e-15 && (quality.volume - 72.0).abs() < 1e-12);
    let faces = exterior_faces(&mesh);
    assert_eq!(faces.len(), 14);
    assert!((surface_area(&mesh, &faces).unwrap() - 2.0 * (18.0 + 24.0 + 12.0)).abs() < 1e-12);
    assert!(surface_area(&mesh, &[Face { cell: 3, face: 0 }]).is_err());
    assert_eq!((mesh.cell(1)[0], mesh.cell_label(1), mesh.point_label(7)), (4, 2, 8));
    assert!(mesh.cell_points::<27>(0).is_none() && mesh.cell_points::<8>(3).is_none());
}

#[test]
fn every_violation_is_named() {
    let broken = |change: fn(&mut Mesh)| {
        let mut mesh = row(2);
        change(&mut mesh);
        mesh.validate().unwrap_err()
    };
    use GeometryError as E;
    assert_eq!(broken(|m| m.cells[9] = 12), E::PointIndex { cell_label: 2, index: 12, points: 12 });
    assert_eq!(broken(|m| m.cells[1] = m.cells[0]), E::DuplicatePoint { cell_label: 1, point_label: 1 });
    assert!(matches!(broken(|m| m.points[3].y = f64::NAN), E::Coordinate { point_label: 4, .. }));
    assert!(matches!(broken(|m| m.cells.truncate(15)), E::ConnectivityLength { length: 15, nodes: 8 }));
    assert!(matches!(broken(|m| m.cell_labels.truncate(1)), E::LabelCount { labels: 1, items: 2 }));
    assert_eq!(broken(|m| m.point_labels[4] = 1), E::DuplicateLabel { label: 1 });
    assert!(matches!(broken(|m| drop(m.node_sets.insert("A".into(), vec![99]))), E::SetIndex { index: 99, items: 12 }));
    assert!(matches!(broken(|m| drop(m.element_sets.insert("A".into(), vec![2]))), E::SetIndex { index: 2, items: 2 }));
    let surface = broken(|m| drop(m.surfaces.insert("S".into(), vec![Face { cell: 0, face: 6 }])));
    assert!(matches!(surface, E::FaceIndex { face: 6, .. }));
    let unused = broken(|m| {
        m.points.push(Vector3::zeros());
        m.point_labels.push(500);
    });
    assert_eq!(unused, E::UnusedPoints { count: 1, first_label: 500 });
}

#[test]
fn inverted_cells_are_listed_with_their_labels() {
    let mut mesh = row(4);
    mesh.cell_labels = vec![10, 20, 30, 40];
    mesh.cells[16..24].rotate_left(4);
    let error = check_orientation(&mesh).unwrap_err();
    let GeometryError::Inverted { cell_label: 30, determinant } = error else { unreachable!("{error}") };
    assert!((determinant + 3.0).abs() < 1e-12);
    mesh.cells.swap(0, 1);
    assert_eq!(inverted_cells(&mesh).unwrap().iter().map(|cell| cell.0).collect::<Vec<_>>(), [10, 30]);
    let several = check_orientation(&mesh).unwrap_err();
    assert!(matches!(several, GeometryError::InvertedCells { .. }));
    assert!(several.to_string().contains("2 bricks"));
    let quality = mesh_quality(&mesh).unwrap().unwrap();
    assert!(quality.least_scaled_jacobian.value < 0.0);
}

/// Any two corners of a cuboid exchanged make an inverted brick.
#[test]
fn exchanged_corners_are_found() {
    for (a, b) in (0..8).flat_map(|a| (a + 1..8).map(move |b| (a, b))) {
        let mut mesh = row(1);
        mesh.cells.swap(a, b);
        assert!(check_orientation(&mesh).is_err(), "corners {a} and {b}");
    }
}

#[test]
fn broken_indices_are_errors_everywhere() {
    let mut mesh = row(2);
    mesh.cells[3] = 77;
    assert!(matches!(volume(&mesh), Err(GeometryError::PointIndex { cell_label: 1, index: 77, points: 12 })));
    assert!(mesh_quality(&mesh).is_err());
    assert!(mesh_quality(&Mesh::new(CellKind::Hex27, vec![], vec![])).unwrap().is_none());
}

/// The map of 27 nodes holds quadratic coordinates exactly: volume, and area of a plane face with a curved edge.
#[test]
fn volume_and_areas_of_a_curved_brick() {
    let bend = |[x, y, z]: [f64; 3]| Vector3::new(x * (1.0 + 0.4 * y * y), y, z + 0.2 * x * x);
    let mesh = Mesh::new(CellKind::Hex27, Hex27::NODES.map(bend).to_vec(), (0..27).collect());
    // The determinant is 1 + 0.4 y^2.
    assert!((volume(&mesh).unwrap() - 8.0 * (1.0 + 0.4 / 3.0)).abs() < 1e-13);
    assert!((surface_area(&mesh, &[Face { cell: 0, face: 4 }]).unwrap() - 2.0 * 2.8).abs() < 1e-13);
    let arch = |[x, y, z]: [f64; 3]| Vector3::new(x, y, z + 0.2 * x * x);
    let mesh = Mesh::new(CellKind::Hex27, Hex27::NODES.map(arch).to_vec(), (0..27).collect());
    // Twice the length of the parabola of slope 0.4 x.
    let exact = 2.0 * (0.4_f64.hypot(1.0) + 0.4_f64.asinh() / 0.4);
    let area = surface_area(&mesh, &[Face { cell: 0, face: 1 }]).unwrap();
    assert!((area / exact - 1.0).abs() < 1e-5, "{area} against {exact}");
}
