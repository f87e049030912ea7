//! Three strands in contact, from a scene.

use subrope_contact::Contact;
use subrope_tests::{run_scene, short_rope};

/// Stretched by 1 % with friction.
fn pulled(increments: usize) -> String {
    short_rope(&format!(
        "[[step]]\nname = \"pull\"\nincrements = {{ fixed = {increments} }}\ntension = {{ elongation = 0.01 }}\n"
    ))
}

fn contacts(run: &subrope_tests::Run) -> impl Iterator<Item = &Contact> {
    run.model.analysis.model().contributions.iter().filter_map(|c| c.as_any()?.downcast_ref::<Contact>())
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
    let reports: Vec<_> = contacts(&run).map(Contact::report).collect();
    assert_eq!(reports.len(), 3);
    for report in &reports {
        assert!(report.touching > 0 && (report.normal / reports[0].normal - 1.0).abs() < 1e-6, "{reports:?}");
        assert!(report.friction <= 0.15 * report.normal * (1.0 + 1e-12), "Coulomb's limit: {report:?}");
        assert!(report.penetration < 0.005 * 2.785, "{report:?}");
    }
}
