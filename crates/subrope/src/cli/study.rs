//! A study on the terminal.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use super::interrupt;
use super::output::print;
use crate::Error;
use crate::study::{
    MemberStatus, StudyError, StudyFile, StudyObserver, StudyOptions, StudyOutcome, answers, run_study,
};

/// What the command line says of a study.
#[derive(Clone, Debug)]
pub(super) struct StudyCommand {
    pub out: Option<PathBuf>,
    pub repeats: Option<usize>,
    pub target: Option<f64>,
    pub resume: bool,
}

/// Runs a study and prints what it answers.
pub(super) fn run(path: &Path, command: &StudyCommand) -> Result<(), Error> {
    let stop = interrupt::flag();
    // On Linux the link stays good when the file is replaced meanwhile.
    let program =
        std::env::current_exe().map_err(|source| StudyError::Start { program: PathBuf::from("subrope"), source })?;
    let options = StudyOptions {
        program: &program,
        folder: command.out.as_deref(),
        repeats: command.repeats,
        target: command.target,
        resume: command.resume,
        interrupt: Some(&stop),
    };
    let outcome = run_study(path, options, &mut Lines)?;
    print(closing(&outcome).as_bytes())
}

/// The answers, and where the files are.
fn closing(outcome: &StudyOutcome) -> String {
    let StudyOutcome { folder, files, report } = outcome;
    let failed = report.members.iter().filter(|m| matches!(m.status, MemberStatus::Failed(_))).count();
    let failed =
        if failed == 0 { String::new() } else { format!("{failed} of {} members failed\n", report.members.len()) };
    format!("{failed}{}{} are in {}\n", answers(report).replace("**", ""), files.join(", "), folder.display())
}

/// A line per run.
struct Lines;

impl Lines {
    /// A study goes on even if nobody reads what it prints.
    fn say(text: &str) {
        let mut out = std::io::stdout();
        let _ = out.write_all(text.as_bytes()).and_then(|()| out.flush());
    }
}

impl StudyObserver for Lines {
    fn on_begin(&mut self, file: &StudyFile, folder: &Path, replaces: bool) {
        let (members, series) = (file.members.len(), file.families.len());
        let place = folder.display();
        let replaces = if replaces { ", where an earlier one is replaced" } else { "" };
        Self::say(&format!("{}: {members} members in {series} series, in {place}{replaces}\n", file.study.title));
    }

    fn on_run(&mut self, member: &str, round: usize, rounds: usize) {
        Self::say(&format!("  round {round} of {rounds}  {member:44}"));
    }

    fn on_result(&mut self, result: Result<f64, &str>) {
        Self::say(&match result {
            Ok(seconds) => format!("  {seconds:.3} s\n"),
            Err(reason) => format!("  failed: {reason}\n"),
        });
    }
}
