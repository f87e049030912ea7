//! Verdicts, by explicit rules.
//!
//! A member FAILS when the program panics or commits a number that is not finite, whatever is declared; when it stops and its
//! family explains no limit; when the energy balance leaves more open than the family allows beside the snaps that were
//! reported, and increments were not reported as too long to tell; when the same problem in other numbers ends differently or its dimensionless results differ by more than the
//! family allows. It *stops* when it ends early and the family explains why. Else it *holds*.

use serde::Serialize;

use super::compare::Outcome;
use super::{Ended, Run, StressFamily};

/// What becomes of a member.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", tag = "verdict")]
pub enum Verdict {
    /// To its end.
    Holds,
    /// Ends early, as the family explains.
    Stops {
        /// What the program says.
        message: String,
    },
    /// Not as it must be.
    Fails {
        /// Why.
        causes: Vec<String>,
    },
}

impl Verdict {
    /// The word in tables.
    #[must_use]
    pub fn word(&self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Stops { .. } => "stops, explained",
            Self::Fails { .. } => "FAILS",
        }
    }

    /// Whether it is a failure.
    #[must_use]
    pub fn is_failure(&self) -> bool {
        matches!(self, Self::Fails { .. })
    }

    /// What there is to say.
    #[must_use]
    pub fn message(&self) -> String {
        match self {
            Self::Holds => String::new(),
            Self::Stops { message } => message.clone(),
            Self::Fails { causes } => causes.join("; "),
        }
    }
}

/// Judges a member by its run, that of its twin and both together.
#[must_use]
pub fn judge(family: &StressFamily, name: &str, (run, other): (&Run, &Run), outcome: &Outcome) -> Verdict {
    let explained = family.limit(name).is_some();
    let mut causes = Vec::new();
    let mut stopped = None;
    for (who, run) in [("", run), ("in other units: ", other)] {
        match &run.ended {
            Ended::Done => {}
            Ended::Panicked(text) => causes.push(format!("{who}panic: {text}")),
            Ended::NotFinite(what) => causes.push(format!("{who}{what} not finite")),
            Ended::OutOfTime => early(&mut stopped, format!("{who}stopped after {} s", family.time_limit)),
            Ended::Stopped(text) => early(&mut stopped, format!("{who}{text}")),
            Ended::Refused(text) => early(&mut stopped, format!("{who}refused: {text}")),
        }
    }
    if let Some(message) = stopped.as_ref().filter(|_| !explained) {
        causes.push(message.clone());
    }
    causes.extend(unbalanced(family, run));
    if stopped.is_none() {
        causes.extend(differing(family, outcome));
    } else if !outcome.ended_alike && !explained {
        causes.push("ends differently in other units".to_owned());
    }
    match (causes.is_empty(), stopped) {
        (false, _) => Verdict::Fails { causes },
        (true, Some(message)) => Verdict::Stops { message },
        (true, None) => Verdict::Holds,
    }
}

fn early(stopped: &mut Option<String>, message: String) {
    stopped.get_or_insert(message);
}

/// Energy that is neither in the balance nor in a reported snap.
fn unbalanced(family: &StressFamily, run: &Run) -> Option<String> {
    let open = run.measured.energy_error - run.measured.released;
    // Also of what is no number.
    let small = open.abs() <= family.energy;
    // What is no number is never told.
    let told = run.measured.unresolved && open.is_finite();
    (!small && !told).then(|| format!("{open:.1e} of the work is neither in the energy balance nor in a reported snap"))
}

fn differing(family: &StressFamily, outcome: &Outcome) -> Option<String> {
    let Some(difference) = outcome.difference else { return Some("no result to compare".to_owned()) };
    let within = difference <= family.within;
    (!within).then(|| format!("results differ by {difference:.1e} in other units, allowed are {:.0e}", family.within))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stress::{Measured, Twin};

    fn family(limit: bool) -> StressFamily {
        let limits = if limit { "limits = { \"*\" = \"known\" }" } else { "" };
        toml::from_str(&format!("name = \"f\"\nquestion = \"q\"\nscene = \"s\"\n{limits}")).unwrap()
    }

    fn run(ended: Ended) -> Run {
        Run { ended, measured: Measured { reached: 1.0, increments: 3, ..Measured::default() } }
    }

    fn verdict(limit: bool, run: &Run, other: &Run) -> Verdict {
        judge(&family(limit), "m", (run, other), &Outcome::of(run, other, Twin::NONE))
    }

    #[test]
    fn what_reaches_its_end_holds() {
        let done = run(Ended::Done);
        assert_eq!(verdict(false, &done, &done), Verdict::Holds);
    }

    #[test]
    fn what_stops_needs_an_explanation() {
        let stopped = run(Ended::Stopped("no convergence".into()));
        assert!(verdict(false, &stopped, &stopped).is_failure());
        assert_eq!(verdict(true, &stopped, &stopped), Verdict::Stops { message: "no convergence".into() });
        let done = run(Ended::Done);
        assert!(verdict(false, &done, &stopped).is_failure(), "only the twin stops");
        assert!(!verdict(true, &run(Ended::OutOfTime), &done).is_failure());
    }

    #[test]
    fn nothing_explains_a_panic_or_a_nan() {
        let done = run(Ended::Done);
        for ended in [Ended::Panicked("oh".into()), Ended::NotFinite("reactions")] {
            assert!(verdict(true, &run(ended.clone()), &done).is_failure());
            assert!(verdict(true, &done, &run(ended)).is_failure());
        }
    }

    #[test]
    fn a_silent_jump_fails_and_a_reported_one_does_not() {
        let mut jumped = run(Ended::Done);
        jumped.measured.energy_error = 0.3;
        assert!(verdict(true, &jumped, &jumped).is_failure());
        jumped.measured.released = 0.299;
        assert_eq!(verdict(false, &jumped, &jumped), Verdict::Holds);
        jumped.measured.released = 0.0;
        jumped.measured.unresolved = true;
        assert_eq!(verdict(false, &jumped, &jumped), Verdict::Holds);
        jumped.measured.energy_error = f64::NAN;
        assert!(verdict(false, &jumped, &jumped).is_failure());
    }

    #[test]
    fn results_must_not_depend_on_units() {
        let (one, mut two) = (run(Ended::Done), run(Ended::Done));
        two.measured.reached = 0.9;
        assert!(verdict(false, &one, &two).is_failure());
    }
}
