//! Paths as a table of comma-separated values.

use std::fmt::Write as _;

use super::{PathFile, StepRecord};

/// Names of vectors of six.
const VOIGT: [&str; 6] = ["11", "22", "33", "12", "13", "23"];
const MODES: [&str; 6] = ["elong", "comp", "D1", "D2", "g2", "g3"];
const STATE: [&str; 8] = ["DP1", "DP2", "gP2", "gP3", "kappa_t", "kappa_l", "d_t", "d_l"];

/// One line per step, one column per number; units stand in the heading. Numbers are the shortest decimals that give
/// the same double back; what was not computed stays empty.
#[must_use]
pub fn to_csv(paths: &PathFile) -> String {
    let mut text = heading();
    for path in &paths.paths {
        for (index, step) in path.steps.iter().enumerate() {
            // Writing to a string cannot fail.
            let _ = write!(text, "\"{}\",{}", path.name.replace('"', "\"\""), index + 1);
            line(step, &mut text);
        }
    }
    text
}

fn heading() -> String {
    let mut names = vec!["path".to_owned(), "step".to_owned()];
    let six = |prefix: &str, names: [&str; 6], unit: &str| names.map(|n| format!("{prefix}_{n} [{unit}]"));
    names.extend([1, 2, 3].iter().flat_map(|i| [1, 2, 3].map(|j| format!("F_{i}{j} [-]"))));
    names.extend(six("I", MODES, "-"));
    names.extend(six("q", MODES, "MPa"));
    names.extend(["p [MPa]".to_owned(), "W [mJ/mm^3]".to_owned()]);
    names.extend(six("S_fibre", VOIGT, "MPa"));
    names.extend(six("S_global", VOIGT, "MPa"));
    names.extend(STATE.map(|n| format!("{n} [{}]", if n.starts_with("d_") { "mJ/mm^3" } else { "-" })));
    names.extend(["dW_t [mJ/mm^3]", "dW_l [mJ/mm^3]", "slip_t [-]", "slip_l [-]"].map(str::to_owned));
    names.join(",") + "\n"
}

fn line(step: &StepRecord, text: &mut String) {
    let mut numbers: Vec<Option<f64>> = Vec::with_capacity(48);
    let mut push = |values: Option<&[f64]>, count: usize| {
        numbers.extend((0..count).map(|i| values.and_then(|v| v.get(i)).copied()));
    };
    push(step.F.as_ref().map(|f| f.as_flattened()), 9);
    push(step.I.as_ref().map(|v| v.as_slice()), 6);
    push(step.q.as_ref().map(|v| v.as_slice()), 6);
    push(step.p.as_ref().map(std::slice::from_ref), 1);
    push(step.W.as_ref().map(std::slice::from_ref), 1);
    push(step.S_fibre.as_ref().map(|v| v.as_slice()), 6);
    push(step.S_global.as_ref().map(|v| v.as_slice()), 6);
    push(step.state.as_deref(), 8);
    push(step.dW_dissip.as_ref().map(|v| v.as_slice()), 2);
    for number in numbers {
        text.push(',');
        if let Some(number) = number {
            let _ = write!(text, "{number:e}");
        }
    }
    for index in 0..2 {
        text.push(',');
        if let Some(slip) = step.slip {
            text.push(if slip[index] { '1' } else { '0' });
        }
    }
    text.push('\n');
}
