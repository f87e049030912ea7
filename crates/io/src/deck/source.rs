//! Lines of a deck and of the files it includes.

use super::error::DeckErrorKind;
use super::keyword::Keyword;
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{BufRead, BufReader, Cursor, ErrorKind, Read};
use std::path::{Path, PathBuf};

/// Longest line, or keyword with its continuation lines \[bytes\].
pub(super) const MAX_LINE: usize = 1 << 16;
/// Most files that one deck may include.
pub(super) const MAX_INCLUDES: usize = 10_000;
/// Deepest nesting of included files.
pub(super) const MAX_DEPTH: usize = 64;

/// Where a line stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct At {
    /// Index of the file.
    pub file: u32,
    /// One-based line; 0 for the file as a whole.
    pub line: u32,
}

/// An error with its place.
#[derive(Debug)]
pub(super) struct Fault {
    pub at: At,
    pub kind: DeckErrorKind,
}

impl Fault {
    pub fn new(at: At, kind: DeckErrorKind) -> Self {
        Self { at, kind }
    }
}

/// Attaches a place to an error.
pub(super) trait Located<T> {
    fn at(self, at: At) -> Result<T, Fault>;
}

impl<T> Located<T> for Result<T, DeckErrorKind> {
    fn at(self, at: At) -> Result<T, Fault> {
        self.map_err(|kind| Fault { at, kind })
    }
}

/// A line that is neither blank nor a comment, includes followed and continued keywords joined.
#[derive(Debug)]
pub(super) enum Line {
    Keyword(Keyword),
    Data(String),
}

struct Open {
    file: u32,
    line: u32,
    reader: Box<dyn BufRead>,
    /// Resolved path, by which a cycle is seen.
    canonical: Option<PathBuf>,
}

/// Where files are.
enum Files {
    /// On the disk.
    Disk,
    /// Texts by their names.
    Texts(BTreeMap<PathBuf, Vec<u8>>),
}

impl Files {
    /// Opens a file; its resolved path, by which a cycle is seen, comes first.
    fn open(&self, path: &Path) -> Result<(PathBuf, Box<dyn BufRead>), DeckErrorKind> {
        let unreadable = |source| DeckErrorKind::Unreadable { path: path.to_path_buf(), source };
        match self {
            Self::Texts(texts) => {
                let bytes = texts.get(path).ok_or_else(|| unreadable(ErrorKind::NotFound.into()))?;
                Ok((path.to_path_buf(), Box::new(Cursor::new(bytes.clone()))))
            }
            Self::Disk => {
                let canonical = fs::canonicalize(path).map_err(unreadable)?;
                // A device or a pipe could deliver without end, and opening a pipe could block.
                if !fs::metadata(path).map_err(unreadable)?.is_file() {
                    return Err(DeckErrorKind::NotAFile { path: path.to_path_buf() });
                }
                Ok((canonical, Box::new(BufReader::new(File::open(path).map_err(unreadable)?))))
            }
        }
    }
}

/// Reads a deck line by line.
pub(super) struct Source {
    /// Every file opened so far; an [`At`] refers to them.
    pub files: Vec<PathBuf>,
    stack: Vec<Open>,
    ahead: Option<(At, String)>,
    disk: Files,
}

impl Source {
    /// Starts with a file.
    pub fn open(path: &Path) -> Result<Self, DeckErrorKind> {
        let mut source = Self { files: Vec::new(), stack: Vec::new(), ahead: None, disk: Files::Disk };
        source.push_file(path.to_path_buf())?;
        Ok(source)
    }

    /// Starts with the text of a name; included files are among the texts.
    pub fn texts(name: &Path, texts: BTreeMap<PathBuf, Vec<u8>>) -> Self {
        let bytes = texts.get(name).cloned().unwrap_or_default();
        let open = Open { file: 0, line: 0, reader: Box::new(Cursor::new(bytes)), canonical: Some(name.to_path_buf()) };
        Self { files: vec![name.to_path_buf()], stack: vec![open], ahead: None, disk: Files::Texts(texts) }
    }

    /// Starts with a text; `name` stands for it in messages, and its folder is where included files are looked for.
    pub fn text(name: &Path, text: &str) -> Self {
        let reader = Box::new(Cursor::new(text.as_bytes().to_vec()));
        let open = Open { file: 0, line: 0, reader, canonical: fs::canonicalize(name).ok() };
        Self { files: vec![name.to_path_buf()], stack: vec![open], ahead: None, disk: Files::Disk }
    }

    /// The next line with its place; `None` at the end of the deck.
    pub fn next(&mut self) -> Result<Option<(At, Line)>, Fault> {
        while let Some((at, text)) = self.take()? {
            if !text.starts_with('*') {
                return Ok(Some((at, Line::Data(text))));
            }
            let text = self.join_continuation(at, text)?;
            let keyword = Keyword::parse(&text).at(at)?;
            if keyword.name != "INCLUDE" {
                return Ok(Some((at, Line::Keyword(keyword))));
            }
            self.include(&keyword, at)?;
        }
        Ok(None)
    }

    fn take(&mut self) -> Result<Option<(At, String)>, Fault> {
        match self.ahead.take() {
            Some(line) => Ok(Some(line)),
            None => self.read(),
        }
    }

    /// Appends the lines after a keyword line that ends with a comma.
    fn join_continuation(&mut self, at: At, mut text: String) -> Result<String, Fault> {
        while text.ends_with(',') {
            match self.take()? {
                Some((_, more)) if !more.starts_with('*') => text.push_str(&more),
                other => {
                    self.ahead = other;
                    break;
                }
            }
            if text.len() > MAX_LINE {
                return Err(Fault::new(at, DeckErrorKind::LineTooLong { limit: MAX_LINE }));
            }
        }
        Ok(text)
    }

    fn read(&mut self) -> Result<Option<(At, String)>, Fault> {
        let mut bytes = Vec::new();
        while let Some(open) = self.stack.last_mut() {
            bytes.clear();
            open.line = open.line.saturating_add(1);
            let at = At { file: open.file, line: open.line };
            let read = (&mut open.reader).take(MAX_LINE as u64 + 1).read_until(b'\n', &mut bytes);
            let length = read.map_err(|source| Fault::new(at, unreadable(&self.files, at, source)))?;
            if length == 0 {
                self.stack.pop();
                continue;
            }
            if length > MAX_LINE {
                return Err(Fault::new(at, DeckErrorKind::LineTooLong { limit: MAX_LINE }));
            }
            let line = String::from_utf8_lossy(&bytes);
            let line = line.trim_matches(|c: char| c.is_whitespace() || c == '\u{feff}');
            if !line.is_empty() && !line.starts_with("**") {
                return Ok(Some((at, line.to_owned())));
            }
        }
        Ok(None)
    }

    fn include(&mut self, keyword: &Keyword, at: At) -> Result<(), Fault> {
        let input = keyword.required("INPUT").at(at)?;
        let including = self.files.get(at.file as usize).and_then(|path| path.parent());
        let path = including.unwrap_or(Path::new("")).join(input.raw());
        self.defer_ahead();
        self.push_file(path).at(at)
    }

    /// Puts a line already read back under the file about to be included.
    fn defer_ahead(&mut self) {
        if let Some((at, text)) = self.ahead.take() {
            let reader = Box::new(Cursor::new(text.into_bytes()));
            self.stack.push(Open { file: at.file, line: at.line.saturating_sub(1), reader, canonical: None });
        }
    }

    fn push_file(&mut self, path: PathBuf) -> Result<(), DeckErrorKind> {
        if self.files.len() > MAX_INCLUDES {
            return Err(DeckErrorKind::TooManyIncludes { limit: MAX_INCLUDES });
        }
        if self.stack.len() >= MAX_DEPTH {
            return Err(DeckErrorKind::IncludeDepth { limit: MAX_DEPTH });
        }
        let (canonical, reader) = self.disk.open(&path)?;
        if self.stack.iter().any(|open| open.canonical.as_ref() == Some(&canonical)) {
            return Err(DeckErrorKind::IncludeCycle { path });
        }
        self.stack.push(Open { file: self.files.len() as u32, line: 0, reader, canonical: Some(canonical) });
        self.files.push(path);
        Ok(())
    }
}

fn unreadable(files: &[PathBuf], at: At, source: std::io::Error) -> DeckErrorKind {
    DeckErrorKind::Unreadable { path: files.get(at.file as usize).cloned().unwrap_or_default(), source }
}
