//! Times the bundle law on one core: points per second with tangent and friction.
//!
//! `cargo run --release -p subrope-material --example law_speed`
#![allow(clippy::print_stdout, clippy::unwrap_used)]

use std::hint::black_box;
use std::time::Instant;

use nalgebra::Matrix3;
use subrope_material::{
    BundleLaw, BundleParameters, Compaction, Friction, Hardening, Law, ModeParameters, PointInput, Request, Response,
};

const POINTS: usize = 1024;
const ROUNDS: usize = 1000;

fn law(tau: f64, hardening: Hardening, mu: f64) -> BundleLaw {
    let friction = Friction { tau, hardening, x: 1.0, mu };
    BundleLaw::new(BundleParameters {
        k_e: 2000.0,
        k_ec: 100.0,
        w_e: 0.005,
        k_c: 60.0,
        nu: 0.5,
        compaction: Compaction::Quadratic,
        transverse: ModeParameters::sliding(15.0, friction),
        longitudinal: ModeParameters::sliding(20.0, friction),
    })
    .unwrap()
}

/// Displacement gradients that differ from point to point, scaled.
fn points(scale: f64) -> Vec<PointInput> {
    let entry = |point: usize, i: usize, j: usize| ((point * 31 + i * 7 + j * 13) as f64 * 0.7531).sin();
    (0..POINTS).map(|point| PointInput::new(Matrix3::from_fn(|i, j| scale * entry(point, i, j)))).collect()
}

/// Points per second, best of many short rounds, so that other work on the machine counts as little as possible.
fn speed(law: &impl Law, inputs: &[PointInput], request: Request) -> f64 {
    let old = vec![0.0; law.state_len()];
    let mut new = old.clone();
    let mut out = Response::default();
    let mut best = f64::INFINITY;
    for _ in 0..ROUNDS {
        let start = Instant::now();
        for input in inputs {
            law.evaluate(black_box(input), &old, &mut new, request, &mut out).unwrap();
            black_box(&mut out);
        }
        best = best.min(start.elapsed().as_secs_f64());
    }
    POINTS as f64 / best
}

fn main() {
    let linear = Hardening::Linear { h: 0.1 };
    let saturating = Hardening::Saturating { h_inf: 0.1, kappa_s: 0.02 };
    for (label, law, scale) in [
        ("sticking, strain 0.1", law(1e6, linear, 0.0), 0.05),
        ("sticking, strain 1", law(1e6, linear, 0.0), 0.25),
        ("sliding, strain 0.1", law(0.01, linear, 0.0), 0.05),
        ("sliding, strain 1", law(0.01, linear, 0.0), 0.25),
        ("sliding with pressure", law(0.01, linear, 0.2), 0.05),
        ("sliding, saturating", law(0.01, saturating, 0.0), 0.05),
        ("without friction", BundleLaw::new(law(1.0, linear, 0.0).parameters().without_friction()).unwrap(), 0.05),
    ] {
        let inputs = points(scale);
        let (tangent, stress) = (speed(&law, &inputs, Request::Tangent), speed(&law, &inputs, Request::Stress));
        println!("{label:24} {:6.2} M/s with tangent, {:6.2} M/s stress only", tangent * 1e-6, stress * 1e-6);
    }
}
