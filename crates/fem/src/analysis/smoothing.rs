//! Smoothing that vanishes: Newton's method by way of a softened model.
//!
//! Pressure that sets in at once leaves Newton's method to find out point by point what touches; where strands just
//! touch along a long line it may go round in circles, however short the increment. Contributions that can soften
//! what sets in abruptly do so in part, the iteration starts from the state found, and softens less, until nothing is
//! softened: the state it ends in is one of the model as it is, to the tolerances asked for.

use super::driver::Analysis;
use super::line_search::ends_search;
use super::newton::Attempt;
use super::record::IncrementRecord;
use super::workspace::Workspace;
use crate::FemError;

/// Parts of the softening, one after the other.
const PARTS: [f64; 4] = [1.0, 0.1, 0.01, 0.0];

/// Tolerances before the last.
const ROUGH: f64 = 1e-4;

impl Analysis {
    /// Whether Newton's method may try again on a softened model.
    pub(super) fn may_soften(&mut self, attempt: Attempt, cause: &FemError) -> bool {
        attempt.may_soften && !ends_search(cause) && self.soften(0.0)
    }

    /// Newton's method with less and less softening.
    pub(super) fn iterate_softened(
        &mut self,
        work: &mut Workspace,
        attempt: Attempt,
        record: &mut IncrementRecord,
    ) -> Result<(), FemError> {
        record.smoothed = true;
        let exact = self.options;
        self.options.force_tolerance = exact.force_tolerance.max(ROUGH);
        self.options.energy_tolerance = exact.energy_tolerance.max(ROUGH);
        let mut outcome = Ok(());
        for part in PARTS {
            self.soften(part);
            if part == 0.0 {
                self.options = exact;
            }
            let start = part == PARTS[0];
            outcome = self.iterate_at_part(work, attempt, record, start);
            if outcome.is_err() {
                break;
            }
        }
        self.options = exact;
        self.soften(0.0);
        outcome
    }

    fn iterate_at_part(
        &mut self,
        work: &mut Workspace,
        attempt: Attempt,
        record: &mut IncrementRecord,
        start: bool,
    ) -> Result<(), FemError> {
        if start {
            return self.iterate(work, attempt, record);
        }
        work.factors.forget();
        self.iterate_here(work, attempt, record)
    }

    /// Softens all contributions by a part; says whether there is one that can be.
    fn soften(&mut self, part: f64) -> bool {
        self.model.contributions.iter_mut().fold(false, |any, c| c.soften(part) | any)
    }
}
