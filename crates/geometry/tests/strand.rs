//! Section and strand meshes: counts, areas, volumes, sets, convergence, lines along the yarns.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use nalgebra::Vector3;
use std::f64::consts::{FRAC_PI_2, PI};
use subrope_geometry::quality::{mesh_quality, volume};
use subrope_geometry::strand::sets;
use subrope_geometry::*;

const RADIUS: f64 = 2.785;

fn refined(factor: usize, area: SectionArea) -> Section {
    Section { core_cells: 4 * factor, rings: 2 * factor, area, ..Section::default() }
}

fn strand(kind: CellKind, area: SectionArea, factor: usize) -> Strand {
    Strand { kind, section: refined(factor, area), layers: 5 * factor, ..Strand::default() }
}

fn rope_strand(ends: StrandEnds, lines: MeshLines, yarn_pitch: f64) -> Strand {
    let helix = Helix::new(Axis::default(), 3.2, Lay::from_pitch(60.0).unwrap(), 0.3).unwrap();
    Strand {
        axis: StrandAxis::Helix(helix),
        lay: Lay::from_pitch(yarn_pitch).unwrap(),
        length: 30.0,
        layers: 30,
        ends,
        lines,
        ..Strand::default()
    }
}

#[test]
fn the_default_strand_is_the_published_one() {
    let mesh = Strand::default().mesh().unwrap();
    mesh.validate().unwrap();
    assert_eq!((mesh.cell_count(), mesh.point_count()), (2400, 57 * 51));
    assert_eq!(mesh.node_sets[sets::END_A].len(), 57);
    assert_eq!(mesh.node_sets[sets::END_B].len(), 57);
    assert_eq!(mesh.node_sets[sets::SURFACE_NODES].len(), 16 * 51);
    assert_eq!(mesh.node_sets[sets::AXIS].len(), 51);
    assert_eq!(mesh.element_sets[sets::STRAND].len(), 2400);
    assert_eq!(mesh.surfaces[sets::LATERAL].len(), 800);
    assert!(mesh.node_sets[sets::END_A].iter().all(|&n| mesh.points[n as usize].z == -30.0));
    assert!(mesh.node_sets[sets::END_B].iter().all(|&n| mesh.points[n as usize].z == 30.0));
    assert!(mesh.node_sets[sets::AXIS].iter().all(|&n| mesh.points[n as usize].xy().norm() == 0.0));
    assert!((volume(&mesh).unwrap() / (PI * RADIUS * RADIUS * 60.0) - 1.0).abs() < 1e-13);
    let quality = mesh_quality(&mesh).unwrap().unwrap();
    assert!(quality.least_scaled_jacobian.value > 0.84, "{quality:?}");
    let surface_angle = Strand::default().lay.angle(RADIUS).to_degrees();
    assert!((surface_angle - 30.0).abs() < 1e-12);
}

#[test]
fn section_areas() {
    for (kind, factor) in [(CellKind::Hex8, 1), (CellKind::Hex8, 3), (CellKind::Hex27, 1), (CellKind::Hex27, 2)] {
        let exact = refined(factor, SectionArea::Exact).mesh(RADIUS, kind).unwrap();
        assert!((exact.area() / (PI * RADIUS * RADIUS) - 1.0).abs() < 1e-13);
        assert_eq!(exact.cell_count(), refined(factor, SectionArea::Exact).cell_count());
        assert_eq!(exact.points[exact.centre as usize].norm(), 0.0);
    }
    let inscribed = refined(1, SectionArea::Inscribed).mesh(RADIUS, CellKind::Hex8).unwrap();
    let polygon = 8.0 * (PI / 8.0).sin() * RADIUS * RADIUS;
    assert!((inscribed.area() / polygon - 1.0).abs() < 1e-14);
    assert!(inscribed.outer.iter().all(|&n| (inscribed.points[n as usize].norm() - RADIUS).abs() < 1e-14));
    let curved = refined(1, SectionArea::Inscribed).mesh(RADIUS, CellKind::Hex27).unwrap();
    assert_eq!(curved.outer.len(), 32);
    assert!(curved.outer.iter().all(|&n| (curved.points[n as usize].norm() - RADIUS).abs() < 1e-14));
}

/// Relative errors of the volume and of the lateral area at refinements 1, 2, 4.
fn errors(kind: CellKind, lines: MeshLines, area: SectionArea) -> [(f64, f64); 3] {
    [1, 2, 4].map(|factor| {
        let strand = Strand { lines, length: 10.0, ..strand(kind, area, factor) };
        let mesh = strand.mesh().unwrap();
        let lateral = surface_area(&mesh, &mesh.surfaces[sets::LATERAL]).unwrap();
        let exact = 2.0 * PI * RADIUS * strand.length;
        ((volume(&mesh).unwrap() / strand.volume() - 1.0).abs(), (lateral / exact - 1.0).abs())
    })
}

#[test]
fn volumes_and_lateral_areas_converge() {
    for lines in [MeshLines::Axis, MeshLines::Yarns] {
        for (kind, order) in [(CellKind::Hex8, 2.0), (CellKind::Hex20, 4.0), (CellKind::Hex27, 4.0)] {
            let e = errors(kind, lines, SectionArea::Inscribed);
            let rate = |a: f64, b: f64| (a / b).log2();
            assert!(rate(e[1].0, e[2].0) > order - 0.1, "{kind:?} {lines:?} volume {e:?}");
            assert!(rate(e[1].1, e[2].1) > order - 0.1, "{kind:?} {lines:?} area {e:?}");
        }
    }
}

#[test]
fn the_lateral_area_of_a_prism_is_closed_form() {
    let mesh = strand(CellKind::Hex8, SectionArea::Inscribed, 1).mesh().unwrap();
    let lateral = surface_area(&mesh, &mesh.surfaces[sets::LATERAL]).unwrap();
    assert!((lateral / (32.0 * (PI / 16.0).sin() * RADIUS * 60.0) - 1.0).abs() < 1e-13);
    let exterior = exterior_faces(&mesh);
    assert_eq!(exterior.len(), 16 * 5 + 2 * 48);
    assert!(mesh.surfaces[sets::LATERAL].iter().all(|face| exterior.binary_search(face).is_ok()));
    for &face in &mesh.surfaces[sets::LATERAL] {
        let nodes: Vec<u32> = mesh.face_nodes(face).unwrap().collect();
        assert!(nodes.iter().all(|n| mesh.node_sets[sets::SURFACE_NODES].contains(n)));
    }
}

/// The surface integral of x . n is three times the volume: faces point outwards and close the mesh.
#[test]
fn exterior_faces_close_the_mesh() {
    use subrope_geometry::quadrilateral::map_surface_point;
    let mesh = rope_strand(StrandEnds::Flat, MeshLines::Yarns, 27.0).mesh().unwrap();
    let mut flux = 0.0;
    for face in exterior_faces(&mesh) {
        let nodes = mesh.face_points::<4>(face).unwrap();
        for point in Quad4::quadrature() {
            let at = map_surface_point::<Quad4, 4>(&nodes, point.xi);
            flux += point.weight * at.area_normal.dot(&at.position);
        }
    }
    assert!((flux / (3.0 * volume(&mesh).unwrap()) - 1.0).abs() < 1e-12);
}

#[test]
fn exact_volume_holds_for_every_axis_and_line() {
    let helical = [StrandEnds::Normal, StrandEnds::Flat]
        .into_iter()
        .flat_map(|ends| [MeshLines::Axis, MeshLines::Yarns].map(|lines| rope_strand(ends, lines, -30.0)));
    let straight = [CellKind::Hex8, CellKind::Hex20, CellKind::Hex20R, CellKind::Hex27]
        .into_iter()
        .map(|kind| Strand { lines: MeshLines::Yarns, ..strand(kind, SectionArea::Exact, 1) });
    for strand in helical.chain(straight) {
        let mesh = strand.mesh().unwrap();
        mesh.validate().unwrap();
        assert!((volume(&mesh).unwrap() / strand.volume() - 1.0).abs() < 1e-12, "{strand:?}");
    }
}

/// Midpoint-to-midpoint differences along mesh lines agree with e1 there to second order in the layer thickness.
fn line_deviation(strand: &Strand) -> f64 {
    let (mesh, field) = (strand.mesh().unwrap(), strand.fibres());
    let per_level = mesh.point_count() / (strand.layers + 1);
    let mut worst = 0.0_f64;
    for node in per_level..mesh.point_count() - per_level {
        let chord = (mesh.points[node + per_level] - mesh.points[node - per_level]).normalize();
        let frame = field.frame(&mesh.points[node], 0).unwrap();
        worst = worst.max((frame.column(0) - chord).norm());
    }
    worst
}

#[test]
fn lines_along_yarns_are_tangent_to_the_fibres() {
    let straight = Strand { lines: MeshLines::Yarns, ..Strand::default() };
    let left = Strand { lay: Lay::from_pitch(-30.0).unwrap(), ..straight };
    let normal = rope_strand(StrandEnds::Normal, MeshLines::Yarns, 30.0);
    let flat = rope_strand(StrandEnds::Flat, MeshLines::Yarns, -30.0);
    for coarse in [straight, left, normal, flat] {
        let fine = Strand { layers: 2 * coarse.layers, ..coarse };
        let (a, b) = (line_deviation(&coarse), line_deviation(&fine));
        assert!(a < 0.02 && a / b > 3.8 && a / b < 4.2, "{a} {b} for {coarse:?}");
    }
    assert!(line_deviation(&Strand::default()) > 0.4, "lines along the axis leave the fibres by their angle");
}

#[test]
fn flat_sections_are_flat_and_on_the_tube() {
    for lines in [MeshLines::Axis, MeshLines::Yarns] {
        let strand =
            Strand { section: refined(1, SectionArea::Inscribed), ..rope_strand(StrandEnds::Flat, lines, 28.0) };
        let StrandAxis::Helix(helix) = strand.axis else { unreachable!() };
        let mesh = strand.mesh().unwrap();
        for (set, s) in [(sets::END_A, -15.0), (sets::END_B, 15.0)] {
            assert!(mesh.node_sets[set].iter().all(|&n| (mesh.points[n as usize].z - helix.axial(s)).abs() < 1e-13));
        }
        for &node in &mesh.node_sets[sets::SURFACE_NODES] {
            let x = mesh.points[node as usize];
            let distance = (x - helix.position(helix.nearest(&x).unwrap())).norm();
            assert!((distance - RADIUS).abs() < 1e-12, "{distance}");
        }
    }
}

/// A slice with flat ends maps onto itself by the screw motion of the helix: what a periodic section needs.
#[test]
fn one_layer_of_a_rope_is_a_screw_image() {
    let strand = Strand { layers: 1, length: 1.3, ..rope_strand(StrandEnds::Flat, MeshLines::Axis, 28.0) };
    let StrandAxis::Helix(helix) = strand.axis else { unreachable!() };
    let mesh = strand.mesh().unwrap();
    let (angle, rise) = (helix.angle(1.3) - helix.angle(0.0), helix.axial(1.3));
    let rotation = nalgebra::Rotation3::from_axis_angle(&Vector3::z_axis(), angle);
    for (&a, &b) in mesh.node_sets[sets::END_A].iter().zip(&mesh.node_sets[sets::END_B]) {
        let image = rotation * mesh.points[a as usize] + Vector3::z() * rise;
        assert!((image - mesh.points[b as usize]).norm() < 1e-13);
    }
}

#[test]
fn origin_axis_and_kind() {
    let strand = Strand { origin: StrandOrigin::Bottom, layers: 3, kind: CellKind::Hex27, ..Strand::default() };
    let mesh = strand.mesh().unwrap();
    mesh.validate().unwrap();
    assert_eq!((mesh.cell_count(), mesh.point_count()), (144, (81 + 32 * 4) * 7));
    let z = mesh.points.iter().map(|x| x.z);
    assert_eq!((z.clone().fold(9.0, f64::min), z.fold(0.0, f64::max)), (0.0, 60.0));
    assert!((volume(&mesh).unwrap() / strand.volume() - 1.0).abs() < 1e-13);
    let along_x = Axis::new(Vector3::new(0.0, 5.0, 0.0), Vector3::x()).unwrap();
    let turned = Strand { axis: StrandAxis::Straight(along_x), ..strand }.mesh().unwrap();
    assert!((turned.points[turned.node_sets[sets::END_B][0] as usize].x - 60.0).abs() < 1e-13);
    assert!(turned.node_sets[sets::AXIS].iter().all(|&n| turned.points[n as usize].y == 5.0));
}

#[test]
fn twenty_nodes_are_those_of_27_on_the_edges() {
    for (kind, points) in [(CellKind::Hex20, 27), (CellKind::Hex20R, 8)] {
        let curved = Strand { layers: 3, lines: MeshLines::Yarns, kind: CellKind::Hex27, ..Strand::default() };
        let section = Section { area: SectionArea::Inscribed, ..curved.section };
        let full = Strand { section, ..curved }.mesh().unwrap();
        let strand = Strand { kind, section, ..curved };
        let mesh = strand.mesh().unwrap();
        mesh.validate().unwrap();
        assert_eq!((mesh.cell_count(), kind.points()), (144, points));
        // Four levels of corners and mid-sides of the section, three with its corners alone.
        assert_eq!(mesh.point_count(), 4 * (81 + 32 * 4 - 48) + 3 * 57);
        for cell in 0..mesh.cell_count() {
            for (a, b) in mesh.cell(cell).iter().zip(full.cell(cell)) {
                assert_eq!(mesh.points[*a as usize], full.points[*b as usize], "cell {cell}");
            }
        }
        assert_eq!(mesh.node_sets[sets::END_A].len(), 81 + 32 * 4 - 48);
        assert_eq!(mesh.node_sets[sets::AXIS].len(), 7);
        assert_eq!(mesh.node_sets[sets::SURFACE_NODES].len(), 4 * 32 + 3 * 16);
        let grid = strand.surface_grid();
        assert_eq!((grid.around, grid.levels), (16, 4));
        let corners: Vec<u32> = mesh.surfaces[sets::LATERAL]
            .iter()
            .flat_map(|&face| mesh.face_nodes(face).unwrap().take(4).collect::<Vec<_>>())
            .collect();
        assert!(grid.nodes.iter().all(|node| corners.contains(node)));
        assert!(corners.iter().all(|node| grid.nodes.contains(node)));
        for (level, q) in [(0, 3), (2, 7)] {
            let (low, high) =
                (mesh.points[grid.node(level, q) as usize], mesh.points[grid.node(level + 1, q) as usize]);
            assert!((high.z - low.z - 20.0).abs() < 1e-12);
        }
    }
}

#[test]
fn bad_parameters_are_refused() {
    let good = Strand { layers: 2, ..Strand::default() };
    let section = good.section;
    let bad = [
        Strand { radius: 0.0, ..good },
        Strand { radius: f64::NAN, ..good },
        Strand { length: -1.0, ..good },
        Strand { layers: 0, ..good },
        Strand { layers: usize::MAX, ..good },
        Strand { section: Section { core_cells: 3, ..section }, ..good },
        Strand { section: Section { core_cells: 0, ..section }, ..good },
        Strand { section: Section { rings: 0, ..section }, ..good },
        Strand { section: Section { core_fraction: 0.75, ..section }, ..good },
        Strand { section: Section { core_fraction: 0.0, ..section }, ..good },
        Strand { section: Section { core_bulge: -0.1, ..section }, ..good },
        Strand { section: Section { core_fraction: 0.69, core_bulge: 0.9, ..section }, ..good },
        Strand { layers: 1 << 20, section: Section { core_cells: 100, rings: 50, ..section }, ..good },
    ];
    for strand in bad {
        let failure = strand.mesh().unwrap_err();
        assert!(!failure.to_string().is_empty(), "{failure}");
    }
    assert!(Lay::from_angle(1.0, FRAC_PI_2, Handedness::Left).is_err());
    let steep = Helix::new(Axis::default(), 3.0, Lay::from_pitch(8.0).unwrap(), 0.0).unwrap();
    let overlap = Strand { axis: StrandAxis::Helix(steep), radius: 3.6, ..good }.mesh();
    assert!(matches!(overlap, Err(GeometryError::SectionsOverlap { .. })), "{overlap:?}");
    let helix = Helix::new(Axis::default(), 6.0, Lay::from_pitch(40.0).unwrap(), 0.0).unwrap();
    let twisted = Strand { axis: StrandAxis::Helix(helix), lay: Lay::from_pitch(10.0).unwrap(), ..good };
    let folds = Strand { ends: StrandEnds::Flat, lines: MeshLines::Yarns, ..twisted }.mesh();
    assert!(matches!(folds, Err(GeometryError::FlatSectionFolds { .. })));
}
