//! One run with its open files.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use nalgebra::Vector3;
use subrope_fem::FemError;
use subrope_fem::analysis::{Analysis, Control, IncrementRecord};
use subrope_io::{HistoryWriter, IoError, write_json};

use super::clock::Clock;
use super::cycles::CycleTable;
use super::line_load::{FrameTime, LineLoadTable};
use super::summary::{Elapsed, Status, Summary};
use super::{RunError, RunFiles, RunOutcome, columns, cycles, line_load};
use crate::Error;
use crate::model::{ContactCells, CycleStep, MeshModel, RopeModel};
use crate::progress::{self, Finish, Observer, Outcome, StepStart};
use crate::scene::SceneFile;

#[cfg(feature = "hdf5")]
use super::fields::{self, CycleStart, FieldArray, Place};
#[cfg(feature = "hdf5")]
use super::last_trial;
#[cfg(feature = "hdf5")]
use subrope_io::{FieldSpec, Precision, Provenance, ResultWriter, WriterOptions};

/// Name of the file with the fields.
const RESULTS: &str = "results.vtkhdf";

/// Files of a run and what it was asked.
pub struct Session<'a> {
    file: &'a SceneFile,
    files: RunFiles,
    output: Output,
    started: Instant,
    clock: Clock,
}

/// Open files.
struct Output {
    history: HistoryWriter,
    cycles: CycleTable,
    line_loads: LineLoadTable,
    every: usize,
    /// Increments of the current step since the last frame.
    waiting: usize,
    /// The last increment.
    at: FrameTime,
    #[cfg(feature = "hdf5")]
    fields: Fields,
}

/// The file with the fields.
#[cfg(feature = "hdf5")]
struct Fields {
    results: ResultWriter,
    arrays: Vec<FieldArray>,
    /// Where the cycle that runs began, if a field wants to know.
    cycle: Option<CycleStart>,
    /// Frames left out because a stress could not be evaluated again.
    lost_frames: usize,
}

impl<'a> Session<'a> {
    /// Makes the folder and opens the files; `clock` runs since the solution began.
    pub fn open(file: &'a SceneFile, model: &RopeModel, folder: &Path, clock: Clock) -> Result<Self, Error> {
        std::fs::create_dir_all(folder).map_err(|source| RunError::Folder { path: folder.to_path_buf(), source })?;
        let mut files = RunFiles {
            folder: folder.to_path_buf(),
            results: cfg!(feature = "hdf5").then(|| folder.join(RESULTS)),
            history: folder.join("history.csv"),
            tables: Vec::new(),
            summary: folder.join("summary.json"),
        };
        // What an earlier run wrote at its end must not stand beside new results.
        remove(&files.summary)?;
        #[cfg(feature = "hdf5")]
        remove(&folder.join(last_trial::FILE))?;
        let output = Output::open(file, model, &files).map_err(RunError::Output)?;
        let tables = [(line_load::FILE, output.line_loads.is_open()), (cycles::FILE, output.cycles.is_open())];
        files.tables = tables.into_iter().filter(|(_, open)| *open).map(|(name, _)| folder.join(name)).collect();
        Ok(Self { file, files, output, started: Instant::now(), clock })
    }

    /// Runs all steps.
    pub fn run(
        self,
        model: &mut RopeModel,
        interrupt: Option<&AtomicBool>,
        observer: &mut dyn Observer,
    ) -> Result<RunOutcome, Error> {
        let Self { file, files, output, started, clock } = self;
        let count = model.steps.len();
        let RopeModel { mesh, contact_cells, analysis, steps, half_cycles, .. } = &mut *model;
        let scenery = Scenery { mesh, cells: contact_cells };
        let mut watch = Watch {
            output,
            scenery,
            observer,
            interrupt,
            failure: None,
            attempt_start: started,
            cutbacks: 0,
            stable: true,
            half_cycle: None,
        };
        let mut outcome = Ok(());
        for (index, step) in steps.iter().enumerate() {
            let start = StepStart { index, count, name: step.name.clone(), duration: step.duration };
            watch.observer.on_step(&start);
            watch.attempt_start = Instant::now();
            watch.half_cycle = half_cycles[index];
            watch.begin_step(analysis);
            outcome = analysis.run_step(step, &mut watch);
            if outcome.is_ok() {
                outcome = watch.end_step(analysis);
            }
            if outcome.is_err() {
                break;
            }
        }
        let solving = clock.read();
        let failure = watch.failure.take();
        #[cfg(feature = "hdf5")]
        if watch.output.fields.lost_frames > 0 {
            let lost = watch.output.fields.lost_frames;
            watch
                .observer
                .on_warning(&format!("{lost} frame(s) are missing in {RESULTS}: no stress at the committed state"));
        }
        let interrupted = matches!(outcome, Err(FemError::Interrupted));
        let cycles = watch.output.cycles.rows().to_vec();
        let closed = watch.output.close(scenery, analysis);
        let status = Status::of(&outcome);
        let elapsed = Elapsed { total: started.elapsed().as_secs_f64(), solving };
        let summary = Summary::new(file, model, status, &cycles, elapsed);
        if let Some(error) = failure {
            return Err(RunError::Output(error).into());
        }
        closed.map_err(RunError::Output)?;
        write_json(&files.summary, &summary).map_err(RunError::Output)?;
        match outcome {
            Err(cause) if !interrupted => {
                // The run has failed already: that this file cannot be written is no more than a pity.
                #[cfg(feature = "hdf5")]
                if let Err(error) = last_trial::write(&files.folder, &model.mesh, &model.analysis) {
                    observer.on_warning(&format!("no {}: {error}", last_trial::FILE));
                }
                let kept = (model.analysis.totals().increments > 0).then(|| files.folder.clone());
                Err(RunError::Solver { cause: Box::new(cause), kept }.into())
            }
            _ => {
                let finish = finish(&model.analysis, started, interrupted);
                observer.on_finish(&finish);
                if interrupted {
                    return Err(RunError::Interrupted { increments: finish.increments, folder: files.folder }.into());
                }
                Ok(RunOutcome { files, summary })
            }
        }
    }
}

/// Removes a file, if there is one.
fn remove(path: &Path) -> Result<(), RunError> {
    match std::fs::remove_file(path) {
        Err(source) if source.kind() != std::io::ErrorKind::NotFound => {
            Err(RunError::Replace { path: path.to_path_buf(), source })
        }
        _ => Ok(()),
    }
}

fn finish(analysis: &Analysis, started: Instant, interrupted: bool) -> Finish {
    let totals = analysis.totals();
    Finish {
        increments: totals.increments,
        iterations: totals.iterations,
        seconds: started.elapsed().as_secs_f64(),
        interrupted,
    }
}

impl Output {
    fn open(file: &SceneFile, model: &RopeModel, files: &RunFiles) -> Result<Self, IoError> {
        let mut out = Self {
            history: HistoryWriter::create(&files.history, &columns::columns(model))?,
            cycles: CycleTable::open(model, &files.folder)?,
            line_loads: LineLoadTable::open(model, &files.folder)?,
            every: file.scene.output.every,
            waiting: 0,
            at: FrameTime::default(),
            #[cfg(feature = "hdf5")]
            fields: Fields::open(file, model, &files.folder)?,
        };
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

    /// Notes where a cycle begins; `half` is what the step that begins is half of.
    fn begin_step(&mut self, half: Option<&CycleStep>, analysis: &Analysis) {
        if let Some(step) = half {
            self.cycles.begin(step, analysis);
        }
        #[cfg(feature = "hdf5")]
        self.fields.begin_step(half, analysis);
    }

    fn increment(
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
    fn skip_frame(&mut self) {
        self.waiting = 0;
    }

    /// Writes what is still waiting.
    fn end_step(&mut self, scenery: Scenery<'_>, analysis: &Analysis) -> Result<(), IoError> {
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

    fn close(mut self, scenery: Scenery<'_>, analysis: &Analysis) -> Result<(), IoError> {
        self.end_step(scenery, analysis)?;
        #[cfg(feature = "hdf5")]
        self.fields.results.close()?;
        Ok(())
    }
}

#[cfg(feature = "hdf5")]
impl Fields {
    fn open(file: &SceneFile, model: &RopeModel, folder: &Path) -> Result<Self, IoError> {
        let scene = &file.scene;
        let arrays = fields::arrays(&scene.output.fields, model);
        let specs: Vec<FieldSpec> = arrays.iter().map(spec).collect();
        let provenance: Provenance = [
            ("version", env!("CARGO_PKG_VERSION").to_string()),
            ("scene", file.text.clone()),
            ("scene_hash", file.hash.clone()),
        ]
        .map(|(name, text)| (name.to_string(), text))
        .into();
        let options = WriterOptions {
            precision: match scene.output.precision {
                crate::scene::Precision::F32 => Precision::F32,
                crate::scene::Precision::F64 => Precision::F64,
            },
            deflate: (scene.output.compression > 0).then_some(scene.output.compression),
        };
        let results = ResultWriter::create(&folder.join(RESULTS), &model.mesh.mesh, &specs, &provenance, options)?;
        Ok(Self { results, arrays, cycle: None, lost_frames: 0 })
    }

    fn begin_step(&mut self, half: Option<&CycleStep>, analysis: &Analysis) {
        match half {
            None => self.cycle = None,
            Some(step) if !step.half.rising && fields::want_cycles(&self.arrays) => {
                self.cycle = Some(CycleStart::new(analysis));
            }
            Some(_) => {}
        }
    }

    fn frame(&mut self, scenery: Scenery<'_>, analysis: &Analysis) -> Result<(), IoError> {
        let cycle = self.cycle.as_ref();
        // The committed state was evaluated a moment ago: a law that fails here would be at the very edge of its range.
        let Ok(values) = fields::values(&self.arrays, scenery.mesh, scenery.cells, analysis, cycle) else {
            self.lost_frames += 1;
            return Ok(());
        };
        let slices: Vec<&[f64]> = values.iter().map(Vec::as_slice).collect();
        self.results.append(analysis.time(), &slices)
    }
}

#[cfg(feature = "hdf5")]
fn spec(array: &FieldArray) -> FieldSpec {
    match array.place {
        Place::Node => FieldSpec::point(array.name, array.components),
        Place::Element => FieldSpec::cell(array.name, array.components),
    }
}

/// What does not change during a run.
#[derive(Clone, Copy)]
struct Scenery<'a> {
    mesh: &'a MeshModel,
    cells: &'a [ContactCells],
}

/// Passes what the kernel tells to the files and to the observer.
struct Watch<'a> {
    output: Output,
    scenery: Scenery<'a>,
    observer: &'a mut dyn Observer,
    interrupt: Option<&'a AtomicBool>,
    failure: Option<IoError>,
    attempt_start: Instant,
    cutbacks: usize,
    /// Whether the last converged tangent had no negative pivot.
    stable: bool,
    /// The half cycle that runs.
    half_cycle: Option<CycleStep>,
}

impl Watch<'_> {
    fn keep<T>(&mut self, result: Result<T, IoError>) -> Result<T, FemError> {
        result.map_err(|error| {
            let text = error.to_string();
            self.failure = Some(error);
            FemError::Observer(text)
        })
    }

    fn begin_step(&mut self, analysis: &Analysis) {
        self.output.begin_step(self.half_cycle.as_ref(), analysis);
    }

    fn end_step(&mut self, analysis: &Analysis) -> Result<(), FemError> {
        if let Some(step) = self.half_cycle {
            let result = self.output.cycles.end(&step, analysis);
            self.keep(result)?;
            if !step.half.written {
                self.output.skip_frame();
                return Ok(());
            }
        }
        let result = self.output.end_step(self.scenery, analysis);
        self.keep(result)
    }

    /// Warns when the branch that is followed becomes unstable.
    fn tell_stability(&mut self, record: &IncrementRecord) {
        let negative = record.negative_pivots.unwrap_or(0);
        if negative > 0 && self.stable {
            self.observer.on_warning(&format!(
                "from increment {} on the tangent has {negative} negative pivot(s): a limit or bifurcation point was \
                 passed, and the unstable branch is followed (history.csv, negative_pivots)",
                record.increment
            ));
        }
        self.stable = negative == 0;
    }

    fn tell(&mut self, record: &IncrementRecord, outcome: Outcome) {
        let seconds = self.attempt_start.elapsed().as_secs_f64();
        self.attempt_start = Instant::now();
        self.observer.on_increment(&progress::IncrementRecord {
            step: record.step_index - 1,
            increment: record.increment,
            attempt: record.attempt,
            outcome,
            iterations: record.iterations,
            residual: record.residual(),
            fraction: record.fraction,
            size: record.length,
            time: record.time,
            seconds,
        });
    }
}

impl subrope_fem::analysis::Observer for Watch<'_> {
    fn converged(&mut self, analysis: &Analysis, record: &IncrementRecord) -> Result<Control, FemError> {
        // In cycles only their ends are written.
        let frames = self.half_cycle.is_none();
        let result = self.output.increment(self.scenery, analysis, record, self.cutbacks, frames);
        self.cutbacks = 0;
        self.keep(result)?;
        self.tell(record, Outcome::Converged);
        self.tell_stability(record);
        let stop = self.interrupt.is_some_and(|flag| flag.load(Ordering::Relaxed));
        Ok(if stop { Control::Stop } else { Control::Continue })
    }

    fn failed(&mut self, record: &IncrementRecord, _: &FemError) {
        self.cutbacks += 1;
        self.tell(record, Outcome::CutBack);
    }
}

/// Reference positions of all integration points \[mm\].
pub fn integration_points(mesh: &subrope_geometry::Mesh) -> Vec<Vector3<f64>> {
    use subrope_geometry::{CellKind, Hex8, Hex20, Hex20R, Hex27, Hexahedron};
    fn positions<H: Hexahedron<N>, const N: usize>(mesh: &subrope_geometry::Mesh) -> Vec<Vector3<f64>> {
        let cells = (0..mesh.cell_count()).filter_map(|e| mesh.cell_points::<N>(e));
        let at = |x: &[Vector3<f64>; N], xi| x.iter().zip(H::shape(xi)).map(|(p, n)| p * n).sum::<Vector3<f64>>();
        cells.flat_map(|x| H::quadrature().iter().map(move |q| at(&x, q.xi))).collect()
    }
    match mesh.kind {
        CellKind::Hex8 => positions::<Hex8, 8>(mesh),
        CellKind::Hex20 => positions::<Hex20, 20>(mesh),
        CellKind::Hex20R => positions::<Hex20R, 20>(mesh),
        CellKind::Hex27 => positions::<Hex27, 27>(mesh),
    }
}
