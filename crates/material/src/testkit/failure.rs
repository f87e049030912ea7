//! What a failed check says.

use crate::LawError;

/// The worst entry of a comparison.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    /// Row, in the Mandel order.
    pub row: usize,
    /// Column, in the Mandel order; 0 for vectors and numbers.
    pub column: usize,
    /// What the law gave.
    pub found: f64,
    /// What it should be.
    pub expected: f64,
    /// Accepted difference.
    pub tolerance: f64,
}

/// Why a law did not pass the battery.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TestkitFailure {
    /// The law gave no answer.
    #[error("{check}, step {step}: the law gave no answer")]
    NoAnswer {
        /// Which check.
        check: &'static str,
        /// Step of the path.
        step: usize,
        /// What the law said.
        #[source]
        source: LawError,
    },
    /// Two numbers that should agree do not.
    #[error(
        "{check}, step {step}, entry ({}, {}): {:e} instead of {:e}, accepted {:e}",
        entry.row, entry.column, entry.found, entry.expected, entry.tolerance
    )]
    Mismatch {
        /// Which check.
        check: &'static str,
        /// Step of the path.
        step: usize,
        /// The worst entry.
        entry: Entry,
    },
    /// Something dissipated is negative or falls.
    #[error("step {step}: dissipation {value:e} is negative or decreasing")]
    Dissipation {
        /// Step of the path.
        step: usize,
        /// Offending increment.
        value: f64,
    },
    /// An extreme deformation gave an answer that is not finite.
    #[error("extreme deformation {case}: the answer is not finite")]
    NotFinite {
        /// Number of the case.
        case: usize,
    },
    /// A deformation that turns matter inside out, or is not a number, was accepted.
    #[error("extreme deformation {case} was accepted")]
    Accepted {
        /// Number of the case.
        case: usize,
    },
    /// What the law says about itself contradicts what it does.
    #[error("the law contradicts itself: {what}")]
    Contradiction {
        /// Which property.
        what: &'static str,
    },
    /// Every entry of a tangent crossed a kink, so nothing was compared.
    #[error("{check}, step {step}: only {compared} columns could be compared")]
    NothingCompared {
        /// Which check.
        check: &'static str,
        /// Step of the path.
        step: usize,
        /// Columns compared.
        compared: usize,
    },
}

/// Compares two slices column-major with `rows` rows; the failure names the entry farthest beyond its tolerance.
pub(super) fn compare(
    (check, step): (&'static str, usize),
    found: &[f64],
    expected: &[f64],
    rows: usize,
    tolerance: f64,
) -> Result<(), TestkitFailure> {
    let mut worst: Option<(f64, Entry)> = None;
    for (i, (&found, &expected)) in found.iter().zip(expected).enumerate() {
        let error = (found - expected).abs();
        let bad = error > tolerance || error.is_nan();
        if bad && worst.is_none_or(|(largest, _)| error > largest || error.is_nan()) {
            worst = Some((error, Entry { row: i % rows, column: i / rows, found, expected, tolerance }));
        }
    }
    worst.map_or(Ok(()), |(_, entry)| Err(TestkitFailure::Mismatch { check, step, entry }))
}

/// Largest magnitude.
pub(super) fn largest(numbers: &[f64]) -> f64 {
    numbers.iter().fold(0.0, |a: f64, b| a.max(b.abs()))
}
