//! Histories: one row of numbers per increment as comma-separated text.

use crate::error::{Action, IoError, OutputCause, OutputError, TextError, TextErrorKind, ValueError};
use crate::input;
use crate::writes::Writes;
use std::fmt::Write as _;
use std::fs::{File, OpenOptions};
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

/// A column of a history.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Column {
    /// What is listed, for example `force`.
    pub name: String,
    /// Its unit, for example `N`; `-` for a pure number.
    pub unit: String,
}

impl Column {
    /// A column of a name and a unit.
    pub fn new(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { name: name.into(), unit: unit.into() }
    }

    fn check(&self) -> Result<(), ValueError> {
        let wrong = |text: &str| {
            text.is_empty() || text.trim() != text || text.contains(['[', ']', ',', '"', '#']) || has_control(text)
        };
        match wrong(&self.name) || wrong(&self.unit) {
            true => Err(ValueError::Name { name: format!("{} [{}]", self.name, self.unit) }),
            false => Ok(()),
        }
    }

    fn parse(header: &str) -> Option<Self> {
        let (name, unit) = header.trim().strip_suffix(']')?.split_once('[')?;
        let column = Self::new(name.trim(), unit.trim());
        column.check().ok().map(|()| column)
    }
}

fn has_control(text: &str) -> bool {
    text.chars().any(char::is_control)
}

/// How far a history had grown: enough to cut it back to there, and to know that it is the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct HistoryPlace {
    /// Bytes.
    pub length: u64,
    /// CRC-32 of them.
    pub checksum: u32,
}

/// Writes a history row by row; every row is on the disk (handed to the system) when [`row`](Self::row) returns.
#[derive(Debug)]
pub struct HistoryWriter {
    path: PathBuf,
    file: File,
    columns: Vec<Column>,
    line: String,
    failed: bool,
    length: u64,
    checksum: crc32fast::Hasher,
    writes: Writes,
}

impl HistoryWriter {
    /// Creates the file, replacing an older one, and writes the header `name [unit],name [unit],...`.
    ///
    /// # Errors
    /// [`ValueError::Name`] and [`ValueError::DuplicateName`] for headers that could not be read back;
    /// [`IoError::Output`] when the file cannot be written.
    pub fn create(path: &Path, columns: &[Column]) -> Result<Self, IoError> {
        Self::create_with(path, columns, &Writes::default())
    }

    /// The same, with its operations counted.
    ///
    /// # Errors
    /// As [`HistoryWriter::create`].
    pub fn create_with(path: &Path, columns: &[Column], writes: &Writes) -> Result<Self, IoError> {
        check_columns(columns)?;
        let file = writes.pass().and_then(|()| File::create(path));
        let file = file.map_err(|e| OutputError::new(path, Action::Create, e))?;
        let mut writer = Self::new(path, file, columns, writes);
        writer.line = header(columns);
        writer.put()?;
        Ok(writer)
    }

    /// Goes on with a history that had grown to a place: rows behind it are cut off.
    ///
    /// # Errors
    /// [`IoError::Read`] when the file cannot be read, [`IoError::Changed`] when it is not the one that grew to that place;
    /// [`IoError::Output`] when it cannot be cut.
    pub fn resume(path: &Path, columns: &[Column], place: HistoryPlace, writes: &Writes) -> Result<Self, IoError> {
        let unreadable = |source| IoError::Read { path: path.to_path_buf(), source };
        let file = OpenOptions::new().read(true).write(true).open(path).map_err(|e| IoError::reopened(path, e))?;
        let mut writer = Self::new(path, file, columns, writes);
        let begin = writer.read_again(place.length).map_err(unreadable)?;
        if writer.place() != place || !begin.starts_with(header(columns).as_bytes()) {
            return Err(IoError::Changed { path: path.to_path_buf(), length: place.length });
        }
        let cut = writes.pass().and_then(|()| {
            writer.file.set_len(place.length)?;
            writer.file.seek(SeekFrom::Start(place.length))
        });
        cut.map_err(|e| OutputError::new(path, Action::Write, e))?;
        Ok(writer)
    }

    fn new(path: &Path, file: File, columns: &[Column], writes: &Writes) -> Self {
        Self {
            path: path.to_path_buf(),
            file,
            columns: columns.to_vec(),
            line: String::new(),
            failed: false,
            length: 0,
            checksum: crc32fast::Hasher::new(),
            writes: writes.clone(),
        }
    }

    /// Reads up to `length` bytes and notes them as written; answers the first of them, the header among them.
    fn read_again(&mut self, length: u64) -> std::io::Result<Vec<u8>> {
        let (mut begin, mut block) = (Vec::new(), vec![0; 1 << 16]);
        let mut content = (&self.file).take(length);
        loop {
            let count = content.read(&mut block)?;
            if count == 0 {
                return Ok(begin);
            }
            if self.length < HEADER_LIMIT {
                begin.extend_from_slice(&block[..count]);
            }
            self.length += count as u64;
            self.checksum.update(&block[..count]);
        }
    }

    /// Where the history ends.
    #[must_use]
    pub fn place(&self) -> HistoryPlace {
        HistoryPlace { length: self.length, checksum: self.checksum.clone().finalize() }
    }

    /// Makes sure that all rows are on the disk itself.
    ///
    /// # Errors
    /// [`IoError::Output`], also after an earlier failure.
    pub fn flush(&mut self) -> Result<(), IoError> {
        self.refuse_after_failure()?;
        let flushed = self.writes.pass().and_then(|()| self.file.sync_data());
        flushed.map_err(|e| OutputError::new(&self.path, Action::Flush, e).into())
    }

    /// Appends one row in the order of the columns; numbers are the shortest text that reads back to the same value.
    ///
    /// # Errors
    /// [`ValueError::Count`], [`ValueError::NotFinite`] (nothing is written then); [`IoError::Output`], after which
    /// every further row is refused.
    pub fn row(&mut self, values: &[f64]) -> Result<(), IoError> {
        if values.len() != self.columns.len() {
            return Err(ValueError::Count { expected: self.columns.len(), got: values.len() }.into());
        }
        if let Some(index) = values.iter().position(|v| !v.is_finite()) {
            let name = self.columns[index].name.clone();
            return Err(ValueError::NotFinite { name, index, value: values[index] }.into());
        }
        self.line.clear();
        for (i, value) in values.iter().enumerate() {
            let comma = if i == 0 { "" } else { "," };
            let _ = write!(self.line, "{comma}{value:?}");
        }
        self.put()
    }

    /// The columns.
    pub fn columns(&self) -> &[Column] {
        &self.columns
    }

    fn put(&mut self) -> Result<(), IoError> {
        self.refuse_after_failure()?;
        self.line.push('\n');
        let written = self.writes.write_all(&self.file, self.line.as_bytes());
        self.failed = written.is_err();
        self.length += self.line.len() as u64;
        self.checksum.update(self.line.as_bytes());
        written.map_err(|e| OutputError::new(&self.path, Action::Write, e).into())
    }

    fn refuse_after_failure(&self) -> Result<(), OutputError> {
        match self.failed {
            true => Err(OutputError::new(&self.path, Action::Write, OutputCause::EarlierFailure)),
            false => Ok(()),
        }
    }
}

/// Headers lie within so many bytes.
const HEADER_LIMIT: u64 = 1 << 20;

/// The first line, without its line break.
fn header(columns: &[Column]) -> String {
    let headers: Vec<String> = columns.iter().map(|c| format!("{} [{}]", c.name, c.unit)).collect();
    headers.join(",")
}

fn check_columns(columns: &[Column]) -> Result<(), ValueError> {
    if columns.is_empty() {
        return Err(ValueError::Count { expected: 1, got: 0 });
    }
    for (i, column) in columns.iter().enumerate() {
        column.check()?;
        if columns[..i].iter().any(|c| c.name == column.name) {
            return Err(ValueError::DuplicateName { name: column.name.clone() });
        }
    }
    Ok(())
}

/// A history read back.
#[derive(Debug, Clone, PartialEq)]
pub struct History {
    /// Its columns.
    pub columns: Vec<Column>,
    /// Its rows, one value per column.
    pub rows: Vec<Vec<f64>>,
    /// Whether the last line was cut (a killed run) and left out.
    pub truncated: bool,
}

impl History {
    /// Values of the column `name`; `None` when there is no such column.
    pub fn column(&self, name: &str) -> Option<Vec<f64>> {
        let index = self.columns.iter().position(|c| c.name == name)?;
        Some(self.rows.iter().filter_map(|row| row.get(index).copied()).collect())
    }
}

/// Reads a history. A last line without its line break is left out and reported by [`History::truncated`].
///
/// # Errors
/// [`IoError::Read`] when the file cannot be read, [`IoError::Text`] with the line of a malformed header or row.
pub fn read_history(path: &Path) -> Result<History, IoError> {
    let text = input::read_text(path, input::MAX_TABLE);
    let text = text.map_err(|source| IoError::Read { path: path.to_path_buf(), source })?;
    Ok(parse_history(path, &text)?)
}

/// Reads a history from its text; `path` stands for it in messages.
///
/// # Errors
/// [`TextError`] with the line of a malformed header or row.
pub fn parse_history(path: &Path, text: &str) -> Result<History, TextError> {
    let fault = |line, kind| TextError { path: path.to_path_buf(), line, kind };
    let truncated = !text.is_empty() && !text.ends_with('\n');
    let whole = if truncated { text.rfind('\n').map_or("", |end| &text[..end]) } else { text };
    let mut lines = whole.lines();
    let header = lines.next().ok_or_else(|| fault(1, TextErrorKind::NoHeader))?;
    let columns = parse_header(header).map_err(|kind| fault(1, kind))?;
    let rows = lines
        .enumerate()
        .map(|(i, line)| parse_row(line, columns.len()).map_err(|kind| fault(i + 2, kind)))
        .collect::<Result<_, _>>()?;
    Ok(History { columns, rows, truncated })
}

fn parse_header(line: &str) -> Result<Vec<Column>, TextErrorKind> {
    line.split(',')
        .map(|header| Column::parse(header).ok_or_else(|| TextErrorKind::BadHeader { header: header.to_owned() }))
        .collect()
}

fn parse_row(line: &str, columns: usize) -> Result<Vec<f64>, TextErrorKind> {
    let values: Vec<f64> = line
        .split(',')
        .map(|field| match field.trim().parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            _ => Err(TextErrorKind::BadNumber { field: field.to_owned() }),
        })
        .collect::<Result<_, _>>()?;
    match values.len() == columns {
        true => Ok(values),
        false => Err(TextErrorKind::ValueCount { expected: columns, got: values.len() }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::ErrorClass;
    use proptest::prelude::*;

    fn columns() -> Vec<Column> {
        vec![Column::new("time", "s"), Column::new("force", "N")]
    }

    #[test]
    fn rows_are_on_the_disk_at_once() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("h.csv");
        let mut writer = HistoryWriter::create(&path, &columns()).unwrap();
        writer.row(&[0.5, -1e-9]).unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "time [s],force [N]\n0.5,-1e-9\n");
        writer.row(&[1.0, 3e300]).unwrap();
        let history = read_history(&path).unwrap();
        assert_eq!(history.columns, columns());
        assert_eq!(history.column("force").unwrap(), [-1e-9, 3e300]);
        assert_eq!(history.column("moment"), None);
    }

    #[test]
    fn wrong_values_and_names_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("h.csv");
        let mut writer = HistoryWriter::create(&path, &columns()).unwrap();
        let error = writer.row(&[0.0, f64::NAN]).unwrap_err();
        assert!(matches!(error, IoError::Value(ValueError::NotFinite { index: 1, .. })));
        assert!(matches!(writer.row(&[0.0]), Err(IoError::Value(ValueError::Count { expected: 2, got: 1 }))));
        assert_eq!(read_history(&path).unwrap().rows.len(), 0);
        for name in ["", "a,b", "a [b", "a\nb", " a", "\"a\""] {
            assert!(HistoryWriter::create(&path, &[Column::new(name, "N")]).is_err(), "{name:?}");
        }
        let twice = [Column::new("a", "N"), Column::new("a", "mm")];
        assert!(matches!(HistoryWriter::create(&path, &twice), Err(IoError::Value(ValueError::DuplicateName { .. }))));
    }

    #[test]
    fn a_history_goes_on_from_a_place() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("h.csv");
        let mut writer = HistoryWriter::create(&path, &columns()).unwrap();
        writer.row(&[1.0, 2.0]).unwrap();
        let place = writer.place();
        writer.row(&[2.0, 3.0]).unwrap();
        drop(writer);
        let resume = |place| HistoryWriter::resume(&path, &columns(), place, &Writes::default());
        let longer = HistoryPlace { length: place.length + 100, ..place };
        let other = HistoryPlace { checksum: !place.checksum, ..place };
        for wrong in [longer, other] {
            assert!(matches!(resume(wrong), Err(IoError::Changed { .. })));
        }
        let mut writer = resume(place).unwrap();
        writer.row(&[5.0, 6.0]).unwrap();
        assert_eq!(read_history(&path).unwrap().rows, [[1.0, 2.0], [5.0, 6.0]]);
        let renamed = [Column::new("time", "s"), Column::new("moment", "N mm")];
        assert!(HistoryWriter::resume(&path, &renamed, place, &Writes::default()).is_err());
    }

    #[test]
    fn the_write_that_is_to_fail_fails() {
        let folder = tempfile::tempdir().unwrap();
        let writes = Writes::failing(4, 1);
        let mut writer = HistoryWriter::create_with(&folder.path().join("h.csv"), &columns(), &writes).unwrap();
        writer.row(&[1.0, 2.0]).unwrap();
        assert!(writer.row(&[2.0, 3.0]).unwrap_err().to_string().contains("h.csv"));
        assert!(writer.row(&[2.0, 3.0]).is_err() && writer.flush().is_err(), "nothing more is written");
        assert_eq!(writes.done(), 4);
        assert!(read_history(&folder.path().join("h.csv")).unwrap().truncated);
    }

    #[test]
    fn a_cut_line_is_left_out_and_a_wrong_one_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("h.csv");
        std::fs::write(&path, "a [N]\n1.0\n2.").unwrap();
        let history = read_history(&path).unwrap();
        assert!(history.truncated);
        assert_eq!(history.rows, [[1.0]]);
        for (text, line) in [("", 1), ("a\n", 1), ("a [N]\n1\nx\n", 3), ("a [N]\n1,2\n", 2), ("a [N]\nNaN\n", 2)] {
            std::fs::write(&path, text).unwrap();
            let Err(IoError::Text(error)) = read_history(&path) else { panic!("{text:?} was read") };
            assert_eq!(error.line, line, "{text:?}");
        }
        assert_eq!(read_history(&folder.path().join("none")).unwrap_err().class(), ErrorClass::Input);
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn a_full_disk_is_told() {
        let error = HistoryWriter::create(Path::new("/dev/full"), &columns()).unwrap_err();
        let IoError::Output(OutputError { action: Action::Write, cause: OutputCause::System(system), .. }) = error
        else {
            panic!("{error}")
        };
        assert_eq!(system.kind(), std::io::ErrorKind::StorageFull);
    }

    proptest! {
        #[test]
        fn every_finite_number_survives(values in prop::collection::vec(any::<f64>(), 1..20)) {
            let values: Vec<f64> = values.into_iter().filter(|x| x.is_finite()).collect();
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("h.csv");
            let mut writer = HistoryWriter::create(&path, &[Column::new("x", "-")]).unwrap();
            for &value in &values {
                writer.row(&[value]).unwrap();
            }
            let bits = |values: &[f64]| values.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            let back = read_history(&path).unwrap().column("x").unwrap();
            prop_assert_eq!(bits(&back), bits(&values));
        }
    }
}
