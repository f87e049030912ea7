//! The report: families, their members, and what was found.

use std::sync::atomic::AtomicBool;
use std::time::Instant;

use serde::Serialize;

use super::compare::Outcome;
use super::{Run, StressFamily, StressMember, Twin, Verdict, digits_lost, judge};

/// All rows of a table.
#[derive(Clone, Debug, Serialize)]
pub struct StressReport {
    /// Version of the program.
    pub version: &'static str,
    /// Families in the order of their lists.
    pub families: Vec<FamilyReport>,
}

impl StressReport {
    pub(super) fn new() -> Self {
        Self { version: env!("CARGO_PKG_VERSION"), families: Vec::new() }
    }

    /// All rows with their family.
    pub fn rows(&self) -> impl Iterator<Item = (&FamilyReport, &StressRow)> {
        self.families.iter().flat_map(|family| family.rows.iter().map(move |row| (family, row)))
    }

    /// Names of the members that fail, with their family.
    #[must_use]
    pub fn failures(&self) -> Vec<String> {
        let failed = self.rows().filter(|(_, row)| row.verdict.is_failure());
        failed.map(|(family, row)| format!("{}: {}", family.name, row.member)).collect()
    }
}

/// A family with its rows.
#[derive(Clone, Debug, Serialize)]
pub struct FamilyReport {
    /// Its name.
    pub name: String,
    /// What it asks.
    pub question: String,
    /// What the results say.
    pub remark: Option<String>,
    /// Explained limits: member and reason.
    pub limits: Vec<(String, String)>,
    /// Largest difference allowed in other units \[-\].
    pub within: f64,
    /// Part of the work that may be left open \[-\].
    pub energy: f64,
    /// One per member.
    pub rows: Vec<StressRow>,
}

impl FamilyReport {
    pub(super) fn new(family: &StressFamily, rows: Vec<StressRow>) -> Self {
        Self {
            name: family.name.clone(),
            question: family.question.clone(),
            remark: family.remark.clone(),
            limits: family.limits.iter().map(|(member, reason)| (member.clone(), reason.clone())).collect(),
            within: family.within,
            energy: family.energy,
            rows,
        }
    }
}

/// What a member gave.
#[derive(Clone, Debug, Serialize)]
pub struct StressRow {
    /// Its name.
    pub member: String,
    /// Units of the second run.
    pub twin: Twin,
    /// Part of all steps that was reached \[-\].
    pub reached: f64,
    /// Converged increments.
    pub increments: usize,
    /// Newton iterations, those of failed attempts included.
    pub iterations: usize,
    /// Failed attempts.
    pub cutbacks: usize,
    /// Estimate of the condition number of the last tangent \[-\].
    pub condition: Option<f64>,
    /// Whether the tangent is symmetric: otherwise the condition is that of its symmetric part and inertia is not known.
    pub symmetric: bool,
    /// Changes of inertia that were reported; none where it is not known.
    pub inertia_changes: Option<usize>,
    /// Snaps that were reported.
    pub jumps: usize,
    /// Energy released in them over the largest external work \[-\].
    pub released: f64,
    /// Whether increments were reported as too long to tell a snap.
    pub unresolved: bool,
    /// What the balance leaves open over the largest external work, snaps included \[-\].
    pub energy_error: f64,
    /// Relative difference of the dimensionless results in other units \[-\].
    pub difference: Option<f64>,
    /// Digits lost \[-\].
    pub digits_lost: Option<f64>,
    /// Time of both runs \[s\].
    pub seconds: f64,
    /// Verdict.
    #[serde(flatten)]
    pub verdict: Verdict,
}

impl StressRow {
    /// Runs a member and its twin.
    pub(super) fn run(family: &StressFamily, member: &StressMember, interrupt: Option<&AtomicBool>) -> Self {
        let start = Instant::now();
        let run = Run::of(&member.text, Twin::NONE, family.time_limit, interrupt);
        let other = Run::of(&member.text, member.twin, family.time_limit, interrupt);
        let outcome = Outcome::of(&run, &other, member.twin);
        let verdict = judge(family, &member.name, (&run, &other), &outcome);
        let m = run.measured;
        Self {
            member: member.name.clone(),
            twin: member.twin,
            reached: m.reached,
            increments: m.increments,
            iterations: m.iterations,
            cutbacks: m.cutbacks,
            condition: m.condition,
            symmetric: m.symmetric,
            inertia_changes: m.symmetric.then_some(m.inertia_changes),
            jumps: m.jumps,
            released: m.released,
            unresolved: m.unresolved,
            energy_error: m.energy_error,
            difference: outcome.difference,
            digits_lost: outcome.difference.map(digits_lost),
            seconds: start.elapsed().as_secs_f64(),
            verdict,
        }
    }
}
