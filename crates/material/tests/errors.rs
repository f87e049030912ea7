//! What the laws refuse, and how they say it.
#![allow(clippy::unwrap_used, clippy::panic)]

use nalgebra::Matrix3;
use subrope_material::driver::{PointDriver, difference_tangent};
use subrope_material::{
    BundleLaw, BundleParameters, Compaction, EngineeringConstants, Friction, Law, LawError, ModeParameters, PointInput,
    Request, Response, StVenantKirchhoff, StateKind,
};

fn parameters() -> BundleParameters {
    let mode = ModeParameters::sliding(15.0, Friction::isotropic(0.05, 0.1));
    BundleParameters {
        k_e: 2000.0,
        k_ec: 100.0,
        w_e: 0.005,
        k_c: 60.0,
        nu: 0.5,
        compaction: Compaction::LockUp { z_lock: -0.3 },
        transverse: mode,
        longitudinal: mode,
    }
}

fn refused(change: impl Fn(&mut BundleParameters)) -> &'static str {
    let mut changed = parameters();
    change(&mut changed);
    match BundleLaw::new(changed) {
        Err(LawError::Parameter { name, .. }) => name,
        other => panic!("{other:?}"),
    }
}

#[test]
fn impossible_parameters_are_named() {
    assert_eq!(refused(|p| p.k_e = 0.0), "K_e");
    assert_eq!(refused(|p| p.k_ec = -1.0), "K_ec");
    assert_eq!(refused(|p| p.w_e = f64::NAN), "w_e");
    assert_eq!(refused(|p| p.nu = f64::INFINITY), "nu");
    assert_eq!(refused(|p| p.compaction = Compaction::LockUp { z_lock: 0.1 }), "z_lock");
    assert_eq!(refused(|p| p.compaction = Compaction::Power { k_p: 1.0, m: 2.0 }), "m");
    assert_eq!(refused(|p| p.transverse.k = 0.0), "K_t");
    assert_eq!(refused(|p| p.transverse.friction = Some(Friction::isotropic(f64::NAN, 0.0))), "tau_t");
    assert_eq!(refused(|p| p.longitudinal.friction = Some(Friction::isotropic(1.0, -1.0))), "H_l");
    let pressed = Friction { mu: -0.1, ..Friction::isotropic(1.0, 0.0) };
    assert_eq!(refused(|p| p.longitudinal.friction = Some(pressed)), "mu_l");
}

#[test]
fn orthotropic_constants_must_be_positive_definite() {
    let constants = EngineeringConstants {
        e1: 1.0,
        e2: 1.0,
        e3: 1.0,
        nu12: 0.9,
        nu13: 0.9,
        nu23: 0.9,
        g12: 1.0,
        g13: 1.0,
        g23: 1.0,
    };
    assert!(matches!(StVenantKirchhoff::orthotropic(&constants), Err(LawError::Parameter { .. })));
}

#[test]
fn orthotropic_with_isotropic_constants_is_isotropic() {
    let (young, nu) = (1000.0, 0.3);
    let g = young / 2.6;
    let constants =
        EngineeringConstants { e1: young, e2: young, e3: young, nu12: nu, nu13: nu, nu23: nu, g12: g, g13: g, g23: g };
    let orthotropic = StVenantKirchhoff::orthotropic(&constants).unwrap();
    let isotropic = StVenantKirchhoff::isotropic(young, nu).unwrap();
    assert!((orthotropic.stiffness() - isotropic.stiffness()).abs().max() < 1e-10);
}

#[test]
fn lock_up_and_inversion_are_told_apart() {
    let law = BundleLaw::new(parameters()).unwrap();
    let driver = PointDriver::new(&law, Matrix3::identity());
    let packed = Matrix3::from_diagonal(&[0.0, -0.3, -0.3].into());
    let error = driver.run(&[Matrix3::zeros(), packed]).unwrap_err();
    assert_eq!(error.step, 1);
    assert!(matches!(error.source, LawError::LockedUp { limit: -0.3, .. }));
    let inverted = Matrix3::from_diagonal(&[0.0, -1.5, 0.0].into());
    assert!(matches!(driver.run(&[inverted]).unwrap_err().source, LawError::Inverted { jacobian } if jacobian == -0.5));
}

#[test]
fn state_of_the_wrong_length_is_refused() {
    let law = BundleLaw::new(parameters()).unwrap();
    let mut out = Response::default();
    let input = PointInput::new(Matrix3::zeros());
    let error = law.evaluate(&input, &[0.0; 3], &mut [0.0; 8], Request::Stress, &mut out).unwrap_err();
    assert_eq!(error, LawError::StateLength { expected: 8, found: 3 });
    let error = law.evaluate(&input, &[0.0; 8], &mut [0.0; 9], Request::Stress, &mut out).unwrap_err();
    assert_eq!(error, LawError::StateLength { expected: 8, found: 9 });
}

#[test]
fn layout_of_the_state() {
    let law = BundleLaw::new(parameters()).unwrap();
    let layout: Vec<_> = law.state_variables().iter().map(|v| (v.kind, v.offset, v.components)).collect();
    assert_eq!(layout.len(), 6);
    assert_eq!(layout[1], (StateKind::LongitudinalShearPlastic, 2, 2));
    assert_eq!(law.state_len(), layout.iter().map(|v| v.2).sum::<usize>());
    let mut pressed = parameters();
    pressed.transverse.friction = Some(Friction { mu: 0.1, ..Friction::isotropic(0.1, 0.0) });
    let law = BundleLaw::new(pressed).unwrap();
    assert_eq!(law.state_variables().last().unwrap().kind, StateKind::CompactionPressure);
    assert_eq!(law.state_len(), 9);
}

#[test]
fn driver_gives_the_difference_tangent() {
    let law = BundleLaw::new(parameters()).unwrap();
    let frame = *nalgebra::Rotation3::from_euler_angles(0.3, 1.0, -0.4).matrix();
    let h = Matrix3::new(0.02, 0.1, -0.03, 0.05, -0.04, 0.08, 0.01, 0.02, -0.05);
    let driver = PointDriver::new(&law, frame).with_difference_tangent(1e-6);
    for step in driver.run(&[h * 0.5, h, h * 0.8]).unwrap() {
        let difference = step.difference_tangent.unwrap();
        let error = (difference - step.response.tangent).abs().max();
        assert!(error < 1e-5 * step.response.tangent.abs().max(), "{error}");
    }
    let input = driver.input(&h);
    assert!(difference_tangent(&law, &input, &[0.0; 8], 1e-6).is_ok());
}
