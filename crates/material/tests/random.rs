//! Properties of laws over ten thousand random laws each, along random paths that load, turn and unload.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use nalgebra::Matrix3;
use subrope_material::testkit::{self, Numbers, Path, TestkitFailure};
use subrope_material::{
    BundleLaw, BundleParameters, CharmetantLaw, CharmetantParameters, Compaction, CompressibleNeoHooke,
    EngineeringConstants, FibreNeoHooke, Friction, Hardening, IsochoricNeoHooke, Law, ModeParameters, PointInput,
    Request, Response, StVenantKirchhoff, mandel,
};

const CASES: u64 = 10_000;

fn friction(numbers: &mut Numbers, modulus: f64) -> Friction {
    let hardening = match numbers.index(3) {
        0 => Hardening::Linear { h: 0.0 },
        1 => Hardening::Linear { h: modulus * numbers.log_between(1e-3, 1.0) },
        _ => Hardening::Saturating {
            h_inf: modulus * numbers.log_between(1e-3, 0.1),
            kappa_s: numbers.log_between(1e-2, 1.0),
        },
    };
    Friction {
        tau: modulus * numbers.log_between(1e-3, 0.1),
        hardening,
        x: if numbers.chance(0.5) { 0.0 } else { modulus * numbers.log_between(1e-3, 1.0) },
        mu: if numbers.chance(0.5) { 0.0 } else { numbers.between(0.0, 0.5) },
    }
}

fn mode(numbers: &mut Numbers) -> ModeParameters {
    let modulus = numbers.log_between(1.0, 100.0);
    match numbers.chance(0.85) {
        true => ModeParameters::sliding(modulus, friction(numbers, modulus)),
        false => ModeParameters::elastic(modulus),
    }
}

fn bundle(numbers: &mut Numbers) -> BundleLaw {
    let compaction = match numbers.index(3) {
        0 => Compaction::Quadratic,
        1 => Compaction::Power { k_p: numbers.log_between(1.0, 300.0), m: numbers.between(2.1, 4.0) },
        _ => Compaction::LockUp { z_lock: numbers.between(-1.5, -0.8) },
    };
    let (k_e, w_e) = (numbers.log_between(100.0, 1e4), numbers.chance(0.5));
    BundleLaw::new(BundleParameters {
        k_e,
        k_ec: k_e * numbers.log_between(1e-2, 1.0),
        w_e: if w_e { numbers.log_between(1e-3, 0.05) } else { 0.0 },
        k_c: numbers.log_between(10.0, 300.0),
        nu: numbers.between(0.0, 0.5),
        compaction,
        transverse: mode(numbers),
        longitudinal: mode(numbers),
    })
    .unwrap()
}

fn orthotropic(numbers: &mut Numbers) -> StVenantKirchhoff {
    let mut modulus = || numbers.log_between(100.0, 1000.0);
    let (e1, e2, e3, g12, g13, g23) = (modulus(), modulus(), modulus(), modulus(), modulus(), modulus());
    // Contractions below a third of their bounds leave the stiffness positive definite.
    let (nu12, nu13, nu23) =
        ((e1 / e2).sqrt() * numbers.signed() / 3.0, (e1 / e3).sqrt() * numbers.signed() / 3.0, (e2 / e3).sqrt() / 4.0);
    let constants = EngineeringConstants { e1, e2, e3, nu12, nu13, nu23, g12, g13, g23 };
    StVenantKirchhoff::orthotropic(&constants).unwrap()
}

/// Most are bundles.
fn law(numbers: &mut Numbers) -> Box<dyn Law> {
    let mut size = |low, high| numbers.log_between(low, high);
    let (a, b, c) = (size(0.1, 10.0), size(0.1, 10.0), size(1.0, 100.0));
    match numbers.index(12) {
        0 => Box::new(CompressibleNeoHooke::new(a, b).unwrap()),
        1 => Box::new(IsochoricNeoHooke::new(a, b).unwrap()),
        2 => Box::new(FibreNeoHooke::new(a, b, c).unwrap()),
        3 => Box::new(orthotropic(numbers)),
        4 => Box::new(
            CharmetantLaw::new(CharmetantParameters {
                k_elong: 100.0 * c,
                k_elong_initial: c,
                toe: 0.01 * a,
                k_comp: 50.0 * b,
                p: 2.1 + 0.2 * a,
                k_rest: a,
                k_dist: c,
                k_sh: 2.0 * c,
            })
            .unwrap(),
        ),
        _ => Box::new(bundle(numbers)),
    }
}

/// Runs a check over random laws and paths; answers how many cases compared nothing (a kink at every entry).
fn over_all(check: impl Fn(&dyn Law, &Path, &mut Numbers) -> Result<(), TestkitFailure>) -> u64 {
    let mut skipped = 0;
    for case in 0..CASES {
        let mut numbers = Numbers::new(case);
        let law = law(&mut numbers);
        let size = [0.003, 0.02, 0.06, 0.12][numbers.index(4)];
        let path = numbers.path(4, size);
        match check(law.as_ref(), &path, &mut numbers) {
            Ok(()) => {}
            Err(TestkitFailure::NothingCompared { .. }) => skipped += 1,
            Err(failure) => panic!("case {case}, {} at {size}: {failure:?}", law.name()),
        }
    }
    skipped
}

#[test]
fn objectivity() {
    // The fixed rotation of the battery, and one of its own for every case.
    over_all(|law, path, numbers| {
        testkit::objectivity(law, path)?;
        let turn = numbers.rotation();
        let (mut old, mut also) = (vec![0.0; law.state_len()], vec![0.0; law.state_len()]);
        for (step, gradient) in path.gradients().iter().enumerate() {
            let turned = turn * (gradient + Matrix3::identity()) - Matrix3::identity();
            let ((a, first), (b, second)) = (ask(law, gradient, &old, step)?, ask(law, &turned, &also, step)?);
            let scale = a.tangent.amax();
            // Rotating rounds the strain, which a steep compaction amplifies.
            assert!((a.second_piola - b.second_piola).amax() <= 1e-12 * scale, "{a:?} {b:?}");
            (old, also) = (first, second);
        }
        Ok(())
    });
}

#[test]
fn dissipation_is_never_negative() {
    over_all(|law, path, _| testkit::dissipation(law, path));
}

#[test]
fn symmetric_where_claimed() {
    over_all(|law, path, _| testkit::symmetry(law, path));
}

#[test]
fn the_tangent_is_the_derivative_of_the_stress() {
    let skipped = over_all(|law, path, _| testkit::tangent_is_derivative(law, path));
    assert!(skipped < CASES / 50, "{skipped} cases compared nothing");
}

#[test]
fn the_stress_is_the_derivative_of_the_incremental_potential() {
    let skipped = over_all(|law, path, _| testkit::stress_is_gradient(law, path));
    assert!(skipped < CASES / 50, "{skipped} cases compared nothing");
}

/// Work put in = energy stored + dissipated: along a straight piece in strain, by the trapezoidal rule over small steps.
#[test]
fn work_is_stored_or_dissipated() {
    const PIECES: usize = 60;
    let mut worst = 0.0_f64;
    for case in 0..CASES {
        let mut numbers = Numbers::new(case);
        let law = law(&mut numbers);
        let path = numbers.path(3, 0.03);
        let mut old = vec![0.0; law.state_len()];
        let (mut work, mut lost, mut turnover) = (0.0, 0.0, 0.0);
        let (mut stress, mut at) = (nalgebra::Vector6::zeros(), Matrix3::zeros());
        let mut stored = 0.0;
        for target in path.gradients() {
            let from = at;
            for piece in 1..=PIECES {
                let to = from + (target - from) * (piece as f64 / PIECES as f64);
                let (out, new) = ask(law.as_ref(), &to, &old, piece).unwrap();
                let change = mandel::green_lagrange(&to) - mandel::green_lagrange(&at);
                let own = 0.5 * (stress + out.second_piola).dot(&change);
                work += own;
                turnover += own.abs();
                lost += out.dissipated_mid[0] + out.dissipated_mid[1];
                (old, stress, at, stored) = (new, out.second_piola, to, out.stored_energy);
            }
        }
        let open = (work - stored - lost).abs() / turnover;
        worst = worst.max(open);
        assert!(open < 0.01, "case {case}, {}: {work:e} = {stored:e} + {lost:e}", law.name());
    }
    assert!(worst > 0.0, "something is compared");
}

fn ask(
    law: &dyn Law,
    gradient: &Matrix3<f64>,
    old: &[f64],
    step: usize,
) -> Result<(Response, Vec<f64>), TestkitFailure> {
    let (mut out, mut new) = (Response::default(), old.to_vec());
    law.evaluate(&PointInput::new(*gradient), old, &mut new, Request::Tangent, &mut out)
        .map_err(|source| TestkitFailure::NoAnswer { check: "random", step, source })?;
    Ok((out, new))
}
