//! Ropes sized from their yarns, their mass or their diameter.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use subrope::model::RopeModel;
use subrope::scene::{Scene, SceneFile};
use subrope::sizing::RopeSizing;
use subrope_geometry::Quantity;

/// A rope with these keys and these tables behind.
fn text(keys: &str, tables: &str) -> String {
    format!(
        r#"title = "sized"
[rope]
length = 20.0
yarns = {{ surface_angle = 30.0 }}
mesh = {{ core = 2, rings = 1, layers = 8 }}
{keys}
{tables}
[element]
formulation = "hex8"
[law]
kind = "neo_hooke"
mu = 10.0
lambda = 10.0
[[end]]
name = "END_A"
[[end]]
name = "END_B"
[[step]]
name = "pull"
tension = {{ elongation = 0.01 }}
"#
    )
}

/// Civier, Bles, Davies, Marco (MARINE 2023), Table 1; coating and packing are assumed.
const TABLE_1: &str = "[rope.sizing]
filament_dtex = 6.7
filaments_per_yarn = 280
yarn_tex = 188.0
yarns_per_rope_yarn = 13
rope_yarns_per_strand = 10
density = 1140.0
coating = 0.08
packing = 0.8";

fn scene(keys: &str, tables: &str) -> Scene {
    Scene::from_toml("sized.toml", &text(keys, tables)).unwrap_or_else(|e| panic!("{}", e.plain()))
}

fn model(scene: &Scene) -> RopeModel {
    RopeModel::from_scene(scene, None, Some(1)).unwrap()
}

fn refused(keys: &str, tables: &str, fragments: &[&str]) {
    let Err(error) = Scene::from_toml("sized.toml", &text(keys, tables)) else { panic!("accepted: {keys} {tables}") };
    let answer = error.plain();
    for fragment in fragments {
        assert!(answer.contains(fragment), "{keys}: no {fragment:?} in\n{answer}");
    }
}

/// Radius and lay follow from Table 1: the mesh has the mass of the rope.
#[test]
fn a_rope_from_its_tex() {
    let scene = scene("linear_density = 90000.0", TABLE_1);
    let model = model(&scene);
    let rope = model.mesh.rope.as_ref().unwrap();
    assert!((rope.shape.lay_angle.to_degrees() - 18.3).abs() < 0.06, "{}", rope.shape.lay_angle);
    // 1 kg/m^3 on 1 mm^2 is 1 tex; the volume of a strand is its section times its arc length.
    let tex = 1140.0 * 0.8 * model.mesh.exact_volume().unwrap() / 20.0;
    assert!((tex / 90_000.0 - 1.0).abs() < 1e-9, "{tex}");
    let sizing = RopeSizing::of(&scene).unwrap();
    let diameter = sizing.report.value(Quantity::OuterDiameter).unwrap();
    assert!((diameter - 13.7).abs() < 0.02, "{diameter}");
    let thinner = 1.0 - rope.shape.outer_diameter / diameter;
    assert!(thinner > 0.0 && thinner < 0.03, "the smooth surfaces of a coarse mesh lie inside: {thinner}");
    assert!((scene.strand_radius().unwrap() - rope.strands[0].radius).abs() < 1e-15);
}

/// A diameter gives the radius when the lay is told, by angle or by length.
#[test]
fn a_rope_from_its_diameter() {
    for lay in ["lay_angle = 20.0", "lay_length = 80.0", "lay_angle = 0.0", "lay_angle = 20.0\ngap = 0.05"] {
        let model = model(&scene(&format!("outer_diameter = 12.0\n{lay}"), ""));
        let shape = &model.mesh.rope.as_ref().unwrap().shape;
        println!("{lay}: {} mm, {} degrees", shape.outer_diameter, shape.lay_angle.to_degrees());
        let thinner = 1.0 - shape.outer_diameter / 12.0;
        assert!(thinner > 0.0 && thinner < 0.03, "the smooth surfaces of a coarse mesh lie inside: {thinner}");
    }
}

/// Mass and lay length give radius and lay angle together.
#[test]
fn a_rope_from_mass_and_lay_length() {
    let scene = scene("linear_density = 90000.0\nlay_length = 80.0", "[rope.sizing]\ndensity = 1140.0\npacking = 0.8");
    let model = model(&scene);
    let tex = 1140.0 * 0.8 * model.mesh.exact_volume().unwrap() / 20.0;
    assert!((tex / 90_000.0 - 1.0).abs() < 1e-2, "{tex}");
    let shape = &model.mesh.rope.as_ref().unwrap().shape;
    let expected = RopeSizing::of(&scene).unwrap().lay_angle().unwrap();
    // The helix radius of the mesh is smaller by up to 4 %, and with it the angle.
    assert!((shape.lay_angle / expected - 0.98).abs() < 2e-2, "{} {expected}", shape.lay_angle);
}

#[test]
fn what_contradicts_is_told_with_its_keys() {
    let wrong = TABLE_1.replace("yarn_tex = 188.0", "yarn_tex = 200.0").replace("coating = 0.08", "coating = 0.0");
    let told = ["`yarn_tex` is 200 tex, but 187.6 tex by `filament_dtex`, `filaments_per_yarn`", "more than 2 % apart"];
    refused("linear_density = 90000.0", &wrong, &[&told[..], &["sized.toml:10:12"]].concat());
    let raised = format!("{wrong}\ntolerance = 0.1");
    assert!(RopeSizing::of(&scene("linear_density = 90000.0", &raised)).is_some());
    // The published diameter of 12 mm and mass would need more than solid strands.
    let no_packing = TABLE_1.replace("packing = 0.8", "");
    let keys = "linear_density = 90000.0\nouter_diameter = 12.0";
    refused(keys, &no_packing, &["`packing` would be 1.", "which is not between 0 and 1", "`outer_diameter`"]);
    // More coating and twist than mass.
    let heavy = TABLE_1.replace("coating = 0.08", "coating = 0.3");
    refused("linear_density = 90000.0", &heavy, &["no `lay_angle` fits", "`linear_density`", "contraction by twist"]);
    // A given radius and lay against a given diameter.
    let keys = "radius = 2.785\nlay_angle = 20.0\nouter_diameter = 14.0";
    refused(keys, "[rope.sizing]", &["`outer_diameter` is 14 mm, but 12.118 mm by `strands`, `lay_angle`, `radius`"]);
}

#[test]
fn what_lacks_is_told() {
    let keys = ["[rope] needs the key `radius`", "`outer_diameter` (touching circular strands)", "`linear_density`"];
    refused("lay_angle = 20.0", "", &keys);
    refused("linear_density = 90000.0", "[rope.sizing]\ndensity = 1140.0", &["needs the key `lay_angle`", "`packing`"]);
    refused("radius = 2.0", "", &["needs the key `lay_angle`", "`outer_diameter`"]);
    refused("radius = 2.0\nlay_angle = 20.0\nouter_diameter = 9.0", "", &["exclude each other"]);
    let core = "linear_density = 90000.0\ncore = { radius = 1.0, yarns = { surface_angle = 0.0 } }";
    refused(core, TABLE_1, &["not a core"]);
    refused("lay_angle = 20.0", "[rope.sizing]\nyarn_tx = 3.0", &["did you mean `yarn_tex`"]);
}

#[test]
fn a_rope_that_asks_for_no_sizing_has_none() {
    assert!(RopeSizing::of(&scene("radius = 2.785\nlay_angle = 20.0", "")).is_none());
}

#[test]
fn check_and_summary_report_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sized.toml");
    let short = text("linear_density = 90000.0", TABLE_1).replace("elongation = 0.01", "elongation = 0.0001");
    std::fs::write(&path, short).unwrap();
    let file = SceneFile::load(&path).unwrap();
    let report = subrope::check::check_scene(&file).unwrap().to_string();
    for line in [
        "linear_density 90000 tex, given",
        "radius 3.153",
        "told twice: yarn_tex 188 tex, 187.6 from filament_dtex, filaments_per_yarn (yarn = filaments)",
        "lay_angle 18.28",
        "(contraction by twist and coating)",
    ] {
        assert!(report.contains(line), "no {line:?} in\n{report}");
    }
    let summary = RopeSizing::of(&file.scene).unwrap().summary();
    let json = serde_json::to_value(&summary).unwrap();
    assert_eq!(json["quantities"]["linear_density"]["value"], 90_000.0);
    assert_eq!(json["quantities"]["lay_angle"]["unit"], "degrees");
    assert_eq!(json["quantities"]["radius"]["relation"], "solid area of the strands");
    assert_eq!(json["told_twice"][0]["quantity"], "yarn_tex");
}
