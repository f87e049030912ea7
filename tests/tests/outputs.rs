//! What a run writes adds up: energies by strand, line loads, what each cycle loses.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::path::Path;

use subrope::model::RopeModel;
use subrope::run::RunOutcome;
use subrope_geometry::{Face, Hex8, Hexahedron, Mesh, map_point, surface_area};
use subrope_io::{Location, ResultReader};
use subrope_tests::{SET_C, close, run_with_files, scene, short_rope};

/// A table by the names of its columns, units left out.
struct Table(subrope_io::History);

impl Table {
    fn read(file: &Path) -> Self {
        Self(subrope_io::read_history(file).unwrap())
    }

    fn at(&self, name: &str) -> usize {
        self.0.columns.iter().position(|c| c.name == name).unwrap_or_else(|| panic!("no column {name}"))
    }

    fn column(&self, name: &str) -> Vec<f64> {
        let at = self.at(name);
        self.0.rows.iter().map(|row| row[at]).collect()
    }
}

/// Fails unless a value is within a relative tolerance of its reference, which may be nothing at all.
#[track_caller]
fn same(what: &str, value: f64, reference: f64, tolerance: f64) {
    assert!((value - reference).abs() <= tolerance * reference.abs(), "{what}: {value} instead of {reference}");
}

fn pull(elongation: f64, increments: usize, every: usize) -> String {
    short_rope(&format!(
        "[[step]]\nname = \"pull\"\nincrements = {{ fixed = {increments} }}\ntension = {{ elongation = {elongation} }}\n\
         [output]\nevery = {every}\n"
    ))
}

/// Energies of the strands are those of the rope, their forces and torques the reaction of its end.
#[test]
fn strands_add_up_to_the_rope() {
    let (folder, outcome) = run_with_files(&pull(0.02, 10, 1));
    let history = Table::read(&folder.path().join("out/history.csv"));
    let pairs = [
        ("stored_energy", "stored_energy"),
        ("dissipated_transverse", "dissipated_transverse"),
        ("dissipated_longitudinal", "dissipated_longitudinal"),
        ("fz", "END_B_fz"),
        ("mz", "END_B_mz"),
    ];
    for (of_strand, of_rope) in pairs {
        let strands = [1, 2, 3].map(|i| history.column(&format!("strand_{i}_{of_strand}")));
        // Moments are sums of forces times arms that cancel to a good part.
        let tolerance = if of_strand == "mz" { 1e-10 } else { 1e-12 };
        let totals = history.column(of_rope);
        assert!(*totals.last().unwrap() != 0.0, "{of_rope}");
        for (row, total) in totals.into_iter().enumerate() {
            same(of_strand, strands.iter().map(|s| s[row]).sum(), total, tolerance);
        }
    }
    let strands = &outcome.summary.strands;
    let energies = &outcome.summary.energies;
    let sum = |of: fn(&subrope::run::StrandSummary) -> f64| strands.iter().map(of).sum::<f64>();
    close("share", sum(|s| s.share_of_force), 1.0, 1e-14);
    close("stored", sum(|s| s.stored_mj), energies.stored_mj, 1e-12);
    let (across, along) = (energies.dissipated_transverse_midpoint_mj, energies.dissipated_longitudinal_midpoint_mj);
    close("across", sum(|s| s.dissipated_transverse_midpoint_mj), across, 1e-12);
    close("along", sum(|s| s.dissipated_longitudinal_midpoint_mj), along, 1e-12);
}

/// Rows of the last frame of a pair: column by column.
fn last_frame(table: &Table, pair: f64, names: &[&str]) -> Vec<Vec<f64>> {
    let (pairs, times) = (table.column("pair"), table.column("time"));
    let last = *times.last().unwrap();
    let chosen: Vec<usize> = (0..pairs.len()).filter(|&i| pairs[i] == pair && times[i] == last).collect();
    names.iter().map(|name| chosen.iter().map(|&i| table.column(name)[i]).collect()).collect()
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Line load times length, summed over a line, is the normal force of the pair; likewise friction and its work.
fn check_lines(folder: &Path, outcome: &RunOutcome) {
    let table = Table::read(&folder.join("out/line_load.csv"));
    let names = [
        "length",
        "normal_line_load",
        "deformed_length",
        "normal_line_load_deformed",
        "friction_line_load",
        "friction_work_per_length",
        "touching_width",
        "smallest_gap",
    ];
    for (pair, contact) in (1_u32..).zip(&outcome.summary.contacts) {
        let line = last_frame(&table, f64::from(pair), &names);
        let of = |name: &str| &line[names.iter().position(|n| *n == name).unwrap()];
        assert!(contact.normal_force_n > 0.0);
        close("force", product(of("length"), of("normal_line_load")), contact.normal_force_n, 1e-12);
        let deformed = product(of("deformed_length"), of("normal_line_load_deformed"));
        close("force by current length", deformed, contact.normal_force_n, 1e-12);
        close("friction", product(of("length"), of("friction_line_load")), contact.friction_force_n, 1e-12);
        close("work", product(of("length"), of("friction_work_per_length")), contact.friction_work_mj, 1e-12);
        close("area", product(of("length"), of("touching_width")), contact.area_mm2, 1e-12);
        let gap = of("smallest_gap").iter().copied().fold(f64::INFINITY, f64::min);
        close("penetration", -gap, contact.largest_penetration_mm, 1e-9);
        let shares = outcome.summary.line_loads[pair as usize - 1].share_of_thirds;
        close("thirds", shares.iter().sum(), 1.0, 1e-12);
    }
}

#[test]
fn slices_of_a_rope_add_up_to_its_contacts() {
    let (folder, outcome) = run_with_files(&pull(0.01, 5, 2));
    check_lines(folder.path(), &outcome);
    let table = Table::read(&folder.path().join("out/line_load.csv"));
    // Frames at increments 0, 2, 4 and 5, of three lines of ten slices each.
    let increments = table.column("increment");
    assert_eq!(increments.len(), 4 * 30);
    assert_eq!([0, 30, 60, 90].map(|i| increments[i]), [0.0, 2.0, 4.0, 5.0]);
    let frames = ResultReader::open(outcome.files.results.as_ref().unwrap()).unwrap().steps();
    assert_eq!(frames, 4);
    // The slices fill the strand, whose axis is longer than the rope by 1/cos of the lay angle.
    let line = last_frame(&table, 2.0, &["length", "deformed_length", "z"]);
    close("arc length", line[0].iter().sum(), 16.0 / 20_f64.to_radians().cos(), 1e-12);
    let stretch = line[1].iter().sum::<f64>() / line[0].iter().sum::<f64>() - 1.0;
    assert!(stretch > 0.0 && stretch < 0.01, "a strand stretches less than its rope: {stretch}");
    close("first middle", line[2][0], -7.2, 1e-12);
    assert_eq!(outcome.summary.line_loads.len(), 3);
    assert!(outcome.summary.analytic_line_load.is_some());
}

const STRAND: &str = r#"
title = "a strand against a rigid body"
[strand]
radius = 2.785
length = 16.0
surface_angle = 30.0
origin = "middle"
[strand.mesh]
core = 2
rings = 1
layers = 8
"#;

#[test]
fn slices_of_a_strand_against_rigid_bodies() {
    let bodies = [
        "shape = \"cylinder\"\npoint = [7.785, 0.0, 0.0]\naxis = [0.0, 1.0, 0.0]\nradius = 5.0\n",
        "shape = \"plane\"\npoint = [2.785, 0.0, 0.0]\naxis = [-1.0, 0.0, 0.0]\n",
    ];
    for body in bodies {
        let (folder, outcome) = run_with_files(&format!(
            "{STRAND}{SET_C}[[rigid]]\nname = \"BODY\"\n{body}[[contact]]\nname = \"body\"\nprimary = \"BODY\"\n\
             secondary = \"LATERAL\"\nfriction = 0.15\n[[step]]\nname = \"pull\"\ntension = {{ elongation = 0.005 }}\n\
             [[step]]\nname = \"press\"\nprescribe = [{{ point = \"BODY\", ux = -0.4 }}]\n"
        ));
        check_lines(folder.path(), &outcome);
        assert!(outcome.summary.analytic_line_load.is_none());
    }
}

fn volumes(mesh: &Mesh) -> Vec<f64> {
    let volume = |e: usize| {
        let x = mesh.cell_points::<8>(e).unwrap();
        Hex8::quadrature().iter().map(|q| q.weight * map_point::<Hex8, 8>(&x, q.xi).unwrap().determinant).sum()
    };
    (0..mesh.cell_count()).map(volume).collect()
}

/// Areas of the outer faces of the cells; nothing for inner cells.
fn areas(mesh: &Mesh) -> Vec<f64> {
    let mut out = vec![0.0; mesh.cell_count()];
    let lateral = mesh.surfaces.iter().filter(|(name, _)| name.starts_with("LATERAL_"));
    for face in lateral.flat_map(|(_, faces): (_, &Vec<Face>)| faces) {
        out[face.cell as usize] += surface_area(mesh, &[*face]).unwrap();
    }
    out
}

/// On faces: forces of both sides of the contacts, opposite tractions within Coulomb's limit, gaps closed under pressure.
#[test]
fn fields_on_faces_balance() {
    let text = pull(0.01, 5, 5);
    let areas = areas(&RopeModel::from_scene(&scene(&text), None, Some(1)).unwrap().mesh.mesh);
    let (_folder, outcome) = run_with_files(&text);
    let file = ResultReader::open(outcome.files.results.as_ref().unwrap()).unwrap();
    let field = |name: &str, frame: usize| file.field(Location::Cell, name, frame).unwrap();
    let (gap, pressure, traction) =
        (field("contact_gap", 1), field("contact_pressure", 1), field("contact_traction", 1));
    let normal: f64 = outcome.summary.contacts.iter().map(|c| c.normal_force_n).sum();
    // Fields are written in single precision.
    close("both sides", product(&pressure, &areas), 2.0 * normal, 1e-6);
    let mut total = [0.0; 3];
    for (cell, t) in traction.chunks_exact(3).enumerate() {
        total.iter_mut().zip(t).for_each(|(sum, t)| *sum += t * areas[cell]);
        let magnitude = t.iter().map(|t| t * t).sum::<f64>().sqrt();
        assert!(magnitude <= 0.15 * pressure[cell] * (1.0 + 1e-5), "cell {cell}: {magnitude} at {}", pressure[cell]);
        assert!(pressure[cell] == 0.0 || gap[cell] < 0.0, "cell {cell}: {} at {}", gap[cell], pressure[cell]);
    }
    let friction: f64 = outcome.summary.contacts.iter().map(|c| c.friction_force_n).sum();
    assert!(friction > 0.0 && total.iter().all(|t| t.abs() < 1e-6 * friction), "{total:?} of {friction}");
    // Smooth strands that just touch: nowhere is the gap at the start more than rounding below zero.
    let start = field("contact_gap", 0).into_iter().fold(f64::INFINITY, f64::min);
    assert!(start > -1e-3 * 2.785 && start < 0.1, "{start}");
}

/// Fields of a cycle are what that one cycle lost, also where the cycles between are not written; nothing before the first.
#[test]
fn fields_of_a_cycle_are_its_row() {
    let text = short_rope(
        r#"
[[step]]
name = "pull"
increments = { initial = 0.02 }
tension = { elongation = 0.02 }
[[step]]
name = "cycle"
increments = { maximum = 0.1 }
cycles = { count = 5, low = 0.1, high = 1.0, every = 3 }
[output]
precision = "f64"
every = 100
"#,
    );
    let model = RopeModel::from_scene(&scene(&text), None, Some(1)).unwrap();
    let (volumes, areas) = (volumes(&model.mesh.mesh), areas(&model.mesh.mesh));
    let (_folder, outcome) = run_with_files(&text);
    let file = ResultReader::open(outcome.files.results.as_ref().unwrap()).unwrap();
    let rows = &outcome.summary.cycles;
    // The start, the pull, then both ends of cycles 3 and 5.
    assert_eq!((file.steps(), rows.len()), (6, 5));
    let sum =
        |name: &str, frame: usize, weights: &[f64]| product(&file.field(Location::Cell, name, frame).unwrap(), weights);
    for (frame, row) in [(3, rows[2]), (5, rows[4])] {
        let across = sum("dissipation_transverse_cycle", frame, &volumes);
        let along = sum("dissipation_longitudinal_cycle", frame, &volumes);
        // Both strands of a pair show the work between them.
        let friction = 0.5 * sum("contact_friction_work_cycle", frame, &areas);
        assert!(across > 0.0 && friction > 0.0, "{across} {along} {friction}");
        same("across", across, row.dissipated_transverse_mj, 1e-9);
        same("along", along, row.dissipated_longitudinal_mj, 1e-9);
        close("friction", friction, row.contact_friction_mj, 1e-9);
        // At the lower end a part of the cycle.
        let half = sum("dissipation_transverse_cycle", frame - 1, &volumes);
        assert!(half > 0.0 && half < across, "{half} {across}");
    }
    for frame in [0, 1] {
        assert_eq!(sum("dissipation_transverse_cycle", frame, &volumes), 0.0);
        assert_eq!(sum("contact_friction_work_cycle", frame, &areas), 0.0);
    }
}
