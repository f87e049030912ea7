//! The return map of one sliding mode.

use super::parameters::{Friction, Hardening, ModeParameters};
use crate::lanes::{Lanes, MAX_LANES};
use crate::strain::{dot, norm};

/// Rounding units of the trial force below which a point counts as sticking.
const YIELD_TOLERANCE: f64 = 32.0 * f64::EPSILON;
/// More Newton steps than any saturating return takes.
const MAX_NEWTON_STEPS: usize = 100;
/// Relative Newton step after which the next one is below rounding.
const CONVERGED: f64 = 1e-9;

/// State of one mode.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ModeState<V> {
    /// `I^P`.
    pub(crate) plastic: [V; 2],
    /// `kappa`.
    pub(crate) sliding: V,
    /// End-value dissipation.
    pub(crate) dissipation: V,
}

/// What drives a mode in one increment.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ModeInput<V> {
    /// The strain mode at the end of the increment.
    pub(crate) strain: [V; 2],
    pub(crate) old: ModeState<V>,
    pub(crate) pressure: V,
    pub(crate) old_pressure: V,
}

/// Outcome of the backward Euler update of one mode.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ModeUpdate<V: Lanes> {
    pub(crate) new: ModeState<V>,
    /// `q = K (I - I^P)`.
    pub(crate) force: [V; 2],
    /// `1/2 K |I - I^P|^2 + 1/2 X |I^P|^2`.
    pub(crate) stored: V,
    /// Mid-point dissipation of the increment.
    pub(crate) dissipated_mid: V,
    pub(crate) slides: V::Mask,
    /// `dq/dI = across (1 - n n) + along n n`.
    pub(crate) across: V,
    pub(crate) along: V,
    /// Sliding direction `n`.
    pub(crate) direction: [V; 2],
    /// `dq/dp = pressure_slope n`.
    pub(crate) pressure_slope: V,
}

impl<V: Lanes> ModeUpdate<V> {
    /// Updates the mode; elastic when it has no friction.
    #[inline(always)]
    pub(crate) fn new(mode: &ModeParameters, input: &ModeInput<V>) -> Self {
        let Some(friction) = &mode.friction else {
            return Self::sticking(mode.k, 0.0, input);
        };
        let trial = Trial::new(mode.k, friction, input);
        if V::any(trial.slides) {
            Self::sliding(mode.k, friction, input, &trial)
        } else {
            Self::sticking(mode.k, friction.x, input)
        }
    }

    #[inline(always)]
    fn sticking(k: f64, back: f64, input: &ModeInput<V>) -> Self {
        let plastic = input.old.plastic;
        let elastic = [input.strain[0] - plastic[0], input.strain[1] - plastic[1]];
        let zero = input.pressure.splat(0.0);
        Self {
            new: input.old,
            force: [elastic[0] * k, elastic[1] * k],
            stored: dot(elastic, elastic) * (0.5 * k) + dot(plastic, plastic) * (0.5 * back),
            dissipated_mid: zero,
            slides: zero.lt(zero),
            across: zero.splat(k),
            along: zero.splat(k),
            direction: [zero; 2],
            pressure_slope: zero,
        }
    }

    /// Radial return: the excess of the trial force is spent on `N = K + X + hardening`; of nothing where it sticks.
    #[inline(always)]
    fn sliding(k: f64, friction: &Friction, input: &ModeInput<V>, trial: &Trial<V>) -> Self {
        let (old, zero) = (input.old, input.pressure.splat(0.0));
        let Advance { increment, hardening, slope, work } = friction.advance(k, old.sliding, trial);
        let inverse = V::select(trial.slides, zero.splat(1.0) / trial.magnitude, zero);
        let n = [trial.vector[0] * inverse, trial.vector[1] * inverse];
        let plastic = [old.plastic[0] + increment * n[0], old.plastic[1] + increment * n[1]];
        let elastic = [input.strain[0] - plastic[0], input.strain[1] - plastic[1]];
        let slope = slope + friction.x;
        let total = zero.splat(1.0) / (slope + k);
        let mean_pressure = (input.pressure + input.old_pressure) * 0.5;
        // A threshold may be infinite where nothing slides.
        let tau = V::select(trial.slides, zero.splat(friction.tau), zero);
        let end_value = (tau + hardening + input.pressure * friction.mu) * increment;
        Self {
            new: ModeState { plastic, sliding: old.sliding + increment, dissipation: old.dissipation + end_value },
            force: [elastic[0] * k, elastic[1] * k],
            stored: dot(elastic, elastic) * (0.5 * k) + dot(plastic, plastic) * (0.5 * friction.x),
            dissipated_mid: (tau + mean_pressure * friction.mu) * increment + work,
            slides: trial.slides,
            across: (increment * inverse * -k + 1.0) * k,
            along: V::select(trial.slides, slope * total * k, zero.splat(k)),
            direction: n,
            pressure_slope: V::select(trial.slides, total * (k * friction.mu), zero),
        }
    }

    /// `dq/dI` applied to a direction.
    #[inline(always)]
    pub(crate) fn stiffness_times(&self, vector: [f64; 2]) -> [V; 2] {
        let along = (self.along - self.across) * (self.direction[0] * vector[0] + self.direction[1] * vector[1]);
        [self.across * vector[0] + along * self.direction[0], self.across * vector[1] + along * self.direction[1]]
    }
}

/// Trial force `xi = q - b` at frozen plastic strain, its length and how far it is beyond the yield surface.
#[derive(Clone, Copy, Debug)]
struct Trial<V: Lanes> {
    vector: [V; 2],
    magnitude: V,
    slides: V::Mask,
    /// Zero where it sticks.
    excess: V,
    /// Isotropic hardening of the old state.
    hardening: V,
}

impl<V: Lanes> Trial<V> {
    #[inline(always)]
    fn new(k: f64, friction: &Friction, input: &ModeInput<V>) -> Self {
        let back = friction.x;
        let (strain, plastic) = (input.strain, input.old.plastic);
        let vector =
            [(strain[0] - plastic[0]) * k - plastic[0] * back, (strain[1] - plastic[1]) * k - plastic[1] * back];
        let hardening = friction.hardening(input.old.sliding);
        let resistance = hardening + friction.tau + input.pressure * friction.mu;
        let magnitude = norm(vector);
        let excess = magnitude - resistance;
        let rounding =
            (strain[0].abs() + strain[1].abs()) * k + (plastic[0].abs() + plastic[1].abs()) * (k + back) + resistance;
        let slides = (rounding * YIELD_TOLERANCE).lt(excess);
        Self { vector, magnitude, slides, excess: V::select(slides, excess, excess.splat(0.0)), hardening }
    }
}

/// How far a mode slides and what its isotropic hardening is afterwards.
struct Advance<V> {
    increment: V,
    hardening: V,
    slope: V,
    /// Integral of the hardening over the increment.
    work: V,
}

impl Friction {
    /// Isotropic hardening at an accumulated sliding.
    #[inline(always)]
    fn hardening<V: Lanes>(&self, kappa: V) -> V {
        match self.hardening {
            Hardening::Linear { h } => kappa * h,
            Hardening::Saturating { h_inf, kappa_s } => kappa.map(|kappa| {
                // Most points have never slid, and the exponential is dear.
                if kappa == 0.0 { 0.0 } else { -h_inf * (-kappa / kappa_s).exp_m1() }
            }),
        }
    }

    /// Root `d` of `excess - (K + X) d - (hardening(kappa + d) - hardening(kappa)) = 0`.
    #[inline(always)]
    fn advance<V: Lanes>(&self, k: f64, kappa: V, trial: &Trial<V>) -> Advance<V> {
        let (stiffness, excess) = (k + self.x, trial.excess);
        match self.hardening {
            Hardening::Linear { h } => {
                let increment = excess / excess.splat(stiffness + h);
                let new = kappa + increment;
                let work = (kappa + new) * increment * (0.5 * h);
                Advance { increment, hardening: new * h, slope: kappa.splat(h), work }
            }
            Hardening::Saturating { h_inf, kappa_s } => {
                let reserve = -trial.hardening + h_inf;
                let (increment, decay) = saturating_roots(excess, stiffness, reserve, kappa_s);
                let left = reserve * (decay + 1.0);
                let work = increment * h_inf + reserve * decay * kappa_s;
                Advance { increment, hardening: -left + h_inf, slope: left * (1.0 / kappa_s), work }
            }
        }
    }
}

/// [`saturating_root`] where there is an excess; no step elsewhere.
#[inline(never)]
fn saturating_roots<V: Lanes>(excess: V, stiffness: f64, reserve: V, scale: f64) -> (V, V) {
    let (excesses, reserves) = (excess.to_array(), reserve.to_array());
    let mut steps = [(0.0, 0.0); MAX_LANES];
    for (i, step) in steps.iter_mut().enumerate() {
        if excesses[i] > 0.0 {
            *step = saturating_root(excesses[i], stiffness, reserves[i], scale);
        }
    }
    (excess.fill(|i| steps[i].0), excess.fill(|i| steps[i].1))
}

/// Root `d` of `excess - stiffness d - reserve (1 - exp(-d/scale))`, with `exp(-d/scale) - 1`.
///
/// The function is convex and falls, so Newton from a point left of the root climbs to it without overshooting. Both
/// bounds of the hardening, its tangent at 0 and its limit, give such a point; the larger is taken.
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
