//! Studies: a scene run with varied meshes, elements, increments, tolerances, contacts, and what its results cost.
//!
//! A study file ([`Study`], TOML) names a scene, series of settings, quantities and a reference. Every member is a run of
//! the program as a process of its own, so that its time and memory are its own and a member that fails does
//! not end the study. Runs are repeated in rounds: all members once, then all again. What they give becomes a
//! [`Report`]: errors, observed orders, Pareto fronts, the cheapest member that is good enough, and how many times longer one
//! series takes than another at equal error.

mod axis;
mod chart;
mod charts;
mod check;
mod child;
mod error;
mod file;
mod front;
mod machine;
mod markdown;
mod members;
mod order;
mod quantity;
mod reduce;
mod report;
mod rounds;
mod sample;
mod setting;
mod svg;
mod table;

pub use error::StudyError;
pub use file::{At, Clock, Quantity, Reference, ReferenceKind, Series, Study, StudyFile};
pub use front::{Bound, CostAt, Ratio, cheapest, cost_at, pareto};
pub use machine::Machine;
pub use markdown::answers;
pub use members::{Family, Member};
pub(crate) use members::{combinations, listed};
pub use order::{Extrapolated, NotExtrapolated, observed, richardson};
pub use quantity::{Known, Missing, Over, Part, Source, known, names};
pub use report::{
    Best, Cheapest, Counts, MemberReport, MemberStatus, Noise, Pair, QuantityReport, ReferenceReport, Report,
    SeriesReport, Times, ValueReport,
};
pub use setting::{KeyPath, Setting, SettingFault};

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use subrope_io::atomic::write_atomically;
use subrope_io::{IoError, write_json};

use crate::Error;
pub(crate) use table::line as csv_line;

use reduce::{Asked, reduce};
use rounds::{Rounds, Runs};

/// What a study may be told.
#[derive(Clone, Copy, Debug)]
pub struct StudyOptions<'a> {
    /// The `subrope` program that runs the members.
    pub program: &'a Path,
    /// Folder of the results; `out/NAME` beside the study when left out.
    pub folder: Option<&'a Path>,
    /// Repetitions; the study's own when left out.
    pub repeats: Option<usize>,
    /// Relative error to be reached; the study's own when left out.
    pub target: Option<f64>,
    /// Keep what an earlier study in the folder has finished.
    pub resume: bool,
    /// Set from elsewhere to stop after the current member.
    pub interrupt: Option<&'a AtomicBool>,
}

/// What a study tells while it goes on.
pub trait StudyObserver {
    /// A study begins; `replaces` says that the folder holds an earlier one.
    fn on_begin(&mut self, file: &StudyFile, folder: &Path, replaces: bool);
    /// A member begins to run, for the `round`-th of `rounds` times.
    fn on_run(&mut self, member: &str, round: usize, rounds: usize);
    /// It ended: its time \[s\], or why it failed.
    fn on_result(&mut self, result: Result<f64, &str>);
}

/// What a study gave.
#[derive(Clone, Debug)]
pub struct StudyOutcome {
    /// Folder of its files.
    pub folder: PathBuf,
    /// Files written there.
    pub files: Vec<String>,
    /// The report, as in `study.json`.
    pub report: Report,
}

/// Name of the file with everything.
const JSON: &str = "study.json";
/// Name of the table.
const TABLE: &str = "study.csv";
/// Name of the text.
const TEXT: &str = "study.md";

/// Runs a study: `study.csv`, `study.json`, `study.md` and charts, beside the members' own results in `members`.
///
/// # Errors
/// [`Error::Study`] and [`Error::Scene`] for what is wrong in the input; [`StudyError::AllFailed`] and
/// [`StudyError::Interrupted`], after which the files hold what there is; other [`StudyError`] when output fails.
pub fn run_study(
    path: &Path,
    options: StudyOptions<'_>,
    observer: &mut dyn StudyObserver,
) -> Result<StudyOutcome, Error> {
    let file = StudyFile::load(path)?;
    let folder = options.folder.map_or_else(|| file.output_folder(), Path::to_path_buf);
    std::fs::create_dir_all(&folder).map_err(|source| StudyError::File { path: folder.clone(), source })?;
    observer.on_begin(&file, &folder, folder.join(JSON).exists());
    clear(&folder)?;
    let repeats = options.repeats.unwrap_or(file.study.repeats);
    let rounds = Rounds {
        file: &file,
        program: options.program,
        folder: &folder,
        repeats,
        resume: options.resume,
        interrupt: options.interrupt,
    };
    let mut machine = Machine::here();
    let (runs, stopped) = rounds.run(&mut machine, observer)?;
    let asked = Asked { target: options.target.unwrap_or(file.study.target), repeats, complete: !stopped };
    let report = reduce(&file, &runs, machine, asked);
    let files = write(&folder, &report)?;
    verdict(&file, &runs, &folder, stopped)?;
    Ok(StudyOutcome { folder, files, report })
}

/// Reports of an earlier study must not stand beside new members.
fn clear(folder: &Path) -> Result<(), StudyError> {
    let entries = std::fs::read_dir(folder).map_err(|source| StudyError::File { path: folder.to_owned(), source })?;
    let names = entries.filter_map(Result::ok).map(|e| e.path());
    let old = |path: &PathBuf| {
        let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        [JSON, TABLE, TEXT].contains(&name.as_str()) || name.ends_with("_time.svg") || name.ends_with("_memory.svg")
    };
    names
        .filter(old)
        .try_for_each(|path| std::fs::remove_file(&path).map_err(|source| StudyError::File { path, source }))
}

fn write(folder: &Path, report: &Report) -> Result<Vec<String>, StudyError> {
    write_json(&folder.join(JSON), report)?;
    let mut files = vec![JSON.to_owned()];
    let texts = [(TABLE.to_owned(), table::csv(report)), (TEXT.to_owned(), markdown::text(report))];
    for (name, text) in texts.into_iter().chain(charts::charts(report)) {
        write_atomically(&folder.join(&name), text.as_bytes()).map_err(IoError::from)?;
        files.push(name);
    }
    Ok(files)
}

fn verdict(file: &StudyFile, runs: &[Runs], folder: &Path, stopped: bool) -> Result<(), StudyError> {
    let count: usize = runs.iter().map(|r| r.samples.len()).sum();
    if stopped {
        return Err(StudyError::Interrupted { runs: count, folder: folder.to_owned() });
    }
    match runs.iter().zip(&file.members).find_map(|(r, m)| Some((r.failure.clone()?, m))) {
        Some((first, member)) if count == 0 => {
            let scene = folder.join("members").join(&member.folder).join("scene.toml");
            Err(StudyError::AllFailed { members: runs.len(), first, scene })
        }
        _ => Ok(()),
    }
}
