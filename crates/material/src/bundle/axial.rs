//! The axial energy `W_A = W_e(u) + W_c(z)`, `z = I_comp + nu u`, `u` the fibre elongation.

use super::parameters::{BundleParameters, Compaction};
use crate::lanes::Lanes;

/// An energy of one variable with its two derivatives.
#[derive(Clone, Copy, Debug)]
struct Potential<V> {
    energy: V,
    slope: V,
    curvature: V,
}

/// `W_A` with its derivatives by elongation `u` and compaction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AxialResponse<V: Lanes> {
    /// Where the section is not locked up.
    pub(crate) valid: V::Mask,
    pub(crate) energy: V,
    /// `W_,e = W_e' + nu W_c'`.
    pub(crate) by_elongation: V,
    /// `W_,c = W_c'`.
    pub(crate) by_compaction: V,
    pub(crate) elongation_stiffness: V,
    pub(crate) coupling: V,
    pub(crate) compaction_stiffness: V,
    /// `p = max(0, -W_c')`.
    pub(crate) pressure: V,
    /// `dp/dI_comp`.
    pub(crate) pressure_by_compaction: V,
    /// `dp/du`.
    pub(crate) pressure_by_elongation: V,
}

impl<V: Lanes> AxialResponse<V> {
    #[inline(always)]
    pub(crate) fn new(parameters: &BundleParameters, elongation: V, compaction: V) -> Self {
        let nu = parameters.nu;
        let z = compaction + elongation * nu;
        let fibre = fibre_energy(parameters, elongation);
        let section = compaction_energy(parameters, z);
        let zero = z.splat(0.0);
        let pressed = V::select(section.slope.lt(zero), -section.curvature, zero);
        Self {
            valid: within_lock_up(parameters.compaction, z),
            energy: fibre.energy + section.energy,
            by_elongation: fibre.slope + section.slope * nu,
            by_compaction: section.slope,
            elongation_stiffness: fibre.curvature + section.curvature * (nu * nu),
            coupling: section.curvature * nu,
            compaction_stiffness: section.curvature,
            pressure: (-section.slope).max(zero),
            pressure_by_compaction: pressed,
            pressure_by_elongation: pressed * nu,
        }
    }
}

/// `W_e`: modulus `K_ec` in compression, rising to `K_e` over the toe as `t^2 (3 - 2t)`, `t = u/w_e` between 0 and 1;
/// beyond the toe by `r = u - w_e` it is `3/20 w^2 + r (w + r)/2`.
#[inline(always)]
fn fibre_energy<V: Lanes>(parameters: &BundleParameters, u: V) -> Potential<V> {
    let (w, base, extra) = (parameters.w_e, parameters.k_ec, parameters.k_e - parameters.k_ec);
    let (zero, one) = (u.splat(0.0), u.splat(1.0));
    let t = if w > 0.0 { (u / u.splat(w)).max(zero).min(one) } else { V::select(u.lt(zero), zero, one) };
    let beyond = (u - w).max(zero);
    let square = t * t;
    let toe = square * square * (t * -0.1 + 0.25) * (w * w) + beyond * (beyond + w) * 0.5;
    let slope = square * t * (t * -0.5 + 1.0) * w + beyond;
    Potential {
        energy: u * u * (0.5 * base) + toe * extra,
        slope: u * base + slope * extra,
        curvature: square * (t * -2.0 + 3.0) * extra + base,
    }
}

/// `W_c(z)`, see [`Compaction`].
#[inline(always)]
fn compaction_energy<V: Lanes>(parameters: &BundleParameters, z: V) -> Potential<V> {
    let k = parameters.k_c;
    let quadratic = Potential { energy: z * z * (0.5 * k), slope: z * k, curvature: z.splat(k) };
    match parameters.compaction {
        Compaction::Quadratic => quadratic,
        Compaction::Power { k_p, m } => with_power(quadratic, (-z).max(z.splat(0.0)), k_p, m),
        Compaction::LockUp { z_lock } => lock_up(k, z, z_lock),
    }
}

/// Adds `K_p depth^m`, `depth = max(0, -z)`.
#[inline(always)]
fn with_power<V: Lanes>(quadratic: Potential<V>, depth: V, k_p: f64, m: f64) -> Potential<V> {
    let power = depth.map(|depth| if depth > 0.0 { k_p * depth.powf(m - 2.0) } else { 0.0 });
    Potential {
        energy: quadratic.energy + power * depth * depth,
        slope: quadratic.slope - power * depth * m,
        curvature: quadratic.curvature + power * (m * (m - 1.0)),
    }
}

/// `-1/2 K_c z_l^2 ln(1 - (z/z_l)^2)` in compaction, quadratic in expansion.
#[inline(always)]
fn lock_up<V: Lanes>(k: f64, z: V, limit: f64) -> Potential<V> {
    let zero = z.splat(0.0);
    let (expanded, ratio) = (z.max(zero), z.min(zero) * (1.0 / limit));
    let square = ratio * ratio;
    let room = z.splat(1.0) / ((-ratio + 1.0) * (ratio + 1.0));
    Potential {
        energy: expanded * expanded * (0.5 * k) - (-square).ln_1p() * (0.5 * k * limit * limit),
        slope: z * k * room,
        curvature: (square + 1.0) * k * room * room,
    }
}

#[inline(always)]
fn within_lock_up<V: Lanes>(compaction: Compaction, z: V) -> V::Mask {
    match compaction {
        Compaction::LockUp { z_lock } => z.splat(z_lock).lt(z),
        Compaction::Quadratic | Compaction::Power { .. } => z.equal(z),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bundle::ModeParameters;

    fn parameters(compaction: Compaction) -> BundleParameters {
        let mode = ModeParameters::elastic(1.0);
        let (transverse, longitudinal) = (mode, mode);
        BundleParameters {
            k_e: 2000.0,
            k_ec: 50.0,
            w_e: 0.01,
            k_c: 80.0,
            nu: 0.4,
            compaction,
            transverse,
            longitudinal,
        }
    }

    /// Both derivatives of a potential against central differences.
    fn check(potential: impl Fn(f64) -> Potential<f64>, at: f64) {
        let step = 1e-6;
        let (low, here, high) = (potential(at - step), potential(at), potential(at + step));
        let slope = (high.energy - low.energy) / (2.0 * step);
        let curvature = (high.slope - low.slope) / (2.0 * step);
        assert!((slope - here.slope).abs() < 1e-7 * (1.0 + here.slope.abs()), "{at}: {slope} {}", here.slope);
        assert!((curvature - here.curvature).abs() < 1e-6 * here.curvature, "{at}: {curvature} {}", here.curvature);
    }

    #[test]
    fn fibre_energy_derivatives() {
        let parameters = parameters(Compaction::Quadratic);
        for u in [-0.02, 0.004, 0.009, 0.02] {
            check(|u| fibre_energy(&parameters, u), u);
        }
    }

    #[test]
    fn compaction_derivatives() {
        for compaction in
            [Compaction::Quadratic, Compaction::Power { k_p: 300.0, m: 2.5 }, Compaction::LockUp { z_lock: -0.3 }]
        {
            let parameters = parameters(compaction);
            for z in [-0.25, -0.1, -0.01, 0.05] {
                check(|z| compaction_energy(&parameters, z), z);
            }
        }
    }

    #[test]
    fn toe_is_twice_continuously_differentiable() {
        let parameters = parameters(Compaction::Quadratic);
        for edge in [0.0, 0.01] {
            let (below, above) = (fibre_energy(&parameters, edge - 1e-14), fibre_energy(&parameters, edge + 1e-14));
            assert!((below.slope - above.slope).abs() < 1e-9);
            assert!((below.curvature - above.curvature).abs() < 1e-6);
        }
    }

    #[test]
    fn locked_up_has_no_answer() {
        let parameters = parameters(Compaction::LockUp { z_lock: -0.3 });
        assert!(!AxialResponse::new(&parameters, 0.0, -0.3).valid);
        assert!(AxialResponse::new(&parameters, 0.0, -0.299).valid);
    }
}
