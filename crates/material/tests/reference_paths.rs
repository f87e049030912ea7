//! The bundle law against 205 steps computed with 90-digit arithmetic (`data/law/README.md`).

#![allow(clippy::unwrap_used, clippy::print_stdout)]

use nalgebra::{Matrix3, Matrix6, Vector6};
use serde_json::Value;
use subrope_material::{
    BundleLaw, BundleParameters, Compaction, Friction, Law, ModeParameters, PointInput, Request, Response, mandel,
};

/// Accepted error relative to the largest entry of a tensor, and in MPa where everything is tiny.
const RELATIVE: f64 = 1e-9;
const ABSOLUTE: f64 = 1e-12;

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

fn matrix(value: &Value) -> Matrix3<f64> {
    let rows: Vec<f64> = value.as_array().unwrap().iter().flat_map(numbers).collect();
    Matrix3::from_row_slice(&rows)
}

fn mode(parameters: &Value, suffix: &str) -> ModeParameters {
    let number = |name: &str| parameters[format!("{name}_{suffix}")].as_f64().unwrap();
    let friction = Friction {
        mu: number("mu"),
        ..Friction::isotropic(parameters[format!("tau_{suffix}0")].as_f64().unwrap(), number("H"))
    };
    ModeParameters { k: number("K"), friction: (parameters["friction"] != 0.0).then_some(friction) }
}

fn law(parameters: &Value) -> BundleLaw {
    let number = |name: &str| parameters[name].as_f64().unwrap();
    let compaction = match number("comp_type") as i32 {
        0 => Compaction::Quadratic,
        1 => Compaction::Power { k_p: number("K_p"), m: number("p_exp") },
        _ => Compaction::LockUp { z_lock: number("z_lock") },
    };
    BundleLaw::new(BundleParameters {
        k_e: number("K_e"),
        k_ec: number("K_ec"),
        w_e: number("w_e"),
        k_c: number("K_c"),
        nu: number("nu"),
        compaction,
        transverse: mode(parameters, "t"),
        longitudinal: mode(parameters, "l"),
    })
    .unwrap()
}

/// Largest difference over the largest expected entry.
fn compare(label: &str, found: &[f64], expected: &[f64], worst: &mut f64) {
    let scale = expected.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    for (i, (a, b)) in found.iter().zip(expected).enumerate() {
        let error = (a - b).abs();
        assert!(error <= (RELATIVE * scale).max(ABSOLUTE), "{label}[{i}]: {a:e} instead of {b:e}");
        if error > ABSOLUTE * 0.1 {
            *worst = worst.max(error / scale);
        }
    }
}

#[test]
fn reproduces_the_reference_paths() {
    let text = include_str!("data/law/law_paths.json");
    let data: Value = serde_json::from_str(text).unwrap();
    let (mut steps, mut worst) = (0, 0.0);
    for path in data["paths"].as_array().unwrap() {
        steps += follow(path, &mut worst);
    }
    assert_eq!(steps, 205);
    println!("largest error relative to the largest entry: {worst:e}");
}

/// Chains the state through the steps of one path.
fn follow(path: &Value, worst: &mut f64) -> usize {
    let law = law(&path["params"]);
    let frame = matrix(&path["frame"]);
    let mut old = numbers(&path["state0"]);
    old.resize(law.state_len(), 0.0);
    let mut new = old.clone();
    let mut out = Response::default();
    let steps = path["steps"].as_array().unwrap();
    for (i, step) in steps.iter().enumerate() {
        let label = |what: &str| format!("{} step {i} {what}", path["name"].as_str().unwrap());
        let h = matrix(&step["F"]) - Matrix3::identity();
        let input = PointInput {
            displacement_gradient: frame.transpose() * h * frame,
            mean_elongation: None,
            time_increment: 1.0,
            temperature: 293.15,
        };
        law.evaluate(&input, &old, &mut new, Request::Tangent, &mut out).unwrap();
        let forces = law.conjugate_forces(&input, &old).unwrap();
        let modes = forces.modes;
        let (d, g) = (modes.distortion, modes.longitudinal_shear);
        let strain = [modes.elongation, modes.compaction, d[0], d[1], g[0], g[1]];
        compare(&label("I"), &strain, &numbers(&step["I"]), worst);
        compare(&label("q"), &forces.to_array(), &numbers(&step["q"]), worst);
        compare(&label("p"), &[forces.compaction_pressure], &[step["p"].as_f64().unwrap()], worst);
        compare(&label("W"), &[out.stored_energy], &[step["W"].as_f64().unwrap()], worst);
        compare(&label("S"), &mandel::to_voigt_stress(&out.second_piola), &numbers(&step["S_fibre"]), worst);
        let global = mandel::rotate(&out.second_piola, &frame);
        compare(&label("S global"), &mandel::to_voigt_stress(&global), &numbers(&step["S_global"]), worst);
        compare_tangent(&label("D"), &out.tangent, &step["D_fibre"], worst);
        let expected = numbers(&step["state"]);
        compare(&label("state"), &new[..expected.len()], &expected, worst);
        let dissipated: Vec<f64> = (6..8).map(|k| new.get(k).unwrap() - old[k]).collect();
        compare(&label("dissipated"), &dissipated, &numbers(&step["dW_dissip"]), worst);
        for (found, flag) in forces.slides.iter().zip(step["slip"].as_array().unwrap()) {
            let expected = flag.as_bool().unwrap_or(flag.as_f64() == Some(1.0));
            assert_eq!(*found, expected, "{}", label("slip"));
        }
        old.copy_from_slice(&new);
    }
    steps.len()
}

fn compare_tangent(label: &str, tangent: &Matrix6<f64>, expected: &Value, worst: &mut f64) {
    let found = mandel::to_voigt_tangent(tangent);
    let found: Vec<f64> = (0..36).map(|k| found[(k / 6, k % 6)]).collect();
    let expected: Vec<f64> = expected.as_array().unwrap().iter().flat_map(numbers).collect();
    compare(label, &found, &expected, worst);
}

#[test]
fn mandel_and_voigt_agree() {
    let stress = mandel::from_matrix(&Matrix3::new(1.0, 4.0, 5.0, 4.0, 2.0, 6.0, 5.0, 6.0, 3.0));
    assert!(
        (Vector6::from(mandel::to_voigt_stress(&stress)) - Vector6::new(1.0, 2.0, 3.0, 4.0, 5.0, 6.0)).norm() < 1e-14
    );
}
