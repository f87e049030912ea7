//! Checkpoints: named arrays in a file of their own format, with checksums.
//!
//! All numbers are little-endian, whatever the machine:
//!
//! | bytes | what |
//! |---|---|
//! | 8 | `SUBROPE\n` |
//! | 4 | version of the format, 1 |
//! | | sections, one after the other: |
//! | 1 | kind: 1 numbers (double precision), 2 counts (64 bits), 3 bytes |
//! | 1 | length of the name |
//! | n | the name |
//! | 8 | length of the content in bytes |
//! | m | the content |
//! | 4 | CRC-32 of the section up to here |
//! | | the end: |
//! | 1 | 255 |
//! | 8 | number of sections |
//! | 8 | length of the file |
//! | 4 | CRC-32 of the file up to here |
//!
//! A file is written aside, flushed, and renamed; the one before stays as `NAME.previous`. A reader checks the whole file
//! before it gives anything.

mod error;
mod reader;
mod writer;

pub use error::{CheckpointError, CheckpointFault};
pub use reader::CheckpointReader;
pub use writer::CheckpointWriter;

use std::ffi::OsString;
use std::path::{Path, PathBuf};

const MAGIC: [u8; 8] = *b"SUBROPE\n";
const FORMAT: u32 = 1;
const END: u8 = 255;
/// Bytes that are handled at a time.
const BLOCK: usize = 1 << 16;

/// What a section holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
enum Kind {
    Numbers = 1,
    Counts = 2,
    Bytes = 3,
}

impl Kind {
    fn of(byte: u8) -> Option<Self> {
        [Self::Numbers, Self::Counts, Self::Bytes].into_iter().find(|k| *k as u8 == byte)
    }
}

/// Where the checkpoint before the last one is kept.
#[must_use]
pub fn previous(path: &Path) -> PathBuf {
    let mut name = path.file_name().map(OsString::from).unwrap_or_default();
    name.push(".previous");
    path.with_file_name(name)
}

#[cfg(test)]
mod tests;
