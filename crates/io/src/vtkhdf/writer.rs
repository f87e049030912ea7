//! Results step by step.

use super::check::{self, Counts};
use super::mesh::put_mesh;
use super::storage::{Room, Rows, create, failure, growing, push, put_texts};
use super::{FieldSpec, Location, Precision, Provenance, WriterOptions};
use crate::error::{Action, IoError, OutputCause, OutputError, ValueError};
use hdf5::{Attribute, Dataset, File, Group};
use std::path::{Path, PathBuf};
use subrope_geometry::Mesh;

/// Arrays of `/VTKHDF/Steps` that are zero at every step, because the mesh does not change.
const ZERO_OFFSETS: [&str; 4] = ["PartOffsets", "PointOffsets", "CellOffsets", "ConnectivityIdOffsets"];

/// Writes a result file step by step. After every [`append`](Self::append) a copy of the file is complete: readers
/// see all steps so far, also when the run is killed. (With one step VTK shows the fields without a time, with none
/// it shows the mesh and complains of empty arrays.)
///
/// Before a step its room on the disk is taken, so that a full disk leaves the file as it was; [`append`](Self::append)
/// may then be tried again. Should writing fail in spite of it, nothing more is written to the file, neither by this
/// type nor when it is dropped.
pub struct ResultWriter {
    path: PathBuf,
    counts: Counts,
    options: WriterOptions,
    steps: usize,
    last_value: Option<f64>,
    specs: Vec<FieldSpec>,
    constants: Vec<FieldSpec>,
    room: Room,
    /// `None` after a failure or a close.
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
        check::mesh(mesh)?;
        check::options(options)?;
        check::provenance(provenance)?;
        check::specs(fields)?;
        let counts = Counts::of(mesh);
        let (file, room) = create(path)?;
        let prepared = put_texts(&file, provenance)
            .and_then(|()| put_mesh(&file, mesh, options))
            .and_then(|root| Arrays::create(&root, fields, counts, options))
            .and_then(|arrays| file.flush().map(|()| arrays));
        match prepared {
            Ok(arrays) => Ok(Self {
                path: path.to_path_buf(),
                counts,
                options,
                steps: 0,
                last_value: None,
                specs: fields.to_vec(),
                constants: Vec::new(),
                room,
                open: Some(OpenFile { arrays, file }),
            }),
            Err(error) => {
                // Closing would write the caches over what could not be written completely.
                std::mem::forget(file);
                Err(failure(path, Action::Write)(error))
            }
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
        self.write(|open| {
            open.arrays.append_data(step, fields)?;
            // On the disk before any counter refers to it: a run killed in between leaves the earlier steps whole.
            open.file.flush()?;
            open.arrays.append_step(step, value)?;
            open.file.flush()
        })?;
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
        let Some(OpenFile { arrays, file }) = self.open.take() else { return Ok(()) };
        let trimmed = self.room.trim(file.size());
        drop(arrays);
        file.close().map_err(failure(&self.path, Action::Close))?;
        trimmed.map_err(|e| OutputError::new(&self.path, Action::Close, e).into())
    }

    /// Takes the room of a step on the disk.
    fn reserve(&self) -> Result<(), IoError> {
        let Some(open) = &self.open else { return Ok(()) };
        let reserved = self.room.reserve(open.file.size(), open.arrays.bytes_per_step());
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
        action(open).map_err(|error| {
            // Handles are given up, not closed: closing would write half of a step over what is on the disk.
            std::mem::forget(self.open.take());
            failure(&self.path, Action::Write)(error)
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

/// The arrays that grow.
struct Arrays {
    fields: Vec<(Rows, Dataset)>,
    constant_offsets: Vec<Dataset>,
    zero_offsets: Vec<Dataset>,
    parts: Dataset,
    values: Dataset,
    count: Attribute,
    data_groups: [Group; 2],
    offset_groups: [Group; 2],
}

impl Arrays {
    fn create(root: &Group, specs: &[FieldSpec], counts: Counts, options: WriterOptions) -> hdf5::Result<Self> {
        let steps = root.create_group("Steps")?;
        let count = steps.new_attr::<i64>().create("NSteps")?;
        count.write_scalar(&0_i64)?;
        let locations = [Location::Point, Location::Cell];
        let [points, cells] = locations.map(|location| root.create_group(location.group()));
        let [point_offsets, cell_offsets] = locations.map(|location| steps.create_group(location.offsets()));
        let mut arrays = Self {
            fields: Vec::with_capacity(specs.len()),
            constant_offsets: Vec::new(),
            zero_offsets: ZERO_OFFSETS.iter().map(|name| growing::<i64>(&steps, name)).collect::<Result<_, _>>()?,
            parts: growing::<i64>(&steps, "NumberOfParts")?,
            values: growing::<f64>(&steps, "Values")?,
            count,
            data_groups: [points?, cells?],
            offset_groups: [point_offsets?, cell_offsets?],
        };
        for spec in specs {
            let rows = arrays.rows(spec, counts, options)?;
            let offsets = arrays.offsets(spec)?;
            arrays.fields.push((rows, offsets));
        }
        Ok(arrays)
    }

    fn rows(&self, spec: &FieldSpec, counts: Counts, options: WriterOptions) -> hdf5::Result<Rows> {
        Rows::create(&self.data_groups[spec.location as usize], spec, counts.tuples(spec.location), options)
    }

    fn offsets(&self, spec: &FieldSpec) -> hdf5::Result<Dataset> {
        growing::<i64>(&self.offset_groups[spec.location as usize], &spec.name)
    }

    fn add_constant(
        &mut self,
        spec: &FieldSpec,
        values: &[f64],
        counts: Counts,
        options: WriterOptions,
    ) -> hdf5::Result<()> {
        self.rows(spec, counts, options)?.append(0, values)?;
        self.constant_offsets.push(self.offsets(spec)?);
        Ok(())
    }

    /// Upper bound of what one step adds to the file: data that do not compress, and the tables of every array.
    fn bytes_per_step(&self) -> u64 {
        const TABLES: u64 = 32 << 10;
        let data: u64 = self.fields.iter().map(|(rows, _)| rows.bytes() + rows.bytes() / 64 + TABLES).sum();
        data + TABLES * (8 + self.constant_offsets.len() as u64)
    }

    fn append_data(&self, step: usize, values: &[&[f64]]) -> hdf5::Result<()> {
        self.fields.iter().zip(values).try_for_each(|((rows, _), values)| rows.append(step, values))
    }

    /// Offsets, then the step's value, then the number of steps: a reader that sees a step finds its data.
    fn append_step(&self, step: usize, value: f64) -> hdf5::Result<()> {
        for (rows, offsets) in &self.fields {
            push(offsets, step, (step * rows.tuples()) as i64)?;
        }
        for offsets in self.constant_offsets.iter().chain(&self.zero_offsets) {
            push(offsets, step, 0_i64)?;
        }
        push(&self.parts, step, 1_i64)?;
        push(&self.values, step, value)?;
        self.count.write_scalar(&(step as i64 + 1))
    }
}
