//! Reading a checkpoint: all of it is checked first.

use super::{BLOCK, CheckpointError, CheckpointFault as Fault, END, FORMAT, Kind, MAGIC};
use crate::error::IoError;
use crc32fast::Hasher;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufReader, ErrorKind, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

/// A checkpoint whose checksums are right.
#[derive(Debug)]
pub struct CheckpointReader {
    path: PathBuf,
    source: Source,
    sections: BTreeMap<String, Section>,
}

/// Where the bytes are.
#[derive(Debug)]
enum Source {
    File(File),
    Memory(Vec<u8>),
}

/// Some of the bytes.
enum Content<'a> {
    File(io::Take<&'a File>),
    Memory(&'a [u8]),
}

impl Read for Content<'_> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::File(file) => file.read(into),
            Self::Memory(bytes) => bytes.read(into),
        }
    }
}

/// Where the content of a section is.
#[derive(Clone, Copy, Debug)]
struct Section {
    kind: Kind,
    begin: u64,
    length: u64,
}

impl CheckpointReader {
    /// Opens a checkpoint and reads all of it once, to check it.
    ///
    /// # Errors
    /// [`IoError::Read`] when the file cannot be read, [`IoError::Checkpoint`] when it is no checkpoint, of another format,
    /// or damaged.
    pub fn open(path: &Path) -> Result<Self, IoError> {
        let unreadable = |source| IoError::Read { path: path.to_path_buf(), source };
        let about = std::fs::metadata(path).map_err(unreadable)?;
        if !about.is_file() {
            // Opening a pipe could block.
            return Err(unreadable(io::Error::new(ErrorKind::InvalidInput, "it is not a regular file")));
        }
        let file = File::open(path).map_err(unreadable)?;
        let mut reader = BufReader::with_capacity(BLOCK, &file);
        let sections = Scan::new(path, &mut reader, about.len()).sections()?;
        Ok(Self { path: path.to_path_buf(), source: Source::File(file), sections })
    }

    /// A checkpoint from its bytes; `path` stands for it in messages.
    ///
    /// # Errors
    /// [`IoError::Checkpoint`], as [`open`](Self::open).
    pub fn of_bytes(path: &Path, bytes: Vec<u8>) -> Result<Self, IoError> {
        let length = bytes.len() as u64;
        let sections = Scan::new(path, &mut bytes.as_slice(), length).sections()?;
        Ok(Self { path: path.to_path_buf(), source: Source::Memory(bytes), sections })
    }

    /// The file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// All numbers of a section.
    ///
    /// # Errors
    /// [`IoError::Checkpoint`] when there is no such section of numbers; [`IoError::Read`].
    pub fn numbers(&self, name: &str) -> Result<Vec<f64>, IoError> {
        let section = self.section(Kind::Numbers, name)?;
        let mut out = Vec::with_capacity((section.length / 8) as usize);
        self.words(section, |bytes| out.push(f64::from_le_bytes(bytes)))?;
        Ok(out)
    }

    /// The numbers of a section, as many as there is room for.
    ///
    /// # Errors
    /// As [`numbers`](Self::numbers), also when there are more or fewer.
    pub fn read_numbers(&self, name: &str, into: &mut [f64]) -> Result<(), IoError> {
        let section = self.section(Kind::Numbers, name)?;
        if section.length != 8 * into.len() as u64 {
            let fault = Fault::Shape { found: section.length / 8, expected: into.len() as u64 };
            return Err(self.fault(name, section.begin, fault).into());
        }
        let mut slots = into.iter_mut();
        self.words(section, |bytes| {
            if let Some(slot) = slots.next() {
                *slot = f64::from_le_bytes(bytes);
            }
        })
    }

    /// All whole numbers of a section.
    ///
    /// # Errors
    /// As [`numbers`](Self::numbers).
    pub fn counts(&self, name: &str) -> Result<Vec<u64>, IoError> {
        let section = self.section(Kind::Counts, name)?;
        let mut out = Vec::with_capacity((section.length / 8) as usize);
        self.words(section, |bytes| out.push(u64::from_le_bytes(bytes)))?;
        Ok(out)
    }

    /// The bytes of a section, to be read in one go: the reader has one position for all of them.
    ///
    /// # Errors
    /// As [`numbers`](Self::numbers).
    pub fn bytes(&self, name: &str) -> Result<impl Read + '_, IoError> {
        self.content(self.section(Kind::Bytes, name)?)
    }

    /// The bytes of a section as text.
    ///
    /// # Errors
    /// As [`numbers`](Self::numbers); text that is not UTF-8 is told as damage.
    pub fn text(&self, name: &str) -> Result<String, IoError> {
        let section = self.section(Kind::Bytes, name)?;
        let mut text = Vec::new();
        self.content(section)?.read_to_end(&mut text).map_err(|source| self.unreadable(source))?;
        String::from_utf8(text).map_err(|_| self.fault(name, section.begin, Fault::Structure).into())
    }

    fn section(&self, kind: Kind, name: &str) -> Result<Section, CheckpointError> {
        let section = self.sections.get(name).copied().filter(|s| s.kind == kind);
        section.ok_or_else(|| self.fault(name, 0, Fault::Missing))
    }

    fn content(&self, section: Section) -> Result<Content<'_>, IoError> {
        match &self.source {
            Source::File(file) => {
                let mut file: &File = file;
                file.seek(SeekFrom::Start(section.begin)).map_err(|source| self.unreadable(source))?;
                Ok(Content::File(file.take(section.length)))
            }
            Source::Memory(bytes) => {
                let (begin, end) = (section.begin as usize, (section.begin + section.length) as usize);
                Ok(Content::Memory(bytes.get(begin..end).unwrap_or_default()))
            }
        }
    }

    fn words(&self, section: Section, mut each: impl FnMut([u8; 8])) -> Result<(), IoError> {
        let mut source = BufReader::with_capacity(BLOCK, self.content(section)?);
        let mut word = [0; 8];
        for _ in 0..section.length / 8 {
            source.read_exact(&mut word).map_err(|source| self.unreadable(source))?;
            each(word);
        }
        Ok(())
    }

    fn unreadable(&self, source: io::Error) -> IoError {
        IoError::Read { path: self.path.clone(), source }
    }

    fn fault(&self, section: &str, offset: u64, fault: Fault) -> CheckpointError {
        CheckpointError { path: self.path.clone(), section: section.to_owned(), offset, fault }
    }
}

/// One pass through the file.
struct Scan<'a> {
    path: &'a Path,
    source: &'a mut dyn Read,
    at: u64,
    length: u64,
    whole: Hasher,
    section: Hasher,
    /// Of the section that is read.
    name: String,
}

impl<'a> Scan<'a> {
    fn new(path: &'a Path, source: &'a mut dyn Read, length: u64) -> Self {
        let (whole, section) = (Hasher::new(), Hasher::new());
        Self { path, source, at: 0, length, whole, section, name: String::new() }
    }

    fn sections(&mut self) -> Result<BTreeMap<String, Section>, IoError> {
        if self.take::<8>().ok() != Some(MAGIC) {
            return Err(self.fault(Fault::Magic));
        }
        let found = u32::from_le_bytes(self.take()?);
        if found != FORMAT {
            return Err(self.fault(Fault::Format { found, known: FORMAT }));
        }
        let mut sections = BTreeMap::new();
        loop {
            self.section = Hasher::new();
            let [kind] = self.take()?;
            if kind == END {
                self.end(sections.len() as u64)?;
                return Ok(sections);
            }
            let kind = Kind::of(kind).ok_or_else(|| self.fault(Fault::Structure))?;
            let section = self.one(kind)?;
            if sections.insert(std::mem::take(&mut self.name), section).is_some() {
                return Err(self.fault(Fault::Structure));
            }
        }
    }

    fn one(&mut self, kind: Kind) -> Result<Section, IoError> {
        let [size] = self.take()?;
        let mut name = vec![0; size as usize];
        self.fill(&mut name)?;
        self.name = String::from_utf8(name).map_err(|_| self.fault(Fault::Structure))?;
        let length = u64::from_le_bytes(self.take()?);
        if length > self.length.saturating_sub(self.at) {
            return Err(self.fault(Fault::Truncated));
        }
        if kind != Kind::Bytes && length % 8 != 0 {
            return Err(self.fault(Fault::Structure));
        }
        let begin = self.at;
        self.skip(length)?;
        let found = self.section.clone().finalize();
        self.compare(found)?;
        Ok(Section { kind, begin, length })
    }

    fn end(&mut self, sections: u64) -> Result<(), IoError> {
        let count = u64::from_le_bytes(self.take()?);
        let length = u64::from_le_bytes(self.take()?);
        let found = self.whole.clone().finalize();
        self.compare(found)?;
        if count != sections || length != self.at {
            return Err(self.fault(Fault::Structure));
        }
        match self.length.saturating_sub(self.at) {
            0 => Ok(()),
            count => Err(self.fault(Fault::Trailing { count })),
        }
    }

    fn compare(&mut self, found: u32) -> Result<(), IoError> {
        let expected = u32::from_le_bytes(self.take()?);
        if found == expected { Ok(()) } else { Err(self.fault(Fault::Checksum { found, expected })) }
    }

    fn skip(&mut self, length: u64) -> Result<(), IoError> {
        let (mut left, mut block) = (length, vec![0; length.min(BLOCK as u64) as usize]);
        while left > 0 {
            let part = left.min(BLOCK as u64) as usize;
            self.fill(&mut block[..part])?;
            left -= part as u64;
        }
        Ok(())
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], IoError> {
        let mut bytes = [0; N];
        self.fill(&mut bytes)?;
        Ok(bytes)
    }

    fn fill(&mut self, bytes: &mut [u8]) -> Result<(), IoError> {
        self.source.read_exact(bytes).map_err(|source| match source.kind() {
            ErrorKind::UnexpectedEof => self.fault(Fault::Truncated),
            _ => IoError::Read { path: self.path.to_path_buf(), source },
        })?;
        self.at += bytes.len() as u64;
        self.whole.update(bytes);
        self.section.update(bytes);
        Ok(())
    }

    fn fault(&self, fault: Fault) -> IoError {
        let section = self.name.clone();
        CheckpointError { path: self.path.to_path_buf(), section, offset: self.at, fault }.into()
    }
}
