//! `study.md`: the tables of a study for people, and the answers a terminal shows.

use std::fmt::Write as _;

use super::file::ReferenceKind;
use super::front::{Bound, CostAt, Ratio};
use super::report::{Cheapest, MemberReport, MemberStatus, Pair, QuantityReport, Report, ValueReport};

/// The whole text.
pub(super) fn text(report: &Report) -> String {
    let mut out = format!("# {}\n\n", report.title);
    out += &conditions(report);
    out.push('\n');
    out += &members(report);
    out += &failures(report);
    out += &unstable(report);
    out.push('\n');
    out += &orders(report);
    out.push('\n');
    out += &answers(report);
    out
}

/// How it was measured.
fn conditions(report: &Report) -> String {
    let machine = &report.machine;
    let mut out = format!(
        "Scene `{}`. Time is {} of {}; {}, {} thread{}.",
        report.scene,
        report.clock.word(),
        report.timed,
        if report.repeats == 1 {
            "one run of each member".to_owned()
        } else {
            format!("the smallest of {} runs, all members in turn", report.repeats)
        },
        report.threads,
        if report.threads == 1 { "" } else { "s" },
    );
    if let Some(noise) = report.noise {
        let (median, largest) = (percent(noise.median), percent(noise.largest));
        let _ = write!(out, " Runs of one member differ by {median} in the median, by {largest} at most.");
    }
    let speeds = machine.calibration_gflops.iter().copied();
    let (low, high) = (speeds.clone().fold(f64::INFINITY, f64::min), speeds.fold(0.0, f64::max));
    let processor = machine.processor.as_deref().unwrap_or("unknown processor");
    let _ = write!(out, " Machine: {processor}, {} processors", machine.processors);
    if low.is_finite() {
        let _ = write!(out, ", matrix product {low:.1} to {high:.1} GFLOP/s");
    }
    out += ".\n";
    if !report.complete {
        out += "\nThe study was stopped before its end.\n";
    }
    out
}

/// One row per member; errors on the Pareto front are bold.
fn members(report: &Report) -> String {
    let mut out = "| member | unknowns | increments | iterations | time \\[s\\] | memory \\[MB\\] |".to_owned();
    for q in &report.quantities {
        let _ = write!(out, " {} \\[{}\\] | error |", q.name, q.unit);
    }
    out += "\n|---|---|---|---|---|---|";
    out += &"---|---|".repeat(report.quantities.len());
    out.push('\n');
    for member in &report.members {
        let counts = member.counts.unwrap_or_default();
        let time = member.time.as_ref().map_or_else(|| member.status.word().to_owned(), times);
        let memory = member.memory_mb.map_or_else(|| "-".to_owned(), |m| format!("{m:.0}"));
        let counted = [counts.unknowns, counts.increments, counts.iterations].map(|n| n.to_string()).join(" | ");
        let _ = write!(out, "| {} | {counted} | {time} | {memory} |", cell(&member.name));
        for value in &member.values {
            let _ = write!(out, " {} | {} |", value.value.map_or_else(|| "-".to_owned(), digits), error(value));
        }
        out.push('\n');
    }
    out + "\nBold: on the Pareto front, no other member is both faster and better.\n"
}

fn times(time: &super::report::Times) -> String {
    if time.all.len() > 1 { format!("{} (to {})", seconds(time.min), seconds(time.max)) } else { seconds(time.min) }
}

fn error(value: &ValueReport) -> String {
    match value {
        ValueReport { is_reference: true, .. } => "reference".to_owned(),
        ValueReport { error: Some(error), on_front: true, .. } => format!("**{}**", percent(*error)),
        ValueReport { error: Some(error), .. } => percent(*error),
        ValueReport { missing: Some(missing), .. } => cell(missing),
        _ => "-".to_owned(),
    }
}

fn failures(report: &Report) -> String {
    let failed = |m: &&MemberReport| matches!(m.status, MemberStatus::Failed(_));
    let mut out = String::new();
    for member in report.members.iter().filter(failed) {
        let _ = write!(out, "\n- **{}** failed: {}", member.name, member.status.reason());
    }
    if out.is_empty() { out } else { out + "\n" }
}

/// Members that went along an unstable branch: others may have left it, and then differ by more than the mesh.
fn unstable(report: &Report) -> String {
    let count = |m: &MemberReport| m.counts.map_or(0, |c| c.unstable_increments);
    let told: Vec<_> =
        report.members.iter().filter(|m| count(m) > 0).map(|m| format!("{} ({})", m.name, count(m))).collect();
    if told.is_empty() {
        return String::new();
    }
    format!(
        "\nIncrements on an unstable branch (negative pivots), which other members may have left: {}.\n",
        told.join("; ")
    )
}

/// References and observed orders.
fn orders(report: &Report) -> String {
    let mut out = String::new();
    for q in &report.quantities {
        let _ = write!(out, "- **{}**: ", q.name);
        out += &reference(report, q);
        let told = report.series.iter().zip(&q.orders).filter(|(_, orders)| orders.iter().any(Option::is_some));
        let told: Vec<_> = told
            .map(|(series, orders)| {
                let orders: Vec<_> = orders.iter().map(|p| p.map_or("-".to_owned(), |p| format!("{p:.1}"))).collect();
                format!("{} {} (size {})", series.name, orders.join(", "), series.sizes_from)
            })
            .collect();
        if !told.is_empty() {
            let _ = write!(out, " Observed orders, level by level: {}.", told.join("; "));
        }
        out.push('\n');
    }
    out
}

fn reference(report: &Report, q: &QuantityReport) -> String {
    let Some(reference) = &q.reference else { return "no reference.".to_owned() };
    let whose = match (reference.kind, reference.member) {
        (ReferenceKind::Value, _) => "the value given".to_owned(),
        (ReferenceKind::Extrapolated, _) => {
            format!("extrapolated with the order {:.2}", reference.order.unwrap_or_default())
        }
        (ReferenceKind::Finest, member) => member.map_or_else(String::new, |m| report.members[m].name.clone()),
    };
    let note = reference.note.as_ref().map(|n| format!(" ({n})")).unwrap_or_default();
    format!("reference {} {}, {whose}{note}.", digits(reference.value), q.unit)
}

/// What reaches the target at what cost, quantity by quantity.
#[must_use]
pub fn answers(report: &Report) -> String {
    let target = percent(report.target);
    let mut out = String::new();
    for q in &report.quantities {
        let _ = write!(out, "- **{}** to {target}: ", q.name);
        out += &match (&q.cheapest, &q.best) {
            (Some(found), _) => format!("cheapest is {}.", told(report, found)),
            (None, Some(best)) => {
                let name = &report.members[best.member].name;
                format!("no member reaches it; best is {name} with {}.", percent(best.error))
            }
            (None, None) => "no member can be compared.".to_owned(),
        };
        let times: Vec<_> =
            report.series.iter().zip(&q.time_at_target).filter_map(|(s, t)| Some(needs(&s.name, (*t)?))).collect();
        if !times.is_empty() {
            let _ = write!(out, " Time needed: {}.", times.join("; "));
        }
        if !q.pairs.is_empty() {
            out += " At equal error:";
        }
        out.push('\n');
        q.pairs.iter().for_each(|p| out += &format!("  - {}\n", pair(report, p)));
    }
    if report.quantities.len() > 1 {
        let found = report.cheapest_for_all.as_ref().map(|c| told(report, c));
        let found = found.unwrap_or_else(|| "no member reaches it".to_owned());
        let _ = writeln!(out, "- **all quantities** to {target}: {found}.");
    }
    out
}

fn told(report: &Report, found: &Cheapest) -> String {
    let chance = if found.by_chance { "; a finer level of its series misses the target again" } else { "" };
    let name = &report.members[found.member].name;
    format!("{name} ({} s, error {}{chance})", seconds(found.time), percent(found.error))
}

fn needs(series: &str, time: CostAt) -> String {
    match time {
        CostAt::Between { cost } => format!("{series} {} s", seconds(cost)),
        CostAt::AtMost { cost } => format!("{series} at most {} s", seconds(cost)),
        CostAt::MoreThan { cost, estimate } => {
            let guess =
                estimate.map(|t| format!(", about {} s by its last two levels", seconds(t))).unwrap_or_default();
            format!("{series} more than {} s{guess}", seconds(cost))
        }
    }
}

fn pair(report: &Report, pair: &Pair) -> String {
    let (slower, faster) = (&report.series[pair.slower].name, &report.series[pair.faster].name);
    let (common, error) = (times_of(pair.common), percent(pair.common_error));
    let target = pair.at_target.map(|r| format!(", {} at the target", times_of(r))).unwrap_or_default();
    format!("{slower} takes {common} the time of {faster} at {error}{target}")
}

fn times_of(ratio: Ratio) -> String {
    let bound = match ratio.bound {
        Bound::Equal => "",
        Bound::AtLeast => "at least ",
        Bound::AtMost => "at most ",
        Bound::Estimated => "about ",
    };
    let guess = ratio.estimate.map(|r| format!(" (about {})", rounded(r, 2))).unwrap_or_default();
    format!("{bound}{}{guess} times", rounded(ratio.value, 2))
}

/// A text that does not end a cell of a table.
fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ")
}

/// Three digits that matter.
pub(super) fn digits(value: f64) -> String {
    rounded(value, 4)
}

fn rounded(value: f64, count: i32) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let magnitude = value.abs().log10().floor() as i32;
    if !(-4..7).contains(&magnitude) {
        return format!("{value:.*e}", (count - 1) as usize);
    }
    let decimals = (count - 1 - magnitude).max(0) as usize;
    format!("{value:.decimals$}")
}

pub(super) fn seconds(value: f64) -> String {
    rounded(value, 3)
}

/// A fraction in per cent, two digits that matter.
pub(super) fn percent(fraction: f64) -> String {
    let number = rounded(100.0 * fraction, 2);
    format!("{} %", number.strip_suffix(".0").unwrap_or(&number))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_digits_that_matter() {
        assert_eq!(digits(79.034_5), "79.03");
        assert_eq!(digits(1234.56), "1235");
        assert_eq!(digits(0.000_012_3), "1.230e-5");
        assert_eq!(percent(0.012_34), "1.2 %");
        assert_eq!(percent(0.000_012), "0.0012 %");
        assert_eq!([0.0, 0.02].map(percent), ["0 %", "2 %"]);
        assert_eq!(seconds(0.123_45), "0.123");
    }
}
