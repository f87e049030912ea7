//! The symmetric part of a matrix that is stored in full.

use super::pattern::{SparsePattern, Storage};

/// Lower triangle of `(A + A^T)/2`.
pub(super) struct SymmetricPart {
    pattern: SparsePattern,
    /// Slots of an entry and of its mirror image in the full values.
    slots: Vec<[u32; 2]>,
    values: Vec<f64>,
}

impl SymmetricPart {
    /// Of the matrices of a full pattern.
    pub(super) fn new(full: &SparsePattern) -> Self {
        let pattern = full.lower();
        let mut slots = Vec::with_capacity(pattern.nnz());
        for column in 0..pattern.n() {
            let slot = |row: usize, column: usize| full.slot(row, column).unwrap_or_default() as u32;
            slots.extend(
                pattern.column(column).iter().map(|&row| [slot(row as usize, column), slot(column, row as usize)]),
            );
        }
        Self { values: vec![0.0; slots.len()], slots, pattern }
    }

    /// Its pattern, of [`Storage::Lower`].
    pub(super) fn pattern(&self) -> &SparsePattern {
        debug_assert_eq!(self.pattern.storage(), Storage::Lower);
        &self.pattern
    }

    /// Its values for those of the whole matrix.
    pub(super) fn of(&mut self, full: &[f64]) -> &[f64] {
        for (value, &[one, other]) in self.values.iter_mut().zip(&self.slots) {
            *value = 0.5 * (full[one as usize] + full[other as usize]);
        }
        &self.values
    }

    /// Those asked for last.
    pub(super) fn values(&self) -> &[f64] {
        &self.values
    }

    pub(super) fn bytes(&self) -> usize {
        self.pattern.bytes() + self.slots.len() * size_of::<[u32; 2]>() + self.values.len() * size_of::<f64>()
    }
}
