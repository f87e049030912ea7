//! The arrays of a result file that grow by one entry or one field per step.

use super::check::Counts;
use super::storage::{Rows, growing, push};
use super::{FieldSpec, Location, WriterOptions};
use hdf5::{Attribute, Dataset, Group};

/// Arrays of `/VTKHDF/Steps` that are zero at every step, because the mesh does not change.
const ZERO_OFFSETS: [&str; 4] = ["PartOffsets", "PointOffsets", "CellOffsets", "ConnectivityIdOffsets"];

/// The arrays that grow.
pub(super) struct Arrays {
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
    pub fn create(root: &Group, specs: &[FieldSpec], counts: Counts, options: WriterOptions) -> hdf5::Result<Self> {
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

    /// Opens the arrays of a file that was written before: of fields, and of constants.
    pub fn open(
        root: &Group,
        (specs, constants): (&[FieldSpec], &[FieldSpec]),
        counts: Counts,
        options: WriterOptions,
    ) -> hdf5::Result<Self> {
        let steps = root.group("Steps")?;
        let locations = [Location::Point, Location::Cell];
        let [points, cells] = locations.map(|location| root.group(location.group()));
        let [point_offsets, cell_offsets] = locations.map(|location| steps.group(location.offsets()));
        let mut arrays = Self {
            fields: Vec::with_capacity(specs.len()),
            constant_offsets: Vec::new(),
            zero_offsets: ZERO_OFFSETS.iter().map(|name| steps.dataset(name)).collect::<Result<_, _>>()?,
            parts: steps.dataset("NumberOfParts")?,
            values: steps.dataset("Values")?,
            count: steps.attr("NSteps")?,
            data_groups: [points?, cells?],
            offset_groups: [point_offsets?, cell_offsets?],
        };
        let offsets = |of: &Self, spec: &FieldSpec| of.offset_groups[spec.location as usize].dataset(&spec.name);
        for spec in specs {
            let dataset = arrays.data_groups[spec.location as usize].dataset(&spec.name)?;
            let rows = Rows::of(dataset, spec, counts.tuples(spec.location), options);
            let offsets = offsets(&arrays, spec)?;
            arrays.fields.push((rows, offsets));
        }
        for spec in constants {
            let offsets = offsets(&arrays, spec)?;
            arrays.constant_offsets.push(offsets);
        }
        Ok(arrays)
    }

    /// Steps in the file.
    pub fn steps(&self) -> hdf5::Result<i64> {
        self.count.read_scalar()
    }

    /// Address and size of the values of all fields at a step, where nothing else shares their place.
    pub fn places(&self, step: usize) -> impl Iterator<Item = [u64; 2]> {
        self.fields.iter().filter_map(move |(rows, _)| rows.place(step))
    }

    fn rows(&self, spec: &FieldSpec, counts: Counts, options: WriterOptions) -> hdf5::Result<Rows> {
        Rows::create(&self.data_groups[spec.location as usize], spec, counts.tuples(spec.location), options)
    }

    fn offsets(&self, spec: &FieldSpec) -> hdf5::Result<Dataset> {
        growing::<i64>(&self.offset_groups[spec.location as usize], &spec.name)
    }

    pub fn add_constant(
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
    pub fn bytes_per_step(&self) -> u64 {
        const TABLES: u64 = 32 << 10;
        let data: u64 = self.fields.iter().map(|(rows, _)| rows.bytes() + rows.bytes() / 64 + TABLES).sum();
        data + TABLES * (8 + self.constant_offsets.len() as u64)
    }

    pub fn append_data(&self, step: usize, values: &[&[f64]]) -> hdf5::Result<()> {
        self.fields.iter().zip(values).try_for_each(|((rows, _), values)| rows.append(step, values))
    }

    /// Offsets, then the step's value, then the number of steps: a reader that sees a step finds its data.
    pub fn append_step(&self, step: usize, value: f64) -> hdf5::Result<()> {
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
