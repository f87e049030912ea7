//! The bending stiffness of rope-yarns in whole scenes: against the theory of beams, in the balance of energy.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use subrope::model::RopeModel;
use subrope::progress::Silent;
use subrope::run::{RunOptions, RunOutcome, run_scene};
use subrope::scene::Scene;
use tempfile::TempDir;

const YARNS: f64 = 10.0;
const EI: f64 = 20.0;
const LENGTH: f64 = 40.0;
const RADIUS: f64 = 2.0;
/// Shear modulus between rope-yarns \[MPa\], next to nothing.
const SHEAR: f64 = 1e-4;
const SHIFT: f64 = 0.05;

/// Straight rope-yarns between two rigid ends of which one is moved across; neither turns.
fn beam(formulation: &str, layers: usize) -> String {
    format!(
        r#"
title = "ten rope-yarns that slide freely"
[strand]
radius = {RADIUS}
length = {LENGTH}
surface_angle = 0.0
[strand.yarn_bending]
yarns = {YARNS}
stiffness = {EI}
[strand.mesh]
core = 2
rings = 1
layers = {layers}
[element]
formulation = "{formulation}"
[law]
kind = "bundle"
K_e = 2000.0
K_ec = 2000.0
K_c = 60.0
K_t = 15.0
K_l = {SHEAR}
friction = false
[[end]]
name = "END_A"
[[end]]
name = "END_B"
[[step]]
name = "shift"
increments = {{ fixed = 2 }}
prescribe = [
    {{ point = "END_A", ux = 0.0, uy = 0.0, uz = 0.0, rx = 0.0, ry = 0.0, rz = 0.0 }},
    {{ point = "END_B", ux = {SHIFT}, uy = 0.0, uz = "free", rx = 0.0, ry = 0.0, rz = 0.0 }},
]
"#
    )
}

/// Runs a scene with files, which are in the folder.
fn run_with_files(text: &str) -> (TempDir, RunOutcome) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, text).unwrap();
    let out = folder.path().join("out");
    let options = RunOptions { folder: Some(&out), threads: Some(1), ..RunOptions::default() };
    let outcome = run_scene(&path, options, &mut Silent).unwrap();
    (folder, outcome)
}

/// Force over that of as many beams side by side, 12 n EI u/L^3, with what is left of the shear between them,
/// K_l A u/L.
fn ratio(formulation: &str, layers: usize) -> f64 {
    let scene = Scene::from_toml("beam.toml", &beam(formulation, layers)).unwrap();
    let mut model = RopeModel::from_scene(&scene, None, Some(1)).unwrap();
    model.solve().unwrap();
    let point = model.analysis.model().kinematics.point_index("END_B").unwrap();
    let force = model.analysis.point_reaction(point).0.x;
    let area = std::f64::consts::PI * RADIUS * RADIUS;
    force / (SHIFT * (12.0 * YARNS * EI / LENGTH.powi(3) + SHEAR * area / LENGTH))
}

/// Of N edges with clamped ends the chain of turns has N^2/(N^2 + 2) of the stiffness of the beam: the exact solution of
/// the difference equations for small deflections.
#[test]
fn rope_yarns_that_slide_freely_bend_as_so_many_beams() {
    for layers in [10_u32, 20] {
        let square = f64::from(layers) * f64::from(layers);
        let ratio = ratio("hex8_mean_elongation", layers as usize);
        println!("{layers} layers: {ratio} of the beams");
        assert!((ratio * (square + 2.0) / square - 1.0).abs() < 1e-3, "{layers} layers: {ratio}");
    }
}

#[test]
fn rope_yarns_bend_in_quadratic_bricks_as_well() {
    for formulation in ["hex20", "hex27"] {
        let error = ratio(formulation, 10) - 1.0;
        println!("{formulation}: {error:.2e}");
        assert!(error.abs() < 2e-2, "{formulation}: {error:e}");
    }
}

/// Ten rope-yarns in a scene that has none.
const BENDING: &str = "[strand.yarn_bending]\nyarns = 10\nstiffness = 20.0\n[strand.mesh]";

/// A short strand that bends: set C without its hardening.
const BENT: &str = r#"
title = "short bent strand"
[strand]
radius = 2.785
length = 24.0
surface_angle = 30.0
[strand.mesh]
core = 2
rings = 1
layers = 12
lines = "yarns"
[law]
kind = "bundle"
K_e = 2000.0
K_ec = 100.0
w_e = 0.005
nu = 0.5
K_c = 60.0
K_t = 15.0
K_l = 20.0
tau_t = 0.05
tau_l = 1.0
[[end]]
name = "END_A"
[[end]]
name = "END_B"
[[step]]
name = "bend"
increments = { fixed = 40 }
[step.bend]
angle = 20.0
[output]
fields = ["displacement"]
"#;

#[test]
fn what_rope_yarns_store_is_in_the_balance() {
    let (_folder, with) = run_with_files(&BENT.replace("[strand.mesh]", BENDING));
    let (_other, without) = run_with_files(BENT);
    let (with, without) = (with.summary, without.summary);
    let stored = with.energies.stored_in_yarn_bending_mj.unwrap();
    println!("{stored} of {} mJ, balance off by {:e}", with.energies.stored_mj, with.energies.energy_error);
    assert!(stored > 0.0 && stored < with.energies.stored_mj);
    assert!(without.energies.stored_in_yarn_bending_mj.is_none());
    assert!(with.energies.energy_error.abs() < 2e-3, "{}", with.energies.energy_error);
}

/// Lines at 30 degrees that follow a bent rod have .83 n EI; that they are clamped at the ends of a short strand adds to it.
#[test]
fn rope_yarns_make_an_elastic_strand_stiffer_by_their_own() {
    let small = BENT.replace("angle = 20.0", "angle = 2.0").replace("fixed = 40", "fixed = 4");
    let elastic = small.replace("tau_t = 0.05\ntau_l = 1.0", "friction = false");
    let moment = |text: &str| {
        let summary = run_with_files(text).1.summary;
        summary.reference_points["END_A"].moment_n_mm.iter().map(|m| m * m).sum::<f64>().sqrt()
    };
    let curvature = 2.0 * 2.0_f64.to_radians() / 24.0;
    let more = (moment(&elastic.replace("[strand.mesh]", BENDING)) - moment(&elastic)) / (YARNS * EI * curvature);
    println!("moment more by {more} n EI kappa");
    assert!((0.83..1.3).contains(&more), "{more}");
}
