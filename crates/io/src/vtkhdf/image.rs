//! What brings a result file back to an earlier state.
//!
//! The library changes tables in the middle of a file whenever a step is added, in an order of its own; a process killed
//! meanwhile may leave a file that does not open. Values of fields, nearly all of a file, are written once and stay where
//! they are. So the state of a file at rest is: its length, the places of those values, and all other bytes, which are few.

use crate::error::{Action, IoError, OutputError};
use crate::writes::Writes;
use std::fs::{File, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// A result file at rest, without the values of its fields.
#[derive(Debug, Clone, PartialEq)]
pub struct ResultImage {
    path: PathBuf,
    /// Length of the file in bytes.
    pub length: u64,
    /// Steps in it.
    pub steps: usize,
    /// Value of the last step.
    pub last_value: Option<f64>,
    /// Address and size of what is written once and stays, rising.
    pub settled: Vec<[u64; 2]>,
}

impl ResultImage {
    /// Of a file that is closed.
    pub(super) fn take(
        path: &Path,
        settled: &[[u64; 2]],
        (steps, last_value): (usize, Option<f64>),
        writes: &Writes,
    ) -> Result<Self, IoError> {
        let flushed = writes.pass().and_then(|()| {
            let file = OpenOptions::new().write(true).open(path)?;
            file.sync_all()?;
            Ok(file.metadata()?.len())
        });
        let length = flushed.map_err(|e| OutputError::new(path, Action::Flush, e))?;
        let image = Self::new(path, length, settled.to_vec());
        Ok(Self { steps, last_value, ..image })
    }

    /// An image without steps; places that do not lie in the file are left out, so that their bytes count as others.
    #[must_use]
    pub fn new(path: &Path, length: u64, mut settled: Vec<[u64; 2]>) -> Self {
        settled.sort_unstable();
        let mut end = 0;
        settled.retain(|&[begin, size]| {
            let fits = begin >= end && begin.checked_add(size).is_some_and(|e| e <= length);
            end = if fits { begin + size } else { end };
            fits
        });
        Self { path: path.to_path_buf(), length, steps: 0, last_value: None, settled }
    }

    /// Bytes that are not values of fields.
    #[must_use]
    pub fn rest_length(&self) -> u64 {
        self.length - self.settled.iter().map(|[_, size]| size).sum::<u64>()
    }

    /// Those bytes, in order.
    ///
    /// # Errors
    /// [`IoError::Read`].
    pub fn rest(&self) -> Result<impl Read + use<>, IoError> {
        let file = File::open(&self.path).map_err(|source| IoError::Read { path: self.path.clone(), source })?;
        let mut gaps = self.gaps();
        gaps.reverse();
        Ok(Gaps { file, gaps, left: 0 })
    }

    /// Address and size of everything else.
    fn gaps(&self) -> Vec<[u64; 2]> {
        let mut at = 0;
        let mut out = Vec::with_capacity(self.settled.len() + 1);
        for &[begin, size] in self.settled.iter().chain([&[self.length, 0]]) {
            if begin > at {
                out.push([at, begin - at]);
            }
            at = begin + size;
        }
        out
    }

    /// Puts those bytes back into the file and cuts off what was added since.
    pub(super) fn restore(&self, path: &Path, rest: &mut dyn Read, writes: &Writes) -> Result<(), IoError> {
        let mut file =
            OpenOptions::new().write(true).open(path).map_err(|e| OutputError::new(path, Action::Open, e))?;
        let found = file.metadata().map_err(|e| OutputError::new(path, Action::Open, e))?.len();
        if found < self.length {
            return Err(IoError::Changed { path: path.to_path_buf(), length: self.length });
        }
        let restored = writes.pass().and_then(|()| {
            for [begin, size] in self.gaps() {
                file.seek(SeekFrom::Start(begin))?;
                if io::copy(&mut (&mut *rest).take(size), &mut file)? < size {
                    return Err(io::ErrorKind::UnexpectedEof.into());
                }
            }
            file.set_len(self.length)?;
            file.flush()?;
            file.sync_all()
        });
        restored.map_err(|e| OutputError::new(path, Action::Write, e).into())
    }
}

/// Reads some parts of a file, one after the other.
struct Gaps {
    file: File,
    /// Those that are still to be read, the next one last.
    gaps: Vec<[u64; 2]>,
    left: u64,
}

impl Read for Gaps {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        if self.left == 0 {
            let Some([begin, size]) = self.gaps.pop() else { return Ok(0) };
            self.file.seek(SeekFrom::Start(begin))?;
            self.left = size;
        }
        let wanted = into.len().min(usize::try_from(self.left).unwrap_or(usize::MAX));
        let count = self.file.read(&mut into[..wanted])?;
        self.left -= count as u64;
        Ok(count)
    }
}
