//! The account of an increment: changes of inertia, and energy that left in a snap.
//!
//! Work of the external forces less what is stored and dissipated,
//!
//! ```text
//! delta = W - dU - D,
//! ```
//!
//! vanishes with the increment where equilibrium changes gradually. Where the structure jumps it does not: what is missing
//! is the energy that a body with mass would carry off as motion; what is too much (`delta < 0`) came from nowhere, since
//! the iteration ended on a branch of higher energy. The trapezoidal rule knows the work of forces that
//! change monotonely over the increment to within `1/2 sum |dF dq|`; where their rate changes, to within about half of the
//! change of the second-order work `s = sum dF dq` against that of the last increment, lengths allowed for; mid-point
//! dissipation is as sure as its distance from the end value. More than all of this together is a jump:
//!
//! ```text
//! |delta| > 1/2 sum |dF dq| + 1/2 |s - s_last (h/h_last)^2| + |D_end - D_mid| + (D_contact + D_viscous)/2.
//! ```
//!
//! A long increment has wide bounds and can hide a jump. What all increments leave open within their bounds is added up:
//! where it comes to more than a twentieth of all work, the balance cannot tell, and shorter increments find out.

use super::driver::Analysis;
use super::newton::Attempt;
use super::record::{IncrementRecord, Totals};
use super::workspace::Workspace;

/// Part of the energies at work that counts as rounding and as what an iteration leaves.
const NOISE: f64 = 1e-7;

/// Part of all work that increments may leave open before they count as too long.
const OPEN: f64 = 0.05;

/// What an increment starts from, and how well its work can be known.
pub struct Ledger {
    /// Totals before.
    before: Totals,
    /// `1/2 sum |dF dq|` \[mJ\].
    monotone: f64,
    /// `sum dF dq` over the length squared \[mJ\].
    curvature: f64,
    /// The same of the last increment; none at the start of a step.
    last_curvature: Option<f64>,
    length: f64,
}

impl Ledger {
    /// `sum dF dq` over the length squared \[mJ\].
    pub fn curvature(&self) -> f64 {
        self.curvature
    }
}

impl Totals {
    /// Counts a converged increment on an unstable branch, and the change of inertia.
    pub(super) fn note_inertia(&mut self, record: &mut IncrementRecord) {
        let Some(now) = record.negative_pivots else { return };
        let before = self.negative_pivots.replace(now).unwrap_or(0);
        self.unstable_increments += usize::from(now > 0);
        if now != before {
            self.inertia_changes += 1;
            record.inertia_change = Some((before, now));
        }
    }

    /// Whether increments were so long that their balances leave more than a twentieth of all work open: a snap cannot be
    /// told from the error of the trapezoidal rule.
    #[must_use]
    pub fn is_unresolved(&self) -> bool {
        self.open > OPEN * self.work_scale
    }

    /// `W - U - D` with mid-point dissipation \[mJ\].
    pub(super) fn missing(&self) -> f64 {
        let kept = self.stored + self.contact_stored;
        let lost = self.dissipated_mid.iter().sum::<f64>() + self.contact_friction + self.stabilising;
        self.external_work - kept - lost
    }
}

impl Analysis {
    /// Opens the account of an increment that has converged and is not committed yet.
    pub(super) fn ledger(&self, work: &Workspace, attempt: Attempt) -> Ledger {
        let (new, target) = (&work.base, &work.target);
        let (mut monotone, mut second) = (0.0, 0.0);
        let mut add = |force: f64, change: f64| {
            monotone += 0.5 * (force * change).abs();
            second += force * change;
        };
        for c in 0..self.q.len() {
            let held = if self.prescribed[c] { new.residual[c] - self.reaction[c] } else { 0.0 };
            add(target.coordinates[c] - self.coordinate_load[c] + held, new.q[c] - self.q[c]);
        }
        for i in 0..self.displacement.len() {
            add(target.nodal[i] - self.nodal_load[i], new.displacement[i] - self.displacement[i]);
        }
        let length = attempt.length;
        let last_curvature = (self.last_length > 0.0).then_some(self.curvature);
        Ledger { before: self.totals, monotone, curvature: second / (length * length), last_curvature, length }
    }

    /// Closes it after the commit, and notes a snap.
    pub(super) fn settle_account(&mut self, ledger: &Ledger, record: &mut IncrementRecord) {
        let Ledger { before, monotone, curvature, last_curvature, length } = ledger;
        self.curvature = *curvature;
        let totals = &mut self.totals;
        let missing = totals.missing() - before.missing();
        let change = last_curvature.map_or(0.0, |last| (curvature - last).abs() * length * length);
        let slid = |t: &Totals| t.dissipated.iter().sum::<f64>() - t.dissipated_mid.iter().sum::<f64>();
        let sliding = (slid(totals) - slid(before)).abs();
        let rubbing =
            totals.contact_friction - before.contact_friction + (totals.interference - before.interference).abs();
        let damped = totals.stabilising - before.stabilising;
        // Multipliers that have moved hold what was stored in the compliance of contacts.
        let moved = totals.augmentations > before.augmentations;
        let multipliers = if moved { (totals.contact_stored - before.contact_stored).abs() } else { 0.0 };
        let sure = monotone + 0.5 * change + sliding + 0.5 * (rubbing + damped) + multipliers;
        let noise = NOISE * (totals.work_scale + totals.stored.abs());
        if missing.abs() > sure + noise {
            totals.jumps += 1;
            totals.released += missing;
            record.released = missing;
        } else {
            totals.open += missing.abs();
        }
    }
}
