//! A run on the terminal: a line per increment, and a bar where there is a terminal to draw it on.

use std::fmt::Display;
use std::io::{IsTerminal as _, Write as _};

use indicatif::{ProgressBar, ProgressStyle};

use crate::plan::Plan;
use crate::progress::{Finish, IncrementRecord, Observer, Outcome, StepStart};

/// Parts of the bar per step.
const PARTS: u64 = 1000;

/// Prints what a run reports: lines to the standard output, warnings to the standard error.
#[derive(Debug)]
pub(super) struct Terminal {
    bar: ProgressBar,
}

impl Terminal {
    pub(super) fn new() -> Self {
        let bar = if std::io::stderr().is_terminal() { ProgressBar::new(PARTS) } else { ProgressBar::hidden() };
        if let Ok(style) = ProgressStyle::with_template("{msg} [{wide_bar}] {elapsed}") {
            bar.set_style(style);
        }
        Self { bar }
    }

    /// A run goes on even if nobody reads what it prints.
    fn line(&self, text: &str) {
        self.bar.suspend(|| {
            let _ = writeln!(std::io::stdout(), "{text}");
        });
    }
}

impl Observer for Terminal {
    fn on_plan(&mut self, plan: &Plan) {
        self.line(&format!("plan\n{}", plan.to_string().trim_end()));
    }

    fn on_restart(&mut self, increments: usize, time: f64) {
        self.line(&format!("goes on after increment {increments}, at {time} s"));
    }

    fn on_step(&mut self, step: &StepStart) {
        self.bar.set_length(PARTS * step.count as u64);
        self.bar.set_message(step.name.clone());
        self.line(&format!("step {} of {}: {} ({} s)", step.index + 1, step.count, step.name, step.duration));
        self.line("  step  inc. att. iter.  residual    fraction    size        time [s]    wall [s]");
    }

    fn on_increment(&mut self, record: &IncrementRecord) {
        let done = record.step as f64 + record.fraction;
        let outcome = match record.outcome {
            Outcome::Converged => "",
            Outcome::Minimised => "  minimised",
            Outcome::CutBack => "  cut back",
        };
        if record.outcome != Outcome::CutBack {
            self.bar.set_position((done * PARTS as f64) as u64);
        }
        self.line(&format!(
            "{:6}{:6}{:5}{:6}  {:<10}  {:<10.6}  {:<10.3e}  {:<10.6}  {:.3}{outcome}",
            record.step + 1,
            record.increment,
            record.attempt,
            record.iterations,
            record.residual.map_or_else(|| "-".to_owned(), |r| format!("{r:.2e}")),
            record.fraction,
            record.size,
            record.time,
            record.seconds,
        ));
    }

    fn on_warning(&mut self, warning: &dyn Display) {
        self.bar.suspend(|| {
            let _ = writeln!(std::io::stderr(), "warning: {warning}");
        });
    }

    fn on_finish(&mut self, finish: &Finish) {
        self.bar.finish_and_clear();
        let end = if finish.interrupted { "interrupted" } else { "done" };
        let Finish { increments, iterations, seconds, .. } = finish;
        self.line(&format!("{end}: {increments} increments, {iterations} iterations, {seconds:.1} s"));
    }
}
