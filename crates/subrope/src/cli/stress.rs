//! The stress table on the terminal.

use std::io::Write as _;
use std::path::Path;

use super::interrupt;
use super::output::print;
use crate::Error;
use crate::stress::{
    StressError, StressFamily, StressList, StressObserver, StressOptions, StressRow, run_stress, shipped,
};

/// Runs the families of a list, or of those that come with the program, and writes the table.
pub(super) fn run(file: Option<&Path>, folder: &Path, only: &[String]) -> Result<(), Error> {
    let stop = interrupt::flag();
    let lists = match file {
        Some(path) => vec![StressList::load(path)?],
        None => shipped()?,
    };
    let options = StressOptions { folder, only, interrupt: Some(&stop) };
    let (report, files) = run_stress(&lists, options, &mut Lines)?;
    let names: Vec<_> = files.iter().filter_map(|f| f.file_name()).map(|n| n.to_string_lossy().into_owned()).collect();
    print(format!("{} are in {}\n", names.join(", "), folder.display()).as_bytes())?;
    let (failed, members) = (report.failures(), report.rows().count());
    match failed.is_empty() {
        true => Ok(()),
        false => Err(StressError::Failed { failed: failed.len(), members, names: failed }.into()),
    }
}

/// A line per member.
struct Lines;

impl Lines {
    /// The table goes on even if nobody reads what is printed.
    fn say(text: &str) {
        let mut out = std::io::stdout();
        let _ = out.write_all(text.as_bytes()).and_then(|()| out.flush());
    }
}

impl StressObserver for Lines {
    fn on_family(&mut self, family: &StressFamily, members: usize) {
        Self::say(&format!("{} ({members})\n", family.name));
    }

    fn on_row(&mut self, row: &StressRow) {
        let message = row.verdict.message();
        let message = if message.is_empty() { message } else { format!(": {message}") };
        Self::say(&format!(
            "  {:44} {:6.2} % {:5} increments {:6} iterations {:4} cutbacks {:7.2} s  {}{message}\n",
            row.member,
            100.0 * row.reached,
            row.increments,
            row.iterations,
            row.cutbacks,
            row.seconds,
            row.verdict.word(),
        ));
    }
}
