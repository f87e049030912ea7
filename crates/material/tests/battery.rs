//! Every law through the battery of `subrope_material::testkit`.

#![allow(clippy::unwrap_used)]

use subrope_material::testkit::{self, Path};
use subrope_material::{
    BundleLaw, BundleParameters, CharmetantLaw, CharmetantParameters, Compaction, CompressibleNeoHooke,
    EngineeringConstants, FibreNeoHooke, Friction, Hardening, IsochoricNeoHooke, Law, ModeParameters,
    StVenantKirchhoff,
};

/// Puts a law through the battery at several amplitudes.
fn pass(law: &dyn Law, amplitudes: &[f64]) {
    for &amplitude in amplitudes {
        for (i, path) in Path::standard(amplitude).iter().enumerate() {
            let result = testkit::check(law, std::slice::from_ref(path));
            assert!(result.is_ok(), "{} at amplitude {amplitude}, path {i}: {result:?}", law.name());
        }
    }
}

fn pass_isotropic(law: &dyn Law, amplitudes: &[f64]) {
    pass(law, amplitudes);
    for &amplitude in amplitudes {
        for path in Path::standard(amplitude) {
            testkit::transverse_isotropy(law, &path).unwrap();
        }
    }
}

fn friction(tau: f64, h: f64, x: f64, mu: f64) -> Friction {
    Friction { tau, hardening: Hardening::Linear { h }, x, mu }
}

fn parameters(compaction: Compaction, transverse: Friction, longitudinal: Friction) -> BundleParameters {
    BundleParameters {
        k_e: 2000.0,
        k_ec: 50.0,
        w_e: 0.02,
        k_c: 100.0,
        nu: 0.5,
        compaction,
        transverse: ModeParameters::sliding(30.0, transverse),
        longitudinal: ModeParameters::sliding(40.0, longitudinal),
    }
}

fn bundle(compaction: Compaction, transverse: Friction, longitudinal: Friction) -> BundleLaw {
    BundleLaw::new(parameters(compaction, transverse, longitudinal)).unwrap()
}

const AMPLITUDES: [f64; 3] = [0.01, 0.08, 0.25];
const POWER: Compaction = Compaction::Power { k_p: 300.0, m: 2.5 };

#[test]
fn elastic_bundle() {
    let friction = friction(0.1, 0.0, 0.0, 0.0);
    for compaction in [Compaction::Quadratic, POWER, Compaction::LockUp { z_lock: -0.6 }] {
        let elastic = parameters(compaction, friction, friction).without_friction();
        let law = BundleLaw::new(elastic).unwrap();
        assert_eq!(law.state_len(), 0);
        pass_isotropic(&law, &AMPLITUDES);
    }
}

#[test]
fn isotropic_hardening() {
    pass_isotropic(
        &bundle(Compaction::Quadratic, friction(0.3, 1.5, 0.0, 0.0), friction(0.4, 2.0, 0.0, 0.0)),
        &AMPLITUDES,
    );
}

#[test]
fn kinematic_isotropic_and_pressure_together() {
    let law = bundle(POWER, friction(0.1, 1.5, 4.0, 0.25), friction(0.15, 2.0, 7.0, 0.35));
    assert!(!law.is_symmetric());
    assert_eq!(law.state_len(), 9);
    pass_isotropic(&law, &AMPLITUDES);
}

#[test]
fn saturating_hardening() {
    let hardening = Hardening::Saturating { h_inf: 0.8, kappa_s: 0.03 };
    let friction = Friction { tau: 0.2, hardening, x: 2.0, mu: 0.0 };
    pass_isotropic(&bundle(Compaction::Quadratic, friction, friction), &AMPLITUDES);
    let pressed = Friction { mu: 0.2, ..friction };
    pass_isotropic(&bundle(POWER, pressed, friction), &AMPLITUDES);
}

#[test]
fn lock_up_with_friction() {
    let law = bundle(Compaction::LockUp { z_lock: -0.6 }, friction(0.2, 0.5, 1.0, 0.3), friction(0.2, 0.5, 1.0, 0.3));
    pass_isotropic(&law, &AMPLITUDES);
}

#[test]
fn perfect_plasticity() {
    pass_isotropic(
        &bundle(Compaction::Quadratic, friction(0.3, 0.0, 0.0, 0.0), friction(0.2, 0.0, 0.0, 0.0)),
        &AMPLITUDES,
    );
}

#[test]
fn purely_pressure_dependent() {
    // At the smallest amplitude the cone without a threshold is too narrow for difference quotients.
    pass_isotropic(
        &bundle(Compaction::Quadratic, friction(0.0, 0.5, 0.0, 0.3), friction(0.0, 0.0, 1.0, 0.3)),
        &AMPLITUDES[1..],
    );
}

#[test]
fn never_sliding_and_one_mode_sliding() {
    let never = friction(f64::INFINITY, 1.0, 1.0, 0.2);
    pass_isotropic(&bundle(Compaction::Quadratic, never, friction(0.2, 0.0, 1.0, 0.0)), &AMPLITUDES);
    let mut one = parameters(Compaction::Quadratic, friction(0.2, 0.0, 1.0, 0.0), never);
    one.longitudinal.friction = None;
    pass_isotropic(&BundleLaw::new(one).unwrap(), &AMPLITUDES);
}

#[test]
fn charmetant() {
    let law = CharmetantLaw::new(CharmetantParameters {
        k_elong: 2000.0,
        k_elong_initial: 60.0,
        toe: 0.01,
        k_comp: 500.0,
        p: 2.6,
        k_rest: 1.0,
        k_dist: 20.0,
        k_sh: 15.0,
    })
    .unwrap();
    pass_isotropic(&law, &AMPLITUDES);
}

#[test]
fn st_venant_kirchhoff() {
    pass_isotropic(&StVenantKirchhoff::isotropic(1000.0, 0.3).unwrap(), &AMPLITUDES);
    let constants = EngineeringConstants {
        e1: 2000.0,
        e2: 300.0,
        e3: 150.0,
        nu12: 0.3,
        nu13: 0.25,
        nu23: 0.4,
        g12: 80.0,
        g13: 60.0,
        g23: 40.0,
    };
    pass(&StVenantKirchhoff::orthotropic(&constants).unwrap(), &AMPLITUDES);
}

#[test]
fn neo_hooke() {
    pass_isotropic(&CompressibleNeoHooke::new(0.5, 1.2).unwrap(), &AMPLITUDES);
    pass_isotropic(&IsochoricNeoHooke::new(0.4225, 0.91541667).unwrap(), &AMPLITUDES);
    pass_isotropic(&FibreNeoHooke::new(1.0, 1.0, 100.0).unwrap(), &AMPLITUDES);
}
