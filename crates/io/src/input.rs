//! Input files read whole: regular ones, and not longer than a limit.

use std::fs::{self, File};
use std::io::{self, ErrorKind, Read};
use std::path::Path;

/// Longest file that people write by hand: scenes, studies, paths of a point \[bytes\].
pub const MAX_TEXT: u64 = 16 << 20;

/// Longest table of numbers that is read whole \[bytes\].
pub const MAX_TABLE: u64 = 1 << 30;

/// Reads a file of at most `limit` bytes.
///
/// A device or a pipe could deliver without end, and opening a pipe could block: both are refused before they are opened.
///
/// # Errors
/// What the system says; [`ErrorKind::InvalidInput`] for what is not a regular file, [`ErrorKind::FileTooLarge`] for more
/// bytes than the limit.
pub fn read_bytes(path: &Path, limit: u64) -> io::Result<Vec<u8>> {
    let about = fs::metadata(path)?;
    if !about.is_file() {
        return Err(io::Error::new(ErrorKind::InvalidInput, "it is not a regular file"));
    }
    let too_large = |length: u64| {
        let text = format!("it has {} MB, more than the {} MB that are read", length >> 20, limit >> 20);
        io::Error::new(ErrorKind::FileTooLarge, text)
    };
    if about.len() > limit {
        return Err(too_large(about.len()));
    }
    let mut bytes = Vec::with_capacity(about.len() as usize);
    // Files of the system tell no length, and others may grow.
    File::open(path)?.take(limit + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > limit { Err(too_large(bytes.len() as u64)) } else { Ok(bytes) }
}

/// [`read_bytes`] of UTF-8 text.
///
/// # Errors
/// As [`read_bytes`]; [`ErrorKind::InvalidData`] for other bytes.
pub fn read_text(path: &Path, limit: u64) -> io::Result<String> {
    String::from_utf8(read_bytes(path, limit)?)
        .map_err(|e| io::Error::new(ErrorKind::InvalidData, format!("it is not text in UTF-8: {}", e.utf8_error())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_regular_files_of_some_length_are_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        fs::write(&path, "1234").unwrap();
        assert_eq!(read_text(&path, 4).unwrap(), "1234");
        assert_eq!(read_text(&path, 3).unwrap_err().kind(), ErrorKind::FileTooLarge);
        assert_eq!(read_text(folder.path(), 4).unwrap_err().kind(), ErrorKind::InvalidInput);
        assert_eq!(read_text(&folder.path().join("b"), 4).unwrap_err().kind(), ErrorKind::NotFound);
        fs::write(&path, b"\xff").unwrap();
        assert_eq!(read_text(&path, 4).unwrap_err().kind(), ErrorKind::InvalidData);
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn what_never_ends_is_not_opened() {
        for path in ["/dev/zero", "/dev/stdin"] {
            let kind = read_bytes(Path::new(path), 4).unwrap_err().kind();
            assert!(matches!(kind, ErrorKind::InvalidInput | ErrorKind::NotFound | ErrorKind::FileTooLarge), "{path}");
        }
    }
}
