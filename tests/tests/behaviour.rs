//! What a run must do whatever its numbers: name what is wrong, leave no trace of a failure, repeat itself to the bit,
//! balance its energy.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::path::{Path, PathBuf};

use nalgebra::Matrix3;
use subrope::model::{ModelError, RopeModel};
use subrope::scene::Scene;
use subrope_fem::FemError;
use subrope_fem::analysis::{Increments, Silent};
use subrope_geometry::{CellKind, GeometryError};
use subrope_material::CompressibleNeoHooke;
use subrope_tests::{
    Brick, Lattice, Problem, Recorder, Run, brick, constant_frames, run_scene, scene, scene_file, scientific,
    short_rope, try_run,
};

const ELASTIC: &str = r#"[law]
kind = "bundle"
K_e = 650.0
K_ec = 65.0
w_e = 0.005
nu = 0.5
K_c = 45.0
K_t = 10.0
K_l = 8.0
friction = false
"#;

const FRICTION: &str = r#"[law]
kind = "bundle"
K_e = 650.0
K_ec = 65.0
w_e = 0.005
nu = 0.5
K_c = 45.0
K_t = 10.0
K_l = 8.0
tau_t = 0.05
H_t = 0.5
tau_l = 0.2
H_l = 1.0
"#;

const PRESSURE: &str = r#"[law]
kind = "bundle"
K_e = 650.0
K_ec = 65.0
w_e = 0.005
nu = 0.5
K_c = 45.0
K_t = 10.0
K_l = 8.0
tau_t = 0.05
H_t = 0.5
mu_t = 0.3
tau_l = 0.2
H_l = 1.0
mu_l = 0.15
"#;

const ENDS: &str = "[[end]]\nname = \"END_A\"\n[[end]]\nname = \"END_B\"\n";

/// A coarse strand with a law, ends and steps.
fn strand(formulation: &str, law: &str, ends: &str, steps: &str) -> String {
    format!(
        r#"title = "coarse strand"
[strand]
radius = 2.785
length = 30.0
surface_angle = 30.0
mesh = {{ core = 2, rings = 1, layers = 10 }}
[element]
formulation = "{formulation}"
{law}{ends}{steps}
[solver]
residual_tolerance = 1e-11
"#
    )
}

fn bend(name: &str, angle: f64, count: usize) -> String {
    format!("[[step]]\nname = \"{name}\"\nincrements = {{ fixed = {count} }}\n[step.bend]\nangle = {angle:?}\n")
}

fn bent(formulation: &str, law: &str, count: usize) -> Run {
    run_scene(&strand(formulation, law, ENDS, &bend("bend", 40.0, count)), None)
}

// ---------------------------------------------------------------------------------------------------------- wrong input

fn free_components(components: &[&str]) -> String {
    components.iter().map(|c| format!("{c} = \"free\"\n")).collect()
}

#[test]
fn free_bodies_are_told_by_their_count_of_rigid_motions() {
    let one_end = "[[end]]\nname = \"END_A\"\n";
    for (components, count) in [
        (&["ux", "uy", "uz", "rx", "ry", "rz"][..], 6),
        (&["rx", "ry", "rz"][..], 3),
        (&["uz", "rz"][..], 2),
        (&["rz"][..], 1),
    ] {
        let step = format!(
            "[[step]]\nname = \"free\"\nincrements = {{ fixed = 1 }}\n[[step.prescribe]]\npoint = \"END_A\"\n{}",
            free_components(components)
        );
        let outcome = try_run(&strand("hex8", ELASTIC, one_end, &step), None, 1).unwrap();
        let Err(error) = outcome else { panic!("a free body was solved") };
        let FemError::RigidModes { count: found, motions, .. } = &error else { panic!("{error}") };
        println!("{error}");
        assert_eq!(*found, count, "{motions}");
        assert!(error.to_string().contains(&format!("step free: {count} rigid motion")), "{error}");
        assert_eq!(motions.matches("rotation").count(), components.iter().filter(|c| c.starts_with('r')).count());
    }
}

#[test]
fn two_free_bodies_are_told_apart() {
    let lattice = Lattice::new([1, 1, 1], CellKind::Hex8);
    let mut mesh = lattice.mesh(|x| x);
    let other = lattice.mesh(|[x, y, z]| [x + 3.0, y, z]);
    mesh.cells.extend(other.cells.iter().map(|n| n + 8));
    let points = mesh.points.into_iter().chain(other.points).collect();
    let mesh = subrope_geometry::Mesh::new(CellKind::Hex8, points, mesh.cells);
    let law = CompressibleNeoHooke::new(1.0, 1.0).unwrap();
    let solid = brick(Brick::Plain, &mesh, &constant_frames(&mesh, Matrix3::identity()), law).unwrap();
    let mut problem = Problem::new(&mesh, solid, Vec::new()).unwrap();
    let held: Vec<u32> = lattice.face(2, false);
    let mut step = problem.step(Increments::Fixed(1));
    for k in 0..3 {
        step = step.nodes(&held, k, 0.0);
    }
    let step = step.build();
    let Err(FemError::RigidModes { count, motions, .. }) = problem.run(&step) else { panic!("a free body was solved") };
    assert_eq!(count, 6);
    assert!(motions.contains("body 2") && !motions.contains("body 1"), "{motions}");
}

fn deck() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/strand_300/strand_300.inp")
}

fn deck_scene(file: &str) -> String {
    format!(
        "title = \"deck\"\n[deck]\nfile = \"{file}\"\nfibres = {{ parallel = [0.0, 0.0, 1.0] }}\n[element]\nformulation = \
         \"hex8\"\n{ELASTIC}{ENDS}{}",
        bend("bend", 10.0, 2).replace("angle", "length = 60.0\nangle")
    )
}

/// The deck with some bricks turned inside out: bottom and top exchanged.
fn deck_with_inverted(labels: &[u64]) -> String {
    let text = std::fs::read_to_string(deck()).unwrap();
    let mut elements = false;
    let mut out = String::new();
    for line in text.lines() {
        if line.starts_with('*') {
            elements = line.to_uppercase().starts_with("*ELEMENT");
        }
        let numbers: Vec<&str> = line.split(',').map(str::trim).collect();
        let label = numbers[0].parse::<u64>().ok().filter(|l| elements && labels.contains(l));
        match label {
            Some(_) => {
                assert_eq!(numbers.len(), 9, "{line}");
                let turned: Vec<&str> =
                    numbers[..1].iter().chain(&numbers[5..9]).chain(&numbers[1..5]).copied().collect();
                out += &turned.join(", ");
            }
            None => out += line,
        }
        out.push('\n');
    }
    out
}

#[test]
fn one_inverted_brick_is_named_by_its_number() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("inverted.inp");
    for labels in [&[17_u64][..], &[300][..]] {
        std::fs::write(&file, deck_with_inverted(labels)).unwrap();
        let error = RopeModel::from_scene(&scene(&deck_scene("inverted.inp")), Some(&file), Some(1)).err().unwrap();
        println!("{error}");
        let ModelError::DeckMesh { cause, .. } = &error else { panic!("{error}") };
        let GeometryError::Inverted { cell_label, determinant } = cause.as_ref() else { panic!("{error:?}") };
        assert_eq!(*cell_label, labels[0]);
        assert!(*determinant < 0.0);
        assert!(error.to_string().contains(&labels[0].to_string()), "{error}");
    }
    std::fs::write(&file, deck_with_inverted(&[5, 44, 123])).unwrap();
    let error = RopeModel::from_scene(&scene(&deck_scene("inverted.inp")), Some(&file), Some(1)).err().unwrap();
    let ModelError::DeckMesh { cause, .. } = &error else { panic!("{error}") };
    let GeometryError::InvertedCells { cell_labels, .. } = cause.as_ref() else { panic!("{error:?}") };
    assert_eq!(cell_labels, &[5, 44, 123]);
}

/// The kernel itself names it too, for meshes that come another way.
#[test]
fn the_kernel_names_an_inverted_brick() {
    let mut mesh = Lattice::new([3, 1, 1], CellKind::Hex8).mesh(|x| x);
    mesh.cell_labels = vec![101, 205, 309];
    mesh.cells[8..16].rotate_left(4);
    let law = CompressibleNeoHooke::new(1.0, 1.0).unwrap();
    let error = brick(Brick::Plain, &mesh, &constant_frames(&mesh, Matrix3::identity()), law).err().unwrap();
    assert!(matches!(error, FemError::Geometry(GeometryError::Inverted { cell_label: 205, .. })), "{error}");
    assert!(error.to_string().contains("205"), "{error}");
}

fn model_error(text: &str) -> ModelError {
    RopeModel::from_scene(&scene(text), None, Some(1)).err().unwrap()
}

#[test]
fn what_does_not_go_together_is_a_typed_error() {
    let free = "[[step.prescribe]]\npoint = \"END_B\"\nrz = \"free\"\n[[step.force]]\npoint = \"END_B\"\nmz = 5.0\n";
    let steps = format!("[[step]]\nname = \"twist\"\n{free}");
    let refused = Scene::from_toml("t", &strand("hex8", ELASTIC, ENDS, &steps)).err().unwrap().plain();
    assert!(refused.contains("a moment is not available") && refused.contains("mz"), "{refused}");

    let clash = "[[constraint]]\nname = \"hold\"\nset = \"SURFACE_NODES\"\ncomponents = { ux = 0.0 }\n";
    let error = model_error(&strand("hex8", ELASTIC, &format!("{ENDS}{clash}"), &bend("bend", 1.0, 1)));
    assert!(matches!(error, ModelError::ConstrainedSectionNode { node: 1.., .. }), "{error:?}");

    let error = Scene::from_toml(
        "t",
        &strand(
            "hex8_mean_elongation",
            "[law]\nkind = \"isotropic\"\nE = 1.0\nnu = 0.3\n",
            ENDS,
            &bend("bend", 1.0, 1),
        ),
    );
    let refused = match error {
        Err(error) => format!("{error:?}"),
        Ok(scene) => {
            let error = RopeModel::from_scene(&scene, None, Some(1)).err().unwrap();
            assert!(matches!(error, ModelError::NoFibreTerm { law: "isotropic" }), "{error:?}");
            error.to_string()
        }
    };
    assert!(refused.contains("fibre"), "{refused}");
}

#[test]
fn sets_that_do_not_exist_are_named_with_those_that_do() {
    let ends = ENDS.replace("END_B", "END_C");
    let steps = bend("bend", 1.0, 1).replace("angle", "second = \"END_C\"\nangle");
    let text = strand("hex8", ELASTIC, &ends, &steps);
    match Scene::from_toml("test.toml", &text) {
        Err(error) => {
            let message = format!("{error:?}{error}");
            assert!(message.contains("END_C") && message.contains("END_B"), "{message}");
        }
        Ok(scene) => {
            let error = RopeModel::from_scene(&scene, None, Some(1)).err().unwrap();
            let ModelError::UnknownSet { name, available, .. } = &error else { panic!("{error:?}") };
            assert!(name == "END_C" && available.iter().any(|a| a == "END_B"), "{error}");
        }
    }
    // In a deck nobody has looked at yet.
    let text = deck_scene("strand_300.inp")
        .replace("END_B", "END_Q")
        .replace("[step.bend]", "[step.bend]\nsecond = \"END_Q\"");
    let error = RopeModel::from_scene(&scene(&text), Some(&deck()), Some(1)).err().unwrap();
    let ModelError::UnknownSet { name, available, .. } = &error else { panic!("{error:?}") };
    assert!(name == "END_Q" && available.iter().any(|a| a == "END_B"), "{error}");
}

#[test]
fn a_brick_of_another_kind_is_refused() {
    let text = deck_scene("strand_300.inp").replace("\"hex8\"", "\"hex27\"");
    let error = RopeModel::from_scene(&scene(&text), Some(&deck()), Some(1)).err().unwrap();
    assert!(matches!(error, ModelError::WrongElement { needed: 27, found: 8, .. }), "{error:?}");
}

#[test]
fn nodes_of_two_ends_are_refused() {
    let ends = format!("{ENDS}[[end]]\nname = \"again\"\nset = \"END_A\"\n");
    let text = strand("hex8", ELASTIC, &ends, &bend("bend", 1.0, 1));
    match Scene::from_toml("test.toml", &text) {
        Err(error) => assert!(format!("{error:?}").contains("END_A"), "{error:?}"),
        Ok(scene) => {
            let error = RopeModel::from_scene(&scene, None, Some(1)).err().unwrap();
            let ModelError::Fem(cause) = &error else { panic!("{error:?}") };
            assert!(matches!(**cause, FemError::NodeTiedTwice { .. }), "{error:?}");
        }
    }
}

/// A radial end cannot be bent, and its nodes cannot be held one by one.
#[test]
fn a_radial_end_is_not_for_everything() {
    let ends = ENDS.replace("name = \"END_A\"", "name = \"END_A\"\nkind = \"radial\"");
    let error = Scene::from_toml("test.toml", &strand("hex8", ELASTIC, &ends, &bend("bend", 1.0, 1))).unwrap_err();
    assert!(format!("{error:?}").contains("cannot be bent"), "{error:?}");

    let hold = "[[constraint]]\nname = \"hold\"\nset = \"AXIS\"\ncomponents = { ux = 0.0, uy = 0.0 }\n";
    let pull = "[[step]]\nname = \"pull\"\n[step.tension]\nelongation = 0.01\n";
    let error = model_error(&strand("hex8", ELASTIC, &format!("{ends}{hold}"), pull));
    assert!(matches!(error, ModelError::ConstrainedSectionNode { .. }), "{error:?}");
}

// ---------------------------------------------------------------------------------------------------- threads, failures

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|v| v.to_bits()).collect()
}

fn fingerprint(run: &Run) -> Vec<u64> {
    let mut out = bits(run.model.analysis.coordinates());
    out.extend(bits(&run.model.analysis.nodal_reactions()));
    for row in &run.rows {
        row.reaction.iter().flatten().for_each(|v| out.extend(bits(v.as_slice())));
        let t = &row.totals;
        out.extend(bits(&[t.stored, t.external_work, t.dissipated[0], t.dissipated[1], t.dissipated_mid[0]]));
        out.extend(bits(&row.record.residuals));
    }
    out
}

#[test]
fn threads_do_not_change_a_bit() {
    for (formulation, law) in
        [("hex8", FRICTION), ("hex8_mean_elongation", PRESSURE), ("hex20r", FRICTION), ("hex27", FRICTION)]
    {
        same_on_all_threads(formulation, &strand(formulation, law, ENDS, &bend("bend", 20.0, 4)));
    }
}

/// A scene on 1, 2, 4 and 8 threads.
fn same_on_all_threads(name: &str, text: &str) {
    let run = |threads| fingerprint(&try_run(text, None, threads).unwrap().unwrap());
    let one = run(1);
    for threads in [2, 4, 8] {
        let many = run(threads);
        assert_eq!(one.len(), many.len(), "{name}, {threads} threads");
        let differing = one.iter().zip(&many).filter(|(a, b)| a != b).count();
        assert_eq!(differing, 0, "{name}, {threads} threads: {differing} of {} numbers differ", one.len());
    }
}

/// Enough bricks that assembly and factorisation are shared.
#[test]
fn threads_do_not_change_a_bit_of_the_whole_strand() {
    let text = scene_file("bent_strand.toml");
    let start = text.find("[[step]]").unwrap();
    same_on_all_threads("2400 bricks", &format!("{}{}", &text[..start], bend("bend", 6.0, 2)));
}

#[test]
fn threads_do_not_change_a_bit_of_ropes_in_contact() {
    let pull = "[[step]]\nname = \"pull\"\nincrements = { fixed = 3 }\ntension = { elongation = 0.01 }\n";
    let back = "[[step]]\nname = \"back\"\nincrements = { fixed = 2 }\ntension = { elongation = 0.006 }\n";
    let rope = short_rope(&format!("{pull}{back}"));
    same_on_all_threads("rope", &rope);
    same_on_all_threads("slice", &rope.replace("[rope]\n", "[rope]\nsymmetry = \"helical\"\n"));
}

/// The same scene with and without a failed step in between: not a bit of difference.
#[test]
fn a_failed_attempt_leaves_no_trace() {
    let steps = |count| format!("{}{}", bend("first", 15.0, 3), bend("second", 30.0, count));
    let text = strand("hex8_mean_elongation", FRICTION, ENDS, &steps(3));
    let straight = run_scene(&text, None);

    let mut model = RopeModel::from_scene(&scene(&text), None, Some(1)).unwrap();
    model.analysis.run_step(&model.steps[0].clone(), &mut Silent).unwrap();
    let state = |m: &RopeModel| {
        let t = m.analysis.totals();
        let mut out = bits(m.analysis.coordinates());
        out.extend(bits(m.analysis.displacement()));
        out.extend(bits(&m.analysis.nodal_reactions()));
        out.extend(bits(m.analysis.reactions()));
        out.extend(bits(&[t.stored, t.external_work, m.analysis.time(), t.dissipated_mid[0], t.dissipated_mid[1]]));
        out.extend(bits(&t.dissipated));
        out.push(t.increments as u64);
        out
    };
    let before = state(&model);
    // All at once, far beyond what one increment can do.
    let wild = RopeModel::from_scene(
        &scene(&strand(
            "hex8_mean_elongation",
            FRICTION,
            ENDS,
            &format!("{}{}", bend("first", 15.0, 3), bend("wild", 170.0, 1)),
        )),
        None,
        Some(1),
    )
    .unwrap();
    let error = model.analysis.run_step(&wild.steps[1], &mut Silent).unwrap_err();
    println!("{error}");
    assert!(matches!(error, FemError::FixedIncrementFailed { increment: 1, .. }), "{error}");
    assert!(state(&model) == before, "the failed attempt left a trace");
    assert_eq!(model.analysis.totals().cutbacks, 1);

    let mut recorder = Recorder::default();
    model.analysis.run_step(&model.steps[1].clone(), &mut recorder).unwrap();
    let last = |rows: &[subrope_tests::Row]| {
        let row = rows.last().unwrap().clone();
        row.reaction.iter().flatten().flat_map(|v| bits(v.as_slice())).collect::<Vec<_>>()
    };
    assert!(bits(model.analysis.coordinates()) == bits(straight.model.analysis.coordinates()), "other coordinates");
    assert_eq!(last(&recorder.rows), last(&straight.rows));
}

/// Increments so small that energies are rounding: a residual of 1e-13 is as good as it gets, and is taken.
#[test]
fn tiny_increments_converge() {
    let run = run_scene(&strand("hex8_mean_elongation", FRICTION, ENDS, &bend("bend", 2.5e-9, 10)), None);
    assert_eq!(run.rows.len(), 10);
    let large = run_scene(&strand("hex8_mean_elongation", FRICTION, ENDS, &bend("bend", 2.5e-6, 1)), None);
    let moment = |run: &Run| run.rows.last().unwrap().reaction[0][1].norm();
    let ratio = 1e3 * moment(&run) / moment(&large);
    assert!((ratio - 1.0).abs() < 1e-5, "moments of a linear strand: {ratio}");
}

/// With automatic increments a failure only shortens them: the path is the same to what increments cost in accuracy.
#[test]
fn cut_increments_go_on() {
    let automatic = "[[step]]\nname = \"bend\"\nincrements = { initial = 1.0, minimum = 1e-4, maximum = 1.0 }\n[step.bend]\nangle = 120.0\n";
    let run = run_scene(&strand("hex8", ELASTIC, ENDS, automatic), None);
    let fixed = run_scene(&strand("hex8", ELASTIC, ENDS, &bend("bend", 120.0, 24)), None);
    println!("{} increments, failures: {:?}", run.rows.len(), run.failures);
    assert!(!run.failures.is_empty(), "nothing failed: nothing tested");
    let moment = |run: &Run| run.rows.last().unwrap().reaction[0][1];
    let error = (moment(&run) - moment(&fixed)).norm() / moment(&fixed).norm();
    assert!(error < 1e-8, "an elastic strand depends on its increments: {error:e}");
}

// ------------------------------------------------------------------------------------------------- convergence, energy

/// Quadratic: each residual below a constant times the square of the one before, down to rounding. (Orders estimated
/// from three residuals scatter where one correction is lucky.) With friction the last one: before, points may still
/// switch between sticking and sliding. In bricks of 20 nodes some do so at the very last: they are looked at without.
#[test]
fn newton_converges_quadratically() {
    for formulation in ["hex8", "hex8_mean_volume", "hex8_mean_elongation", "hex20", "hex20r", "hex27"] {
        for (name, law) in [("elastic", ELASTIC), ("friction", FRICTION), ("pressure", PRESSURE)] {
            if formulation.starts_with("hex20") && name != "elastic" {
                continue;
            }
            let run = bent(formulation, law, 8);
            let mut worst = 0.0_f64;
            for row in &run.rows {
                println!("{formulation}, {name}: {}", scientific(&row.record.residuals));
                let pairs: Vec<f64> = row
                    .record
                    .residuals
                    .windows(2)
                    .filter(|p| p[0] < 0.01 && p[1] > 1e-12)
                    .map(|p| p[1] / (p[0] * p[0]))
                    .collect();
                let first = if name == "elastic" { 0 } else { pairs.len().saturating_sub(1) };
                worst = pairs[first..].iter().copied().fold(worst, f64::max);
            }
            println!("{formulation}, {name}: largest constant {worst:.1}");
            assert!(worst < 100.0, "{formulation}, {name}: constant {worst}");
        }
    }
}

fn imbalance(formulation: &str, law: &str, count: usize) -> f64 {
    bent(formulation, law, count).model.analysis.totals().energy_error().abs()
}

#[test]
fn energy_balances_with_second_order() {
    for formulation in ["hex8", "hex8_mean_elongation", "hex20r", "hex27"] {
        let errors = [10, 20, 40].map(|n| imbalance(formulation, ELASTIC, n));
        println!("{formulation}: {}", scientific(&errors));
        for pair in errors.windows(2) {
            let ratio = pair[0] / pair[1];
            assert!((3.5..4.6).contains(&ratio), "{formulation}: {errors:?}, ratio {ratio}");
        }
        assert!(errors[2] < 1e-3);
    }
    for law in [FRICTION, PRESSURE] {
        let errors = [10, 20, 40].map(|n| imbalance("hex8_mean_elongation", law, n));
        println!("with friction: {}", scientific(&errors));
        assert!(errors[1] < 0.6 * errors[0] && errors[2] < 0.6 * errors[1], "{errors:?}");
    }
}

#[test]
fn dissipation_never_decreases() {
    let steps = [bend("bend", 30.0, 6), bend("back", -20.0, 10), bend("again", 30.0, 10)].concat();
    for law in [FRICTION, PRESSURE] {
        for formulation in ["hex8", "hex8_mean_elongation"] {
            let run = run_scene(&strand(formulation, law, ENDS, &steps), None);
            let mut before = [0.0; 4];
            for row in &run.rows {
                let t = &row.totals;
                let now = [t.dissipated[0], t.dissipated[1], t.dissipated_mid[0], t.dissipated_mid[1]];
                for (a, b) in before.iter().zip(now) {
                    assert!(b >= *a, "{formulation}: dissipation falls from {before:?} to {now:?}");
                }
                before = now;
            }
            // Bending to and fro costs energy in both modes.
            assert!(before[0] > 0.0 && before[1] > 0.0, "{before:?}");
            println!(
                "{formulation}: dissipated {before:.4?}, energy error {:.1e}",
                run.model.analysis.totals().energy_error()
            );
        }
    }
}
