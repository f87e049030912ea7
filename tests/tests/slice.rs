//! The helical slice: one layer of one strand, whose images under a screw are a whole rope.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]
#![allow(clippy::panic, reason = "a test fails by panicking")]

use std::f64::consts::PI;

use nalgebra::{DVector, Rotation3, Vector3};
use subrope::model::RopeModel;
use subrope::scene::Scene;
use subrope_contact::{Contact, contacts};
use subrope_fem::analysis::{Analysis, Increments, Model, NewtonOptions, PathControl, Silent};
use subrope_fem::kinematics::{Image, Kinematics, NodeRule, Screw};
use subrope_fem::linear::{Method, SolverOptions};
use subrope_fem::{FemError, Repeated, Request};
use subrope_geometry::{
    Handedness, Lay, Mesh, MeshLines, Rope, RopeStrand, Section, Strand, StrandOrigin, fibre_frames,
};
use subrope_material::{FibreNeoHooke, Law, StVenantKirchhoff};
use subrope_tests::{
    Brick, Dense, Middle, Problem, Run, brick, close, relative, run_scene, run_with_files, scene, scene_file,
    scientific, short_rope,
};

// ------------------------------------------------------------------------------------------------------------ helpers

/// The same scene as a slice.
fn sliced(text: &str) -> String {
    assert!(text.contains("[rope]\n"));
    text.replace("[rope]\n", "[rope]\nsymmetry = \"helical\"\n")
}

/// Tension and torque.
fn load(run: &Run) -> [f64; 2] {
    let (force, moment) = run.model.analysis.point_reaction(run.point("END_B"));
    [force.z, moment.z]
}

/// A scene with some of its text replaced.
fn changed(text: &str, changes: &[(&str, &str)]) -> String {
    changes.iter().fold(text.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "the scene has no {from}");
        text.replace(from, to)
    })
}

/// The top of a layer as the image of its bottom.
fn tops(mesh: &Mesh, [low, high]: [&str; 2]) -> Vec<Image> {
    let pairs = mesh.node_sets[low].iter().zip(&mesh.node_sets[high]);
    pairs.map(|(&master, &node)| Image { node, master, turn: 0.0, layer: 1 }).collect()
}

/// Numbers without pattern between -1 and 1.
fn noise(n: usize) -> DVector<f64> {
    DVector::from_fn(n, |i, _| (12.9898 * (i as f64 + 1.0)).sin() * (78.233 * (i as f64 + 0.3)).cos())
}

// -------------------------------------------------------------------------------------------------------- derivatives

/// Residual against the potential and stiffness against the residual, by differences.
fn check_derivatives(name: &str, dense: &mut Dense, q: &DVector<f64>, h: f64) {
    let residual = dense.residual(q);
    let mut worst = 0.0_f64;
    for c in 0..q.len() {
        let mut at = |step: f64| {
            let mut moved = q.clone();
            moved[c] += step;
            dense.evaluate(&moved, Request::Residual).unwrap().1.potential
        };
        let slope = (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
        worst = worst.max((slope - residual[c]).abs() / residual.amax());
    }
    let (exact, differences) = (dense.stiffness(q), dense.differenced_stiffness(q, h));
    let error = (&exact - &differences).amax() / exact.amax();
    println!("{name}: residual off by {worst:.1e}, stiffness by {error:.1e}");
    assert!(worst < 1e-7 && error < 1e-7, "{name}: {worst:e}, {error:e}");
}

#[test]
fn residual_and_stiffness_of_images_are_derivatives() {
    let section = Section { core_cells: 2, rings: 1, ..Section::default() };
    for kind in [Brick::Plain, Brick::MeanElongation, Brick::Quadratic] {
        let outer = RopeStrand { section, ..RopeStrand::default() };
        let slice = Rope { outer, kind: kind.kind(), ..Rope::default() }.slice().unwrap();
        let frames = fibre_frames(&slice.mesh, &slice.strand.fibres()).unwrap();
        let solid = brick(kind, &slice.mesh, &frames, FibreNeoHooke::new(1.0, 1.0, 100.0).unwrap()).unwrap();
        let images = tops(&slice.mesh, ["END_A_1", "END_B_1"]);
        let screw = Screw { name: "screw".into(), angle: slice.angle, height: slice.height, share: 0.3, images };
        let kinematics = Kinematics::with_screw(slice.mesh.points.clone(), Vec::new(), screw).unwrap();
        let point = kinematics.points()[0].first as usize;
        let mut q = 0.01 * noise(kinematics.coordinate_count());
        (q[point + 2], q[point + 5]) = (0.2, 0.3);
        let mut dense = Dense::new(kinematics, Box::new(Repeated::new(solid, 7.0)));
        check_derivatives(&format!("{kind:?}"), &mut dense, &q, 1e-4);
    }
}

/// A strand pressed on the image of itself: both patches of a pair move with the same coordinates.
#[test]
fn residual_and_stiffness_of_contact_with_images_are_derivatives() {
    for n in [2, 3] {
        let step = "[[step]]\nname = \"pull\"\ntension = { elongation = 0.01 }\n";
        let text = changed(&sliced(&short_rope(step)), &[("friction = 0.15", "friction = 0.0\nramp = 0.0")]);
        let text = text.replace("[rope]\n", &format!("[rope]\nstrands = {n}\ngap = -0.02\n"));
        let model = RopeModel::from_scene(&scene(&text), None, Some(1)).unwrap();
        let Model { kinematics, mut contributions } = model.analysis.into_model();
        // The contact alone.
        contributions.remove(0);
        let point = kinematics.points()[0].first as usize;
        let mut q = 2e-3 * noise(kinematics.coordinate_count());
        (q[point + 2], q[point + 5]) = (0.05, 0.02);
        let mut dense = Dense::of(kinematics, contributions, q.as_slice());
        let energies = dense.evaluate(&q, Request::Residual).unwrap().1;
        assert!(energies.contact_stored > 0.0, "they touch");
        check_derivatives(&format!("{n} strands"), &mut dense, &q, 2e-6);
    }
}

#[test]
fn images_must_be_images_of_free_nodes() {
    let slice = Rope::default().slice().unwrap();
    let images = tops(&slice.mesh, ["END_A_1", "END_B_1"]);
    let screw = Screw { name: "screw".into(), angle: slice.angle, height: slice.height, share: 1.0, images };
    let refused = |screw: Screw| Kinematics::with_screw(slice.mesh.points.clone(), Vec::new(), screw).unwrap_err();
    let wrong = Screw { angle: 1.01 * slice.angle, ..screw.clone() };
    assert!(matches!(refused(wrong), FemError::NotAnImage { distance, .. } if distance > 1e-3));
    let mut chained = screw.clone();
    chained.images[0].master = chained.images[1].node;
    assert!(matches!(refused(chained), FemError::ImageOfTied { .. }));
    let mut twice = screw;
    twice.images.push(twice.images[0]);
    assert!(matches!(refused(twice), FemError::NodeTiedTwice { .. }));
}

// ---------------------------------------------------------------------------------------------------------- cylinders

/// One layer of a straight strand about z.
fn layer(strand: Strand, kind: Brick, law: impl Law + 'static) -> (Problem, Mesh) {
    let strand = Strand { layers: 1, kind: kind.kind(), origin: StrandOrigin::Bottom, ..strand };
    let mesh = strand.mesh().unwrap();
    let frames = fibre_frames(&mesh, &strand.fibres()).unwrap();
    let solid = brick(kind, &mesh, &frames, law).unwrap();
    let angle = if strand.lines == MeshLines::Yarns { strand.lay.rate() * strand.length } else { 0.0 };
    let images = tops(&mesh, ["END_A", "END_B"]);
    let screw = Screw { name: "screw".into(), angle, height: strand.length, share: 1.0, images };
    let kinematics = Kinematics::with_screw(mesh.points.clone(), Vec::new(), screw).unwrap();
    let options = NewtonOptions { force_tolerance: 1e-9, ..NewtonOptions::default() };
    let model = Model { kinematics, contributions: vec![solid] };
    (Problem { analysis: Analysis::new(model, options, SolverOptions::default(), 1) }, mesh)
}

/// Stretches and twists a layer; force, moment and energy.
fn stretch(problem: &mut Problem, mesh: &Mesh, extension: f64, twist: f64) -> [f64; 3] {
    let axis = mesh.node_sets["AXIS"][0];
    let x = |n: u32| mesh.points[n as usize].x;
    let outer = mesh.node_sets["END_A"].iter().copied().max_by(|&a, &b| x(a).total_cmp(&x(b))).unwrap();
    let increments =
        Increments::Automatic { control: PathControl::Load, initial: 0.5, minimum: 1e-3, maximum: 0.5, max_count: 100 };
    let mut step = problem.step(increments).hold(0, &[]).point(0, 2, extension).point(0, 5, twist);
    step = step.place(axis, &Vector3::zeros()).nodes(&[outer], 1, 0.0);
    let step = step.build();
    problem.analysis.check_held(&step).unwrap();
    let rows = problem.run(&step).unwrap();
    let row = rows.last().unwrap();
    // What is held carries nothing.
    for held in [axis, outer] {
        let NodeRule::Free { first } = problem.analysis.model().kinematics.rules()[held as usize] else { panic!() };
        let reactions = &problem.analysis.reactions()[first as usize..first as usize + 3];
        assert!(reactions.iter().all(|r| r.abs() < 1e-8 * row.reaction[0][0].z.abs().max(1.0)), "{reactions:?}");
    }
    [row.reaction[0][0].z, row.reaction[0][1].z, row.totals.stored]
}

/// Only motions that stay with the screw are left to name.
#[test]
fn free_motions_of_a_layer_are_named() {
    let lay = Lay::from_lay_length(27.0, Handedness::Right).unwrap();
    let law = || StVenantKirchhoff::isotropic(1000.0, 0.3).unwrap();
    for (lines, names) in [
        (MeshLines::Yarns, &["translation along z", "rotation about z"][..]),
        (MeshLines::Axis, &["translation along x", "translation along y", "translation along z", "rotation about z"]),
    ] {
        let (problem, _) = layer(Strand { length: 1.0, lay, lines, ..Strand::default() }, Brick::Plain, law());
        let step = problem.step(Increments::Fixed(1)).hold(0, &[]).build();
        let Err(FemError::RigidModes { count, motions, .. }) = problem.analysis.check_held(&step) else { panic!() };
        assert_eq!(count, names.len(), "{motions}");
        assert!(names.iter().all(|name| motions.contains(name)), "{motions}");
    }
}

/// `F = E A (l - 1)`, `M = G J twist` at small strain, whatever the height of the layer.
#[test]
fn an_isotropic_cylinder_is_a_rod() {
    let section = Section { core_cells: 6, rings: 3, ..Section::default() };
    for length in [0.3, 2.0] {
        let strand = Strand { radius: 2.5, length, section, ..Strand::default() };
        let law = StVenantKirchhoff::isotropic(1000.0, 0.3).unwrap();
        let (mut problem, mesh) = layer(strand, Brick::Quadratic, law);
        let [extension, twist] = [1e-5, 1e-5].map(|rate| rate * length);
        let [force, moment, energy] = stretch(&mut problem, &mesh, extension, twist);
        let (area, shear) = (PI * 2.5 * 2.5, 1000.0 / 2.6);
        close("force", force, 1000.0 * area * 1e-5, 2e-4);
        close("moment", moment, shear * PI * 2.5_f64.powi(4) / 2.0 * 1e-5, 2e-4);
        let work = 0.5 * (force * extension + moment * twist);
        close("energy", energy, work, 1e-4);
    }
}

/// The semi-analytic cylinder with helical fibres at finite stretch and twist, from one layer.
#[test]
fn a_helically_fibred_cylinder_needs_one_layer() {
    let cases = [
        ([1.01, 0.0], [190.179_784, 87.530_398]),
        ([1.05, 0.0], [1_013.010_338, 403.221_964]),
        ([1.0, -0.01], [-92.732_121, -93.187_814]),
        ([1.02, 0.02], [541.230_226, 314.425_376]),
    ];
    let law =
        r#"{ kind = "bundle", K_e = 2000.0, K_ec = 2000.0, K_c = 50.0, K_t = 20.0, K_l = 20.0, friction = false }"#;
    let text = changed(&short_rope("[[step]]\nname = \"x\"\ntension = { elongation = 0.0 }\n"), &[]);
    let start = text.find("[law]").unwrap();
    let end = text.find("[[end]]").unwrap();
    let text = format!("{}{}", &text[..start], &text[end..]).replace("[rope]\n", &format!("law = {law}\n[rope]\n"));
    let law = scene(&text).law;
    let section = Section { core_cells: 8, rings: 4, ..Section::default() };
    for lines in [MeshLines::Axis, MeshLines::Yarns] {
        for ([stretched, twist], [force, moment]) in cases {
            let length = 0.25;
            let lay = Lay::from_lay_length(27.206_990, Handedness::Right).unwrap();
            let strand = Strand { radius: 2.5, length, section, lay, lines, ..Strand::default() };
            let law = subrope::law::build(&law).unwrap();
            let (mut problem, mesh) = layer(strand, Brick::Quadratic, law);
            let [f, m, _] = stretch(&mut problem, &mesh, (stretched - 1.0) * length, twist * length);
            let errors = [relative(f, force), relative(m, moment)];
            println!("{lines:?}, {stretched}, {twist}: {}", scientific(&errors));
            assert!(errors.iter().all(|e| *e < 5e-3), "{errors:?}");
        }
    }
}

// ------------------------------------------------------------------------------------------------------ the whole rope

/// Three turns of an elastic rope of wires.
fn wires(strands: usize) -> String {
    // A little overlap at the start has wires touch from the first iteration on.
    let gap = if strands == 3 { 0.0 } else { -0.01 };
    changed(
        &scene_file("three_wire_rope.toml"),
        &[
            ("[rope]\n", &format!("[rope]\nstrands = {strands}\ngap = {gap:?}\n")),
            ("length = 68.0", "length = 204.0"),
            ("core = 4\nrings = 2\nlayers = 30", "core = 2\nrings = 1\nlayers = 90"),
            ("points = [12, 2]", "points = [16, 2]"),
            ("fixed = 4", "fixed = 2"),
        ],
    )
}

/// The scene of a slice that is stretched and twisted as the middle of a rope of the same length.
fn slice_of(text: &str, middle: &Middle, length: f64) -> String {
    let motion = format!("elongation = {:e}\ntwist = {:e}", middle.elongation, (middle.twist * length).to_degrees());
    changed(&sliced(text), &[("elongation = 0.004", &motion)])
}

/// The force between neighbours per length of strand.
fn line_loads(run: &Run, middle: &Middle, layers: usize) -> f64 {
    let contact: &Contact = contacts(&run.model.analysis).next().unwrap();
    let around = contact.secondary().patch_count() / layers;
    middle.line_load(contact, around)
}

#[test]
fn a_slice_is_the_middle_of_a_rope_of_wires() {
    for strands in [3, 2] {
        let text = wires(strands);
        let whole = run_scene(&text, None);
        let middle = Middle::of(&whole, 90, 30);
        let slice = run_scene(&slice_of(&text, &middle, 204.0), None);
        let ([f, m], [force, moment]) = (load(&slice), load(&whole));
        // The slice stands for the whole length, the middle for its part of it.
        let own = Middle { layers: [0, 1], axis_length: middle.axis_length / 30.0, ..middle };
        let (p, pressure) = (line_loads(&slice, &own, 1), line_loads(&whole, &middle, 90));
        let parts = [f / force, m / moment, p / pressure];
        println!(
            "{strands} strands, elongation {:.6}, twist {:.3e}: force, moment and line load of the slice are {} of \
             those of the rope ({force:.1} N, {moment:.1} N mm, {pressure:.3} N/mm)",
            middle.elongation,
            middle.twist,
            scientific(&parts.map(|x| x - 1.0))
        );
        assert!(parts.iter().all(|x| (x - 1.0).abs() < 0.01), "{parts:?}");
        let error = slice.model.analysis.totals().energy_error();
        assert!(error.abs() < 0.02, "energy {error:e}");
    }
}

/// What the rope of a length does is told per strand and pair, whatever the layers.
#[test]
fn totals_are_those_of_the_whole_length() {
    let step = "[[step]]\nname = \"pull\"\nincrements = { fixed = 16 }\ntension = { elongation = 0.02 }\n";
    let text = changed(&sliced(&short_rope(step)), &[("tau_l = 1.0\n", "tau_l = 1.0\nmu_t = 0.2\nmu_l = 0.1\n")]);
    let (_one, once) = run_with_files(&text);
    let twice = changed(&text, &[("length = 16.0", "length = 32.0"), ("layers = 10", "layers = 20")]);
    let (_two, twice) = run_with_files(&twice);
    let (a, b) = (once.summary, twice.summary);
    let (p, q) = (&a.reference_points["END_B"], &b.reference_points["END_B"]);
    close("force", q.force_n[2], p.force_n[2], 1e-9);
    close("torque", q.moment_n_mm[2], p.moment_n_mm[2], 1e-9);
    close("work", b.energies.external_work_mj, 2.0 * a.energies.external_work_mj, 1e-9);
    close("sliding", b.energies.dissipated_transverse_mj, 2.0 * a.energies.dissipated_transverse_mj, 1e-9);
    close("friction", b.energies.contact_friction_mj, 2.0 * a.energies.contact_friction_mj, 1e-9);
    close("pair", b.contacts[0].normal_force_n, 2.0 * a.contacts[0].normal_force_n, 1e-9);
    close("line load", b.line_loads[0].normal_n_per_mm, a.line_loads[0].normal_n_per_mm, 1e-9);
    // Three strands and three pairs make up the totals.
    close("strands", 3.0 * a.strands[0].stored_mj, a.energies.stored_mj, 1e-12);
    close(
        "sliding of strands",
        3.0 * a.strands[0].dissipated_transverse_mj,
        a.energies.dissipated_transverse_mj,
        1e-12,
    );
    close("force of strands", 3.0 * a.strands[0].force_n, p.force_n[2], 1e-12);
    close("friction of pairs", 3.0 * a.contacts[0].friction_work_mj, a.energies.contact_friction_mj, 0.2);
    let length = b.contacts[0].normal_force_n / b.line_loads[0].normal_n_per_mm;
    close("length of a strand", length, 32.0 / 20_f64.to_radians().cos(), 1e-3);
    let symmetry = a.symmetry.unwrap();
    assert_eq!((symmetry.kind, symmetry.strands, symmetry.layers), ("helical", 3, 10));
    println!("held: {:?} N of {} N", symmetry.held_reaction_n, p.force_n[2]);
    assert!(symmetry.held_reaction_n.iter().all(|r| r.abs() < 1e-6 * p.force_n[2]), "{:?}", symmetry.held_reaction_n);
    assert!(a.energies.energy_error.abs() < 0.01, "{:e}", a.energies.energy_error);
}

#[test]
fn cycles_of_a_slice_balance() {
    let steps = r#"
[[step]]
name = "pull"
increments = { initial = 0.02 }
tension = { elongation = 0.02 }
[[step]]
name = "cycle"
increments = { maximum = 0.1 }
cycles = { count = 2, low = 0.1, high = 1.0 }
[[step]]
name = "turn"
increments = { fixed = 5 }
tension = { force = 50.0, twist = "free" }
"#;
    let (folder, outcome) = run_with_files(&sliced(&short_rope(steps)));
    let rows = &outcome.summary.cycles;
    let error = outcome.summary.energies.energy_error;
    println!("{rows:?}, energy error {error:e}");
    assert!(error.abs() < 0.01 && rows.len() == 2);
    for row in rows {
        close("low", row.low_force_n, 0.1 * row.high_force_n, 1e-6);
        let lost = row.dissipated_transverse_mj + row.dissipated_longitudinal_mj + row.contact_friction_mj;
        assert!(row.hysteresis_mj > 0.0 && lost > 0.0);
    }
    let end = &outcome.summary.reference_points["END_B"];
    assert!(end.moment_n_mm[2].abs() < 1e-5 * end.force_n[2] && end.rotation_rad[2] < 0.0, "it unlays: {end:?}");
    close("force", end.force_n[2], 50.0, 1e-6);
    assert!(outcome.summary.counts.cutbacks <= 2, "{:?}", outcome.summary.counts);
    for file in ["results.vtkhdf", "history.csv", "cycles.csv", "line_load.csv", "summary.json"] {
        assert!(folder.path().join("out").join(file).is_file(), "{file}");
    }
}

/// Two rows of the tangent are dense: every way to solve copes with them.
#[test]
fn all_solvers_give_the_same() {
    let step = "[[step]]\nname = \"pull\"\ntension = { elongation = 0.01, twist = \"free\" }\n";
    let text = sliced(&short_rope(step)).replace("K_t = 15.0\n", "K_t = 15.0\nmu_t = 0.2\n");
    let usual = load(&run_scene(&text, None));
    for method in [Method::BlockLu, Method::SparseLu] {
        let built = RopeModel::from_scene(&scene(&text), None, Some(1)).unwrap();
        let options = SolverOptions { unsymmetric: Some(method), ..SolverOptions::default() };
        let steps = built.steps.clone();
        let mut analysis = Analysis::new(built.analysis.into_model(), NewtonOptions::default(), options, 1);
        steps.iter().for_each(|step| analysis.run_step(step, &mut Silent).unwrap());
        let (force, moment) = analysis.point_reaction(0);
        println!("{method:?}: {} N, {} N mm; usual {usual:?}", force.z, moment.z);
        close("force", force.z, usual[0], 1e-5);
        assert!(moment.z.abs() < 1e-4 * force.z && usual[1].abs() < 1e-4 * force.z);
    }
}

/// Every element, smoothing, method and section: the slice balances and pulls.
#[test]
fn all_elements_and_contacts_balance() {
    let step = "[[step]]\nname = \"pull\"\nincrements = { initial = 0.01 }\ntension = { elongation = 0.02 }\n";
    let text = changed(&sliced(&short_rope(step)), &[("tau_l = 1.0\n", "tau_l = 1.0\nmu_t = 0.2\nmu_l = 0.1\n")]);
    let points = "points = [8, 2]";
    for (from, to) in [
        ("[law]", "[element]\nformulation = \"hex27\"\n[law]"),
        ("[law]", "[element]\nformulation = \"hex8_mean_elongation\"\n[law]"),
        (points, "points = [8, 2]\nsmoothing = \"none\""),
        (points, "points = [8, 2]\nmethod = \"augmented\""),
        ("lay_angle = 20.0", "lay_angle = 20.0\ncompaction = 1.0"),
        ("lay_angle = 20.0", "lay_angle = 20.0\nstrands = 4"),
    ] {
        let (_folder, outcome) = run_with_files(&changed(&text, &[(from, to)]));
        let summary = outcome.summary;
        let (force, held) = (summary.reference_points["END_B"].force_n[2], summary.symmetry.unwrap().held_reaction_n);
        let error = summary.energies.energy_error;
        println!("{to:?}: {force} N, held {held:?} N, energy error {error:e}");
        assert!(force > 100.0 && summary.contacts[0].normal_force_n > 1.0);
        assert!(held.iter().all(|r| r.abs() < 1e-7 * force), "{held:?}");
        assert!(error.abs() < 5e-3, "{error:e}");
    }
}

/// A left-hand rope is the mirror of a right-hand one.
#[test]
fn hands_are_mirrors() {
    let step = "[[step]]\nname = \"pull\"\ntension = { elongation = 0.01, twist = TWIST }\n";
    let text = sliced(&short_rope(step));
    let right = load(&run_scene(&text.replace("TWIST", "2.0"), None));
    let left = text.replace("TWIST", "-2.0").replace("[rope]\n", "[rope]\nhand = \"left\"\n");
    let left = load(&run_scene(&left, None));
    println!("right {right:?}, left {left:?}");
    // A rope turned upside down shows its other neighbour: which of them carries the points of contact does not matter.
    close("force", left[0], right[0], 1e-7);
    close("torque", -left[1], right[1], 1e-7);
}

/// Fields of an image are turned back by what this says.
#[test]
fn images_stand_where_their_turn_says() {
    let step = "[[step]]\nname = \"pull\"\ntension = { elongation = 0.01, twist = 5.0 }\n";
    let run = run_scene(&sliced(&short_rope(step)), None);
    let (kinematics, q) = (&run.model.analysis.model().kinematics, run.model.analysis.coordinates());
    let turns: Vec<f64> = (0..kinematics.node_count()).filter_map(|n| kinematics.turn_of_image(n, q)).collect();
    assert_eq!(turns.len(), kinematics.screw().unwrap().images.len());
    let displacement = run.model.analysis.displacement();
    let now =
        |n: u32| kinematics.positions()[n as usize] + Vector3::from_column_slice(&displacement[3 * n as usize..][..3]);
    for (image, turn) in kinematics.screw().unwrap().images.iter().zip(&turns) {
        let turned = Rotation3::from_axis_angle(&Vector3::z_axis(), *turn) * now(image.master);
        assert!((turned - now(image.node)).xy().norm() < 1e-12, "{image:?}");
    }
}

// ----------------------------------------------------------------------------------------------------------- refusals

#[test]
fn what_breaks_the_symmetry_is_refused() {
    let good = sliced(&short_rope("[[step]]\nname = \"pull\"\ntension = { elongation = 0.01 }\n"));
    let _ = scene(&good);
    let refused = |from: &str, to: &str, fragments: &[&str]| {
        let text = changed(&good, &[(from, to)]);
        let Err(error) = Scene::from_toml("slice.toml", &text) else { panic!("accepted: {to}") };
        let told = error.plain();
        for fragment in fragments.iter().chain(&["slice.toml:", "help:"]) {
            assert!(told.contains(fragment), "{to}: no {fragment:?} in\n{told}");
        }
    };
    let step = "tension = { elongation = 0.01 }";
    refused(step, "bend = { angle = 10.0 }", &["bending breaks its symmetry", "the whole rope"]);
    refused(step, "tension = { elongation = 0.01, point = \"END_A\" }", &["moved by \"END_B\", not by \"END_A\""]);
    refused(step, "prescribe = [{ point = \"END_B\", ux = 1.0, uz = 1.0 }]", &["`ux` breaks the symmetry"]);
    refused(step, "prescribe = [{ point = \"END_B\", rx = \"free\", uz = 1.0 }]", &["`rx` breaks the symmetry"]);
    refused(step, "prescribe = [{ point = \"END_A\", rz = 1.0 }]", &["`rz` breaks the symmetry"]);
    let beside = |more: &str| format!("{step}\n{more}");
    let traction = "traction = [{ surface = \"LATERAL_1\", tx = 1.0 }]";
    refused(step, &beside(traction), &["a traction on a surface breaks the symmetry"]);
    let nodal = "nodal_force = [{ set = \"AXIS_1\", fx = 1.0 }]";
    refused(step, &beside(nodal), &["a force on some nodes breaks the symmetry"]);
    let across = "prescribe = [{ point = \"END_B\", ux = \"free\" }]\nforce = [{ point = \"END_B\", fx = 1.0 }]";
    refused(step, &beside(across), &["`fx` breaks the symmetry"]);
    let rigid = "[[rigid]]\nname = \"ROD\"\nshape = \"cylinder\"\npoint = [9.0, 0.0, 0.0]\naxis = [0.0, 1.0, 0.0]\n\
        radius = 2.0\n[[contact]]";
    refused("[[contact]]", rigid, &["a rigid body beside a rope"]);
    let named = "name = \"strands\"\nprimary = \"LATERAL_1\"\nsecondary = \"LATERAL_2\"";
    refused("name = \"strands\"", named, &["touches the image of itself"]);
    refused("[[contact]]", "[[contact]]\nname = \"more\"\n[[contact]]", &["one contact"]);
    refused("[[contact]]", "[solver]\nstabilisation = { viscosity = 1.0 }\n[[contact]]", &["dashpots"]);
    let constraint = "[[constraint]]\nname = \"c\"\nset = \"AXIS_1\"\ncomponents = { ux = 0.0 }\n[[contact]]";
    refused("[[contact]]", constraint, &["nodes held in a helical slice"]);
    refused("[rope]\n", "[rope]\ncore = { radius = 1.0, yarns = { surface_angle = 0.0 } }\n", &["has no core"]);
    refused("lay_angle = 20.0", "lay_angle = 0.0", &["have no screw"]);
    refused("name = \"END_B\"", "name = \"END_B\"\nset = \"END_B_1\"", &["not one of the whole rope"]);
    refused("name = \"END_A\"", "name = \"END_A\"\npoint = [1.0, 0.0, -8.0]", &["on the axis of the rope"]);
    refused("symmetry = \"helical\"", "symmetry = \"screw\"", &["helical"]);
}

// -------------------------------------------------------------------------------------------------------------- study

/// What the middle of a rope, or a slice, has done up to an increment.
#[derive(Clone, Copy, Debug, Default)]
struct State {
    fraction: f64,
    elongation: f64,
    /// Per length \[rad/mm\].
    twist: f64,
    force: f64,
    torque: f64,
    /// Per length of rope \[mJ/mm\]: stored, across, along, between strands.
    energies: [f64; 4],
    /// Per length of strand \[N/mm\].
    line_load: f64,
}

/// Cells, axis and length of the middle third of a rope, or of a slice.
struct Place {
    mesh: subrope::model::MeshModel,
    layers: [usize; 2],
    per_layer: usize,
}

impl Place {
    fn state(&self, analysis: &Analysis, fraction: f64) -> State {
        let (mesh, [low, high]) = (&self.mesh.mesh, self.layers);
        let strand = &self.mesh.rope.as_ref().unwrap().strands[0];
        let count = strand.layers;
        let axis = &mesh.node_sets["AXIS_1"];
        let moved = |level: usize| {
            let node = axis[level] as usize;
            mesh.points[node] + Vector3::from_column_slice(&analysis.displacement()[3 * node..3 * node + 3])
        };
        let turn = |level: usize| {
            let (a, b) = (moved(level), mesh.points[axis[level] as usize]);
            (b.x * a.y - b.y * a.x).atan2(b.x * a.x + b.y * a.y)
        };
        let height = |level: usize| mesh.points[axis[level] as usize].z;
        let length = height(high) - height(low);
        let inside = |layer: usize| (low..high).contains(&layer);
        let solid = analysis.model().contributions.iter().find_map(|c| c.fields()).unwrap();
        let mut energies = [0.0; 4];
        for cell in (0..solid.element_count()).filter(|c| inside(c / self.per_layer % count)) {
            let (stored, lost) = (solid.element_energies(cell).stored, solid.element_dissipation(cell));
            [stored, lost[0], lost[1]].iter().zip(&mut energies).for_each(|(e, sum)| *sum += e);
        }
        let mut normal = 0.0;
        for contact in contacts(analysis) {
            let faces = contact.secondary().patch_count() / count;
            for point in contact.points().filter(|p| inside(p.patch / faces)) {
                normal += point.area * point.state.pressure;
                energies[3] += point.area * point.state.work;
            }
        }
        let copies = self.mesh.slice.map_or(1.0, |slice| slice.strands as f64);
        let lines = contacts(analysis).count() as f64;
        let (force, moment) = analysis.point_reaction(analysis.model().kinematics.points().len() - 1);
        State {
            fraction,
            elongation: (moved(high).z - moved(low).z) / length - 1.0,
            twist: (turn(high) - turn(low)) / length,
            force: force.z,
            torque: moment.z,
            energies: energies.map(|e| copies * e / length),
            line_load: normal / lines / (length / self.lay_cosine()),
        }
    }

    /// Cosine of the lay angle: length of rope per length of strand.
    fn lay_cosine(&self) -> f64 {
        self.mesh.rope.as_ref().unwrap().shape.lay_angle.cos()
    }
}

/// Keeps the states of a run.
struct Watch {
    place: Place,
    states: Vec<State>,
    started: std::time::Instant,
}

impl subrope_fem::analysis::Observer for Watch {
    fn converged(
        &mut self,
        analysis: &Analysis,
        record: &subrope_fem::analysis::IncrementRecord,
    ) -> Result<subrope_fem::analysis::Control, FemError> {
        let state = self.place.state(analysis, record.fraction);
        println!("{:.1} s: {state:?}", self.started.elapsed().as_secs_f64());
        self.states.push(state);
        Ok(subrope_fem::analysis::Control::Continue)
    }
}

/// Runs a scene and watches the middle third, or the slice.
fn watch(text: &str) -> (Vec<State>, f64) {
    let scene = scene(text);
    let (mesh, _) = subrope::model::MeshModel::new(&scene, None).unwrap();
    let mut model = RopeModel::from_scene(&scene, None, Some(1)).unwrap();
    let layers = mesh.rope.as_ref().unwrap().strands[0].layers;
    let per_layer = mesh.rope.as_ref().unwrap().strands[0].section.cell_count();
    let third = if mesh.slice.is_some() { [0, 1] } else { [layers / 3, 2 * layers / 3] };
    let place = Place { mesh, layers: third, per_layer };
    let mut watch = Watch { place, states: Vec::new(), started: std::time::Instant::now() };
    for step in model.steps.clone() {
        model.analysis.run_step(&step, &mut watch).unwrap();
    }
    let seconds = watch.started.elapsed().as_secs_f64();
    (watch.states, seconds)
}

/// Runs three lay lengths of the sub-rope, and the slice along the path of elongation and twist of the middle one. The
/// strands overlap at rest by 3 % of their radius: a long rope of strands that just touch takes hundreds of small increments.
fn compare(mesh: &str, points: &str, length: f64, elongation: f64) -> Vec<f64> {
    let text = changed(
        &scene_file("sub_rope_tension.toml"),
        &[
            ("length = 60.0 ", &format!("length = {length:?} ")),
            ("core = 4\nrings = 2\nlayers = 50", mesh),
            ("elongation = 0.05", &format!("elongation = {elongation:?}")),
            ("points = [4, 2]", points),
            ("initial = 0.0015", "initial = 0.02"),
            ("lay_angle = 20.0", "gap = -0.03\nlay_angle = 20.0"),
        ],
    );
    let (whole, slow) = watch(&text);
    let path = |of: &dyn Fn(&State) -> f64| {
        let knots: Vec<String> = whole.iter().map(|s| format!("[{:e}, {:e}]", s.fraction, of(s))).collect();
        format!("[{}]", knots.join(", "))
    };
    let motion =
        format!("elongation = {}\ntwist = {}", path(&|s| s.elongation), path(&|s| (s.twist * length).to_degrees()));
    let text = changed(
        &sliced(&text),
        &[(&format!("elongation = {elongation:?}"), &motion), ("initial = 0.02, maximum = 0.1", "initial = 1.0")],
    );
    let (slice, fast) = watch(&text);
    let (a, b) = (whole.last().unwrap(), slice.last().unwrap());
    println!("{slow:.1} s and {fast:.2} s, 1/{:.0}\nrope  {a:?}\nslice {b:?}", slow / fast);
    let pairs = [(b.force, a.force), (b.torque, a.torque), (b.line_load, a.line_load)];
    let energies = b.energies.into_iter().zip(a.energies);
    let off: Vec<f64> = pairs.into_iter().chain(energies).map(|(x, y)| x / y - 1.0).collect();
    println!("force, torque, line load, stored, across, along, between strands off by {}", scientific(&off));
    off
}

/// Three lay lengths of the sub-rope against the slice.
#[test]
#[ignore = "a quarter of an hour"]
fn a_slice_is_the_middle_of_a_sub_rope() {
    let off = compare("core = 4\nrings = 2\nlayers = 141", "points = [4, 2]", 168.4, 0.02);
    assert!(off.iter().all(|x| x.abs() < 0.01), "{off:?}");
}

/// The same on a coarse mesh.
#[test]
#[ignore = "a minute or two"]
fn a_slice_is_the_middle_of_a_coarse_sub_rope() {
    let off = compare("core = 2\nrings = 2\nlayers = 90", "points = [8, 2]", 168.4, 0.02);
    assert!(off.iter().all(|x| x.abs() < 0.005), "{off:?}");
}
