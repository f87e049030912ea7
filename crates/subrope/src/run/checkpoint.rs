//! Checkpoints of a run: when they are written, what they hold, whose they are.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use subrope_fem::analysis::Analysis;
use subrope_fem::{StateError, StateReader, StateWriter};
use subrope_io::{
    Action, CheckpointReader, CheckpointWriter, IoError, OutputCause, OutputError, Writes, atomic, checkpoint,
};

use super::clock::Reading;
use super::output::Output;
use super::restart::RestartError;
use super::summary::Elapsed;
use crate::scene::SceneFile;

/// Name of the file.
pub const FILE: &str = "checkpoint";

/// Elements below which checkpoints are rarer.
const SMALL: usize = 1000;

/// Version that is written into a checkpoint.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Writes the checkpoints of a run.
pub struct Checkpoints {
    path: PathBuf,
    scene: String,
    /// Increments between two of them; 0: none.
    every: usize,
    writes: Writes,
    /// Increments at the last one.
    last: Option<usize>,
    /// Time that they took.
    spent: Duration,
}

impl Checkpoints {
    /// Of a run that has `last` as its last checkpoint.
    pub fn new(file: &SceneFile, elements: usize, folder: &Path, (writes, last): (&Writes, Option<usize>)) -> Self {
        // A flush to the disk takes as long as some increments of a small mesh.
        let usual = if elements < SMALL { 100 } else { 10 };
        let every = file.scene.output.checkpoint_every.unwrap_or(usual);
        let (path, scene) = (folder.join(FILE), file.hash.clone());
        Self { path, scene, every, writes: writes.clone(), last, spent: Duration::ZERO }
    }

    /// Whether one is to be written after so many increments; when the user stops the run one always is.
    pub fn is_due(&self, increments: usize, stopped: bool) -> bool {
        self.every > 0 && (stopped || increments.is_multiple_of(self.every))
    }

    /// Time that they took \[s\].
    pub fn seconds(&self) -> f64 {
        self.spent.as_secs_f64()
    }

    /// Increments at the last one.
    pub fn last(&self) -> Option<usize> {
        self.last
    }

    /// Writes one.
    pub fn write(&mut self, output: &mut Output, analysis: &Analysis, elapsed: Elapsed) -> Result<(), IoError> {
        let start = Instant::now();
        let mut file = CheckpointWriter::create(&self.path, &self.writes)?;
        for (name, text) in [("version", VERSION), ("scene", &self.scene)] {
            file.bytes(name, text.len() as u64, &mut text.as_bytes())?;
        }
        let (Reading { wall, cpu }, own) = (elapsed.solving, elapsed.checkpoints);
        file.numbers("elapsed", 4, &mut [elapsed.total, wall, cpu.unwrap_or(f64::NAN), own].into_iter())?;
        output.save(&mut file)?;
        self.save(analysis, &mut file)?;
        file.commit()?;
        self.last = Some(analysis.totals().increments);
        output.go_on()?;
        self.spent += start.elapsed();
        Ok(())
    }

    fn save(&self, analysis: &Analysis, file: &mut CheckpointWriter) -> Result<(), IoError> {
        let mut sink = ToFile { file, failure: None };
        analysis.save(&mut sink).map_err(|_| {
            let lost =
                OutputError { path: self.path.clone(), action: Action::Write, cause: OutputCause::EarlierFailure };
            sink.failure.take().unwrap_or(lost.into())
        })
    }

    /// Takes them away: a run that is done needs none.
    pub fn remove(&self) {
        // What cannot be taken away does no harm: the summary says that the run is done.
        let _ = std::fs::remove_file(&self.path);
        let _ = std::fs::remove_file(checkpoint::previous(&self.path));
    }
}

/// What a run goes on from.
pub struct Found {
    /// The file.
    pub reader: CheckpointReader,
    /// Whether it is the one before the last, because there is no last one.
    pub is_previous: bool,
}

impl Found {
    /// Finds the checkpoint of a scene in a folder.
    ///
    /// # Errors
    /// [`RestartError`].
    pub fn of(file: &SceneFile, folder: &Path) -> Result<Self, RestartError> {
        let path = folder.join(FILE);
        let previous = checkpoint::previous(&path);
        let is_previous = !path.exists() && previous.exists();
        let path = if is_previous { previous } else { path };
        if !path.exists() {
            return Err(RestartError::Missing { folder: folder.to_path_buf() });
        }
        let reader = CheckpointReader::open(&path).map_err(RestartError::Checkpoint)?;
        let text = |name| reader.text(name).map_err(RestartError::Checkpoint);
        let (version, scene) = (text("version")?, text("scene")?);
        if scene != file.hash {
            return Err(RestartError::OtherScene { path, found: scene, scene: file.hash.clone() });
        }
        if version != VERSION {
            return Err(RestartError::OtherVersion { path, found: version });
        }
        Ok(Self { reader, is_previous })
    }

    /// Takes up the state of a model.
    ///
    /// # Errors
    /// [`RestartError::State`].
    pub fn restore(&self, analysis: &mut Analysis) -> Result<(), RestartError> {
        analysis.restore(&FromFile(&self.reader)).map_err(|cause| RestartError::State { cause: Box::new(cause) })
    }

    /// Time that was spent before.
    ///
    /// # Errors
    /// [`IoError`].
    pub fn before(&self) -> Result<Elapsed, IoError> {
        let mut elapsed = [0.0; 4];
        self.reader.read_numbers("elapsed", &mut elapsed)?;
        let [total, wall, cpu, checkpoints] = elapsed;
        let solving = Reading { wall, cpu: Some(cpu).filter(|c| !c.is_nan()) };
        Ok(Elapsed { total, solving, checkpoints })
    }
}

/// Takes away what killed processes and earlier runs have left.
///
/// # Errors
/// What the system says of the file.
pub fn clear(folder: &Path) -> Result<(), (PathBuf, std::io::Error)> {
    let path = folder.join(FILE);
    for path in [checkpoint::previous(&path), path] {
        match std::fs::remove_file(&path) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => return Err((path, error)),
            _ => {}
        }
    }
    Ok(())
}

/// Takes away the halves of files that a killed process was writing.
pub fn remove_parts(folder: &Path, summary: &Path) {
    atomic::remove_parts(&folder.join(FILE));
    atomic::remove_parts(summary);
}

/// Passes the state of a model to the file, and keeps its failure.
struct ToFile<'a> {
    file: &'a mut CheckpointWriter,
    failure: Option<IoError>,
}

impl ToFile<'_> {
    fn keep(&mut self, result: Result<(), IoError>) -> Result<(), StateError> {
        result.map_err(|error| {
            let told = std::io::Error::other(error.to_string());
            self.failure = Some(error);
            StateError::access(told)
        })
    }
}

impl StateWriter for ToFile<'_> {
    fn numbers(&mut self, name: &str, count: usize, values: &mut dyn Iterator<Item = f64>) -> Result<(), StateError> {
        let result = self.file.numbers(name, count, values);
        self.keep(result)
    }

    fn counts(&mut self, name: &str, count: usize, values: &mut dyn Iterator<Item = u64>) -> Result<(), StateError> {
        let result = self.file.counts(name, count, values);
        self.keep(result)
    }
}

struct FromFile<'a>(&'a CheckpointReader);

impl StateReader for FromFile<'_> {
    fn numbers(&self, name: &str) -> Result<Vec<f64>, StateError> {
        self.0.numbers(name).map_err(StateError::access)
    }

    fn read_numbers(&self, name: &str, into: &mut [f64]) -> Result<(), StateError> {
        self.0.read_numbers(name, into).map_err(StateError::access)
    }

    fn counts(&self, name: &str) -> Result<Vec<u64>, StateError> {
        self.0.counts(name).map_err(StateError::access)
    }
}
