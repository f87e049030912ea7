//! The equation u + e sin(u) = m.

use std::f64::consts::{PI, TAU};

/// The solution u of u + e sin(u) = m, e >= 0, that minimises (u - m)^2/2 - e cos(u).
///
/// It is the only solution for e <= 1. With m reduced to \[-pi, pi\] it lies between 0 and m, where the left side is
/// concave (for m > 0, odd otherwise), so that Newton's iteration started at 0 grows to it without overshooting.
pub(crate) fn kepler(e: f64, m: f64) -> f64 {
    let turns = (m / TAU).round();
    let reduced = m - turns * TAU;
    let target = reduced.abs().min(PI);
    let mut u = target / (1.0 + e);
    for _ in 0..100 {
        let step = (target - u - e * u.sin()) / (1.0 + e * u.cos());
        // Close to the solution rounding makes the step negative or lets the slope vanish.
        if !(step > 1e-16 * target && step.is_finite()) {
            break;
        }
        u = (u + step).min(target);
    }
    turns * TAU + u.copysign(reduced)
}
