//! The laws against closed forms and independently computed numbers.
#![allow(clippy::unwrap_used)]

use approx::assert_relative_eq;
use nalgebra::Matrix3;
use subrope_material::driver::PointDriver;
use subrope_material::{
    BundleLaw, BundleParameters, Compaction, CompressibleNeoHooke, Friction, Hardening, ModeParameters, StrainModes,
    transverse_modulus,
};

/// `W = 1/2 (1000 Ie^2 + 50 Ic^2 + 20 Id^2 + 10 Is^2)`.
fn quadratic() -> BundleParameters {
    BundleParameters {
        k_e: 1000.0,
        k_ec: 1000.0,
        w_e: 0.0,
        k_c: 50.0,
        nu: 0.0,
        compaction: Compaction::Quadratic,
        transverse: ModeParameters::elastic(20.0),
        longitudinal: ModeParameters::elastic(10.0),
    }
}

/// Fibre along the global z.
fn upright() -> Matrix3<f64> {
    Matrix3::new(0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0)
}

#[test]
fn general_deformation_with_the_fibre_along_z() {
    let law = BundleLaw::new(quadratic()).unwrap();
    let f = Matrix3::new(1.1, 0.05, -0.1, 0.2, 0.95, 0.03, -0.04, 0.15, 1.02);
    let h = f - Matrix3::identity();
    let step = PointDriver::new(&law, upright()).run(&[h]).unwrap().remove(0);
    let modes = step.modes;
    assert_relative_eq!(modes.elongation, 0.0250137467998241, epsilon = 1e-15);
    assert_relative_eq!(modes.compaction, 0.00897018656238702, epsilon = 1e-15);
    assert_relative_eq!(modes.distortion_norm(), 0.150804896779531, epsilon = 1e-15);
    assert_relative_eq!(modes.longitudinal_shear_norm(), 0.21715637383422, epsilon = 1e-14);
    assert_relative_eq!(step.response.stored_energy, 0.778060993067944, epsilon = 1e-14);
    let expected = Matrix3::new(
        0.833767798033,
        1.13179411287,
        -3.77093384966,
        1.25964361213,
        -0.657101751055,
        2.23922934446,
        -1.3056420261,
        1.77624141093,
        23.6253996349,
    );
    assert_relative_eq!(step.first_piola_global(&h), expected, max_relative = 1e-11);
}

#[test]
fn simple_shears() {
    let law = BundleLaw::new(quadratic()).unwrap();
    let driver = PointDriver::new(&law, Matrix3::identity());
    let mut h = Matrix3::zeros();
    h[(0, 1)] = 0.4;
    let step = driver.run(&[h]).unwrap().remove(0);
    assert_relative_eq!(step.modes.longitudinal_shear_norm(), 0.4, epsilon = 1e-15);
    let expected = Matrix3::new(-1.6, 4.0, 0.0, 4.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    assert_relative_eq!(step.first_piola_global(&h), expected, epsilon = 1e-13);
    let mut h = Matrix3::zeros();
    h[(1, 2)] = 0.4;
    let modes = StrainModes::from_displacement_gradient(&h).unwrap();
    assert_relative_eq!(modes.distortion_norm(), 0.2_f64.asinh(), epsilon = 1e-15);
}

#[test]
fn homogeneous_state_of_the_neo_hookean_patch() {
    let law = CompressibleNeoHooke::new(0.5, 1.2).unwrap();
    let h = Matrix3::new(0.3, 0.2, -0.1, 0.15, -0.1, 0.25, -0.05, 0.1, 0.1);
    let step = PointDriver::new(&law, Matrix3::identity()).run(&[h]).unwrap().remove(0);
    let expected = Matrix3::new(
        0.4365671,
        0.13925838,
        -0.06327044,
        0.12587002,
        0.13482707,
        0.15596436,
        -0.05596436,
        0.12519915,
        0.29786166,
    );
    assert_relative_eq!(step.first_piola_global(&h), expected, epsilon = 1e-8);
    assert_relative_eq!(step.response.stored_energy, 0.14019847012063, epsilon = 1e-14);
}

fn sliding(friction: Friction) -> BundleLaw {
    let mode = ModeParameters::sliding(10.0, friction);
    BundleLaw::new(BundleParameters { transverse: mode, longitudinal: mode, ..quadratic() }).unwrap()
}

/// Longitudinal shear `g2, g3` alone.
fn longitudinal(g2: f64, g3: f64) -> Matrix3<f64> {
    Matrix3::new(0.0, g2, g3, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
}

/// Distortion of norm `size` alone: stretches `exp(+-size)` of two directions turned by half the angle.
fn distortion(d1: f64, d2: f64) -> Matrix3<f64> {
    let (size, angle) = (d1.hypot(d2), 0.5 * d2.atan2(d1));
    let (s, c) = angle.sin_cos();
    let turn = Matrix3::new(1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c);
    let stretch = Matrix3::from_diagonal(&[0.0, size.exp_m1(), (-size).exp_m1()].into());
    turn * stretch * turn.transpose()
}

/// A mode by its deformation, its index in `dissipated_mid` and the state entry of its dissipation.
type Mode = (fn(f64, f64) -> Matrix3<f64>, usize, usize);
const MODES: [Mode; 2] = [(distortion, 0, 6), (longitudinal, 1, 7)];

/// Dissipation of the last of several cycles of amplitude .5 and the largest force, end and mid value.
fn loop_of(law: &BundleLaw, (deform, mode, _): Mode) -> (f64, f64) {
    let corner = |i: usize| [0.5, -0.5][i % 2];
    let steps = 40;
    let path: Vec<_> = (0..6 * steps)
        .map(|i| {
            let fraction = (i % steps + 1) as f64 / steps as f64;
            let from = if i < steps { 0.0 } else { corner(i / steps - 1) };
            deform(from + (corner(i / steps) - from) * fraction, 0.0)
        })
        .collect();
    let answers = PointDriver::new(law, Matrix3::identity()).run(&path).unwrap();
    let last = &answers[4 * steps..];
    let dissipated = last.iter().map(|step| step.response.dissipated_mid[mode]).sum();
    let force = |step: &subrope_material::driver::PointStep| {
        let forces = step.forces.unwrap();
        [forces.distortion[0], forces.longitudinal_shear[0]][mode]
    };
    (dissipated, last.iter().map(force).fold(0.0, f64::max))
}

#[test]
fn friction_loops() {
    for mode in MODES {
        let (dissipated, peak) = loop_of(&sliding(Friction::isotropic(1.0, 0.0)), mode);
        assert_relative_eq!(dissipated, 1.6, epsilon = 1e-12);
        assert_relative_eq!(peak, 1.0, epsilon = 1e-12);
        let (dissipated, peak) = loop_of(&sliding(Friction { x: 2.0, ..Friction::isotropic(1.0, 0.0) }), mode);
        assert_relative_eq!(peak, 5.0 / 3.0, epsilon = 1e-12);
        assert_relative_eq!(dissipated, 4.0 / 3.0, epsilon = 1e-12);
    }
}

#[test]
fn saturated_loop_keeps_a_finite_area() {
    let hardening = Hardening::Saturating { h_inf: 0.5, kappa_s: 0.05 };
    let law = sliding(Friction { hardening, ..Friction::isotropic(0.5, 0.0) });
    for mode in MODES {
        let (dissipated, peak) = loop_of(&law, mode);
        assert_relative_eq!(peak, 1.0, epsilon = 1e-6);
        assert_relative_eq!(dissipated, 1.6, epsilon = 1e-5);
    }
}

#[test]
fn circular_path() {
    let law = sliding(Friction::isotropic(1.0, 0.0));
    for (deform, _, entry) in MODES {
        let mut found = Vec::new();
        for (steps, expected) in [(64, 3.046220), (256, 3.070342), (1024, 3.076188)] {
            let path: Vec<_> = (0..4 * steps)
                .map(|i| {
                    let (s, c) = (std::f64::consts::TAU * (i + 1) as f64 / f64::from(steps)).sin_cos();
                    deform(0.5 * c, 0.5 * s)
                })
                .collect();
            let answers = PointDriver::new(&law, Matrix3::identity()).run(&path).unwrap();
            let total = |turn: i32| answers[(turn * steps - 1) as usize].state[entry];
            found.push(total(4) - total(3));
            assert_relative_eq!(found[found.len() - 1], expected, epsilon = 1e-6);
        }
        // First order in the step: the limit of the last two.
        let limit = (4.0 * found[2] - found[1]) / 3.0;
        assert_relative_eq!(limit, 3.07812, epsilon = 3e-5);
    }
}

#[test]
fn yield_condition_holds_after_sliding() {
    let friction = Friction { tau: 0.1, hardening: Hardening::Linear { h: 1.5 }, x: 4.0, mu: 0.3 };
    let law = sliding(friction);
    let direction = Matrix3::new(0.01, 0.2, -0.1, 0.0, -0.25, 0.1, 0.02, 0.05, -0.1);
    let turn = Matrix3::new(0.0, 0.05, 0.2, 0.0, -0.05, 0.0, 0.0, 0.3, 0.0);
    let path = [direction, direction + turn, turn - direction * 0.3, -turn];
    let mut slid = 0;
    for step in PointDriver::new(&law, Matrix3::identity()).run(&path).unwrap() {
        let (forces, state) = (step.forces.unwrap(), &step.state);
        let both = [(forces.distortion, 0, 4), (forces.longitudinal_shear, 2, 5)];
        for (mode, (q, plastic, kappa)) in both.into_iter().enumerate() {
            let [x, y] = [0, 1].map(|i| q[i] - friction.x * state[plastic + i]);
            let resistance = 0.1 + 1.5 * state[kappa] + 0.3 * forces.compaction_pressure;
            if forces.slides[mode] {
                slid += 1;
                assert_relative_eq!(x.hypot(y), resistance, epsilon = 1e-13);
            } else {
                assert!(x.hypot(y) <= resistance * (1.0 + 1e-14));
            }
        }
    }
    assert!(slid >= 4, "{slid}");
}

/// Work of the stress along a straight path in many steps equals what is stored and dissipated, by the mid value.
#[test]
fn energy_balance_on_a_monotone_path() {
    let law = sliding(Friction { x: 2.0, ..Friction::isotropic(0.5, 1.0) });
    for (deform, mode, _) in MODES {
        let run = |steps: i32| {
            let path: Vec<_> = (1..=steps).map(|i| deform(0.3 * f64::from(i) / f64::from(steps), 0.0)).collect();
            let answers = PointDriver::new(&law, Matrix3::identity()).run(&path).unwrap();
            let dissipated: f64 = answers.iter().map(|step| step.response.dissipated_mid[mode]).sum();
            (dissipated, answers.last().unwrap().response.stored_energy)
        };
        // q = G (g - I^P), |q - 2 I^P| = .5 + kappa: kappa = (10 g - .5)/13.
        let kappa = 2.5 / 13.0;
        let exact = 0.5 * kappa + 0.5 * kappa * kappa;
        let elastic: f64 = 0.3 - kappa;
        for steps in [1, 16] {
            let (dissipated, stored) = run(steps);
            assert_relative_eq!(dissipated, exact, epsilon = 1e-14);
            assert_relative_eq!(stored, 5.0 * elastic * elastic + kappa * kappa, epsilon = 1e-14);
        }
    }
}

/// `I_comp = E22/2` and `D1 = E22/2` for small strain across the fibres: `K_c/4 + K_t/4`, sliding or not.
#[test]
fn transverse_modulus_at_rest() {
    let law = BundleLaw::new(quadratic()).unwrap();
    assert_relative_eq!(transverse_modulus(&law).unwrap(), 17.5, epsilon = 1e-12);
    let isotropic = CompressibleNeoHooke::new(3.0, 5.0).unwrap();
    assert_relative_eq!(transverse_modulus(&isotropic).unwrap(), 11.0, epsilon = 1e-12);
}
