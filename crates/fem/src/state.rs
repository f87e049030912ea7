//! What a model remembers between increments, as named arrays: to be kept elsewhere and to be taken up again.

use std::error::Error;
use std::sync::Arc;

/// Why a state cannot be kept or taken up.
#[derive(Clone, Debug, thiserror::Error)]
pub enum StateError {
    /// Where the arrays are kept something failed.
    #[error("{0}")]
    Access(Arc<dyn Error + Send + Sync>),
    /// An array has more or fewer entries than the model needs.
    #[error("the state was kept for another model: {found} values of {name} instead of {expected}")]
    Length {
        /// The array.
        name: String,
        /// Its entries.
        found: usize,
        /// Entries needed.
        expected: usize,
    },
    /// An entry that the model cannot have.
    #[error("the state was kept for another model: {name} refers to something that is not there")]
    Value {
        /// The array.
        name: String,
    },
}

impl StateError {
    /// Of whoever keeps the arrays.
    #[must_use]
    pub fn access(cause: impl Error + Send + Sync + 'static) -> Self {
        Self::Access(Arc::new(cause))
    }

    /// Compares the length of an array with what is needed.
    ///
    /// # Errors
    /// [`StateError::Length`].
    pub fn expect(name: &str, found: usize, expected: usize) -> Result<(), Self> {
        if found == expected { Ok(()) } else { Err(Self::Length { name: name.into(), found, expected }) }
    }
}

/// Keeps named arrays. Entries are taken one by one, so that nothing has to be copied together first.
pub trait StateWriter {
    /// Keeps `count` numbers; not a bit of them may change.
    ///
    /// # Errors
    /// [`StateError::Access`].
    fn numbers(&mut self, name: &str, count: usize, values: &mut dyn Iterator<Item = f64>) -> Result<(), StateError>;

    /// Keeps `count` whole numbers.
    ///
    /// # Errors
    /// [`StateError::Access`].
    fn counts(&mut self, name: &str, count: usize, values: &mut dyn Iterator<Item = u64>) -> Result<(), StateError>;
}

/// Gives back what a [`StateWriter`] kept.
pub trait StateReader {
    /// All numbers of an array.
    ///
    /// # Errors
    /// [`StateError::Access`] when there is no such array.
    fn numbers(&self, name: &str) -> Result<Vec<f64>, StateError>;

    /// The numbers of an array, exactly as many as there is room for.
    ///
    /// # Errors
    /// [`StateError`].
    fn read_numbers(&self, name: &str, into: &mut [f64]) -> Result<(), StateError>;

    /// All whole numbers of an array.
    ///
    /// # Errors
    /// [`StateError::Access`] when there is no such array.
    fn counts(&self, name: &str) -> Result<Vec<u64>, StateError>;
}

/// Names within names: `PREFIX.NAME`.
pub struct Within<T> {
    inner: T,
    prefix: String,
}

impl<T> Within<T> {
    /// Arrays whose names begin with `prefix` and a dot.
    pub fn new(inner: T, prefix: String) -> Self {
        Self { inner, prefix }
    }

    fn name(&self, name: &str) -> String {
        format!("{}.{name}", self.prefix)
    }
}

impl<T: StateWriter + ?Sized> StateWriter for Within<&mut T> {
    fn numbers(&mut self, name: &str, count: usize, values: &mut dyn Iterator<Item = f64>) -> Result<(), StateError> {
        let name = self.name(name);
        self.inner.numbers(&name, count, values)
    }

    fn counts(&mut self, name: &str, count: usize, values: &mut dyn Iterator<Item = u64>) -> Result<(), StateError> {
        let name = self.name(name);
        self.inner.counts(&name, count, values)
    }
}

impl<T: StateReader + ?Sized> StateReader for Within<&T> {
    fn numbers(&self, name: &str) -> Result<Vec<f64>, StateError> {
        self.inner.numbers(&self.name(name))
    }

    fn read_numbers(&self, name: &str, into: &mut [f64]) -> Result<(), StateError> {
        self.inner.read_numbers(&self.name(name), into)
    }

    fn counts(&self, name: &str) -> Result<Vec<u64>, StateError> {
        self.inner.counts(&self.name(name))
    }
}
