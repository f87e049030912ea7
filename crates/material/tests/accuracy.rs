//! Accuracy at strains of 1e-14, at distortion 8 and at large shear.
#![allow(clippy::unwrap_used)]

use approx::assert_relative_eq;
use nalgebra::{Matrix3, Rotation3};
use proptest::prelude::*;
use subrope_material::{
    BundleLaw, BundleParameters, Compaction, CompressibleNeoHooke, FibreNeoHooke, Friction, IsochoricNeoHooke, Law,
    ModeParameters, PointInput, Request, Response, StVenantKirchhoff, StrainModes, mandel,
};

fn parameters() -> BundleParameters {
    BundleParameters {
        k_e: 1000.0,
        k_ec: 1000.0,
        w_e: 0.0,
        k_c: 60.0,
        nu: 0.5,
        compaction: Compaction::LockUp { z_lock: -0.5 },
        transverse: ModeParameters::sliding(15.0, Friction::isotropic(0.05, 0.1)),
        longitudinal: ModeParameters::sliding(20.0, Friction::isotropic(1.0, 0.3)),
    }
}

fn answer(law: &dyn Law, h: Matrix3<f64>) -> Response {
    let old = vec![0.0; law.state_len()];
    let mut out = Response::default();
    law.evaluate(&PointInput::new(h), &old, &mut old.clone(), Request::Tangent, &mut out).unwrap();
    out
}

/// At a strain of 1e-14 stress and energy are those of the tangent at rest, to 1e-12 and entry by entry.
#[test]
fn infinitesimal_strain_keeps_its_digits() {
    let laws: [&dyn Law; 5] = [
        &BundleLaw::new(parameters()).unwrap(),
        &StVenantKirchhoff::isotropic(1000.0, 0.3).unwrap(),
        &CompressibleNeoHooke::new(0.5, 1.2).unwrap(),
        &IsochoricNeoHooke::new(0.4, 0.9).unwrap(),
        &FibreNeoHooke::new(1.0, 1.0, 100.0).unwrap(),
    ];
    let direction = Matrix3::new(0.31, 0.52, -0.37, 0.48, -0.44, 0.63, -0.29, 0.18, 0.21);
    for law in laws {
        let rest = answer(law, Matrix3::zeros()).tangent;
        for size in [1e-14, 1e-17, 1e-25] {
            let h = direction * size;
            let strain = mandel::green_lagrange(&h);
            let expected = rest * strain;
            let out = answer(law, h);
            for i in 0..6 {
                assert_relative_eq!(out.second_piola[i], expected[i], max_relative = 1e-12);
            }
            let energy = 0.5 * strain.dot(&expected);
            assert_relative_eq!(out.stored_energy, energy, max_relative = 1e-12, epsilon = 0.0);
        }
    }
}

/// `E1 = K_e`, `G12 = K_l`, `G23 = K_t/4`, plane-strain bulk modulus `K_c/4` when nothing couples.
#[test]
fn small_strain_moduli() {
    let law = BundleLaw::new(BundleParameters { nu: 0.0, ..parameters() }).unwrap();
    let tangent = mandel::to_voigt_tangent(&answer(&law, Matrix3::zeros()).tangent);
    assert_relative_eq!(tangent[(0, 0)], 1000.0, max_relative = 1e-15);
    assert_relative_eq!(tangent[(3, 3)], 20.0, max_relative = 1e-15);
    assert_relative_eq!(tangent[(4, 4)], 20.0, max_relative = 1e-15);
    assert_relative_eq!(tangent[(5, 5)], 15.0 / 4.0, max_relative = 1e-15);
    assert_relative_eq!(0.5 * (tangent[(1, 1)] + tangent[(1, 2)]), 60.0 / 4.0, max_relative = 1e-15);
    assert_relative_eq!(0.5 * (tangent[(1, 1)] - tangent[(1, 2)]), 15.0 / 4.0, max_relative = 1e-15);
}

/// Second-order series of the modes at strains where every digit can be checked.
#[test]
fn modes_of_tiny_diagonal_strains() {
    for size in [1e-14_f64, 1e-10, 1e-7] {
        let (a, b, c) = (0.7 * size, -0.4 * size, 0.9 * size);
        let modes = StrainModes::from_displacement_gradient(&Matrix3::from_diagonal(&[a, b, c].into())).unwrap();
        assert_relative_eq!(modes.elongation, a.ln_1p(), max_relative = 4e-16);
        assert_relative_eq!(modes.compaction, 0.5 * (b.ln_1p() + c.ln_1p()), max_relative = 2e-15);
        assert_relative_eq!(modes.distortion[0], 0.5 * (b.ln_1p() - c.ln_1p()), max_relative = 2e-15);
        assert_eq!(modes.distortion[1], 0.0);
    }
}

#[test]
fn distortion_of_eight() {
    let (large, small) = (8.0_f64.exp_m1(), (-8.0_f64).exp_m1());
    let stretch = Matrix3::from_diagonal(&[0.0, large, small].into());
    let modes = StrainModes::from_displacement_gradient(&stretch).unwrap();
    assert_relative_eq!(modes.distortion[0], 8.0, max_relative = 1e-13);
    assert!(modes.compaction.abs() < 1e-12);
    for angle in [0.3, 0.9, 2.0] {
        let turn = *Rotation3::from_euler_angles(angle, 0.0, 0.0).matrix();
        let modes = StrainModes::from_displacement_gradient(&(turn * stretch * turn.transpose())).unwrap();
        assert_relative_eq!(modes.distortion_norm(), 8.0, max_relative = 1e-9);
        assert_relative_eq!(modes.distortion[0], 8.0 * (2.0 * angle).cos(), epsilon = 8e-9);
        assert_relative_eq!(modes.distortion[1], 8.0 * (2.0 * angle).sin(), epsilon = 8e-9);
    }
}

/// Both the large and the tiny stress component, `S_aa = +-K_t 4/T_aa`, and the tangent `+-K_t/(4 T T) ...` by its
/// scaling.
#[test]
fn stress_at_distortion_eight() {
    let law = BundleLaw::new(parameters().without_friction()).unwrap();
    let out = answer(&law, Matrix3::from_diagonal(&[0.0, 8.0_f64.exp_m1(), (-8.0_f64).exp_m1()].into()));
    let (t22, t33) = (16.0_f64.exp(), (-16.0_f64).exp());
    assert_relative_eq!(out.second_piola[1], 15.0 * 4.0 / t22, max_relative = 1e-11);
    assert_relative_eq!(out.second_piola[2], -15.0 * 4.0 / t33, max_relative = 1e-11);
    // W = K_t/2 (1/4 ln(T22/T33))^2 + K_c/2 (1/4 ln(T22 T33))^2 along 33.
    let expected = 4.0 / (t33 * t33) * (15.0 / 16.0 + 60.0 / 16.0 + 15.0 * 8.0 / 4.0);
    assert_relative_eq!(out.tangent[(2, 2)], expected, max_relative = 1e-11);
}

/// A large longitudinal shear does not spoil a small distortion.
#[test]
fn large_shear_leaves_the_section_alone() {
    for shear in [10.0, 1e3, 1e5] {
        let section = Matrix3::new(0.0, 0.0, 0.0, 0.0, 1e-3, 0.0, 0.0, 0.0, -1e-3);
        let sheared = Matrix3::identity() + Matrix3::new(0.0, shear, -0.7 * shear, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        let h = sheared * (Matrix3::identity() + section) - Matrix3::identity();
        let modes = StrainModes::from_displacement_gradient(&h).unwrap();
        let exact = 0.5 * (1e-3_f64.ln_1p() - (-1e-3_f64).ln_1p());
        assert_relative_eq!(modes.distortion[0], exact, max_relative = 1e-12 * shear);
        assert_relative_eq!(modes.longitudinal_shear[0], shear * 1.001, max_relative = 1e-14);
        assert_relative_eq!(modes.longitudinal_shear[1], -0.7 * shear * 0.999, max_relative = 1e-14);
    }
}

proptest! {
    /// The norms are Charmetant's invariants: `cosh(2 |I_dist|) = (I1 I4 - I5)/(2 sqrt(I3 I4))`,
    /// `|I_sh|^2 = I5/I4^2 - 1`, and `ln J = I_elong + 2 I_comp`.
    #[test]
    fn norms_are_the_original_invariants(entries in prop::array::uniform9(-0.4_f64..0.4)) {
        let h = Matrix3::from_row_slice(&entries);
        let f = Matrix3::identity() + h;
        prop_assume!(f.determinant() > 0.05);
        let modes = StrainModes::from_displacement_gradient(&h).unwrap();
        let c = f.tr_mul(&f);
        let (i1, i3, i4, i5) = (c.trace(), c.determinant(), c[(0, 0)], (c * c)[(0, 0)]);
        let x = (i1 * i4 - i5) / (2.0 * (i3 * i4).sqrt());
        prop_assert!(((2.0 * modes.distortion_norm()).cosh() - x).abs() < 1e-11 * x);
        prop_assert!((modes.longitudinal_shear_norm().powi(2) - (i5 / (i4 * i4) - 1.0)).abs() < 1e-11 * (1.0 + i5));
        prop_assert!((modes.log_volume_ratio() - f.determinant().ln()).abs() < 1e-12);
    }

    /// The branches for small and large strain agree where they meet.
    #[test]
    fn branches_meet(entries in prop::array::uniform9(-1.0_f64..1.0), factor in 0.05_f64..0.4) {
        let h = Matrix3::from_row_slice(&entries) * factor;
        let near = h * (1.0 + 1e-13);
        if let (Ok(a), Ok(b)) = (StrainModes::from_displacement_gradient(&h), StrainModes::from_displacement_gradient(&near)) {
            prop_assert!((a.elongation - b.elongation).abs() < 1e-11);
            prop_assert!((a.compaction - b.compaction).abs() < 1e-10);
            prop_assert!((a.distortion_norm() - b.distortion_norm()).abs() < 1e-10);
        }
    }
}
