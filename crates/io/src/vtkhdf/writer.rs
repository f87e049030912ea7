//! Results step by step.

use super::arrays::Arrays;
use super::check::{self, Counts};
use super::image::ResultImage;
use super::mesh::put_mesh;
use super::storage::{Room, create, failure, put_texts, reopen};
use super::{FieldSpec, Precision, Provenance, WriterOptions};
use crate::error::{Action, IoError, OutputCause, OutputError, ValueError};
use crate::writes::Writes;
use hdf5::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use subrope_geometry::Mesh;

/// Writes a result file step by step. After every [`append`](Self::append) a copy of the file is complete: readers
/// see all steps so far, also when the run is killed. (With one step VTK shows the fields without a time, with none
/// it shows the mesh and complains of empty arrays.)
///
/// Before a step its room on the disk is taken, so that a full disk leaves the file as it was; [`append`](Self::append)
/// may then be tried again. Should writing fail in spite of it, nothing more is written to the file, neither by this
/// type nor when it is dropped.
///
/// A process that is killed while it writes may leave a file that does not open. [`pause`](Self::pause) gives what is needed
/// to bring the file back to where it was then, whatever has happened to it since.
pub struct ResultWriter {
    path: PathBuf,
    counts: Counts,
    options: WriterOptions,
    steps: usize,
    last_value: Option<f64>,
    specs: Vec<FieldSpec>,
    constants: Vec<FieldSpec>,
    room: Room,
    /// Address and size of what is written once and stays: the values of fields, step by step.
    settled: Vec<[u64; 2]>,
    /// Steps of which that is known.
    settled_steps: usize,
    writes: Writes,
    /// `None` after a failure or a close, and during a pause.
    open: Option<OpenFile>,
}

impl std::fmt::Debug for ResultWriter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ResultWriter").field("path", &self.path).field("steps", &self.steps).finish_non_exhaustive()
    }
}

impl ResultWriter {
    /// Creates the file, replacing an older one, and writes the mesh, the empty fields and the texts.
    ///
    /// # Errors
    /// [`IoError::Mesh`] and [`IoError::Value`] for an inconsistent mesh or wrong names; [`IoError::Output`].
    pub fn create(
        path: &Path,
        mesh: &Mesh,
        fields: &[FieldSpec],
        provenance: &Provenance,
        options: WriterOptions,
    ) -> Result<Self, IoError> {
        Self::create_with(path, mesh, fields, provenance, (options, &Writes::default()))
    }

    /// The same, with its operations counted.
    ///
    /// # Errors
    /// As [`ResultWriter::create`].
    pub fn create_with(
        path: &Path,
        mesh: &Mesh,
        fields: &[FieldSpec],
        provenance: &Provenance,
        (options, writes): (WriterOptions, &Writes),
    ) -> Result<Self, IoError> {
        check::mesh(mesh)?;
        check::options(options)?;
        check::provenance(provenance)?;
        check::specs(fields)?;
        writes.pass().map_err(|e| OutputError::new(path, Action::Create, e))?;
        let (file, room) = create(path)?;
        let mut writer = Self::new(path, Counts::of(mesh), fields, room, (options, writes));
        let prepared = writes.pass().map_err(|e| OutputError::new(path, Action::Write, e).into()).and_then(|()| {
            let arrays = put_texts(&file, provenance)
                .and_then(|()| put_mesh(&file, mesh, options))
                .and_then(|root| Arrays::create(&root, fields, writer.counts, options))
                .and_then(|arrays| file.flush().map(|()| arrays));
            arrays.map_err(failure(path, Action::Write))
        });
        match prepared {
            Ok(arrays) => {
                writer.open = Some(OpenFile { arrays, file });
                Ok(writer)
            }
            Err(error) => {
                // Closing would write the caches over what could not be written completely.
                std::mem::forget(file);
                Err(error)
            }
        }
    }

    /// Brings a file back to where it was when an image of it was taken, and goes on with it.
    ///
    /// `rest` gives what [`ResultImage::rest`] gave. The file may have grown since, and need not open any more.
    ///
    /// # Errors
    /// [`IoError::Read`] when there is no such file, [`IoError::Changed`] when it has become shorter;
    /// [`IoError::ReadResult`] when the file does not hold what the image says; [`IoError::Output`].
    pub fn resume(
        path: &Path,
        mesh: &Mesh,
        fields: &[FieldSpec],
        (image, rest): (&ResultImage, &mut dyn Read),
        (options, writes): (WriterOptions, &Writes),
    ) -> Result<Self, IoError> {
        check::mesh(mesh)?;
        check::specs(fields)?;
        let room = Room::of(path).map_err(|e| IoError::reopened(path, e))?;
        image.restore(path, rest, writes)?;
        let mut writer = Self::new(path, Counts::of(mesh), fields, room, (options, writes));
        writer.steps = image.steps;
        writer.last_value = image.last_value;
        writer.settled.clone_from(&image.settled);
        writer.settled_steps = image.steps;
        writer.go_on()?;
        Ok(writer)
    }

    fn new(
        path: &Path,
        counts: Counts,
        fields: &[FieldSpec],
        room: Room,
        (options, writes): (WriterOptions, &Writes),
    ) -> Self {
        Self {
            path: path.to_path_buf(),
            counts,
            options,
            steps: 0,
            last_value: None,
            specs: fields.to_vec(),
            constants: Vec::new(),
            room,
            settled: Vec::new(),
            settled_steps: 0,
            writes: writes.clone(),
            open: None,
        }
    }

    /// Closes the file for a moment, so that it is whole on the disk, and takes an image of it. [`go_on`](Self::go_on) opens
    /// it again; until then nothing may be written.
    ///
    /// # Errors
    /// [`IoError::Output`], also after an earlier failure.
    pub fn pause(&mut self) -> Result<ResultImage, IoError> {
        self.write(|open| open.file.flush())?;
        self.settle();
        self.shut()?;
        ResultImage::take(&self.path, &self.settled, (self.steps, self.last_value), &self.writes)
    }

    /// Opens the file again after a pause.
    ///
    /// # Errors
    /// [`IoError::ReadResult`] when it does not open or has changed.
    pub fn go_on(&mut self) -> Result<(), IoError> {
        let failed = |error| failure(&self.path, Action::Open)(error);
        let file = reopen(&self.path).map_err(failed)?;
        let opened = file.group("VTKHDF").and_then(|root| {
            let constants = self.constants.as_slice();
            Arrays::open(&root, (&self.specs, constants), self.counts, self.options)
        });
        let arrays = opened.map_err(failed)?;
        if arrays.steps().map_err(failed)? != self.steps as i64 {
            let message = format!("it does not hold the {} step(s) that it held before", self.steps);
            return Err(IoError::ReadResult { path: self.path.clone(), cause: OutputCause::Hdf5 { message } });
        }
        self.open = Some(OpenFile { arrays, file });
        Ok(())
    }

    /// Notes where the values of the steps since the last time lie.
    fn settle(&mut self) {
        if let Some(open) = &self.open {
            let steps = self.settled_steps..self.steps;
            self.settled.extend(steps.flat_map(|step| open.arrays.places(step)));
            self.settled_steps = self.steps;
        }
    }

    /// Writes a field that is the same at every step, for example the strand of every cell; before the first step.
    ///
    /// # Errors
    /// [`IoError::Value`] for wrong names or values, or after the first step; [`IoError::Output`].
    pub fn write_constant(&mut self, spec: &FieldSpec, values: &[f64]) -> Result<(), IoError> {
        if self.steps > 0 {
            return Err(ValueError::LateConstant { name: spec.name.clone(), steps: self.steps }.into());
        }
        check::specs(self.specs.iter().chain(&self.constants).chain([spec]))?;
        check::values(spec, values, self.counts, self.options.precision)?;
        let (counts, options) = (self.counts, self.options);
        self.write(|open| {
            open.arrays.add_constant(spec, values, counts, options)?;
            open.file.flush()
        })?;
        self.constants.push(spec.clone());
        Ok(())
    }

    /// Appends a step: its value (time \[s\] or load factor), which must increase, and the values of every field in the
    /// order of creation, component running fastest.
    ///
    /// # Errors
    /// [`IoError::Value`] for wrong lengths, values that are not finite (or overflow single precision), or a step
    /// value that does not increase; nothing is written then. [`IoError::Output`] when writing fails.
    pub fn append(&mut self, value: f64, fields: &[&[f64]]) -> Result<(), IoError> {
        self.check_step(value, fields)?;
        self.reserve()?;
        let step = self.steps;
        self.write(|open| open.arrays.append_data(step, fields))?;
        // On the disk before any counter refers to it: a run killed in between leaves the earlier steps whole.
        self.write(|open| open.file.flush())?;
        self.write(|open| open.arrays.append_step(step, value))?;
        self.write(|open| open.file.flush())?;
        self.steps += 1;
        self.last_value = Some(value);
        Ok(())
    }

    /// Steps written so far.
    pub const fn steps(&self) -> usize {
        self.steps
    }

    /// Path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Closes the file. Dropping the writer closes it too, without telling a failure.
    ///
    /// # Errors
    /// [`IoError::Output`] when the rest cannot be written, or after an earlier failure.
    pub fn close(mut self) -> Result<(), IoError> {
        self.finish()
    }

    fn finish(&mut self) -> Result<(), IoError> {
        self.write(|open| open.file.flush())?;
        self.shut()
    }

    /// Closes the file and gives back the room behind it.
    fn shut(&mut self) -> Result<(), IoError> {
        let Some(OpenFile { arrays, file }) = self.open.take() else { return Ok(()) };
        let passed = self.writes.pass();
        if passed.is_err() {
            std::mem::forget((arrays, file));
            return passed.map_err(|e| OutputError::new(&self.path, Action::Close, e).into());
        }
        let trimmed = self.room.trim(file.size());
        drop(arrays);
        file.close().map_err(failure(&self.path, Action::Close))?;
        trimmed.map_err(|e| OutputError::new(&self.path, Action::Close, e).into())
    }

    /// Takes the room of a step on the disk.
    fn reserve(&self) -> Result<(), IoError> {
        let Some(open) = &self.open else { return Ok(()) };
        let reserve = || self.room.reserve(open.file.size(), open.arrays.bytes_per_step());
        let reserved = self.writes.pass().and_then(|()| reserve());
        reserved.map_err(|e| OutputError::new(&self.path, Action::Write, e).into())
    }

    fn check_step(&self, value: f64, fields: &[&[f64]]) -> Result<(), ValueError> {
        if fields.len() != self.specs.len() {
            return Err(ValueError::Count { expected: self.specs.len(), got: fields.len() });
        }
        if !value.is_finite() {
            return Err(ValueError::NotFinite { name: "step value".to_owned(), index: self.steps, value });
        }
        if let Some(previous) = self.last_value.filter(|&previous| value <= previous) {
            return Err(ValueError::StepOrder { previous, value });
        }
        let precision: Precision = self.options.precision;
        self.specs.iter().zip(fields).try_for_each(|(spec, values)| check::values(spec, values, self.counts, precision))
    }

    fn write(&mut self, action: impl FnOnce(&mut OpenFile) -> hdf5::Result<()>) -> Result<(), IoError> {
        let Some(open) = &mut self.open else {
            return Err(OutputError::new(&self.path, Action::Write, OutputCause::EarlierFailure).into());
        };
        let passed = self.writes.pass().map_err(|e| OutputError::new(&self.path, Action::Write, e).into());
        passed.and_then(|()| action(open).map_err(failure(&self.path, Action::Write))).inspect_err(|_| {
            // Handles are given up, not closed: closing would write half of a step over what is on the disk.
            std::mem::forget(self.open.take());
        })
    }
}

impl Drop for ResultWriter {
    fn drop(&mut self) {
        if self.open.is_some() {
            // Whoever wants to know of a failure calls close.
            let _ = self.finish();
        }
    }
}

/// Handles, arrays before the file: they close first.
struct OpenFile {
    arrays: Arrays,
    file: File,
}
