//! A strand of 300 plain bricks against the numbers of an independent kernel, increment by increment.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::path::{Path, PathBuf};

use nalgebra::Vector3;
use serde_json::Value;
use subrope_tests::{Row, Worst, relative, run_scene};

const RADIUS: f64 = 2.785;
const LENGTH: f64 = 60.0;
const TOLERANCE: f64 = 1e-8;

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/strand_300").join(name)
}

fn case(name: &str) -> Value {
    let all: Value = serde_json::from_str(&std::fs::read_to_string(data("strand_300.json")).unwrap()).unwrap();
    all[name].clone()
}

fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or_else(|| panic!("no number {key}"))
}

fn vector(value: &Value, key: &str) -> Vector3<f64> {
    Vector3::from_fn(|k, _| value[key][k].as_f64().unwrap())
}

fn law(params: &Value) -> String {
    let mut text = String::from("[law]\nkind = \"bundle\"\n");
    let mut put = |key: &str, name: &str| text += &format!("{key} = {:?}\n", number(params, name));
    for key in ["K_e", "K_ec", "w_e", "nu", "K_c", "K_t", "K_l"] {
        put(key, key);
    }
    if number(params, "friction") == 0.0 {
        return text + "friction = false\n";
    }
    let pairs =
        [("tau_t", "tau_t0"), ("tau_l", "tau_l0"), ("H_t", "H_t"), ("H_l", "H_l"), ("mu_t", "mu_t"), ("mu_l", "mu_l")];
    pairs.iter().for_each(|(key, name)| put(key, name));
    text
}

fn motion(case: &Value) -> String {
    match case.get("eps") {
        Some(eps) => {
            let (uz, rz) = (eps.as_f64().unwrap() * LENGTH, number(case, "twist").to_degrees());
            format!("[[step.prescribe]]\npoint = \"END_B\"\nuz = {uz:?}\nrz = {rz:?}\n")
        }
        None => {
            let angle = number(case["steps"].as_array().unwrap().last().unwrap(), "theta").to_degrees();
            format!("[step.bend]\nangle = {angle:?}\nends = \"free\"\nlength = {LENGTH:?}\n")
        }
    }
}

fn scene(case: &Value) -> String {
    format!(
        r#"title = "strand of 300 bricks"
[deck]
file = "strand_300.inp"
fibres = {{ helix = {{ angle = 30.0, radius = {RADIUS:?} }} }}
[element]
formulation = "hex8"
{}
[[end]]
name = "END_A"
[[end]]
name = "END_B"
[[step]]
name = "load"
increments = {{ fixed = {} }}
{}
[solver]
residual_tolerance = 1e-11
"#,
        law(&case["params"]),
        case["steps"].as_array().unwrap().len(),
        motion(case)
    )
}

/// Deviation of a vector over its norm, with a floor under that.
fn deviation(value: Vector3<f64>, reference: Vector3<f64>, floor: f64) -> f64 {
    (value - reference).norm() / reference.norm().max(floor)
}

fn compare(row: &Row, step: &Value, worst: &mut Worst) {
    let bends = step.get("M_A").is_some();
    let [end, force, moment] = if bends { ["0", "F_A", "M_A"] } else { ["1", "F", "M"] };
    let [f, m] = row.reaction[end.parse::<usize>().unwrap()];
    let (force, moment) = (vector(step, force), vector(step, moment));
    // A deviation of 1e-9 of moment/R passes, however small the force is.
    let floor = 0.1 * moment.norm() / RADIUS;
    worst.see("force", deviation(f, force, floor));
    worst.see("moment", deviation(m, moment, floor * RADIUS));
    worst.see("W", relative(row.totals.stored, number(step, "W")));
    for (name, value, key) in [("Dt", row.totals.dissipated[0], "Dt"), ("Dl", row.totals.dissipated[1], "Dl")] {
        let reference = number(step, key);
        worst.see(name, if reference == 0.0 { value.abs() } else { relative(value, reference) });
    }
    if bends {
        let centre = Vector3::new(0.0, 0.0, 0.5 * LENGTH) + row.motion[1][0];
        worst.see("centre", deviation(centre, vector(step, "centre_B"), 1.0));
    }
}

fn check(name: &str) {
    let case = case(name);
    let run = run_scene(&scene(&case), Some(&data("strand_300.inp")));
    let steps = case["steps"].as_array().unwrap();
    assert_eq!(run.rows.len(), steps.len());
    let mut worst = Worst::default();
    for (row, step) in run.rows.iter().zip(steps) {
        compare(row, step, &mut worst);
    }
    println!("{name}: {worst}");
    assert!(worst.largest() <= TOLERANCE, "{name}: {worst}");
}

#[test]
fn tension_elastic() {
    check("tension_elastic_m300");
}

#[test]
fn tension_with_friction() {
    check("tension_friction_m300");
}

#[test]
fn bending_elastic() {
    check("bend_elastic_m300");
}

#[test]
fn bending_with_friction_to_20_degrees() {
    check("bend_friction_m300_20deg");
}

#[test]
fn bending_with_friction_to_90_degrees() {
    check("bend_frictionS_m300_90deg");
}
