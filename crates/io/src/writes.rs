//! Operations on output files, counted, so that a test can make some of them fail.

use std::fs::File;
use std::io::{self, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Lets operations on output files pass: creating, writing, flushing, renaming, closing, and every call of the HDF5 library
/// that writes. The default lets all of them pass; [`Writes::failing`] is for tests of what a full disk leaves behind.
///
/// Clones count together.
#[derive(Clone, Debug, Default)]
pub struct Writes(Option<Arc<Faults>>);

#[derive(Debug)]
struct Faults {
    done: AtomicU64,
    first: u64,
    count: u64,
}

impl Writes {
    /// Lets the first `first - 1` operations pass and `count` fail from then on, as on a full disk.
    #[must_use]
    pub fn failing(first: u64, count: u64) -> Self {
        Self(Some(Arc::new(Faults { done: AtomicU64::new(0), first, count })))
    }

    /// Operations so far; not counted by the default.
    #[must_use]
    pub fn done(&self) -> u64 {
        self.0.as_ref().map_or(0, |f| f.done.load(Ordering::Relaxed))
    }

    /// Counts an operation that is about to be done.
    pub(crate) fn pass(&self) -> io::Result<()> {
        let Some(faults) = &self.0 else { return Ok(()) };
        let number = faults.done.fetch_add(1, Ordering::Relaxed) + 1;
        let fails = number >= faults.first && number - faults.first < faults.count;
        if fails { Err(io::ErrorKind::StorageFull.into()) } else { Ok(()) }
    }

    /// Writes all bytes; where that is made to fail a part of them, as a disk takes that becomes full.
    pub(crate) fn write_all(&self, mut file: &File, bytes: &[u8]) -> io::Result<()> {
        match self.pass() {
            Ok(()) => file.write_all(bytes),
            Err(error) => file.write_all(&bytes[..bytes.len() / 2]).and(Err(error)),
        }
    }
}

/// A file whose writes are counted.
#[derive(Debug)]
pub(crate) struct Counted {
    pub file: File,
    pub writes: Writes,
}

impl Write for Counted {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.writes.write_all(&self.file, bytes).map(|()| bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}
