//! The charts of a study: error against time and error against memory, per quantity.

use super::chart::{Chart, Curve, Point, draw};
use super::front::pareto;
use super::markdown::{digits, percent, seconds};
use super::report::{MemberReport, QuantityReport, Report};

/// What errors are drawn against.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Cost {
    Time,
    Memory,
}

/// Names of files and their content.
pub(super) fn charts(report: &Report) -> Vec<(String, String)> {
    let both = |index: usize| [("time", Cost::Time), ("memory", Cost::Memory)].map(|(name, cost)| (index, name, cost));
    let all = (0..report.quantities.len()).flat_map(both);
    all.filter_map(|(index, name, cost)| {
        let file = format!("{}_{name}.svg", report.quantities[index].name);
        Some((file, draw(&chart(report, index, cost))?))
    })
    .collect()
}

fn chart(report: &Report, index: usize, cost: Cost) -> Chart {
    let quantity = &report.quantities[index];
    let points: Vec<_> = report.members.iter().map(|m| point(report, m, index, cost)).collect();
    let places: Vec<_> = points.iter().map(|p| p.as_ref().map(|p| (p.x, p.y))).collect();
    let series = report.series.iter().map(|s| {
        let points = s.members.iter().filter_map(|&m| points[m].clone()).collect();
        Curve { name: s.name.clone(), points }
    });
    Chart {
        title: format!("{}: error of {}", report.title, quantity.name),
        x_label: match cost {
            Cost::Time => format!("{} of the solution [s]", report.clock.word()),
            Cost::Memory => "largest resident memory [MB]".to_owned(),
        },
        y_label: format!("relative error of {}", quantity.name),
        series: series.filter(|c| !c.points.is_empty()).collect(),
        front: pareto(&places).into_iter().filter_map(|m| places[m]).collect(),
        target: Some((report.target, format!("target {}", percent(report.target)))),
        notes: notes(report, quantity, index),
    }
}

fn point(report: &Report, member: &MemberReport, index: usize, cost: Cost) -> Option<Point> {
    let y = member.values[index].error?;
    let time = member.time.as_ref()?;
    let (x, band) = match cost {
        Cost::Time => (time.min, (time.min, time.max)),
        Cost::Memory => (member.memory_mb?, (member.memory_mb?, member.memory_mb?)),
    };
    let unknowns = member.counts.unwrap_or_default().unknowns;
    let value = member.values[index].value.unwrap_or_default();
    let unit = &report.quantities[index..].first().map_or("", |q| q.unit.as_str());
    let hint = format!(
        "{}: {} {unit}, error {}, {} s, {unknowns} unknowns",
        member.name,
        digits(value),
        percent(y),
        seconds(time.min)
    );
    Some(Point { x, band, y, hint })
}

/// What is compared with what, and how the machine behaved.
fn notes(report: &Report, quantity: &QuantityReport, index: usize) -> Vec<String> {
    let mut out = Vec::new();
    if let Some(reference) = &quantity.reference {
        let whose = match (reference.member, reference.order) {
            (Some(member), _) => report.members[member].name.clone(),
            (None, Some(order)) => format!("extrapolated, order {order:.2}"),
            (None, None) => "given".to_owned(),
        };
        out.push(format!("reference: {} {} ({whose})", digits(reference.value), quantity.unit));
    }
    let runs = match report.noise {
        Some(noise) => format!(
            "fastest of {} runs each; runs of one member differ by {} (median) to {}",
            report.repeats,
            percent(noise.median),
            percent(noise.largest)
        ),
        None => "one run each: the noise of the machine is not known".to_owned(),
    };
    out.push(runs);
    let hidden = report.members.iter().filter(|m| m.values[index].error == Some(0.0)).count();
    let lacking = report.members.iter().filter(|m| m.values[index].value.is_none()).count();
    if hidden + lacking > 0 {
        out.push(format!("not shown: {hidden} without an error, {lacking} without a value"));
    }
    out
}
