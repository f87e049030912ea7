//! Factors that serve more than one iterate: fewer factorisations, the same answer.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use subrope::plan::Plan;
use subrope_tests::{Run, relative, scene, try_run};

/// A strand thick enough for its factors to cost more than twenty solutions.
fn strand(law: &str, angle: f64, keep: bool) -> String {
    format!(
        r#"title = "thick strand"
[strand]
radius = 2.785
length = 12.0
surface_angle = 30.0
[strand.mesh]
core = 8
rings = 4
layers = 12
[element]
formulation = "hex8"
{law}
[[end]]
name = "END_A"
[[end]]
name = "END_B"
[[step]]
name = "bend"
increments = {{ fixed = 2 }}
[step.bend]
angle = {angle:?}
[solver]
keep_factors = {keep}
"#
    )
}

const ELASTIC: &str = "[law]\nkind = \"bundle\"\nK_e = 2000.0\nK_ec = 100.0\nw_e = 0.005\nnu = 0.5\nK_c = 60.0\n\
                       K_t = 15.0\nK_l = 20.0\nfriction = false\n";
const FRICTION: &str = "[law]\nkind = \"bundle\"\nK_e = 2000.0\nK_ec = 100.0\nw_e = 0.005\nnu = 0.5\nK_c = 60.0\n\
                        K_t = 15.0\nK_l = 20.0\ntau_t = 0.05\ntau_l = 1.0\nH_t = 0.1\nH_l = 0.3\nmu_t = 0.0\nmu_l = 0.0\n";
/// The same with a tangent that is not symmetric.
const PRESSURE: &str = "[law]\nkind = \"bundle\"\nK_e = 2000.0\nK_ec = 100.0\nw_e = 0.005\nnu = 0.5\nK_c = 60.0\n\
                        K_t = 15.0\nK_l = 20.0\ntau_t = 0.05\ntau_l = 1.0\nH_t = 0.1\nH_l = 0.3\nmu_t = 0.2\nmu_l = 0.2\n";

fn run(law: &str, angle: f64, keep: bool, threads: usize) -> Run {
    try_run(&strand(law, angle, keep), None, threads).unwrap().unwrap()
}

fn moment(run: &Run) -> f64 {
    run.model.analysis.point_reaction(run.point("END_B")).1.norm()
}

#[test]
fn fewer_factorisations_give_the_same_answer() {
    for (name, law, angle) in [("elastic", ELASTIC, 4.0), ("friction", FRICTION, 4.0), ("pressure", PRESSURE, 4.0)] {
        let [kept, renewed] = [true, false].map(|keep| run(law, angle, keep, 1));
        let counts = |run: &Run| *run.model.analysis.totals();
        let (with, without) = (counts(&kept), counts(&renewed));
        println!(
            "{name}: {} iterations with {} factorisations and {} of GMRES, {} with {}",
            with.iterations, with.factorisations, with.linear_iterations, without.iterations, without.factorisations
        );
        assert!(kept.model.analysis.keeps_factors() && !renewed.model.analysis.keeps_factors());
        // The plan says so.
        let plan = |run: &Run| Plan::new(&scene(&strand(law, angle, true)), &run.model).to_string();
        assert!(plan(&kept).contains("factors serve later iterations by GMRES"), "{}", plan(&kept));
        assert!(!plan(&renewed).contains("factors serve"), "{}", plan(&renewed));
        assert!(with.factorisations < without.factorisations, "{name}");
        assert!(with.iterations <= without.iterations + 3, "{name}");
        assert!(relative(moment(&kept), moment(&renewed)) < 1e-7, "{name}");
        for (a, b) in [(with.stored, without.stored), (with.external_work, without.external_work)] {
            assert!(relative(a, b) < 1e-7, "{name}: {a} against {b}");
        }
    }
}

#[test]
fn threads_do_not_change_a_bit() {
    let bits = |run: &Run| run.model.analysis.displacement().iter().map(|u| u.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&run(FRICTION, 4.0, true, 1)), bits(&run(FRICTION, 4.0, true, 2)));
}
