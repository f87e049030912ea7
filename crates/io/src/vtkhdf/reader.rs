//! Reading results back, for checks and studies.

use super::storage::{cause, open};
use super::{FieldSpec, Location};
use crate::error::{IoError, OutputCause};
use hdf5::types::VarLenUnicode;
use hdf5::{Dataset, File};
use std::path::{Path, PathBuf};

/// A result file written by this crate.
pub struct ResultReader {
    path: PathBuf,
    file: File,
    steps: usize,
}

impl std::fmt::Debug for ResultReader {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ResultReader").field("path", &self.path).field("steps", &self.steps).finish_non_exhaustive()
    }
}

impl ResultReader {
    /// Opens a result file; a mesh without steps has no step.
    ///
    /// # Errors
    /// [`IoError::Read`] when the file does not exist, [`IoError::ReadResult`] when it is not a result file.
    pub fn open(path: &Path) -> Result<Self, IoError> {
        std::fs::metadata(path).map_err(|source| IoError::Read { path: path.to_path_buf(), source })?;
        let failed = |error: hdf5::Error| IoError::ReadResult { path: path.to_path_buf(), cause: cause(&error) };
        let file = open(path).map_err(failed)?;
        let steps = match file.group("VTKHDF").map_err(failed)?.link_exists("Steps") {
            true => {
                let count = file.group("VTKHDF/Steps").and_then(|group| group.attr("NSteps"));
                count.and_then(|count| count.read_scalar::<i64>()).map_err(failed)?
            }
            false => 0,
        };
        Ok(Self { path: path.to_path_buf(), file, steps: usize::try_from(steps).unwrap_or(0) })
    }

    /// Number of steps.
    pub const fn steps(&self) -> usize {
        self.steps
    }

    /// Value of every step.
    ///
    /// # Errors
    /// [`IoError::ReadResult`].
    pub fn values(&self) -> Result<Vec<f64>, IoError> {
        if self.steps == 0 {
            return Ok(Vec::new());
        }
        let read = self.file.dataset("VTKHDF/Steps/Values").and_then(|values| values.read_raw::<f64>());
        let mut values = read.map_err(|error| self.failed(&error))?;
        values.truncate(self.steps);
        Ok(values)
    }

    /// Number of nodes and of cells.
    ///
    /// # Errors
    /// [`IoError::ReadResult`].
    pub fn counts(&self) -> Result<(usize, usize), IoError> {
        Ok((self.count("NumberOfPoints")?, self.count("NumberOfCells")?))
    }

    /// Reference coordinates of the nodes \[mm\].
    ///
    /// # Errors
    /// [`IoError::ReadResult`].
    pub fn points(&self) -> Result<Vec<[f64; 3]>, IoError> {
        let read = self.file.dataset("VTKHDF/Points").and_then(|points| points.read_raw::<f64>());
        let flat = read.map_err(|error| self.failed(&error))?;
        Ok(flat.chunks_exact(3).map(|x| [x[0], x[1], x[2]]).collect())
    }

    /// Fields of the file, those at the nodes first, each group by name.
    ///
    /// # Errors
    /// [`IoError::ReadResult`].
    pub fn fields(&self) -> Result<Vec<FieldSpec>, IoError> {
        let mut specs = Vec::new();
        for location in [Location::Point, Location::Cell] {
            let group = self.file.group(&format!("VTKHDF/{}", location.group()));
            let datasets = group.and_then(|group| group.datasets()).map_err(|error| self.failed(&error))?;
            for dataset in datasets {
                let name = dataset.name().rsplit('/').next().unwrap_or_default().to_owned();
                let components = dataset.shape().get(1).copied().unwrap_or(1);
                specs.push(FieldSpec { name, location, components });
            }
        }
        Ok(specs)
    }

    /// Values of a field at a zero-based step, component running fastest; a file without steps has its fields at
    /// step 0.
    ///
    /// # Errors
    /// [`IoError::NoSuchField`] when there is no such field or step, [`IoError::ReadResult`].
    pub fn field(&self, location: Location, name: &str, step: usize) -> Result<Vec<f64>, IoError> {
        let absent =
            || IoError::NoSuchField { path: self.path.clone(), field: name.to_owned(), step, steps: self.steps };
        let dataset = self.file.dataset(&format!("VTKHDF/{}/{name}", location.group())).map_err(|_| absent())?;
        if step >= self.steps.max(1) {
            return Err(absent());
        }
        let begin = if self.steps == 0 { 0 } else { self.offset(location, name, step)? };
        let (points, cells) = self.counts()?;
        let tuples = if location == Location::Point { points } else { cells };
        rows(&dataset, begin, tuples).map_err(|error| self.failed(&error))
    }

    /// A text stored beside the results; `None` when there is none of that name.
    ///
    /// # Errors
    /// [`IoError::ReadResult`] when it is there but cannot be read.
    pub fn text(&self, name: &str) -> Result<Option<String>, IoError> {
        let Ok(dataset) = self.file.dataset(&format!("subrope/{name}")) else { return Ok(None) };
        let text = dataset.read_scalar::<VarLenUnicode>().map_err(|error| self.failed(&error))?;
        Ok(Some(text.as_str().to_owned()))
    }

    fn failed(&self, error: &hdf5::Error) -> IoError {
        IoError::ReadResult { path: self.path.clone(), cause: cause(error) }
    }

    fn missing(&self, what: &str) -> IoError {
        let message = format!("{what} is not what it should be");
        IoError::ReadResult { path: self.path.clone(), cause: OutputCause::Hdf5 { message } }
    }

    fn count(&self, name: &str) -> Result<usize, IoError> {
        let read = self.file.dataset(&format!("VTKHDF/{name}")).and_then(|count| count.read_raw::<i64>());
        let parts = read.map_err(|error| self.failed(&error))?;
        parts.first().and_then(|&n| usize::try_from(n).ok()).ok_or_else(|| self.missing(name))
    }

    fn offset(&self, location: Location, name: &str, step: usize) -> Result<usize, IoError> {
        let path = format!("VTKHDF/Steps/{}/{name}", location.offsets());
        let read = self.file.dataset(&path).and_then(|offsets| offsets.read_raw::<i64>());
        let offsets = read.map_err(|error| self.failed(&error))?;
        offsets.get(step).and_then(|&n| usize::try_from(n).ok()).ok_or_else(|| self.missing(&path))
    }
}

fn rows(dataset: &Dataset, begin: usize, tuples: usize) -> hdf5::Result<Vec<f64>> {
    let range = begin..begin.saturating_add(tuples);
    match dataset.ndim() {
        1 => Ok(dataset.read_slice_1d::<f64, _>(range)?.to_vec()),
        _ => Ok(dataset.read_slice_2d::<f64, _>((range, ..))?.iter().copied().collect()),
    }
}
