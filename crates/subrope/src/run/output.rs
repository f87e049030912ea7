//! The files that grow during a run.

use std::path::Path;

use subrope_fem::analysis::{Analysis, IncrementRecord};
use subrope_io::{CheckpointReader, CheckpointWriter, Column, HistoryPlace, HistoryWriter, IoError, Writes};

use super::cycles::CycleTable;
use super::line_load::{FrameTime, LineLoadTable};
use super::{RunFiles, columns, line_load};
use crate::model::{ContactCells, CycleStep, MeshModel, RopeModel};
use crate::scene::SceneFile;

#[cfg(feature = "hdf5")]
use super::field_file::Fields;

/// How files are opened: anew, or to go on from a checkpoint.
#[derive(Clone, Copy)]
pub struct Opening<'a> {
    /// Counts what is done to them.
    pub writes: &'a Writes,
    /// Where they go on.
    pub from: Option<&'a CheckpointReader>,
}

impl Opening<'_> {
    /// Opens a table; `name` is that of its section in a checkpoint.
    pub fn table(&self, path: &Path, name: &str, columns: &[Column]) -> Result<HistoryWriter, IoError> {
        let Some(checkpoint) = self.from else { return HistoryWriter::create_with(path, columns, self.writes) };
        let [length, checksum] = counts(checkpoint, name)?;
        let place = HistoryPlace { length, checksum: checksum as u32 };
        HistoryWriter::resume(path, columns, place, self.writes)
    }
}

/// So many counts of a section; zeros behind those that are there.
pub fn counts<const N: usize>(checkpoint: &CheckpointReader, name: &str) -> Result<[u64; N], IoError> {
    let found = checkpoint.counts(name)?;
    Ok(std::array::from_fn(|i| found.get(i).copied().unwrap_or_default()))
}

/// Flushes a table and keeps where it ends.
pub fn save_table(table: &mut HistoryWriter, name: &str, to: &mut CheckpointWriter) -> Result<(), IoError> {
    table.flush()?;
    let HistoryPlace { length, checksum } = table.place();
    to.counts(name, 2, &mut [length, u64::from(checksum)].into_iter())
}

/// What does not change during a run.
#[derive(Clone, Copy)]
pub struct Scenery<'a> {
    /// Mesh.
    pub mesh: &'a MeshModel,
    /// Faces of contacts.
    pub cells: &'a [ContactCells],
}

/// Open files.
pub struct Output {
    history: HistoryWriter,
    pub cycles: CycleTable,
    pub line_loads: LineLoadTable,
    every: usize,
    /// Increments of the current step since the last frame.
    waiting: usize,
    /// The last increment.
    at: FrameTime,
    #[cfg(feature = "hdf5")]
    pub fields: Fields,
}

impl Output {
    /// Opens all files. A run that begins writes its first frame; one that goes on takes up what was waiting.
    pub fn open(file: &SceneFile, model: &RopeModel, files: &RunFiles, opening: Opening<'_>) -> Result<Self, IoError> {
        let mut out = Self {
            history: opening.table(&files.history, "history", &columns::columns(model))?,
            cycles: CycleTable::open(model, &files.folder, opening)?,
            line_loads: LineLoadTable::open(model, &files.folder, opening)?,
            every: file.scene.output.every,
            waiting: 0,
            at: FrameTime::default(),
            #[cfg(feature = "hdf5")]
            fields: Fields::open(file, model, &files.folder, opening)?,
        };
        if let Some(checkpoint) = opening.from {
            let [waiting, step, increment] = counts(checkpoint, "output")?.map(|n| n as usize);
            (out.waiting, out.at) = (waiting, FrameTime { step, increment });
            return Ok(out);
        }
        let scenery = Scenery { mesh: &model.mesh, cells: &model.contact_cells };
        match out.frame(scenery, &model.analysis) {
            Ok(()) => Ok(out),
            Err(error) => {
                // Without a step the files are of no use, and readers complain of them.
                drop(out);
                let opened = [Some(files.history.clone()), files.results.clone()];
                for path in opened.into_iter().flatten().chain([files.folder.join(line_load::FILE)]) {
                    let _ = std::fs::remove_file(path);
                }
                Err(error)
            }
        }
    }

    /// Keeps how far all files have grown, and makes sure that they are on the disk.
    pub fn save(&mut self, to: &mut CheckpointWriter) -> Result<(), IoError> {
        save_table(&mut self.history, "history", to)?;
        self.cycles.save(to)?;
        self.line_loads.save(to)?;
        let FrameTime { step, increment } = self.at;
        to.counts("output", 3, &mut [self.waiting, step, increment].map(|n| n as u64).into_iter())?;
        #[cfg(feature = "hdf5")]
        self.fields.save(to)?;
        Ok(())
    }

    /// To be called when what [`save`](Self::save) kept is on the disk.
    pub fn go_on(&mut self) -> Result<(), IoError> {
        #[cfg(feature = "hdf5")]
        self.fields.results.go_on()?;
        Ok(())
    }

    /// Notes where a cycle begins; `half` is what the step that begins is half of.
    pub fn begin_step(&mut self, half: Option<&CycleStep>, analysis: &Analysis) {
        if let Some(step) = half {
            self.cycles.begin(step, analysis);
        }
        #[cfg(feature = "hdf5")]
        self.fields.begin_step(half, analysis);
    }

    /// Adds a converged increment.
    pub fn increment(
        &mut self,
        scenery: Scenery<'_>,
        analysis: &Analysis,
        record: &IncrementRecord,
        cutbacks: usize,
        frames: bool,
    ) -> Result<(), IoError> {
        self.history.row(&columns::row(scenery.mesh, analysis, record, cutbacks))?;
        self.at = FrameTime { step: record.step_index, increment: record.increment };
        self.waiting += 1;
        if frames && self.waiting >= self.every {
            self.frame(scenery, analysis)?;
        }
        Ok(())
    }

    /// Leaves out the frame of a step.
    pub fn skip_frame(&mut self) {
        self.waiting = 0;
    }

    /// Writes what is still waiting.
    pub fn end_step(&mut self, scenery: Scenery<'_>, analysis: &Analysis) -> Result<(), IoError> {
        if self.waiting > 0 {
            self.frame(scenery, analysis)?;
        }
        Ok(())
    }

    fn frame(&mut self, scenery: Scenery<'_>, analysis: &Analysis) -> Result<(), IoError> {
        self.waiting = 0;
        self.line_loads.frame(self.at, scenery.mesh, scenery.cells, analysis)?;
        #[cfg(feature = "hdf5")]
        self.fields.frame(scenery, analysis)?;
        Ok(())
    }

    /// Writes what is still waiting, and closes the files.
    pub fn close(mut self, scenery: Scenery<'_>, analysis: &Analysis) -> Result<(), IoError> {
        self.end_step(scenery, analysis)?;
        #[cfg(feature = "hdf5")]
        self.fields.results.close()?;
        Ok(())
    }
}
