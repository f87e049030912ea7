//! Ropes: touching of the smooth surfaces, symmetry, volumes, sets, ends, fibres.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use nalgebra::{Matrix3, Rotation3, Vector3};
use proptest::prelude::*;
use std::f64::consts::TAU;
use subrope_geometry::fibre::frame_deviation;
use subrope_geometry::quality::{check_orientation, volume};
use subrope_geometry::rope::sets;
use subrope_geometry::strand::sets as strand_sets;
use subrope_geometry::*;

fn laid(by: LayBy, handedness: Handedness) -> Rope {
    Rope { lay: RopeLay { by, handedness }, ..Rope::default() }
}

/// One lay length of three strands at 20 deg in 48 layers.
fn one_lay(degrees: f64, kind: CellKind) -> Rope {
    let rope = Rope { kind, layers: 48, ..laid(LayBy::Angle(degrees.to_radians()), Handedness::Right) };
    // The helix radius depends a little on the length of a layer: two passes settle the lay length.
    (0..3).fold(rope, |rope, _| Rope { length: rope.shape().unwrap().lay.lay_length(), ..rope })
}

fn steel_1x7() -> Rope {
    let wire = |diameter: f64| RopeStrand {
        radius: 0.5 * diameter,
        yarns: YarnLay { by: YarnLayBy::Parallel, sense: Sense::Same },
        section: Section::default(),
    };
    Rope {
        strands: 6,
        outer: wire(3.73),
        core: Some(wire(3.94)),
        lay: RopeLay { by: LayBy::Length(115.0), handedness: Handedness::Right },
        length: 115.0,
        layers: 48,
        ..Rope::default()
    }
}

/// Least distance \[mm\] between the smooth surfaces of two strands where the first has the parameter v, negative where
/// they overlap: over the points of the second near it, the distance across the first.
fn gap_at(rope: &RopeMesh, [first, second]: [usize; 2], v: f64) -> f64 {
    let points = &rope.mesh.points;
    let (a, b) = (&rope.surfaces[first], &rope.surfaces[second]);
    let point = |grid: &SurfaceGrid, u: f64, v: f64| grid.smooth_point(points, u, v).unwrap();
    let outward = |[u, v]: [f64; 2]| {
        let h = 1e-4;
        let around = point(b, u + h, v) - point(b, u - h, v);
        around.cross(&(point(b, u, v + h) - point(b, u, v - h)))
    };
    // Signed distance of the point (u, v) of a from b: pattern search for the nearest point, from the best of a grid.
    let signed = |u: f64| {
        let x = point(a, u, v);
        let distance = |p: [f64; 2]| (point(b, p[0], p[1].clamp(1.0, (b.levels - 2) as f64)) - x).norm_squared();
        let samples = (0..b.around).flat_map(|i| (-6..=6).map(move |j| [i as f64, v + f64::from(j)]));
        let mut at = samples.min_by(|p, q| distance(*p).total_cmp(&distance(*q))).unwrap();
        let mut step = 0.5;
        while step > 1e-7 {
            let around = [[step, 0.0], [-step, 0.0], [0.0, step], [0.0, -step], [step, step], [-step, -step]];
            let next = around.map(|d| [at[0] + d[0], at[1] + d[1]]);
            let best = next.into_iter().min_by(|p, q| distance(*p).total_cmp(&distance(*q))).unwrap();
            if distance(best) < distance(at) { at = best } else { step *= 0.5 }
        }
        let from = x - point(b, at[0], at[1]);
        from.norm().copysign(from.dot(&outward(at)))
    };
    let samples = (0..4 * a.around).map(|i| 0.25 * i as f64);
    let start = samples.min_by(|p, q| signed(*p).total_cmp(&signed(*q))).unwrap();
    let (mut low, mut high) = (start - 0.25, start + 0.25);
    for _ in 0..14 {
        let cut = 0.381_966 * (high - low);
        if signed(low + cut) < signed(high - cut) { high -= cut } else { low += cut }
    }
    signed(0.5 * (low + high))
}

#[test]
fn smooth_surfaces_touch_along_the_contact_lines() {
    for (degrees, kind) in [(20.0, CellKind::Hex8), (30.0, CellKind::Hex8), (20.0, CellKind::Hex27)] {
        let rope = one_lay(degrees, kind).mesh().unwrap();
        let radius = rope.strands[0].radius;
        let levels = rope.surfaces[0].levels as f64;
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        for i in 0..=16 {
            let v = 8.0 + (levels - 17.0) * f64::from(i) / 16.0;
            for pair in [[0, 1], [1, 2], [2, 0]] {
                let gap = gap_at(&rope, pair, v) / radius;
                (least, most) = (least.min(gap), most.max(gap));
            }
        }
        println!("{degrees} {kind:?}: {least:.2e} {most:.2e} {:?}", rope.shape);
        assert!(least > -1e-3 && most < 1e-3, "{degrees} deg {kind:?}: gap {least:e} to {most:e} R");
    }
}

/// Tubes that no mesh has bent: with many nodes the helix radius of the smooth surfaces is that of exact tubes.
#[test]
fn the_helix_radius_converges_to_that_of_tubes() {
    for (degrees, ratio) in [(10.0, 1.15928505), (20.0, 1.17562992), (30.0, 1.21458713)] {
        let error = [1, 2, 4].map(|factor| {
            let section = Section { core_cells: 4 * factor, rings: 2, ..Section::default() };
            let outer = RopeStrand { section, ..RopeStrand::default() };
            let rope =
                Rope { outer, layers: 25 * factor, ..laid(LayBy::Angle(f64::to_radians(degrees)), Handedness::Left) };
            rope.shape().unwrap().helix_radius / 2.785 - ratio
        });
        assert!(error[2].abs() < 2.5e-3, "{degrees}: {error:?}");
        assert!(error[0] / error[1] > 3.6 && error[1] / error[2] > 3.8, "{degrees}: {error:?}");
    }
}

/// A ring of N nodes on a circle of radius rho gives a smooth circle of rho (2 + cos(2 pi/N))/3.
#[test]
fn smooth_radii() {
    for (kind, nodes) in [(CellKind::Hex8, 16.0), (CellKind::Hex27, 32.0)] {
        let section = Section::default().mesh(2.0, kind).unwrap();
        let expected = section.outer_radius() * (2.0 + (TAU / nodes).cos()) / 3.0;
        assert!((section.smooth_radius() / expected - 1.0).abs() < 7e-5, "{kind:?}");
    }
}

#[test]
fn sets_cover_the_rope() {
    let rope = Rope { layers: 4, length: 8.0, ..steel_1x7() }.mesh().unwrap();
    let mesh = &rope.mesh;
    mesh.validate().unwrap();
    assert_eq!((mesh.cell_count(), mesh.point_count()), (7 * 48 * 4, 7 * 57 * 5));
    assert_eq!(mesh.cell_count(), rope.strand_of_cell.len());
    let all = |name: &str| (0..7).map(|i| mesh.node_sets[&sets::of_strand(name, i)].len()).sum::<usize>();
    assert_eq!((all(strand_sets::END_A), mesh.node_sets[strand_sets::END_A].len()), (7 * 57, 7 * 57));
    assert_eq!((all(strand_sets::SURFACE_NODES), all(strand_sets::AXIS)), (7 * 16 * 5, 7 * 5));
    assert_eq!(mesh.node_sets[sets::ALL].len(), mesh.point_count());
    assert_eq!(mesh.element_sets[sets::ALL].len(), mesh.cell_count());
    for i in 0..7 {
        for &cell in &mesh.element_sets[&sets::of_strand(strand_sets::STRAND, i)] {
            assert_eq!((rope.strand_of_cell[cell as usize] as usize, rope.fibres.strand(cell as usize)), (i, i));
        }
        let name = sets::of_strand(strand_sets::SURFACE_NODES, i);
        assert_eq!(mesh.node_sets[&name], rope.surfaces[i].nodes);
    }
    assert_eq!(rope.fibres.strand(mesh.cell_count()), 7);
}

/// Two strands of unequal size about one axis, with the sets of a rope.
#[test]
fn unequal_strands_are_joined() {
    let lay = Lay::from_pitch(60.0).unwrap();
    let strand = |radius: f64, helix_radius: f64, phase: f64| {
        let helix = Helix::new(Axis::default(), helix_radius, lay, phase).unwrap();
        let (axis, length) = (StrandAxis::Helix(helix), helix.arc_length(20.0));
        Strand { radius, axis, length, layers: 8, ends: StrandEnds::Flat, ..Strand::default() }
    };
    let strands = [strand(2.0, 1.3, 0.0), strand(1.2, 2.1, 0.5 * TAU)];
    let (mesh, surfaces) = join_strands(&strands).unwrap();
    mesh.validate().unwrap();
    let volumes = strands.map(|strand| strand.volume());
    assert!((volume(&mesh).unwrap() / (volumes[0] + volumes[1]) - 1.0).abs() < 1e-12);
    assert_eq!(surfaces[1].nodes, mesh.node_sets["SURFACE_NODES_2"]);
    assert!(fibre_frames(&mesh, &RopeFibres::new(&strands)).unwrap().iter().all(|f| frame_deviation(f) < 1e-12));
    let mixed = [strands[0], Strand { kind: CellKind::Hex27, ..strands[1] }];
    assert!(matches!(join_strands(&mixed), Err(GeometryError::KindsDiffer { strand: 2 })));
}

/// Around times along points outwards, and the faces of the grid are the lateral surface.
#[test]
fn surface_grids_are_oriented_and_complete() {
    for kind in [CellKind::Hex8, CellKind::Hex27] {
        let rope = Rope { kind, layers: 6, length: 12.0, ..Rope::default() }.mesh().unwrap();
        for (strand, grid) in rope.strands.iter().zip(&rope.surfaces) {
            let StrandAxis::Helix(helix) = strand.axis else { unreachable!() };
            let x = |level: usize, q: usize| rope.mesh.points[grid.node(level, q) as usize];
            for (level, q) in (0..grid.levels - 1).flat_map(|l| (0..grid.around).map(move |q| (l, q))) {
                let normal = (x(level, q + 1) - x(level, q)).cross(&(x(level + 1, q) - x(level, q)));
                let axis = helix.position(helix.nearest(&x(level, q)).unwrap());
                assert!(normal.dot(&(x(level, q) - axis)) > 0.0);
            }
            assert_eq!(grid.ring(1)[0], grid.node(1, grid.around));
        }
    }
}

/// Every strand is the first one turned by 2 pi k/n, nodes and fibre frames.
#[test]
fn strands_are_images_of_each_other() {
    for (strands, compaction) in [(2, Compaction::None), (3, Compaction::Degree(1.3)), (5, Compaction::None)] {
        let rope = Rope { strands, compaction, layers: 10, ..Rope::default() }.mesh().unwrap();
        let (per_strand, frames) = (rope.mesh.point_count() / strands, rope.frames().unwrap());
        let per_frame = frames.len() / strands;
        for k in 1..strands {
            let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), TAU * k as f64 / strands as f64);
            for i in 0..per_strand {
                let image = turn * rope.mesh.points[i];
                assert!((image - rope.mesh.points[k * per_strand + i]).amax() < 1e-12);
            }
            for i in 0..per_frame {
                assert!((turn.matrix() * frames[i] - frames[k * per_frame + i]).amax() < 1e-12);
            }
        }
    }
}

fn mirrored(x: &Vector3<f64>) -> Vector3<f64> {
    Vector3::new(x.x, -x.y, x.z)
}

#[test]
fn a_left_handed_rope_is_the_mirror_image() {
    for (kind, compaction) in [(CellKind::Hex8, Compaction::Degree(1.3)), (CellKind::Hex27, Compaction::None)] {
        let lay = |handedness| {
            let rope = laid(LayBy::Length(50.0), handedness);
            Rope { layers: 3, length: 5.0, kind, compaction, ..rope }
        };
        let [right, left] = [lay(Handedness::Right), lay(Handedness::Left)].map(|rope| rope.mesh().unwrap());
        let found = |x: Vector3<f64>| left.mesh.points.iter().position(|y| (y - x).amax() < 1e-12);
        let image: Vec<usize> = right.mesh.points.iter().map(|x| found(mirrored(x)).unwrap()).collect();
        let mut all = image.clone();
        all.sort_unstable();
        assert!(all.iter().copied().eq(0..left.mesh.point_count()));
        // Yarns turn the other way too: e1 is mirrored.
        for (i, &j) in image.iter().enumerate().step_by(7) {
            let strand = |mesh: &RopeMesh, node: usize| node / (mesh.mesh.point_count() / 3);
            let e1 = right.fibres.fields()[strand(&right, i)].frame(&right.mesh.points[i], 0).unwrap().column(0).into();
            let f1 = left.fibres.fields()[strand(&left, j)].frame(&left.mesh.points[j], 0).unwrap();
            assert!((mirrored(&e1) - f1.column(0)).amax() < 1e-11);
        }
    }
}

#[test]
fn the_wires_of_a_steel_strand_touch_the_core_only() {
    let rope = steel_1x7();
    let mesh = rope.mesh().unwrap();
    let shape = mesh.shape;
    assert!(shape.gap > 0.0 && shape.core_gap.unwrap().abs() < 1e-12, "{shape:?}");
    // Within the shrinking along the rope, about (2 pi/48)^2/6 of the radius, the sum of the smooth radii.
    let sum = shape.smooth_radius + shape.core_smooth_radius.unwrap();
    assert!((shape.helix_radius / sum - 1.0).abs() < 4e-3, "{shape:?}");
    for outer in 0..6 {
        let gap = gap_at(&mesh, [outer, 6], 20.0 + 0.7 * outer as f64) / 1.865;
        assert!(gap.abs() < 1e-3, "wire {outer}: gap {gap} R");
    }
    check_strands(&mesh);
    let thick = RopeStrand { radius: 2.0, ..rope.outer };
    let failure = Rope { outer: thick, core: Some(RopeStrand { radius: 1.9, ..thick }), ..rope }.mesh().unwrap_err();
    assert!(matches!(failure, GeometryError::OuterStrandsOverlap { gap, .. } if gap < 0.0), "{failure}");
    // Strands far apart are laid all the same.
    let apart = Rope { helix_radius: HelixRadius::Given(40.0), ..Rope::default() }.shape().unwrap();
    assert!(apart.gap > 10.0, "{apart:?}");
    // With a given helix radius the overlap is told, not refused.
    let given = Rope { helix_radius: HelixRadius::Given(3.7), ..rope }.shape().unwrap();
    assert!(given.gap < 0.0 && given.core_gap.unwrap() < -0.05, "{given:?}");
}

/// Exact volumes, flat ends, positive Jacobians, orthonormal frames.
fn check_strands(rope: &RopeMesh) {
    check_orientation(&rope.mesh).unwrap();
    for (i, strand) in rope.strands.iter().enumerate() {
        let cells = &rope.mesh.element_sets[&sets::of_strand(strand_sets::STRAND, i)];
        let cells = cells.iter().flat_map(|&cell| rope.mesh.cell(cell as usize)).copied().collect();
        let part = Mesh::new(rope.mesh.kind, rope.mesh.points.clone(), cells);
        assert!((volume(&part).unwrap() / strand.volume() - 1.0).abs() < 1e-12);
    }
    let half = 0.5 * rope.strands[0].length * rope.shape.lay_angle.cos();
    for (set, z) in [(strand_sets::END_A, -half), (strand_sets::END_B, half)] {
        assert!(rope.mesh.node_sets[set].iter().all(|&n| (rope.mesh.points[n as usize].z - z).abs() < 1e-12));
    }
    assert!(rope.frames().unwrap().iter().all(|frame: &Matrix3<f64>| frame_deviation(frame) < 1e-12));
}

/// Given diameter, length or angle: the three ways to say one lay agree.
#[test]
fn lay_by_length_angle_and_diameter() {
    let by_angle = laid(LayBy::Angle(0.4), Handedness::Left).shape().unwrap();
    for by in [LayBy::Length(by_angle.lay.lay_length()), LayBy::OuterDiameter(by_angle.outer_diameter)] {
        let shape = laid(by, Handedness::Left).shape().unwrap();
        assert!((shape.lay_angle - 0.4).abs() < 1e-9 && (shape.helix_radius - by_angle.helix_radius).abs() < 1e-11);
        assert_eq!(shape.lay.handedness(), Some(Handedness::Left));
    }
    let straight = laid(LayBy::Angle(0.0), Handedness::Right).shape().unwrap();
    let same = laid(LayBy::OuterDiameter(straight.outer_diameter), Handedness::Right).shape().unwrap();
    assert!(same.lay_angle < 1e-5 && (same.helix_radius / straight.helix_radius - 1.0).abs() < 1e-12);
    for diameter in [0.99 * straight.outer_diameter, 20.0, f64::NAN, -1.0] {
        let failure = laid(LayBy::OuterDiameter(diameter), Handedness::Right).mesh().unwrap_err();
        assert!(matches!(failure, GeometryError::OuterDiameter { .. }), "{failure}");
    }
}

/// Strands of 3.1 mm radius, 13.4 mm over all as circles, pressed into 12.6 mm.
fn compacted(diameter: f64, kind: CellKind) -> Rope {
    let outer = RopeStrand { radius: 3.1, ..RopeStrand::default() };
    Rope { outer, kind, compaction: Compaction::OuterDiameter(diameter), layers: 40, ..Rope::default() }
}

#[test]
fn compacted_strands_meet_the_diameter_and_touch() {
    for kind in [CellKind::Hex8, CellKind::Hex27] {
        let rope = compacted(12.6, kind);
        let mesh = rope.mesh().unwrap();
        assert!((mesh.shape.outer_diameter - 12.6).abs() < 1e-9 && mesh.shape.gap.abs() < 1e-9, "{:?}", mesh.shape);
        assert!(mesh.shape.compaction > 1.0 && mesh.shape.compaction < 1.6);
        check_strands(&mesh);
        let levels = mesh.surfaces[0].levels as f64;
        for i in 0..4 {
            let v = 10.0 + (levels - 21.0) * f64::from(i) / 3.0;
            let gap = gap_at(&mesh, [i as usize % 3, (i as usize + 1) % 3], v) / 3.1;
            assert!(gap.abs() < 1e-3, "{kind:?}: gap {gap} R");
        }
        // The outermost nodes lie on the outer diameter but for the scaling of straight edges to the exact area.
        let reach = mesh.mesh.points.iter().map(|x| x.xy().norm()).fold(0.0, f64::max);
        assert!((2.0 * reach / 12.6 - 1.0).abs() < 0.02, "{reach}");
    }
}

/// Degree 0 is round; the diameter falls with the degree; what cannot be is refused.
#[test]
fn degrees_of_compaction() {
    let of = |degree: f64| Rope { compaction: Compaction::Degree(degree), ..Rope::default() };
    assert_eq!(of(0.0).mesh().unwrap().mesh, Rope::default().mesh().unwrap().mesh);
    let diameters: Vec<f64> = (0..=8).map(|i| of(0.25 * f64::from(i)).shape().unwrap().outer_diameter).collect();
    assert!(diameters.is_sorted_by(|a, b| a >= b) && diameters[8] < 0.92 * diameters[0], "{diameters:?}");
    let round = compacted(13.0, CellKind::Hex8);
    for diameter in [11.0, 14.0, f64::NAN] {
        let failure = Rope { compaction: Compaction::OuterDiameter(diameter), ..round }.shape().unwrap_err();
        assert!(matches!(failure, GeometryError::OuterDiameter { .. }), "{failure}");
    }
    let diameter = RopeLay { by: LayBy::OuterDiameter(12.3), handedness: Handedness::Right };
    for bad in [
        Rope { compaction: Compaction::Degree(2.1), ..round },
        Rope { compaction: Compaction::Degree(-0.1), ..round },
        Rope { helix_radius: HelixRadius::Given(3.6), ..round },
        Rope { core: Some(round.outer), ..round },
        Rope { lay: diameter, ..round },
    ] {
        assert!(!bad.mesh().unwrap_err().to_string().is_empty());
    }
}

/// The growth of a flattened section keeps its area: with inscribed sections, which nothing rescales, the volume
/// converges to that of the strand.
#[test]
fn compaction_keeps_the_area() {
    let error = [1, 2, 4].map(|factor| {
        let section = Section { core_cells: 4 * factor, rings: 2, area: SectionArea::Inscribed, ..Section::default() };
        let outer = RopeStrand { section, ..RopeStrand::default() };
        let layers = 20 * factor;
        let rope = Rope { outer, layers, length: 20.0, compaction: Compaction::Degree(1.3), ..Rope::default() };
        let mesh = rope.mesh().unwrap();
        volume(&mesh.mesh).unwrap() / (3.0 * mesh.strands[0].volume()) - 1.0
    });
    assert!(error[2].abs() < 3e-3 && error[0] / error[1] > 3.5 && error[1] / error[2] > 3.8, "{error:?}");
}

/// Every layer of every strand is the image of the slice by a screw, and so are the yarns in it.
#[test]
fn a_slice_and_its_images_are_the_rope() {
    let flat = Rope { compaction: Compaction::Degree(1.0), ..laid(LayBy::Angle(0.35), Handedness::Left) };
    let serendipity = Rope { kind: CellKind::Hex20R, ..laid(LayBy::Length(50.0), Handedness::Right) };
    assert!(matches!(serendipity.mesh(), Err(GeometryError::NoSmoothSurface { nodes: 20 })));
    let quadratic = Rope { kind: CellKind::Hex27, layers: 7, ..laid(LayBy::Length(50.0), Handedness::Right) };
    for rope in [flat, quadratic] {
        let rope = Rope { origin: StrandOrigin::Bottom, ..rope };
        let (whole, slice) = (rope.mesh().unwrap(), rope.slice().unwrap());
        assert_eq!(slice.shape, whole.shape);
        let (frames, own) = (whole.frames().unwrap(), fibre_frames(&slice.mesh, &slice.strand.fibres()).unwrap());
        let (cells, points) = (slice.mesh.cell_count(), slice.mesh.kind.points());
        let (mut off, mut turned) = (0.0_f64, 0.0_f64);
        for (strand, layer) in (0..rope.strands).flat_map(|s| (0..rope.layers).map(move |l| (s, l))) {
            let angle = TAU * strand as f64 / rope.strands as f64 + layer as f64 * slice.angle;
            let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), angle);
            let up = Vector3::z() * (layer as f64 * slice.height);
            let first = (strand * rope.layers + layer) * cells;
            for cell in 0..cells {
                for (&a, &b) in slice.mesh.cell(cell).iter().zip(whole.mesh.cell(first + cell)) {
                    let image = turn * slice.mesh.points[a as usize] + up;
                    off = off.max((image - whole.mesh.points[b as usize]).norm());
                }
                for q in 0..points {
                    let image = turn.matrix() * own[cell * points + q];
                    turned = turned.max((image - frames[(first + cell) * points + q]).amax());
                }
            }
        }
        println!("nodes off by {off:e} mm, frames by {turned:e}");
        assert!(off < 1e-11 && turned < 1e-11, "{off:e} {turned:e}");
    }
}

#[test]
fn bad_ropes_are_refused() {
    let good = Rope::default();
    let diameter = RopeLay { by: LayBy::OuterDiameter(12.3), handedness: Handedness::Right };
    let bad = [
        Rope { strands: 1, ..good },
        Rope { length: 0.0, ..good },
        Rope { layers: 0, ..good },
        Rope { outer: RopeStrand { radius: f64::NAN, ..good.outer }, ..good },
        Rope { helix_radius: HelixRadius::Touching { gap: -1.0 }, ..good },
        Rope { helix_radius: HelixRadius::Given(-3.0), ..good },
        Rope { helix_radius: HelixRadius::Given(3.0), lay: diameter, ..good },
        Rope { core: Some(good.outer), lay: diameter, ..good },
        laid(LayBy::Length(16.0), Handedness::Right),
        laid(LayBy::Length(f64::INFINITY), Handedness::Right),
        laid(LayBy::Angle(1.6), Handedness::Right),
    ];
    for rope in bad {
        assert!(!rope.mesh().unwrap_err().to_string().is_empty());
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn ropes_of_all_angles_are_sound(
        degrees in 0.0..40.0_f64, strands in 2..6_usize, radius in 0.5..5.0_f64, gap in -0.05..0.05_f64, left: bool,
        same: bool, quadratic: bool,
    ) {
        let handedness = if left { Handedness::Left } else { Handedness::Right };
        let sense = if same { Sense::Same } else { Sense::Opposite };
        let outer = RopeStrand {
            radius,
            yarns: YarnLay { by: YarnLayBy::SurfaceAngle(0.5), sense },
            section: Section { core_cells: 2, rings: 2, ..Section::default() },
        };
        let kind = if quadratic { CellKind::Hex27 } else { CellKind::Hex8 };
        let rope = Rope {
            strands, outer, kind, helix_radius: HelixRadius::Touching { gap }, length: 3.0 * radius, layers: 4,
            ..laid(LayBy::Angle(degrees.to_radians()), handedness)
        };
        let mesh = rope.mesh().unwrap();
        check_strands(&mesh);
        prop_assert!((mesh.shape.gap - gap).abs() < 1e-9);
        prop_assert!((mesh.shape.lay_angle - degrees.to_radians()).abs() < 1e-12);
        let sign = mesh.shape.lay.rate() * mesh.strands[0].lay.rate();
        prop_assert!(degrees == 0.0 || (sign > 0.0) == same);
    }
}
