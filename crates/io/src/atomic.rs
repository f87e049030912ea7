//! Files that appear whole or not at all.

use crate::error::{Action, OutputError};
use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::io::{BufWriter, Write};
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
    /// `None` once closed.
    writer: Option<BufWriter<File>>,
}

impl AtomicFile {
    /// Opens a new file aside of `target`.
    ///
    /// # Errors
    /// [`OutputError`] when the folder does not exist or cannot be written.
    pub fn create(target: &Path) -> Result<Self, OutputError> {
        let aside = aside(target);
        let file = OpenOptions::new()
            .write(true)
            .create_new(true)
            .open(&aside)
            .map_err(|e| OutputError::new(target, Action::Create, e))?;
        Ok(Self { target: target.to_path_buf(), aside, writer: Some(BufWriter::with_capacity(1 << 16, file)) })
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
        if let Some(writer) = self.writer.take() {
            let file =
                writer.into_inner().map_err(|e| OutputError::new(&self.target, Action::Write, e.into_error()))?;
            file.sync_all().map_err(|e| OutputError::new(&self.target, Action::Flush, e))?;
        }
        fs::rename(&self.aside, &self.target).map_err(|e| OutputError::new(&self.target, Action::Rename, e))?;
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

fn aside(target: &Path) -> PathBuf {
    let mut name = OsString::from(".");
    name.push(target.file_name().unwrap_or_default());
    name.push(format!(".{}.{}.part", std::process::id(), SERIAL.fetch_add(1, Ordering::Relaxed)));
    target.with_file_name(name)
}

/// Makes the rename itself durable where folders can be synchronised; elsewhere there is nothing to do.
fn sync_folder(target: &Path) {
    let folder = match target.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    if let Ok(folder) = File::open(folder) {
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
}
