//! The return map of one sliding mode.

use super::parameters::{Friction, Hardening, ModeParameters};
use crate::strain::{dot, norm};

/// Rounding units of the trial force below which a point counts as sticking.
const YIELD_TOLERANCE: f64 = 32.0 * f64::EPSILON;
/// More Newton steps than any saturating return takes.
const MAX_NEWTON_STEPS: usize = 100;
/// Relative Newton step after which the next one is below rounding.
const CONVERGED: f64 = 1e-9;

/// State of one mode.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ModeState {
    /// `I^P`.
    pub(crate) plastic: [f64; 2],
    /// `kappa`.
    pub(crate) sliding: f64,
    /// End-value dissipation.
    pub(crate) dissipation: f64,
}

/// What drives a mode in one increment.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ModeInput {
    /// The strain mode at the end of the increment.
    pub(crate) strain: [f64; 2],
    pub(crate) old: ModeState,
    pub(crate) pressure: f64,
    pub(crate) old_pressure: f64,
}

/// Outcome of the backward Euler update of one mode.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ModeUpdate {
    pub(crate) new: ModeState,
    /// `q = K (I - I^P)`.
    pub(crate) force: [f64; 2],
    /// `1/2 K |I - I^P|^2 + 1/2 X |I^P|^2`.
    pub(crate) stored: f64,
    /// Mid-point dissipation of the increment.
    pub(crate) dissipated_mid: f64,
    pub(crate) slides: bool,
    /// `dq/dI = across (1 - n n) + along n n`.
    pub(crate) across: f64,
    pub(crate) along: f64,
    /// Sliding direction `n`.
    pub(crate) direction: [f64; 2],
    /// `dq/dp = pressure_slope n`.
    pub(crate) pressure_slope: f64,
}

impl ModeUpdate {
    /// Updates the mode; elastic when it has no friction.
    #[inline(always)]
    pub(crate) fn new(mode: &ModeParameters, input: &ModeInput) -> Self {
        let Some(friction) = &mode.friction else {
            return Self::sticking(mode.k, 0.0, input);
        };
        let back = friction.x;
        let (strain, plastic) = (input.strain, input.old.plastic);
        // xi = q - b at frozen plastic strain.
        let trial = [
            mode.k * (strain[0] - plastic[0]) - back * plastic[0],
            mode.k * (strain[1] - plastic[1]) - back * plastic[1],
        ];
        let hardening = friction.hardening(input.old.sliding);
        let resistance = friction.tau + hardening + friction.mu * input.pressure;
        let magnitude = norm(trial);
        let excess = magnitude - resistance;
        let rounding = mode.k * (strain[0].abs() + strain[1].abs())
            + (mode.k + back) * (plastic[0].abs() + plastic[1].abs())
            + resistance;
        if excess > YIELD_TOLERANCE * rounding {
            Self::sliding(mode.k, friction, input, Trial { vector: trial, magnitude, excess, hardening })
        } else {
            Self::sticking(mode.k, back, input)
        }
    }

    #[inline]
    fn sticking(k: f64, back: f64, input: &ModeInput) -> Self {
        let plastic = input.old.plastic;
        let elastic = [input.strain[0] - plastic[0], input.strain[1] - plastic[1]];
        Self {
            new: input.old,
            force: [k * elastic[0], k * elastic[1]],
            stored: 0.5 * (k * dot(elastic, elastic) + back * dot(plastic, plastic)),
            dissipated_mid: 0.0,
            slides: false,
            across: k,
            along: k,
            direction: [0.0; 2],
            pressure_slope: 0.0,
        }
    }

    /// Radial return: the excess of the trial force is spent on `N = K + X + hardening`.
    #[inline]
    fn sliding(k: f64, friction: &Friction, input: &ModeInput, trial: Trial) -> Self {
        let old = input.old;
        let Advance { increment, hardening, slope, work } = friction.advance(k, old.sliding, &trial);
        let inverse = 1.0 / trial.magnitude;
        let n = [trial.vector[0] * inverse, trial.vector[1] * inverse];
        let plastic = [old.plastic[0] + increment * n[0], old.plastic[1] + increment * n[1]];
        let elastic = [input.strain[0] - plastic[0], input.strain[1] - plastic[1]];
        let sliding = old.sliding + increment;
        let slope = slope + friction.x;
        let total = 1.0 / (k + slope);
        let mean_pressure = 0.5 * (input.pressure + input.old_pressure);
        let end_value = (friction.tau + hardening + friction.mu * input.pressure) * increment;
        Self {
            new: ModeState { plastic, sliding, dissipation: old.dissipation + end_value },
            force: [k * elastic[0], k * elastic[1]],
            stored: 0.5 * (k * dot(elastic, elastic) + friction.x * dot(plastic, plastic)),
            dissipated_mid: (friction.tau + friction.mu * mean_pressure) * increment + work,
            slides: true,
            across: k * (1.0 - k * increment * inverse),
            along: k * slope * total,
            direction: n,
            pressure_slope: k * friction.mu * total,
        }
    }

    /// `dq/dI` applied to a direction.
    #[inline]
    pub(crate) fn stiffness_times(&self, vector: [f64; 2]) -> [f64; 2] {
        let along = (self.along - self.across) * dot(self.direction, vector);
        [self.across * vector[0] + along * self.direction[0], self.across * vector[1] + along * self.direction[1]]
    }
}

/// Trial force `xi`, its length and how far it is beyond the yield surface.
struct Trial {
    vector: [f64; 2],
    magnitude: f64,
    excess: f64,
    /// Isotropic hardening of the old state.
    hardening: f64,
}

/// How far a mode slides and what its isotropic hardening is afterwards.
struct Advance {
    increment: f64,
    hardening: f64,
    slope: f64,
    /// Integral of the hardening over the increment.
    work: f64,
}

impl Friction {
    /// Isotropic hardening at an accumulated sliding.
    #[inline]
    fn hardening(&self, kappa: f64) -> f64 {
        match self.hardening {
            Hardening::Linear { h } => h * kappa,
            // Most points have never slid, and the exponential is dear.
            Hardening::Saturating { .. } if kappa == 0.0 => 0.0,
            Hardening::Saturating { h_inf, kappa_s } => -h_inf * (-kappa / kappa_s).exp_m1(),
        }
    }

    /// Root `d` of `excess - (K + X) d - (hardening(kappa + d) - hardening(kappa)) = 0`.
    #[inline]
    fn advance(&self, k: f64, kappa: f64, trial: &Trial) -> Advance {
        let (stiffness, excess) = (k + self.x, trial.excess);
        match self.hardening {
            Hardening::Linear { h } => {
                let increment = excess / (stiffness + h);
                let new = kappa + increment;
                Advance { increment, hardening: h * new, slope: h, work: 0.5 * h * (kappa + new) * increment }
            }
            Hardening::Saturating { h_inf, kappa_s } => {
                let reserve = h_inf - trial.hardening;
                let (increment, decay) = saturating_root(excess, stiffness, reserve, kappa_s);
                let left = reserve * (1.0 + decay);
                let work = h_inf * increment + kappa_s * reserve * decay;
                Advance { increment, hardening: h_inf - left, slope: left / kappa_s, work }
            }
        }
    }
}

/// Root `d` of `excess - stiffness d - reserve (1 - exp(-d/scale))`, with `exp(-d/scale) - 1`.
///
/// The function is convex and falls, so Newton from a point left of the root climbs to it without overshooting. Both
/// bounds of the hardening, its tangent at 0 and its limit, give such a point; the larger is taken.
#[inline(never)]
fn saturating_root(excess: f64, stiffness: f64, reserve: f64, scale: f64) -> (f64, f64) {
    let tangent = excess / (stiffness + reserve / scale);
    let mut root = tangent.max((excess - reserve) / stiffness);
    let mut decay = (-root / scale).exp_m1();
    for _ in 0..MAX_NEWTON_STEPS {
        let residual = excess - stiffness * root + reserve * decay;
        let climb = residual / (stiffness + reserve / scale * (1.0 + decay));
        // Rounding, not progress, once the steps stop climbing.
        if climb <= root * f64::EPSILON {
            break;
        }
        root += climb;
        decay += (1.0 + decay) * exp_m1(-climb / scale);
        if climb < root * CONVERGED {
            break;
        }
    }
    (root, decay)
}

/// `exp(x) - 1`, by its series for the small arguments that the last Newton steps have.
#[inline]
fn exp_m1(x: f64) -> f64 {
    if x.abs() > 0.03 {
        return x.exp_m1();
    }
    let cubic = 1.0 / 6.0 + x * (1.0 / 24.0 + x * (1.0 / 120.0 + x * (1.0 / 720.0 + x / 5040.0)));
    x + x * x * (0.5 + x * cubic)
}

#[cfg(test)]
mod tests {
    use super::saturating_root;

    #[test]
    fn saturating_return_closes_the_yield_condition() {
        for (excess, stiffness, reserve, scale) in [
            (1.0, 10.0, 0.5, 0.01),
            (1e-9, 10.0, 0.5, 1e-4),
            (5.0, 0.1, 4.9, 1e-3),
            (5.0, 0.1, 5.1, 1e-6),
            (3.0, 20.0, 0.0, 1.0),
        ] {
            let (root, decay) = saturating_root(excess, stiffness, reserve, scale);
            assert!((decay - f64::exp_m1(-root / scale)).abs() < 1e-15);
            let residual = excess - stiffness * root + reserve * f64::exp_m1(-root / scale);
            assert!(
                residual.abs() < 4e-16 * (excess + reserve),
                "{excess} {stiffness} {reserve} {scale}: {residual:e}"
            );
        }
    }
}
