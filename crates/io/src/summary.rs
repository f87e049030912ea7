//! Summaries: any serialisable value as JSON.

use crate::atomic::AtomicFile;
use crate::error::{Action, IoError, OutputError};
use crate::writes::Writes;
use serde::Serialize;
use std::path::Path;

/// Writes `value` as indented JSON with a final line break; the file appears whole or not at all.
///
/// JSON knows no infinity and no NaN: such numbers become `null`.
///
/// # Errors
/// [`IoError::Output`] when the value cannot be serialised or the file cannot be written.
pub fn write_json<T: Serialize + ?Sized>(path: &Path, value: &T) -> Result<(), IoError> {
    write_json_with(path, value, &Writes::default())
}

/// The same, with its operations counted.
///
/// # Errors
/// As [`write_json`].
pub fn write_json_with<T: Serialize + ?Sized>(path: &Path, value: &T, writes: &Writes) -> Result<(), IoError> {
    let mut text = serde_json::to_vec_pretty(value).map_err(|e| OutputError::new(path, Action::Write, e))?;
    text.push(b'\n');
    let mut file = AtomicFile::create_with(path, writes)?;
    file.write(&text)?;
    Ok(file.commit()?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::ErrorClass;
    use std::collections::BTreeMap;

    #[test]
    fn numbers_survive() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("summary.json");
        let value = BTreeMap::from([("force".to_owned(), 0.1 + 0.2), ("tiny".to_owned(), 5e-324)]);
        write_json(&path, &value).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.ends_with("}\n"));
        let back: BTreeMap<String, f64> = serde_json::from_str(&text).unwrap();
        assert_eq!(back, value);
    }

    #[test]
    fn failures_are_outputs() {
        let error = write_json(Path::new("/proc/no/summary.json"), &1).unwrap_err();
        assert_eq!(error.class(), ErrorClass::Output);
        // Keys of a JSON object are texts: this value cannot be serialised.
        let folder = tempfile::tempdir().unwrap();
        let error = write_json(&folder.path().join("s.json"), &BTreeMap::from([((1, 2), 3)])).unwrap_err();
        assert_eq!(error.class(), ErrorClass::Output);
    }
}
