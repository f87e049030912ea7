//! Comparisons that keep the worst number.

use std::collections::BTreeMap;
use std::fmt;

use nalgebra::Matrix3;

/// Relative deviation of a value from its reference.
#[must_use]
pub fn relative(value: f64, reference: f64) -> f64 {
    (value - reference).abs() / reference.abs()
}

/// Fails unless a value is within a relative tolerance of its reference.
#[track_caller]
pub fn close(what: &str, value: f64, reference: f64, tolerance: f64) {
    let error = relative(value, reference);
    assert!(error <= tolerance, "{what}: {value} instead of {reference}: off by {error:.3e}, allowed {tolerance:e}");
}

/// Fails unless every entry is within a tolerance of its reference, over the largest entry of that.
#[track_caller]
pub fn matrix_close(what: &str, value: &Matrix3<f64>, reference: &Matrix3<f64>, tolerance: f64) {
    let error = (value - reference).amax() / reference.amax();
    assert!(error <= tolerance, "{what}: {value} instead of {reference}: off by {error:.3e}, allowed {tolerance:e}");
}

/// Numbers with two digits, for a log.
#[must_use]
pub fn scientific(values: &[f64]) -> String {
    values.iter().map(|v| format!("{v:.1e}")).collect::<Vec<_>>().join(" ")
}

/// Largest deviations by name.
#[derive(Clone, Debug, Default)]
pub struct Worst(BTreeMap<&'static str, f64>);

impl Worst {
    /// Takes a deviation into account.
    pub fn see(&mut self, what: &'static str, deviation: f64) {
        let entry = self.0.entry(what).or_insert(0.0);
        // A NaN must not get lost.
        *entry = if deviation.is_nan() { f64::INFINITY } else { entry.max(deviation) };
    }

    /// The largest of all.
    #[must_use]
    pub fn largest(&self) -> f64 {
        self.0.values().copied().fold(0.0, f64::max)
    }
}

impl fmt::Display for Worst {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (what, deviation) in &self.0 {
            write!(f, "{what} {deviation:.2e}  ")?;
        }
        Ok(())
    }
}
