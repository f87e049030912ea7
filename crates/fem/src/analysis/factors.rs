//! When the factors of an earlier iterate serve the next ones.
//!
//! Where factors are large, a factorisation costs as much as many solutions with them, and near the end of an increment
//! the tangent hardly changes from one iterate to the next. Old factors then precondition GMRES on the new tangent: the
//! iteration stays Newton's, with its linear systems solved as far as they are worth.

use crate::linear::GmresLimits;

/// Fall of the residual in one correction from which the tangent counts as nearly constant: what is left of the error is
/// of the order of the change of the tangent. (.1 took one factorisation more for 19 200 bricks, and no fewer elsewhere.)
const NEAR: f64 = 0.3;
/// Part of what a factorisation costs that may be spent on a solution without one.
const SHARE: f64 = 0.5;
/// Fewer iterations of GMRES than this are not worth an attempt.
const LEAST: f64 = 4.0;
/// Relative residuals of the linear systems: no correction that leaves more is taken, none is asked to leave less.
const COARSEST: f64 = 1e-2;
const FINEST: f64 = 1e-7;
/// Iterations of GMRES after which their rate is believed.
const TRUSTED: usize = 3;

/// The factors at hand in an attempt.
#[derive(Clone, Copy, Debug, Default)]
pub struct KeptFactors {
    /// Most iterations of GMRES; zero where factors are never kept.
    most: usize,
    /// Whether they are of this attempt, and have not failed in it.
    usable: bool,
}

impl KeptFactors {
    /// For factors that cost as much as `worth` solutions.
    pub fn new(worth: f64) -> Self {
        let most = SHARE * worth;
        Self { most: if most >= LEAST { most as usize } else { 0 }, usable: false }
    }

    /// Whether factors are ever kept.
    pub fn any(self) -> bool {
        self.most > 0
    }

    /// Forgets the factors of the attempt before: how an attempt goes depends on nothing but the committed state.
    pub fn forget(&mut self) {
        self.usable = false;
    }

    /// Notes that there are factors of the present iterate, and whether older ones have failed before.
    pub fn renew(&mut self, after_failure: bool) {
        self.usable = !after_failure;
    }

    /// How far to solve the next linear system with them; `None` if it wants factors of its own. `residuals` are the
    /// relative ones of the attempt so far.
    pub fn limits(self, residuals: &[f64], tolerance: f64) -> Option<GmresLimits> {
        let &[.., before, now] = residuals else { return None };
        let fall = now / before;
        if self.most == 0 || !self.usable || fall.is_nan() || fall > NEAR {
            return None;
        }
        // Newton's next residual falls by the square of this fall at best, and need not fall far below the tolerance.
        let target = (fall * fall).max(0.1 * tolerance / now).clamp(FINEST, COARSEST);
        Some(GmresLimits { target, limit: COARSEST, most: self.most, trusted: TRUSTED })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kept(worth: f64) -> KeptFactors {
        let mut kept = KeptFactors::new(worth);
        kept.renew(false);
        kept
    }

    #[test]
    fn cheap_factors_are_not_kept() {
        assert!(kept(7.0).limits(&[1.0, 1e-3], 1e-8).is_none());
        assert!(kept(8.0).limits(&[1.0, 1e-3], 1e-8).is_some());
    }

    #[test]
    fn factors_serve_where_the_tangent_is_nearly_constant() {
        let kept = kept(20.0);
        assert!(kept.limits(&[], 1e-8).is_none() && kept.limits(&[1.0], 1e-8).is_none());
        assert!(kept.limits(&[1.0, 0.4], 1e-8).is_none(), "the residual falls too little");
        assert!(kept.limits(&[1.0, f64::NAN], 1e-8).is_none());
        let limits = kept.limits(&[10.0, 1.0, 1e-2], 1e-8);
        assert_eq!(limits.map(|l| (l.target, l.most)), Some((1e-4, 10)));
        let near_the_end = kept.limits(&[1.0, 1e-2, 1e-6], 1e-8);
        assert_eq!(near_the_end.map(|l| l.target), Some(1e-3));
    }

    #[test]
    fn factors_that_failed_or_are_of_another_attempt_are_not_used() {
        let mut kept = kept(20.0);
        kept.renew(true);
        assert!(kept.limits(&[1.0, 1e-3], 1e-8).is_none());
        kept.renew(false);
        kept.forget();
        assert!(kept.limits(&[1.0, 1e-3], 1e-8).is_none());
    }
}
