//! One run with its open files.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use nalgebra::Vector3;
use subrope_fem::FemError;
use subrope_fem::analysis::{Analysis, Control, IncrementRecord, Step};
use subrope_io::{CheckpointReader, IoError, Writes, write_json_with};

use super::checkpoint::{self, Checkpoints, Found};
use super::clock::{Clock, Reading};
use super::output::{Opening, Output, Scenery};
use super::summary::{Elapsed, Status, Summary};
use super::{RestartError, RunError, RunFiles, RunOptions, RunOutcome, SUMMARY, cycles, failed_point, line_load};
use crate::Error;
use crate::model::{CycleStep, RopeModel};
use crate::progress::{self, Finish, Observer, Outcome, StepStart};
use crate::scene::SceneFile;

#[cfg(feature = "hdf5")]
use super::field_file::RESULTS;
#[cfg(feature = "hdf5")]
use super::last_trial;

/// Files of a run and what it was asked.
pub struct Session<'a> {
    file: &'a SceneFile,
    files: RunFiles,
    output: Output,
    checkpoints: Checkpoints,
    writes: Writes,
    stopwatch: Stopwatch,
    /// Whether a step goes on.
    resumed: bool,
}

/// Time of a run, with what was spent before it was stopped.
#[derive(Clone, Copy)]
struct Stopwatch {
    started: Instant,
    clock: Clock,
    before: Option<Elapsed>,
}

impl Stopwatch {
    /// What it shows; `checkpoints` is the time that they took since the run began or went on \[s\].
    fn read(&self, checkpoints: f64) -> Elapsed {
        let (total, solving) = (self.started.elapsed().as_secs_f64(), self.clock.read());
        let Some(before) = self.before else { return Elapsed { total, solving, checkpoints } };
        let cpu = solving.cpu.zip(before.solving.cpu).map(|(a, b)| a + b);
        let solving = Reading { wall: solving.wall + before.solving.wall, cpu };
        Elapsed { total: total + before.total, solving, checkpoints: checkpoints + before.checkpoints }
    }
}

impl<'a> Session<'a> {
    /// Makes the folder and opens the files anew; the clock runs since the solution began.
    pub fn open(
        file: &'a SceneFile,
        model: &RopeModel,
        folder: &Path,
        (clock, options): (Clock, &RunOptions<'_>),
    ) -> Result<Self, Error> {
        std::fs::create_dir_all(folder).map_err(|source| RunError::Folder { path: folder.to_path_buf(), source })?;
        // Without the results that it knows a checkpoint is of no use.
        checkpoint::clear(folder).map_err(|(path, source)| RunError::Replace { path, source })?;
        let writes = options.writes.cloned().unwrap_or_default();
        Self::with_files(file, model, folder, (clock, &writes, None))
    }

    /// Cuts the files back to what a checkpoint knows.
    pub fn resume(
        file: &'a SceneFile,
        model: &RopeModel,
        folder: &Path,
        (clock, options): (Clock, &RunOptions<'_>),
        found: &Found,
    ) -> Result<Self, Error> {
        let writes = options.writes.cloned().unwrap_or_default();
        let mut session = Self::with_files(file, model, folder, (clock, &writes, Some(&found.reader)))?;
        let before = found.before().map_err(|error| RunError::from(RestartError::Checkpoint(error)))?;
        (session.stopwatch.before, session.resumed) = (Some(before), true);
        Ok(session)
    }

    fn with_files(
        file: &'a SceneFile,
        model: &RopeModel,
        folder: &Path,
        (clock, writes, from): (Clock, &Writes, Option<&CheckpointReader>),
    ) -> Result<Self, Error> {
        let mut files = RunFiles {
            folder: folder.to_path_buf(),
            #[cfg(feature = "hdf5")]
            results: Some(folder.join(RESULTS)),
            #[cfg(not(feature = "hdf5"))]
            results: None,
            history: folder.join("history.csv"),
            tables: Vec::new(),
            summary: folder.join(SUMMARY),
        };
        checkpoint::remove_parts(folder, &files.summary);
        // What an earlier run wrote at its end must not stand beside new results.
        remove(&files.summary)?;
        remove(&folder.join(failed_point::FILE))?;
        #[cfg(feature = "hdf5")]
        remove(&folder.join(last_trial::FILE))?;
        let output = Output::open(file, model, &files, Opening { writes, from });
        let output = output.map_err(|error| match (&error, from) {
            (IoError::Output(_), _) | (_, None) => RunError::Output(error),
            _ => RestartError::Results(error).into(),
        })?;
        let tables = [(line_load::FILE, output.line_loads.is_open()), (cycles::FILE, output.cycles.is_open())];
        files.tables = tables.into_iter().filter(|(_, open)| *open).map(|(name, _)| folder.join(name)).collect();
        let last = from.map(|_| model.analysis.totals().increments);
        Ok(Self {
            checkpoints: Checkpoints::new(file, model.mesh.mesh.cell_count(), folder, (writes, last)),
            file,
            files,
            output,
            writes: writes.clone(),
            stopwatch: Stopwatch { started: Instant::now(), clock, before: None },
            resumed: false,
        })
    }

    /// Runs all steps, or what is left of them.
    pub fn run(
        self,
        model: &mut RopeModel,
        interrupt: Option<&AtomicBool>,
        observer: &mut dyn Observer,
    ) -> Result<RunOutcome, Error> {
        let Self { file, files, output, checkpoints, writes, stopwatch, resumed } = self;
        let RopeModel { mesh, contact_cells, analysis, steps, half_cycles, .. } = &mut *model;
        let scenery = Scenery { mesh, cells: contact_cells };
        let mut watch = Watch {
            output,
            checkpoints,
            scenery,
            observer,
            interrupt,
            failure: None,
            stopwatch,
            attempt_start: stopwatch.started,
            cutbacks: 0,
            half_cycle: None,
            resumed,
        };
        let outcome = watch.run_steps(analysis, (steps, half_cycles));
        let elapsed = stopwatch.read(watch.checkpoints.seconds());
        watch.tell_lost_frames();
        watch.tell_long_increments(analysis);
        let Watch { output, checkpoints, failure, .. } = watch;
        let cycles = output.cycles.rows().to_vec();
        let closed = output.close(scenery, analysis);
        let elapsed = Elapsed { total: stopwatch.read(0.0).total, ..elapsed };
        let summary = Summary::new(file, model, Status::of(&outcome), &cycles, elapsed);
        // What failed first is told: files that it spoilt cannot be closed either.
        let written = failure.map_or(closed, Err).and_then(|()| write_json_with(&files.summary, &summary, &writes));
        written.map_err(|cause| halted(cause, &checkpoints))?;
        let totals = model.analysis.totals();
        let (increments, iterations, restart) = (totals.increments, totals.iterations, checkpoints.last().is_some());
        let interrupted = matches!(outcome, Err(FemError::Interrupted));
        match outcome {
            Err(cause) if !interrupted => {
                // The run has failed already: that this file cannot be written is no more than a pity.
                #[cfg(feature = "hdf5")]
                if let Err(error) = last_trial::write(&files.folder, &model.mesh, &model.analysis) {
                    observer.on_warning(&format!("no {}: {error}", last_trial::FILE));
                }
                let point = failed_point::write(&files.folder, &file.scene, model, &cause).unwrap_or_else(|error| {
                    observer.on_warning(&format!("no {}: {error}", failed_point::FILE));
                    None
                });
                let kept = (increments > 0).then(|| files.folder.clone());
                Err(RunError::Solver { cause: Box::new(cause), kept, point }.into())
            }
            _ => {
                let seconds = stopwatch.started.elapsed().as_secs_f64();
                observer.on_finish(&Finish { increments, iterations, seconds, interrupted });
                if interrupted {
                    return Err(RunError::Interrupted { increments, folder: files.folder, restart }.into());
                }
                checkpoints.remove();
                Ok(RunOutcome { files, summary })
            }
        }
    }
}

/// A failing output, with where the run can go on.
fn halted(cause: IoError, checkpoints: &Checkpoints) -> RunError {
    match checkpoints.last() {
        Some(increments) => RunError::Halted { cause: Box::new(cause), increments },
        None => RunError::Output(cause),
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

/// Passes what the kernel tells to the files and to the observer.
struct Watch<'a> {
    output: Output,
    checkpoints: Checkpoints,
    scenery: Scenery<'a>,
    observer: &'a mut dyn Observer,
    interrupt: Option<&'a AtomicBool>,
    failure: Option<IoError>,
    stopwatch: Stopwatch,
    attempt_start: Instant,
    cutbacks: usize,
    /// The half cycle that runs.
    half_cycle: Option<CycleStep>,
    /// Whether the step that comes goes on.
    resumed: bool,
}

impl Watch<'_> {
    /// All steps that are not done.
    fn run_steps(
        &mut self,
        analysis: &mut Analysis,
        (steps, half_cycles): (&[Step], &[Option<CycleStep>]),
    ) -> Result<(), FemError> {
        let count = steps.len();
        for (index, step) in steps.iter().enumerate().skip(analysis.steps_done()) {
            let start = StepStart { index, count, name: step.name.clone(), duration: step.duration };
            self.observer.on_step(&start);
            self.attempt_start = Instant::now();
            self.half_cycle = half_cycles[index];
            if !std::mem::take(&mut self.resumed) {
                self.begin_step(analysis);
            }
            analysis.run_step(step, self)?;
            self.end_step(analysis)?;
        }
        Ok(())
    }

    fn tell_lost_frames(&mut self) {
        #[cfg(feature = "hdf5")]
        if self.output.fields.lost_frames > 0 {
            let lost = self.output.fields.lost_frames;
            self.observer
                .on_warning(&format!("{lost} frame(s) are missing in {RESULTS}: no stress at the committed state"));
        }
    }

    /// Tells when increments were too long for a balance of energy.
    fn tell_long_increments(&mut self, analysis: &Analysis) {
        if analysis.totals().is_unresolved() {
            self.observer.on_warning(
                &"the energy balances of long increments leave more than 5 % of all work open: whether the structure snapped \
                  in one of them, shorter ones tell (increments.maximum)",
            );
        }
    }

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

    /// Tells of limit and bifurcation points and of snaps.
    fn tell_findings(&mut self, record: &IncrementRecord) {
        let at = format!("at {} s (increment {} of step {})", record.time, record.increment, record.step);
        if let Some((before, now)) = record.inertia_change {
            let meaning = match now > before && !record.switched {
                true => "a limit or bifurcation point was passed, and the unstable branch is followed",
                false => "a limit or bifurcation point was passed",
            };
            self.observer.on_warning(&format!(
                "inertia changed from {before} to {now} negative pivot(s) {at}: {meaning} (history.csv, negative_pivots)"
            ));
        }
        if record.switched {
            self.observer.on_warning(&format!(
                "branch switched {at}: equilibrium has forked, and the branch that forks off is followed (summary.json, \
                 counts.switched)"
            ));
        }
        let energy = record.released;
        if energy != 0.0 {
            let what = if energy > 0.0 { "released" } else { "appeared" };
            self.observer.on_warning(&format!(
                "snap {at}: {:.4e} mJ {what} that forces and sliding do not account for: the state is on another branch \
                 (history.csv, released_energy)",
                energy.abs()
            ));
        }
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
        self.tell(record, if record.minimised { Outcome::Minimised } else { Outcome::Converged });
        self.tell_findings(record);
        let stop = self.interrupt.is_some_and(|flag| flag.load(Ordering::Relaxed));
        if self.checkpoints.is_due(analysis.totals().increments, stop) {
            let elapsed = self.stopwatch.read(self.checkpoints.seconds());
            let result = self.checkpoints.write(&mut self.output, analysis, elapsed);
            self.keep(result)?;
        }
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
        let mut positions = Vec::with_capacity(mesh.cell_count() * mesh.kind.points());
        let cells = (0..mesh.cell_count()).filter_map(|e| mesh.cell_points::<N>(e));
        let at = |x: &[Vector3<f64>; N], xi| x.iter().zip(H::shape(xi)).map(|(p, n)| p * n).sum::<Vector3<f64>>();
        positions.extend(cells.flat_map(|x| H::quadrature().iter().map(move |q| at(&x, q.xi))));
        positions
    }
    match mesh.kind {
        CellKind::Hex8 => positions::<Hex8, 8>(mesh),
        CellKind::Hex20 => positions::<Hex20, 20>(mesh),
        CellKind::Hex20R => positions::<Hex20R, 20>(mesh),
        CellKind::Hex27 => positions::<Hex27, 27>(mesh),
    }
}
