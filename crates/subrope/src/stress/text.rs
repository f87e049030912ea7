//! The table for people (Markdown) and for programs (CSV).

use std::fmt::Write as _;

use super::report::{FamilyReport, StressReport, StressRow};
use super::{Twin, Verdict};
use crate::study::csv_line;

/// `stress.md`: a count of verdicts, then a table per family.
#[must_use]
pub fn markdown(report: &StressReport) -> String {
    let count = |wanted: fn(&Verdict) -> bool| report.rows().filter(|(_, row)| wanted(&row.verdict)).count();
    let total = report.rows().count();
    let mut out = format!(
        "{total} members in {} families: {} hold, {} stop as explained, {} FAIL.\n",
        report.families.len(),
        count(|v| matches!(v, Verdict::Holds)),
        count(|v| matches!(v, Verdict::Stops { .. })),
        count(Verdict::is_failure),
    );
    report.families.iter().for_each(|family| out += &table(family));
    out
}

const HEAD: &str = "| member | reached | increments | iterations | cutbacks | condition | inertia changes | \
     snaps: energy/work | energy error | digits lost | verdict |\n|---|---|---|---|---|---|---|---|---|---|---|\n";

fn table(family: &FamilyReport) -> String {
    let mut out = format!("\n### {}\n\n{}\n\n{HEAD}", family.name, family.question.trim());
    for row in &family.rows {
        let verdict = if row.verdict.is_failure() { "**FAILS**" } else { row.verdict.word() };
        let cells = [
            row.member.replace('|', "\\|"),
            format!("{:.4}", row.reached),
            row.increments.to_string(),
            row.iterations.to_string(),
            row.cutbacks.to_string(),
            condition(row),
            row.inertia_changes.map_or_else(|| "not known".to_owned(), |n| n.to_string()),
            snaps(row),
            format!("{:.0e}", row.energy_error),
            row.digits_lost.map_or_else(|| "-".to_owned(), |d| format!("{d:.1}")),
            verdict.to_owned(),
        ];
        let _ = writeln!(out, "| {} |", cells.join(" | "));
    }
    out += &notes(family);
    out
}

/// How many, with their energy, and whether increments were too long to tell.
fn snaps(row: &StressRow) -> String {
    let told = if row.jumps == 0 { "0".to_owned() } else { format!("{}: {:.1e}", row.jumps, row.released) };
    if row.unresolved { format!("{told}, too long to tell") } else { told }
}

/// The estimate; that of a symmetric part is marked.
fn condition(row: &StressRow) -> String {
    let mark = if row.symmetric { "" } else { "*" };
    row.condition.map_or_else(|| "-".to_owned(), |c| format!("{c:.0e}{mark}"))
}

/// Messages, limits and remarks below a table.
fn notes(family: &FamilyReport) -> String {
    let mut out = String::new();
    for row in &family.rows {
        let message = row.verdict.message();
        if !message.is_empty() {
            let _ = write!(out, "\n- *{}*: {}", row.member, message.replace('\n', " "));
        }
    }
    for (member, reason) in &family.limits {
        let who = if member == "*" { "Limit".to_owned() } else { format!("Limit, *{member}*") };
        let _ = write!(out, "\n- {who}: {}", reason.trim());
    }
    let bounds = [(family.within, 1e-6, "difference in other units"), (family.energy, 1e-2, "energy left open")];
    for (bound, usual, what) in bounds {
        if bound != usual {
            let _ = write!(out, "\n- {what} allowed: {bound:.0e}");
        }
    }
    out += if out.is_empty() { "" } else { "\n" };
    if let Some(remark) = &family.remark {
        let _ = write!(out, "\n{}\n", remark.trim());
    }
    out
}

const COLUMNS: [&str; 19] = [
    "family",
    "member",
    "reached [-]",
    "increments",
    "iterations",
    "cutbacks",
    "condition [-]",
    "symmetric",
    "inertia_changes",
    "snaps",
    "released [-]",
    "unresolved",
    "energy_error [-]",
    "twin",
    "difference [-]",
    "digits_lost [-]",
    "seconds [s]",
    "verdict",
    "message",
];

/// `stress.csv`: one row per member; empty fields are unknown.
#[must_use]
pub fn csv(report: &StressReport) -> String {
    let mut out = csv_line(&COLUMNS.map(str::to_owned));
    for (family, row) in report.rows() {
        let known = |value: Option<f64>| value.map_or_else(String::new, |v| format!("{v:?}"));
        out += &csv_line(&[
            family.name.clone(),
            row.member.clone(),
            format!("{:?}", row.reached),
            row.increments.to_string(),
            row.iterations.to_string(),
            row.cutbacks.to_string(),
            known(row.condition),
            row.symmetric.to_string(),
            row.inertia_changes.map_or_else(String::new, |n| n.to_string()),
            row.jumps.to_string(),
            format!("{:?}", row.released),
            row.unresolved.to_string(),
            format!("{:?}", row.energy_error),
            Twin::to_string(&row.twin),
            known(row.difference),
            known(row.digits_lost),
            format!("{:.3}", row.seconds),
            row.verdict.word().to_owned(),
            row.verdict.message(),
        ]);
    }
    out
}
