//! The axial energy `W_A = W_e(u) + W_c(z)`, `z = I_comp + nu u`, `u` the fibre elongation.

use super::parameters::{BundleParameters, Compaction};
use crate::LawError;

/// An energy of one variable with its two derivatives.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Potential {
    pub(crate) energy: f64,
    pub(crate) slope: f64,
    pub(crate) curvature: f64,
}

/// `W_A` with its derivatives by elongation `u` and compaction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AxialResponse {
    pub(crate) energy: f64,
    /// `W_,e = W_e' + nu W_c'`.
    pub(crate) by_elongation: f64,
    /// `W_,c = W_c'`.
    pub(crate) by_compaction: f64,
    pub(crate) elongation_stiffness: f64,
    pub(crate) coupling: f64,
    pub(crate) compaction_stiffness: f64,
    /// `p = max(0, -W_c')`.
    pub(crate) pressure: f64,
    /// `dp/dI_comp`.
    pub(crate) pressure_by_compaction: f64,
    /// `dp/du`.
    pub(crate) pressure_by_elongation: f64,
}

impl AxialResponse {
    /// # Errors
    /// [`LawError::LockedUp`].
    #[inline]
    pub(crate) fn new(parameters: &BundleParameters, elongation: f64, compaction: f64) -> Result<Self, LawError> {
        let nu = parameters.nu;
        let fibre = fibre_energy(parameters, elongation);
        let section = compaction_energy(parameters, compaction + nu * elongation)?;
        let pressed = if section.slope < 0.0 { -section.curvature } else { 0.0 };
        Ok(Self {
            energy: fibre.energy + section.energy,
            by_elongation: fibre.slope + nu * section.slope,
            by_compaction: section.slope,
            elongation_stiffness: fibre.curvature + nu * nu * section.curvature,
            coupling: nu * section.curvature,
            compaction_stiffness: section.curvature,
            pressure: (-section.slope).max(0.0),
            pressure_by_compaction: pressed,
            pressure_by_elongation: nu * pressed,
        })
    }
}

/// `W_e`: modulus `K_ec` in compression, rising to `K_e` over the toe as `t^2 (3 - 2t)`, `t = u/w_e`.
#[inline]
fn fibre_energy(parameters: &BundleParameters, u: f64) -> Potential {
    let (w, extra) = (parameters.w_e, parameters.k_e - parameters.k_ec);
    let base = parameters.k_ec;
    let [energy, slope, curvature] = if u < 0.0 {
        [0.0; 3]
    } else if u < w {
        let t = u / w;
        let t2 = t * t;
        [w * w * t2 * t2 * (0.25 - 0.1 * t), w * t2 * t * (1.0 - 0.5 * t), t2 * (3.0 - 2.0 * t)]
    } else {
        // 3/20 w^2 is the energy at the end of the toe.
        [0.15 * w * w + 0.5 * u * (u - w), u - 0.5 * w, 1.0]
    };
    Potential {
        energy: 0.5 * base * u * u + extra * energy,
        slope: base * u + extra * slope,
        curvature: base + extra * curvature,
    }
}

/// `W_c(z)`, see [`Compaction`].
#[inline]
fn compaction_energy(parameters: &BundleParameters, z: f64) -> Result<Potential, LawError> {
    let k = parameters.k_c;
    let quadratic = Potential { energy: 0.5 * k * z * z, slope: k * z, curvature: k };
    if z >= 0.0 {
        return Ok(quadratic);
    }
    match parameters.compaction {
        Compaction::Quadratic => Ok(quadratic),
        Compaction::Power { k_p, m } => Ok(with_power(quadratic, -z, k_p, m)),
        Compaction::LockUp { z_lock } => lock_up(k, z, z_lock),
    }
}

/// Adds `K_p depth^m`, `depth = -z`.
fn with_power(quadratic: Potential, depth: f64, k_p: f64, m: f64) -> Potential {
    let power = k_p * depth.powf(m - 2.0);
    Potential {
        energy: quadratic.energy + power * depth * depth,
        slope: quadratic.slope - m * power * depth,
        curvature: quadratic.curvature + m * (m - 1.0) * power,
    }
}

/// `-1/2 K_c z_l^2 ln(1 - (z/z_l)^2)`.
fn lock_up(k: f64, z: f64, limit: f64) -> Result<Potential, LawError> {
    if z <= limit {
        return Err(LawError::LockedUp { compaction: z, limit });
    }
    let ratio = z / limit;
    let room = (1.0 - ratio) * (1.0 + ratio);
    Ok(Potential {
        energy: -0.5 * k * limit * limit * (-ratio * ratio).ln_1p(),
        slope: k * z / room,
        curvature: k * (1.0 + ratio * ratio) / (room * room),
    })
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
    fn check(potential: impl Fn(f64) -> Potential, at: f64) {
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
                check(|z| compaction_energy(&parameters, z).unwrap(), z);
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
    fn lock_up_is_an_error() {
        let parameters = parameters(Compaction::LockUp { z_lock: -0.3 });
        let error = AxialResponse::new(&parameters, 0.0, -0.3).unwrap_err();
        assert_eq!(error, LawError::LockedUp { compaction: -0.3, limit: -0.3 });
    }
}
