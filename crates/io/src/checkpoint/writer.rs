//! Writing a checkpoint, section by section, without keeping any.

use super::{BLOCK, END, FORMAT, Kind, MAGIC, previous};
use crate::atomic::AtomicFile;
use crate::error::{Action, IoError, OutputError, ValueError};
use crate::writes::Writes;
use crc32fast::Hasher;
use std::io::Read;
use std::path::{Path, PathBuf};

/// A checkpoint that is being written; dropped without a [`commit`](Self::commit), it leaves no trace.
#[derive(Debug)]
pub struct CheckpointWriter {
    path: PathBuf,
    file: AtomicFile,
    whole: Hasher,
    section: Hasher,
    length: u64,
    sections: u64,
    block: Vec<u8>,
}

impl CheckpointWriter {
    /// Begins a checkpoint.
    ///
    /// # Errors
    /// [`IoError::Output`].
    pub fn create(path: &Path, writes: &Writes) -> Result<Self, IoError> {
        let mut writer = Self {
            path: path.to_path_buf(),
            file: AtomicFile::create_with(path, writes)?,
            whole: Hasher::new(),
            section: Hasher::new(),
            length: 0,
            sections: 0,
            block: Vec::with_capacity(BLOCK),
        };
        writer.put(&MAGIC)?;
        writer.put(&FORMAT.to_le_bytes())?;
        Ok(writer)
    }

    /// Adds `count` numbers; they may be infinite or no numbers at all.
    ///
    /// # Errors
    /// [`IoError::Output`]; [`ValueError::Name`] for a name longer than 255 bytes, [`ValueError::Count`] when the iterator
    /// gives another number of them.
    pub fn numbers(&mut self, name: &str, count: usize, values: &mut dyn Iterator<Item = f64>) -> Result<(), IoError> {
        self.values(Kind::Numbers, name, count, &mut values.map(f64::to_le_bytes))
    }

    /// Adds `count` whole numbers.
    ///
    /// # Errors
    /// As [`numbers`](Self::numbers).
    pub fn counts(&mut self, name: &str, count: usize, values: &mut dyn Iterator<Item = u64>) -> Result<(), IoError> {
        self.values(Kind::Counts, name, count, &mut values.map(u64::to_le_bytes))
    }

    /// Adds `length` bytes from a source.
    ///
    /// # Errors
    /// As [`numbers`](Self::numbers); a source that cannot be read is told as a failed write.
    pub fn bytes(&mut self, name: &str, length: u64, source: &mut dyn Read) -> Result<(), IoError> {
        self.begin(Kind::Bytes, name, length)?;
        let (mut left, mut block) = (length, vec![0; BLOCK]);
        while left > 0 {
            let part = &mut block[..left.min(BLOCK as u64) as usize];
            source.read_exact(part).map_err(|e| OutputError::new(&self.path, Action::Write, e))?;
            self.put(part)?;
            left -= part.len() as u64;
        }
        self.end()
    }

    /// Ends the file, flushes it to the disk and gives it its name; the checkpoint before is kept as
    /// [`previous`](super::previous).
    ///
    /// # Errors
    /// [`IoError::Output`]; the checkpoint before is then where it was, or the previous one.
    pub fn commit(mut self) -> Result<(), IoError> {
        self.put(&[END])?;
        self.put(&self.sections.to_le_bytes())?;
        let length = self.length + 12;
        self.put(&length.to_le_bytes())?;
        let checksum = self.whole.clone().finalize();
        self.put(&checksum.to_le_bytes())?;
        Ok(self.file.commit_keeping(&previous(&self.path))?)
    }

    fn values(
        &mut self,
        kind: Kind,
        name: &str,
        count: usize,
        values: &mut dyn Iterator<Item = [u8; 8]>,
    ) -> Result<(), IoError> {
        self.begin(kind, name, 8 * count as u64)?;
        let (mut block, mut given) = (std::mem::take(&mut self.block), 0);
        for value in values {
            block.extend_from_slice(&value);
            given += 1;
            if block.len() >= BLOCK {
                self.put(&block)?;
                block.clear();
            }
        }
        self.put(&block)?;
        block.clear();
        self.block = block;
        if given != count {
            return Err(ValueError::Count { expected: count, got: given }.into());
        }
        self.end()
    }

    fn begin(&mut self, kind: Kind, name: &str, length: u64) -> Result<(), IoError> {
        let size = u8::try_from(name.len()).map_err(|_| ValueError::Name { name: name.to_owned() })?;
        self.section = Hasher::new();
        self.put(&[kind as u8, size])?;
        self.put(name.as_bytes())?;
        self.put(&length.to_le_bytes())
    }

    fn end(&mut self) -> Result<(), IoError> {
        let checksum = self.section.clone().finalize();
        self.put(&checksum.to_le_bytes())?;
        self.sections += 1;
        Ok(())
    }

    fn put(&mut self, bytes: &[u8]) -> Result<(), IoError> {
        self.whole.update(bytes);
        self.section.update(bytes);
        self.length += bytes.len() as u64;
        Ok(self.file.write(bytes)?)
    }
}
