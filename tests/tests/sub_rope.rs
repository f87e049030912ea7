//! Three strands in contact, from a scene.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::f64::consts::PI;

use nalgebra::{Rotation3, Vector3};

use subrope_contact::{Contact, contacts};
use subrope_fem::FemError;
use subrope_fem::analysis::Increments;
use subrope_tests::{Problem, close, run_scene, short_rope};

/// Stretched by 1 % with friction.
fn pulled(increments: usize) -> String {
    short_rope(&format!(
        "[[step]]\nname = \"pull\"\nincrements = {{ fixed = {increments} }}\ntension = {{ elongation = 0.01 }}\n"
    ))
}

#[test]
fn strands_share_alike_and_energy_balances() {
    let run = run_scene(&pulled(10), None);
    let reactions = run.model.analysis.nodal_reactions();
    let share = |strand: usize| -> f64 {
        let nodes = &run.model.mesh.mesh.node_sets[&format!("END_B_{strand}")];
        nodes.iter().map(|&n| reactions[3 * n as usize + 2]).sum()
    };
    let shares = [share(1), share(2), share(3)];
    println!("shares {shares:?} N, energy error {:e}", run.model.analysis.totals().energy_error());
    assert!(shares[0] > 1.0, "it resists");
    assert!(shares.iter().all(|s| (s / shares[0] - 1.0).abs() < 1e-6), "images of each other: {shares:?}");
    let coarser = run_scene(&pulled(5), None).model.analysis.totals().energy_error().abs();
    let error = run.model.analysis.totals().energy_error().abs();
    println!("energy error {coarser:e} in 5 increments, {error:e} in 10");
    assert!(error < 1e-2 && error < 0.5 * coarser, "{coarser:e} {error:e}");
    let totals = run.model.analysis.totals();
    assert!(totals.contact_friction > 0.0 && totals.contact_stored > 0.0);
    let reports: Vec<_> = contacts(&run.model.analysis).map(Contact::report).collect();
    assert_eq!(reports.len(), 3);
    for report in &reports {
        assert!(report.touching > 0 && (report.normal / reports[0].normal - 1.0).abs() < 1e-6, "{reports:?}");
        assert!(report.friction <= 0.15 * report.normal * (1.0 + 1e-12), "Coulomb's limit: {report:?}");
        assert!(report.penetration < 0.005 * 2.785, "{report:?}");
    }
}

/// A rope that is stretched, then bent, so that no symmetry makes the sides of a contact equal: force and moment on its
/// end, work of friction between the strands.
fn bent(pairs: [[usize; 2]; 3]) -> [f64; 3] {
    let pair = |[primary, secondary]: [usize; 2]| {
        format!(
            "[[contact]]\nname = \"{primary}{secondary}\"\nprimary = \"LATERAL_{primary}\"\n\
             secondary = \"LATERAL_{secondary}\"\nfriction = 0.15\npoints = [16, 4]\n"
        )
    };
    let steps = r#"
[[step]]
name = "pull"
increments = { fixed = 5 }
tension = { elongation = 0.01 }
[[step]]
name = "bend"
increments = { fixed = 6 }
prescribe = [{ point = "END_B", rx = 4.0, uy = -0.3 }]
"#;
    let text = short_rope(steps);
    let start = text.find("[[contact]]").unwrap();
    let end = text.find("[[step]]").unwrap();
    let text = format!("{}{}{}", &text[..start], pairs.map(pair).concat(), &text[end..]);
    let run = run_scene(&text, None);
    let (force, moment) = run.model.analysis.point_reaction(run.point("END_B"));
    [force.norm(), moment.norm(), run.model.analysis.totals().contact_friction]
}

#[test]
fn primary_and_secondary_exchanged_tell_the_same() {
    let [one, other] = [bent([[1, 2], [2, 3], [3, 1]]), bent([[2, 1], [3, 2], [1, 3]])];
    println!("force, moment, friction work {one:?}; exchanged {other:?}");
    assert!(one[2] > 1.0, "strands slide");
    for (what, (a, b)) in ["force", "moment", "friction work"].iter().zip(one.iter().zip(other)) {
        close(what, *a, b, 0.01);
    }
}

/// A stretched rope, turned by a right angle and carried away.
#[test]
fn a_rigid_motion_of_a_rope_slips_nothing() {
    // So tight that the next increment finds nothing left to settle.
    let run = run_scene(&format!("{}[solver]\nresidual_tolerance = 1e-13\n", pulled(5)), None);
    let ends = ["END_A", "END_B"].map(|name| run.point(name));
    let mut problem = Problem { analysis: run.model.analysis };
    let places: Vec<[Vector3<f64>; 2]> = ends
        .iter()
        .map(|&end| {
            let kinematics = &problem.analysis.model().kinematics;
            let moved: [Vector3<f64>; 2] = kinematics.point_motion(end, problem.analysis.coordinates()).into();
            [kinematics.points()[end].position, moved[0]]
        })
        .collect();
    let before = *problem.analysis.totals();
    let axis = Vector3::new(0.3, -0.8, 0.5).normalize();
    let (centre, way) = (Vector3::new(3.0, -2.0, 5.0), Vector3::new(10.0, 20.0, -10.0));
    let mut step = problem.step(Increments::Fixed(20));
    for (&end, &[place, moved]) in ends.iter().zip(&places) {
        for k in 0..3 {
            step = step
                .point_path(end, k, move |s| {
                    let turn = Rotation3::from_scaled_axis(axis * (s * 0.5 * PI));
                    (turn * (place + moved - centre) + centre + way * s - place)[k as usize]
                })
                .point_path(end, 3 + k, move |s| axis[k as usize] * (s * 0.5 * PI));
        }
    }
    let step = step.build();
    let rows = problem.run(&step).unwrap();
    let after = *problem.analysis.totals();
    println!(
        "friction {} and {:e} more, stored {} and {:e} more; iterations {:?}",
        before.contact_friction,
        after.contact_friction - before.contact_friction,
        before.stored,
        after.stored - before.stored,
        rows.iter().map(|r| r.record.iterations).collect::<Vec<_>>()
    );
    assert!(before.contact_friction > 1e-3);
    close("friction", after.contact_friction, before.contact_friction, 1e-9);
    close("stored", after.stored, before.stored, 1e-9);
}

/// Multipliers press down the penetration to what is asked for, and to where penalties lead.
#[test]
fn an_augmented_lagrangian_is_the_limit_of_penalties() {
    let pull = "[[step]]\nname = \"pull\"\nincrements = { fixed = 5 }\ntension = { elongation = 0.01 }\n";
    let with = |method: &str| {
        let text = short_rope(pull).replace("friction = 0.15", &format!("friction = 0.0\n{method}"));
        let run = run_scene(&text, None);
        let deepest = contacts(&run.model.analysis).map(|c| c.report().penetration).fold(0.0, f64::max);
        let (force, moment) = run.model.analysis.point_reaction(run.point("END_B"));
        println!("{method}: F {} M {} penetration {deepest}", force.z, moment.z);
        [force.z, moment.z, deepest]
    };
    let [soft, hard] = ["penalty = 4000.0", "penalty = 8000.0"].map(with);
    for penetration in [1e-3, 1e-4] {
        let multiplied = with(&format!("method = \"augmented\"\npenetration = {penetration}\npenalty = 1000.0"));
        assert!(multiplied[2] <= penetration * 2.785, "penetration {}", multiplied[2]);
        for k in 0..2 {
            // Errors fall with one over the penalty.
            let limit = 2.0 * hard[k] - soft[k];
            close("limit of penalties", multiplied[k], limit, 5.0 * penetration);
        }
    }
}

/// Displacement of a node \[mm\].
fn moved(run: &subrope_tests::Run, node: usize) -> Vector3<f64> {
    Vector3::from_column_slice(&run.model.analysis.displacement()[3 * node..3 * node + 3])
}

#[test]
fn strands_slide_inwards_at_sliding_ends() {
    let sliding = pulled(10).replace("name = \"END_A\"", "name = \"END_A\"\nkind = \"sliding\"");
    let run = run_scene(&sliding.replace("name = \"END_B\"", "name = \"END_B\"\nkind = \"sliding\""), None);
    let analysis = &run.model.analysis;
    let mesh = &run.model.mesh.mesh;
    // Three strands are images of each other under 120 degrees, displacements too.
    let n = mesh.point_count() / 3;
    let largest = (0..n).map(|node| moved(&run, node).norm()).fold(0.0, f64::max);
    let mut worst: f64 = 0.0;
    for strand in 1..3 {
        let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), std::f64::consts::TAU * strand as f64 / 3.0);
        for node in 0..n {
            worst = worst.max((moved(&run, strand * n + node) - turn * moved(&run, node)).norm());
        }
    }
    println!("largest displacement {largest} mm, off symmetry by {worst:e} mm");
    assert!(worst < 1e-6 * largest, "off symmetry by {worst:e} mm");
    // At both ends every strand goes inwards as a whole, and nothing pushes it there.
    let kinematics = &analysis.model().kinematics;
    for point in kinematics.points() {
        assert_eq!(point.slides.len(), 3);
        for (strand, &c) in point.slides.iter().enumerate() {
            let slide = analysis.coordinates()[c as usize];
            println!("{} strand {}: {slide} mm", point.name, strand + 1);
            assert!(slide < -1e-4, "{slide}");
            assert!(analysis.reactions()[c as usize].abs() < 1e-12, "{}", analysis.reactions()[c as usize]);
            let nodes = &mesh.node_sets[&format!("{}_{}", point.name, strand + 1)];
            let mean: Vector3<f64> = nodes.iter().map(|&node| moved(&run, node as usize)).sum::<Vector3<f64>>();
            let mean = mean / nodes.len() as f64;
            let radius = run.model.mesh.centroid(nodes).xy().normalize();
            assert!((mean.xy() - radius * slide).norm() < 1e-12, "{mean} {slide}");
            for &node in nodes {
                assert!((moved(&run, node as usize) - mean).norm() < 1e-12, "not as one body");
            }
        }
    }
    let rigid = run_scene(&pulled(10), None);
    let force = |run: &subrope_tests::Run| run.model.analysis.point_reaction(1).0.z;
    println!("force {} N, with rigid ends {} N", force(&run), force(&rigid));
    assert!(force(&run) < force(&rigid));
    assert!(analysis.totals().energy_error().abs() < 1e-2);
}

#[test]
fn a_strand_that_slides_along_one_line_is_told() {
    let straight = pulled(1).replace("lay_angle = 20.0", "lay_angle = 0.0\ngap = 0.5");
    let sliding = straight.replace("[[end]]\nname", "[[end]]\nkind = \"sliding\"\nname");
    let mut model = subrope::model::RopeModel::from_scene(&subrope_tests::scene(&sliding), None, Some(1)).unwrap();
    let Err(subrope::run::RunError::Solver { cause, .. }) = model.check_steps() else { panic!("not told") };
    let FemError::RigidModes { count: 3, motions, .. } = &*cause else { panic!("{cause}") };
    assert!(motions.contains("part 1 of section") && motions.contains("sliding along x"), "{motions}");
    // The same with laid strands, or with one rigid end, is held.
    for held in
        [sliding.replace("lay_angle = 0.0", "lay_angle = 20.0"), sliding.replacen("kind = \"sliding\"\n", "", 1)]
    {
        let scene = subrope_tests::scene(&held);
        subrope::model::RopeModel::from_scene(&scene, None, Some(1)).unwrap().check_steps().unwrap();
    }
}
