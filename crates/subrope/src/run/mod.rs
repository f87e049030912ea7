//! Running a scene: results on disk while it goes on, a summary at the end.

mod checkpoint;
mod clock;
mod columns;
mod cycles;
mod error;
mod failed_point;
#[cfg(feature = "hdf5")]
mod field_file;
#[cfg(feature = "hdf5")]
mod fields;
mod findings;
#[cfg(feature = "hdf5")]
mod last_trial;
mod line_load;
mod output;
mod restart;
mod sections;
mod session;
mod strands;
mod summary;

pub use cycles::CycleRow;
pub use error::RunError;
pub(crate) use error::output_advice;
pub use findings::{Findings, Mode, ModeFinding, PeakDensities, Zone};
pub use line_load::{AnalyticLineLoad, ContactLine, LineLoadSummary, LineSlice, contact_lines};
pub use restart::{RestartError, restart_scene};
pub use sections::{SectionShape, section_shapes};
pub use strands::{StrandSummary, strands};
pub use summary::{Status, Summary, SymmetrySummary};

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use subrope_io::Writes;

use crate::Error;
use crate::model::RopeModel;
use crate::plan::Plan;
use crate::progress::Observer;
use crate::scene::SceneFile;
use clock::Clock;
use session::Session;

/// What a run may be told.
#[derive(Clone, Copy, Debug, Default)]
pub struct RunOptions<'a> {
    /// Folder of the results; the scene's own when left out.
    pub folder: Option<&'a Path>,
    /// Threads; the scene's own when left out.
    pub threads: Option<usize>,
    /// Set from elsewhere to stop after the current increment.
    pub interrupt: Option<&'a AtomicBool>,
    /// Counts operations on files, for tests of what a failing one leaves behind.
    pub writes: Option<&'a Writes>,
}

/// Files of a run.
#[derive(Clone, Debug)]
pub struct RunFiles {
    /// Folder.
    pub folder: PathBuf,
    /// Fields, VTKHDF; absent without the feature `hdf5`.
    pub results: Option<PathBuf>,
    /// One row per increment.
    pub history: PathBuf,
    /// Other tables: cycles, line loads.
    pub tables: Vec<PathBuf>,
    /// Numbers at the end.
    pub summary: PathBuf,
}

/// What a run gave.
#[derive(Clone, Debug)]
pub struct RunOutcome {
    /// Its files.
    pub files: RunFiles,
    /// Its summary, as written.
    pub summary: Summary,
}

/// Runs a scene file: `results.vtkhdf`, `history.csv`, `cycles.csv` and `line_load.csv` where there are cycles and contact
/// lines (all readable while it runs), and `summary.json`; and checkpoints, from which [`restart_scene`] goes on.
///
/// # Errors
/// [`Error::Scene`], [`Error::Model`] for what is wrong in the input; [`Error::Run`] when no equilibrium is found (files
/// hold everything up to the last converged increment) or when output fails.
pub fn run_scene(path: &Path, options: RunOptions<'_>, observer: &mut dyn Observer) -> Result<RunOutcome, Error> {
    let file = SceneFile::load(path)?;
    let mut model = ready(RopeModel::new(&file, options.threads)?, observer);
    let folder = options.folder.map_or_else(|| file.output_folder(), Path::to_path_buf);
    let clock = Clock::start();
    // Everything that can be refused is refused before files of an earlier run are replaced.
    model.check_steps()?;
    model.check_memory()?;
    observer.on_plan(&Plan::new(&file.scene, &model));
    if folder.join(checkpoint::FILE).exists() {
        observer.on_warning(&format!("the run that stopped in {} is replaced", folder.display()));
    }
    let session = Session::open(&file, &model, &folder, (clock, &options))?;
    session.run(&mut model, options.interrupt, observer)
}

/// Name of the file with the numbers at the end.
const SUMMARY: &str = "summary.json";

/// Tells what of a deck is not read, and lets go of what a run does not need.
fn ready(mut model: RopeModel, observer: &mut dyn Observer) -> RopeModel {
    model.mesh.drop_frames();
    for ignored in &model.ignored {
        let place = format!("{}:{}", ignored.file.display(), ignored.line);
        observer.on_warning(&format!("{place}: *{} is not read", ignored.keyword));
    }
    model
}
