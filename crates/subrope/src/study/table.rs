//! `study.csv`: one row per member.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use super::report::{MemberReport, Report};

/// The table; empty fields are unknown.
pub(super) fn csv(report: &Report) -> String {
    let keys: BTreeSet<&str> = report.members.iter().flat_map(|m| m.settings.keys().map(String::as_str)).collect();
    let mut header: Vec<String> = ["member", "series", "level"].map(str::to_owned).to_vec();
    header.extend(keys.iter().map(|&key| key.to_owned()));
    let fixed = [
        "status",
        "reason",
        "elements",
        "nodes",
        "unknowns",
        "increments",
        "iterations",
        "cutbacks",
        "unstable_increments",
        "runs",
        "time_min [s]",
        "time_median [s]",
        "time_max [s]",
        "wall_min [s]",
        "peak_memory [MB]",
    ];
    header.extend(fixed.map(str::to_owned));
    for q in &report.quantities {
        let name = &q.name;
        header.extend([format!("{name} [{}]", q.unit), format!("{name}_error [-]"), format!("{name}_on_front")]);
    }
    let mut text = line(&header);
    for member in &report.members {
        text += &line(&row(member, &keys));
    }
    text
}

fn row(member: &MemberReport, keys: &BTreeSet<&str>) -> Vec<String> {
    let mut out = vec![member.name.clone(), member.series.clone(), member.level.to_string()];
    let setting = |key: &&str| match member.settings.get(*key) {
        Some(serde_json::Value::String(text)) => text.clone(),
        Some(other) => other.to_string(),
        None => String::new(),
    };
    out.extend(keys.iter().map(setting));
    out.extend([member.status.word().to_owned(), member.status.reason().to_owned()]);
    let count = |get: fn(&super::report::Counts) -> u64| {
        member.counts.as_ref().map_or_else(String::new, |c| get(c).to_string())
    };
    out.extend([
        count(|c| c.elements),
        count(|c| c.nodes),
        count(|c| c.unknowns),
        count(|c| c.increments),
        count(|c| c.iterations),
        count(|c| c.cutbacks),
        count(|c| c.unstable_increments),
    ]);
    let time = member.time.as_ref();
    out.push(time.map_or(0, |t| t.all.len()).to_string());
    out.extend([number(time.map(|t| t.min)), number(time.map(|t| t.median)), number(time.map(|t| t.max))]);
    out.extend([number(member.wall.as_ref().map(|t| t.min)), number(member.memory_mb)]);
    for value in &member.values {
        out.extend([number(value.value), number(value.error), value.on_front.to_string()]);
    }
    out
}

fn number(value: Option<f64>) -> String {
    value.map_or_else(String::new, |v| format!("{v:?}"))
}

/// A line of comma-separated fields (RFC 4180).
pub(crate) fn line(fields: &[String]) -> String {
    let mut out = String::new();
    for (index, field) in fields.iter().enumerate() {
        if index > 0 {
            out.push(',');
        }
        if field.contains([',', '"', '\n', '\r']) {
            let _ = write!(out, "\"{}\"", field.replace('"', "\"\""));
        } else {
            out.push_str(field);
        }
    }
    out.push('\n');
    out
}

#[cfg(test)]
mod tests {
    #[test]
    fn fields_are_quoted_where_needed() {
        let fields = ["a", "b, \"c\"", ""].map(str::to_owned);
        assert_eq!(super::line(&fields), "a,\"b, \"\"c\"\"\",\n");
    }
}
