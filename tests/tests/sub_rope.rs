//! Three strands in contact, from a scene.

use nalgebra::{Rotation3, Vector3};
use subrope_contact::{Contact, contacts};
use subrope_fem::FemError;
use subrope_tests::{run_scene, short_rope};

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
