//! Stress: declared families of extreme scenes, and whether the program holds there.
//!
//! A list ([`StressList`], TOML) names scenes and families of settings. Every member runs in memory, and once more in other
//! units ([`Twin`]): the same problem with other numbers, whose dimensionless results must be the same. What both runs give
//! becomes a row of the table: how far they came, what it took, how the tangent is conditioned, which changes of inertia and
//! snaps were reported, what the energy balance leaves open, and how many digits the change of units costs. A [`Verdict`]
//! by explicit rules closes the row. One that is FAILS makes the program end with exit code 1.

mod compare;
mod error;
mod file;
mod measure;
mod members;
mod report;
mod shipped;
mod text;
mod twin;
mod units;
mod verdict;

pub use compare::{Outcome, difference, digits_lost};
pub use error::StressError;
pub use file::{StressFamily, StressList};
pub use measure::{Ended, Measured, Run};
pub use members::StressMember;
pub use report::{FamilyReport, StressReport, StressRow};
pub use shipped::shipped;
pub use text::{csv, markdown};
pub use twin::Twin;
pub use units::{UnitError, in_other_units};
pub use verdict::{Verdict, judge};

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use subrope_io::atomic::write_atomically;
use subrope_io::{IoError, write_json};

/// What `subrope stress` may be told.
#[derive(Clone, Copy, Debug)]
pub struct StressOptions<'a> {
    /// Folder of the tables.
    pub folder: &'a Path,
    /// Names of the only families to run, or parts of their names; all when empty.
    pub only: &'a [String],
    /// Set from elsewhere to stop.
    pub interrupt: Option<&'a AtomicBool>,
}

/// What it tells while it goes on.
pub trait StressObserver {
    /// A family begins.
    fn on_family(&mut self, _family: &StressFamily, _members: usize) {}
    /// A member has its row.
    fn on_row(&mut self, _row: &StressRow) {}
}

/// Tells nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Quiet;

impl StressObserver for Quiet {}

/// Runs the families of lists; nothing is written.
///
/// # Errors
/// [`StressError::Setting`], [`StressError::UnknownScene`], [`StressError::UnknownFamily`], [`StressError::Interrupted`].
pub fn run_lists(
    lists: &[StressList],
    only: &[String],
    interrupt: Option<&AtomicBool>,
    observer: &mut dyn StressObserver,
) -> Result<StressReport, StressError> {
    let mut report = StressReport::new();
    members::check_names(lists, only)?;
    for list in lists {
        for family in list.family.iter().filter(|f| f.is_wanted(only)) {
            let members = members::expand(list, family)?;
            observer.on_family(family, members.len());
            let mut rows = Vec::with_capacity(members.len());
            for member in &members {
                let row = StressRow::run(family, member, interrupt);
                if interrupt.is_some_and(|flag| flag.load(Ordering::Relaxed)) {
                    return Err(StressError::Interrupted);
                }
                observer.on_row(&row);
                rows.push(row);
            }
            report.families.push(FamilyReport::new(family, rows));
        }
    }
    Ok(report)
}

/// Names of the files.
const FILES: [&str; 3] = ["stress.md", "stress.csv", "stress.json"];

/// Runs the families of lists and writes `stress.md`, `stress.csv` and `stress.json`; the paths come back with the report.
///
/// # Errors
/// As [`run_lists`]; [`StressError::File`] and [`StressError::Output`] when the tables cannot be written.
pub fn run_stress(
    lists: &[StressList],
    options: StressOptions<'_>,
    observer: &mut dyn StressObserver,
) -> Result<(StressReport, Vec<PathBuf>), StressError> {
    let StressOptions { folder, only, interrupt } = options;
    std::fs::create_dir_all(folder).map_err(|source| StressError::File { path: folder.to_owned(), source })?;
    let report = run_lists(lists, only, interrupt, observer)?;
    let files = FILES.map(|name| folder.join(name));
    let write = |path: &Path, text: String| write_atomically(path, text.as_bytes()).map_err(IoError::from);
    write(&files[0], markdown(&report))?;
    write(&files[1], csv(&report))?;
    write_json(&files[2], &report)?;
    Ok((report, files.to_vec()))
}
