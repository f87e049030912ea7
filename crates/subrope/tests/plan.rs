//! The plan: what a scene uses, and that what it leaves out is not there.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::path::Path;

use subrope::model::{ModelError, RopeModel};
use subrope::plan::{Plan, PlanPart};
use subrope::scene::{BranchChoice, PathControl, Ramp, SceneFile, TrustRegion};

fn changed(scene: &str, change: impl Fn(&mut SceneFile)) -> SceneFile {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes").join(scene);
    let mut file = SceneFile::load(&path).unwrap();
    change(&mut file);
    file
}

fn plan(scene: &str, change: impl Fn(&mut SceneFile)) -> (Plan, RopeModel) {
    let file = changed(scene, change);
    let mut model = RopeModel::new(&file, Some(1)).unwrap();
    model.check_steps().unwrap();
    (Plan::new(&file.scene, &model), model)
}

fn part<'a>(plan: &'a Plan, name: &str) -> &'a PlanPart {
    plan.parts.iter().find(|p| p.part == name).unwrap()
}

fn leaves_out(plan: &Plan, name: &str, what: &str) -> bool {
    part(plan, name).leaves_out.iter().any(|l| l.what.contains(what) && !l.why.is_empty())
}

#[test]
fn an_elastic_strand_has_no_state_no_contact_and_half_a_matrix() {
    let (plan, model) = plan("bent_strand_elastic.toml", |_| {});
    assert!(leaves_out(&plan, "law", "state"), "{plan}");
    assert!(leaves_out(&plan, "contact", "search"), "{plan}");
    assert!(leaves_out(&plan, "solver", "GMRES"), "{plan}");
    assert_eq!(model.state_bytes_per_point(), 0);
    assert!(model.analysis.system().unwrap().is_symmetric());
    assert_eq!(model.analysis.model().contributions.len(), 1);
}

#[test]
fn rope_yarns_bend_where_the_scene_says_so() {
    let (without, model) = plan("strand_tension.toml", |_| {});
    assert!(leaves_out(&without, "yarns", "bending stiffness"), "{without}");
    let count = model.analysis.model().contributions.len();
    let (with, model) = plan("strand_tension.toml", |file| {
        let bending = subrope::scene::YarnBending { yarns: 10, stiffness: 20.0 };
        file.scene.strand.as_mut().unwrap().yarn_bending = Some(bending);
    });
    assert!(part(&with, "yarns").uses.contains("10 that bend with EI = 20 N mm^2"), "{with}");
    assert_eq!(model.analysis.model().contributions.len(), count + 1);
    assert!(model.analysis.system().unwrap().is_symmetric());
}

/// A scene that asks for minima has them or is refused, whatever takes the potential away.
#[test]
fn minima_without_a_potential_are_refused() {
    let always = |file: &mut SceneFile| file.scene.solver.trust_region = TrustRegion::Always;
    for scene in ["sub_rope_cycles.toml", "sub_rope_slice_cycles.toml"] {
        let refused = RopeModel::new(&changed(scene, always), Some(1));
        assert!(matches!(refused, Err(ModelError::NoPotential)), "{scene}");
    }
    assert!(RopeModel::new(&changed("bent_strand_coarse.toml", always), Some(1)).is_ok());
}

/// Paths have no corners, and where they fork only a symmetric tangent tells.
#[test]
fn paths_that_cannot_be_followed_are_refused() {
    let corner = changed("bent_strand_coarse.toml", |file| {
        let step = &mut file.scene.step[0];
        step.increments.control = Some(PathControl::ArcLength);
        step.bend.as_mut().unwrap().angle = Ramp::Path(vec![[0.5, 20.0], [1.0, 0.0]]);
    });
    let refused = RopeModel::new(&corner, Some(1)).err().unwrap();
    assert!(matches!(refused, ModelError::KnotOnArc { knot: 0.5, .. }), "{refused}");
    let switch = |file: &mut SceneFile| file.scene.solver.branch = BranchChoice::Switch;
    let refused = RopeModel::new(&changed("sub_rope_cycles.toml", switch), Some(1));
    assert!(matches!(refused, Err(ModelError::NoPivots)));
    let (plan, _) = plan("bent_strand_coarse.toml", |file| {
        switch(file);
        file.scene.step[0].increments.control = Some(PathControl::ArcLength);
    });
    assert_eq!(part(&plan, "steps").uses, "1 step, increments along the path");
    assert!(!leaves_out(&plan, "steps", "arc length") && !leaves_out(&plan, "steps", "branches"), "{plan}");
}

#[test]
fn state_and_system_follow_what_the_law_needs() {
    let (sliding, model) = plan("bent_strand_coarse.toml", |_| {});
    assert!(leaves_out(&sliding, "law", "back stress") && leaves_out(&sliding, "law", "pressure"), "{sliding}");
    let (rubbing, other) = plan("bent_strand_coarse.toml", |file| {
        if let subrope::scene::Law::Bundle(law) = &mut file.scene.law {
            law.mu_t = 0.2;
        }
    });
    assert!(!leaves_out(&rubbing, "law", "pressure"), "{rubbing}");
    assert!(part(&rubbing, "solver").uses.contains("GMRES"), "{rubbing}");
    // One number more, committed and trial.
    assert_eq!(other.state_bytes_per_point(), model.state_bytes_per_point() + 16);
}

#[test]
fn a_rope_without_friction_keeps_no_slip() {
    let (rubs, _) = plan("sub_rope_cycles.toml", |_| {});
    assert!(part(&rubs, "contact").uses.contains("3 pairs, penalty with friction"), "{rubs}");
    let (smooth, model) = plan("sub_rope_cycles.toml", |file| {
        file.scene.contact[0].friction = 0.0;
        if let subrope::scene::Law::Bundle(law) = &mut file.scene.law {
            (law.mu_t, law.mu_l) = (0.0, 0.0);
        }
    });
    assert!(leaves_out(&smooth, "contact", "slip"), "{smooth}");
    assert!(model.analysis.system().unwrap().is_symmetric());
}
