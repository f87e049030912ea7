//! Files that appear whole or not at all.

use crate::error::{Action, OutputError};
use crate::writes::{Counted, Writes};
use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::io::{BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

static SERIAL: AtomicU64 = AtomicU64::new(0);

/// A file written aside in the folder of its target and renamed over it by [`commit`](Self::commit).
///
/// Readers see the old content or the new one, never a part. Dropped without a commit, it leaves no trace.
#[derive(Debug)]
pub struct AtomicFile {
    target: PathBuf,
    aside: PathBuf,
    writes: Writes,
    /// `None` once closed.
    writer: Option<BufWriter<Counted>>,
}

impl AtomicFile {
    /// Opens a new file aside of `target`.
    ///
    /// # Errors
    /// [`OutputError`] when the folder does not exist or cannot be written.
    pub fn create(target: &Path) -> Result<Self, OutputError> {
        Self::create_with(target, &Writes::default())
    }

    /// The same, with its operations counted.
    ///
    /// # Errors
    /// As [`AtomicFile::create`].
    pub fn create_with(target: &Path, writes: &Writes) -> Result<Self, OutputError> {
        let aside = aside(target);
        let opened = writes.pass().and_then(|()| OpenOptions::new().write(true).create_new(true).open(&aside));
        let file = opened.map_err(|e| OutputError::new(target, Action::Create, e))?;
        let writer = BufWriter::with_capacity(1 << 16, Counted { file, writes: writes.clone() });
        Ok(Self { target: target.to_path_buf(), aside, writes: writes.clone(), writer: Some(writer) })
    }

    /// Appends bytes.
    ///
    /// # Errors
    /// [`OutputError`], for example on a full disk.
    pub fn write(&mut self, bytes: &[u8]) -> Result<(), OutputError> {
        match &mut self.writer {
            Some(writer) => writer.write_all(bytes).map_err(|e| OutputError::new(&self.target, Action::Write, e)),
            None => Ok(()),
        }
    }

    /// Flushes the content to the disk and gives it its final name.
    ///
    /// # Errors
    /// [`OutputError`]; the target is then untouched.
    pub fn commit(mut self) -> Result<(), OutputError> {
        self.flush()?;
        self.rename()
    }

    /// The same, keeping what stood under that name as `previous`. A process that is killed between both renames leaves
    /// the previous file alone.
    ///
    /// # Errors
    /// [`OutputError`]; the target is then untouched, or has become the previous one.
    pub fn commit_keeping(mut self, previous: &Path) -> Result<(), OutputError> {
        self.flush()?;
        let kept = self.writes.pass().and_then(|()| match fs::rename(&self.target, previous) {
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
            done => done,
        });
        kept.map_err(|e| OutputError::new(previous, Action::Rename, e))?;
        self.rename()
    }

    fn flush(&mut self) -> Result<(), OutputError> {
        let Some(writer) = self.writer.take() else { return Ok(()) };
        let failure = |action| move |e| (action, e);
        let counted = writer.into_inner().map_err(|e| failure(Action::Write)(e.into_error()));
        let flushed = counted.and_then(|counted| {
            self.writes.pass().and_then(|()| counted.file.sync_all()).map_err(failure(Action::Flush))
        });
        flushed.map_err(|(action, e)| OutputError::new(&self.target, action, e))
    }

    fn rename(&mut self) -> Result<(), OutputError> {
        let renamed = self.writes.pass().and_then(|()| fs::rename(&self.aside, &self.target));
        renamed.map_err(|e| OutputError::new(&self.target, Action::Rename, e))?;
        self.aside.clear();
        sync_folder(&self.target);
        Ok(())
    }
}

impl Drop for AtomicFile {
    fn drop(&mut self) {
        if self.aside.as_os_str().is_empty() {
            return;
        }
        if let Some(writer) = self.writer.take() {
            // The parts are discarded unflushed: a failing flush would have nobody to tell.
            let _ = writer.into_parts();
        }
        let _ = fs::remove_file(&self.aside);
    }
}

/// Writes `bytes` to `path` so that the file appears whole or not at all.
///
/// # Errors
/// [`OutputError`]; the previous content is then untouched.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), OutputError> {
    let mut file = AtomicFile::create(path)?;
    file.write(bytes)?;
    file.commit()
}

/// Takes away what a process that was killed while it wrote `target` left beside it. Nobody else may be writing it.
pub fn remove_parts(target: &Path) {
    let Some(name) = target.file_name().map(|n| format!(".{}.", n.to_string_lossy())) else { return };
    let Ok(entries) = fs::read_dir(folder_of(target)) else { return };
    for entry in entries.flatten() {
        let other = entry.file_name().to_string_lossy().into_owned();
        if other.starts_with(&name) && other.ends_with(PART) {
            // What cannot be taken away does no harm.
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// End of the names of files that are being written.
const PART: &str = ".part";

fn aside(target: &Path) -> PathBuf {
    let mut name = OsString::from(".");
    name.push(target.file_name().unwrap_or_default());
    name.push(format!(".{}.{}{PART}", std::process::id(), SERIAL.fetch_add(1, Ordering::Relaxed)));
    target.with_file_name(name)
}

fn folder_of(target: &Path) -> &Path {
    match target.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// Makes the rename itself durable where folders can be synchronised; elsewhere there is nothing to do.
fn sync_folder(target: &Path) {
    if let Ok(folder) = File::open(folder_of(target)) {
        let _ = folder.sync_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entries(folder: &Path) -> usize {
        fs::read_dir(folder).unwrap().count()
    }

    #[test]
    fn content_is_replaced_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        write_atomically(&path, b"first, long").unwrap();
        write_atomically(&path, b"second").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"second");
        assert_eq!(entries(folder.path()), 1);
    }

    #[test]
    fn nothing_remains_without_a_commit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        fs::write(&path, "old").unwrap();
        let mut file = AtomicFile::create(&path).unwrap();
        file.write(b"new").unwrap();
        drop(file);
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(entries(folder.path()), 1);
    }

    #[test]
    fn missing_folder_and_folder_as_target_are_told() {
        let folder = tempfile::tempdir().unwrap();
        let error = write_atomically(&folder.path().join("no/such/a.txt"), b"x").unwrap_err();
        assert_eq!(error.action, Action::Create);
        let taken = folder.path().join("taken");
        fs::create_dir(&taken).unwrap();
        assert_eq!(write_atomically(&taken, b"x").unwrap_err().action, Action::Rename);
        assert_eq!(entries(folder.path()), 1);
    }

    #[test]
    fn the_one_before_is_kept_and_parts_go() {
        let folder = tempfile::tempdir().unwrap();
        let (path, previous) = (folder.path().join("a"), folder.path().join("a.previous"));
        for content in [b"1", b"2", b"3"] {
            let mut file = AtomicFile::create(&path).unwrap();
            file.write(content).unwrap();
            file.commit_keeping(&previous).unwrap();
        }
        assert_eq!((fs::read(&path).unwrap(), fs::read(&previous).unwrap()), (b"3".to_vec(), b"2".to_vec()));
        fs::write(folder.path().join(".a.7.0.part"), "half").unwrap();
        remove_parts(&path);
        assert_eq!(entries(folder.path()), 2);
    }
}
