//! A program built without contact: scenes with it are refused with their place, all others run.
#![cfg(not(feature = "contact"))]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use std::path::Path;

use subrope::model::{ModelError, RopeModel};
use subrope::plan::Plan;
use subrope::scene::{Scene, SceneError, SceneFile};

const STRAND: &str = r#"title = "A strand in tension"
[strand]
radius = 2.785
length = 20.0
surface_angle = 30.0
mesh = { core = 2, rings = 1, layers = 4 }
[law]
kind = "bundle"
K_e = 2000.0
K_ec = 100.0
K_c = 60.0
K_t = 15.0
K_l = 20.0
friction = false
[[end]]
name = "END_A"
[[end]]
name = "END_B"
[[step]]
name = "pull"
tension = { elongation = 0.01 }
"#;

#[test]
fn a_scene_with_contact_is_refused_with_its_line_and_the_feature() {
    for name in ["sub_rope_tension", "sub_rope_slice"] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../scenes/{name}.toml"));
        let text = std::fs::read_to_string(&path).unwrap();
        let line = 1 + text.lines().position(|l| l == "[[contact]]").unwrap();
        let Err(error @ SceneError::Invalid(_)) = SceneFile::load(&path) else { panic!("{name} is accepted") };
        let answer = error.plain();
        assert!(answer.contains(&format!("{name}.toml:{line}:")), "{answer}");
        assert!(answer.contains("built without the feature `contact`"), "{answer}");
        assert!(answer.contains("--features contact"), "{answer}");
    }
}

#[test]
fn a_scene_without_contact_runs_and_its_plan_says_so() {
    let scene = Scene::from_toml("strand.toml", STRAND).unwrap();
    let mut model = RopeModel::from_scene(&scene, None, Some(1)).unwrap();
    model.check_steps().unwrap();
    assert!(Plan::new(&scene, &model).to_string().contains("built without the feature `contact`"));
    model.solve().unwrap();
    assert!(model.analysis.point_reaction(1).0.z > 0.0);
}

#[test]
fn a_scene_made_in_memory_is_refused_by_its_model() {
    let mut scene = Scene::from_toml("strand.toml", STRAND).unwrap();
    scene.contact.push(toml::from_str("name = \"rubs\"\nprimary = \"ROD\"\nsecondary = \"LATERAL\"").unwrap());
    assert!(matches!(RopeModel::from_scene(&scene, None, Some(1)), Err(ModelError::Contact(_))));
}
