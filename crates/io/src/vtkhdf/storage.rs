//! Files, datasets and rows: the few HDF5 operations the format needs.

use super::{FieldSpec, Precision, Provenance, WriterOptions};
use crate::error::{Action, IoError, OutputCause, OutputError};
use hdf5::file::{FileBuilder, LibraryVersion};
use hdf5::types::VarLenUnicode;
use hdf5::{Dataset, File, Group, H5Type};
use std::fs::{self, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;

/// Largest chunk of a field \[bytes\]; below it, one step is one chunk and is never written twice.
const MAX_CHUNK: usize = 64 << 20;
/// Entries per chunk of the small arrays that grow by one entry per step.
const STEP_CHUNK: usize = 256;

/// Error of the library in the terms of this crate.
pub(super) fn failure(path: &Path, action: Action) -> impl Fn(hdf5::Error) -> IoError + '_ {
    move |error| OutputError::new(path, action, cause(&error)).into()
}

/// What the system said, where the library tells it; otherwise what the library says.
pub(super) fn cause(error: &hdf5::Error) -> OutputCause {
    let message = error.to_string();
    match system_error(&message) {
        Some(system) => OutputCause::System(system),
        None => OutputCause::Hdf5 { message: one_line(&message) },
    }
}

/// The library reports a failed call with time, addresses and, among them, `errno = 28`.
fn system_error(message: &str) -> Option<io::Error> {
    let (_, after) = message.split_once("errno = ")?;
    let digits = after.find(|c: char| !c.is_ascii_digit()).map_or(after, |end| &after[..end]);
    digits.parse().ok().filter(|&code| code != 0).map(io::Error::from_raw_os_error)
}

fn one_line(message: &str) -> String {
    message.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Creates a file, replacing an older one: earliest formats allowed, nothing newer than HDF5 1.10, no file lock.
pub(super) fn create(path: &Path) -> Result<(File, Room), IoError> {
    // The system tells a missing folder or a missing permission more clearly than the library does.
    let room = OpenOptions::new().write(true).create(true).truncate(false).open(path);
    let room = Room { file: room.map_err(|e| OutputError::new(path, Action::Create, e))? };
    let file = builder().create(path).map_err(failure(path, Action::Create))?;
    Ok((file, room))
}

/// Opens a file to go on with it.
pub(super) fn reopen(path: &Path) -> hdf5::Result<File> {
    builder().open_rw(path)
}

fn builder() -> FileBuilder {
    let mut builder = File::with_options();
    builder.with_fapl(|p| p.libver_bounds(LibraryVersion::Earliest, LibraryVersion::V110).file_locking(false));
    builder
}

/// Room on the disk behind the content of a file.
///
/// The library writes its tables even when the data they refer to did not fit, which spoils the whole file. So a step
/// is begun only when zeros in its place could be written; what is behind the content does not disturb readers.
pub(super) struct Room {
    file: fs::File,
}

impl Room {
    /// Of a file that is there.
    pub fn of(path: &Path) -> io::Result<Self> {
        Ok(Self { file: OpenOptions::new().write(true).open(path)? })
    }

    /// Makes sure that `needed` bytes behind the first `used` ones are on the disk.
    pub fn reserve(&self, used: u64, needed: u64) -> io::Result<()> {
        let length = self.file.metadata()?.len();
        let target = used.saturating_add(needed);
        let mut file = &self.file;
        let filled = file.seek(SeekFrom::Start(length)).and_then(|_| {
            let missing = target.saturating_sub(length);
            io::copy(&mut io::repeat(0).take(missing), &mut file)
        });
        filled.map(|_| ()).inspect_err(|_| {
            // A part of the room is of no use to anybody.
            let _ = self.file.set_len(length);
        })
    }

    /// Gives back what is behind the first `used` bytes.
    pub fn trim(&self, used: u64) -> io::Result<()> {
        if used > 0 && used < self.file.metadata()?.len() { self.file.set_len(used) } else { Ok(()) }
    }
}

/// Opens a file for reading, without a lock.
pub(super) fn open(path: &Path) -> hdf5::Result<File> {
    let mut builder = File::with_options();
    builder.with_fapl(|p| p.file_locking(false));
    builder.open(path)
}

/// Writes an array once, uncompressed.
pub(super) fn put_array<T: H5Type>(group: &Group, name: &str, values: &[T]) -> hdf5::Result<()> {
    group.new_dataset::<T>().shape(values.len()).create(name)?.write_raw(values)
}

/// Writes an array once, compressed.
pub(super) fn put_compressed<T: H5Type>(
    group: &Group,
    name: &str,
    values: &[T],
    deflate: Option<u8>,
) -> hdf5::Result<()> {
    let mut builder = group.new_dataset::<T>();
    if !values.is_empty() {
        builder = builder.chunk(values.len().min(MAX_CHUNK / size_of::<T>().max(1)));
        builder = compress(builder, deflate);
    }
    builder.shape(values.len()).create(name)?.write_raw(values)
}

fn compress(builder: hdf5::DatasetBuilderEmpty, deflate: Option<u8>) -> hdf5::DatasetBuilderEmpty {
    match deflate {
        // Shuffled bytes compress better: exponents of neighbouring values are alike.
        Some(level) => builder.shuffle().deflate(level),
        None => builder,
    }
}

/// Creates the group `/subrope` with its texts.
pub(super) fn put_texts(file: &File, texts: &Provenance) -> hdf5::Result<()> {
    let group = file.create_group("subrope")?;
    for (name, text) in texts {
        let text: VarLenUnicode = text.parse().map_err(|e| hdf5::Error::Internal(format!("{e}")))?;
        group.new_dataset::<VarLenUnicode>().create(name.as_str())?.write_scalar(&text)?;
    }
    Ok(())
}

/// An empty array that grows by one entry per step.
pub(super) fn growing<T: H5Type>(group: &Group, name: &str) -> hdf5::Result<Dataset> {
    group.new_dataset::<T>().chunk(STEP_CHUNK).shape(0..).create(name)
}

/// Appends the entry of step `step`.
pub(super) fn push<T: H5Type>(dataset: &Dataset, step: usize, value: T) -> hdf5::Result<()> {
    dataset.resize(step + 1)?;
    dataset.write_slice(&[value], step..step + 1)
}

/// An array of tuples that grows by one step at a time.
pub(super) struct Rows {
    dataset: Dataset,
    tuples: usize,
    components: usize,
    precision: Precision,
}

impl Rows {
    /// Creates the array without a step. Scalars are one-dimensional, everything else is (tuples, components).
    pub fn create(group: &Group, spec: &FieldSpec, tuples: usize, options: WriterOptions) -> hdf5::Result<Self> {
        let dataset = match options.precision {
            Precision::F32 => Self::dataset::<f32>(group, spec, tuples, options.deflate)?,
            Precision::F64 => Self::dataset::<f64>(group, spec, tuples, options.deflate)?,
        };
        Ok(Self { dataset, tuples, components: spec.components, precision: options.precision })
    }

    /// An array that was created before.
    pub fn of(dataset: Dataset, spec: &FieldSpec, tuples: usize, options: WriterOptions) -> Self {
        Self { dataset, tuples, components: spec.components, precision: options.precision }
    }

    /// Address and size of a step; none where a step is not one chunk, which is then written once and stays.
    pub fn place(&self, step: usize) -> Option<[u64; 2]> {
        if self.dataset.chunk()?.first() != Some(&self.tuples) {
            return None;
        }
        let chunk = self.dataset.chunk_info(step)?;
        (chunk.offset.first() == Some(&((step * self.tuples) as u64))).then_some([chunk.addr, chunk.size])
    }

    fn dataset<T: H5Type>(
        group: &Group,
        spec: &FieldSpec,
        tuples: usize,
        deflate: Option<u8>,
    ) -> hdf5::Result<Dataset> {
        let rows = tuples.clamp(1, (MAX_CHUNK / (spec.components * size_of::<T>())).max(1));
        let builder = compress(group.new_dataset::<T>(), deflate);
        let name = spec.name.as_str();
        match spec.components {
            1 => builder.chunk(rows).shape(0..).create(name),
            n => builder.chunk((rows, n)).shape((0.., n)).create(name),
        }
    }

    /// Tuples per step.
    pub const fn tuples(&self) -> usize {
        self.tuples
    }

    /// Bytes of one step without compression.
    pub const fn bytes(&self) -> u64 {
        let bytes = match self.precision {
            Precision::F32 => size_of::<f32>(),
            Precision::F64 => size_of::<f64>(),
        };
        (self.tuples * self.components * bytes) as u64
    }

    /// Appends one step after `steps` earlier ones.
    pub fn append(&self, steps: usize, values: &[f64]) -> hdf5::Result<()> {
        match self.precision {
            Precision::F32 => self.append_as(steps, values.iter().map(|&x| x as f32)),
            Precision::F64 => self.append_as(steps, values.iter().copied()),
        }
    }

    fn append_as<T: H5Type + Copy>(&self, steps: usize, values: impl Iterator<Item = T>) -> hdf5::Result<()> {
        let (begin, end) = (steps * self.tuples, (steps + 1) * self.tuples);
        if self.components == 1 {
            self.dataset.resize(end)?;
            let values: Vec<T> = values.collect();
            return self.dataset.write_slice(&values, begin..end);
        }
        self.dataset.resize((end, self.components))?;
        write_rows(&self.dataset, begin..end, values)
    }
}

/// Writes rows of a two-dimensional array, which already has them.
pub(super) fn write_rows<T: H5Type + Copy>(
    dataset: &Dataset,
    rows: std::ops::Range<usize>,
    values: impl Iterator<Item = T>,
) -> hdf5::Result<()> {
    // Reading rows that were never written costs no disk access and gives a buffer of the right shape.
    let mut block = dataset.read_slice_2d::<T, _>((rows.clone(), ..))?;
    block.iter_mut().zip(values).for_each(|(slot, value)| *slot = value);
    dataset.write_slice(&block, (rows, ..))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_system_is_quoted_where_it_spoke() {
        let message = "H5Fflush(): file write failed: time = Mon Jan  5 10:00:00 2026\n, filename = 'a', errno = 28, \
                       error message = 'No space left on device', buf = 0x55";
        assert_eq!(system_error(message).map(|e| e.kind()), Some(io::ErrorKind::StorageFull));
        assert!(system_error("H5Gcreate2(): name already exists").is_none());
        assert!(system_error("errno = 0, fine").is_none());
        assert_eq!(one_line("a\n, b"), "a , b");
    }
}
