//! Writing files and the standard output.

use std::io::{ErrorKind, Write as _};
use std::path::Path;

use crate::Error;

/// Writes to the standard output; a reader that went away is no error.
pub(super) fn print(text: &[u8]) -> Result<(), Error> {
    let mut stdout = std::io::stdout().lock();
    match stdout.write_all(text).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(failed(Path::new("standard output"))(error)),
        _ => Ok(()),
    }
}

/// Writes a file.
pub(super) fn write(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    std::fs::write(path, bytes).map_err(failed(path))
}

/// Writes a file that must not be there yet.
pub(super) fn write_new(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    let exists = || Error::Exists { path: path.to_owned() };
    let mut file = std::fs::File::create_new(path)
        .map_err(|error| if error.kind() == ErrorKind::AlreadyExists { exists() } else { failed(path)(error) })?;
    file.write_all(bytes).map_err(failed(path))
}

/// The error of a path that cannot be written.
pub(super) fn failed(path: &Path) -> impl FnOnce(std::io::Error) -> Error {
    let path = path.to_owned();
    |source| Error::Output { path, source }
}
