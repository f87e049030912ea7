//! General sparse LU with column ordering, for bodies too thick for a block factorisation over their levels.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::factor::PartialPivLuParams;
use faer::sparse::linalg::LuError;
use faer::sparse::linalg::lu::{LuRef, LuSymbolicParams, NumericLu, SymbolicLu, factorize_symbolic_lu};
use faer::sparse::{FaerError, SparseColMatRef, SymbolicSparseColMatRef};
use faer::{ColMut, Conj, Par, Spec};

use super::error::LinearError;
use super::pattern::SparsePattern;

/// The factors and the buffers of repeated factorisations.
pub(super) struct SparseLu {
    n: usize,
    col_ptr: Vec<u32>,
    row_idx: Vec<u32>,
    symbolic: SymbolicLu<u32>,
    numeric: NumericLu<u32, f64>,
    memory: MemBuffer,
    bytes: usize,
}

impl SparseLu {
    /// Column order and elimination structure of a pattern with full storage.
    ///
    /// # Errors
    /// [`LinearError::FactorTooLarge`] or [`LinearError::OutOfMemory`].
    pub(super) fn new(pattern: &SparsePattern) -> Result<Self, LinearError> {
        let limit = u32::MAX as usize;
        if pattern.nnz() >= limit {
            return Err(LinearError::FactorTooLarge { entries: pattern.nnz() as f64, limit: limit as f64 });
        }
        let col_ptr: Vec<u32> = pattern.column_pointers().iter().map(|&p| p as u32).collect();
        let row_idx = pattern.row_indices().to_vec();
        let n = pattern.n();
        let structure = SymbolicSparseColMatRef::new_checked(n, n, &col_ptr, None, &row_idx);
        let symbolic = factorize_symbolic_lu(structure, LuSymbolicParams::default())
            .map_err(|error| failure(error, pattern.nnz()))?;
        let params = Spec::<PartialPivLuParams, f64>::default();
        let request = symbolic
            .factorize_numeric_lu_scratch::<f64>(Par::Seq, params)
            .or(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
        let bytes = request.size_bytes() + (col_ptr.len() + row_idx.len()) * size_of::<u32>();
        let memory =
            MemBuffer::try_new(request).map_err(|_| LinearError::OutOfMemory { bytes: request.size_bytes() })?;
        Ok(Self { n, col_ptr, row_idx, symbolic, numeric: NumericLu::new(), memory, bytes })
    }

    /// Bytes known before the factorisation: structure and buffers, without the factors.
    pub(super) fn bytes(&self) -> usize {
        self.bytes
    }

    /// Factorises the matrix with `values` in the order of the pattern.
    ///
    /// # Errors
    /// [`LinearError::Singular`] if a column has no entry to pivot on, [`LinearError::OutOfMemory`],
    /// [`LinearError::FactorTooLarge`].
    pub(super) fn factorise(&mut self, values: &[f64]) -> Result<(), LinearError> {
        let Self { n, col_ptr, row_idx, symbolic, numeric, memory, .. } = self;
        let structure = SymbolicSparseColMatRef::new_checked(*n, *n, col_ptr, None, row_idx);
        let matrix = SparseColMatRef::new(structure, values);
        let params = Spec::<PartialPivLuParams, f64>::default();
        match symbolic.factorize_numeric_lu(numeric, matrix, Par::Seq, MemStack::new(memory), params) {
            Ok(_) => Ok(()),
            Err(LuError::SymbolicSingular { index }) => {
                let dof = symbolic.col_perm().arrays().0.get(index).map_or(index, |&dof| dof as usize);
                Err(LinearError::Singular { dof, pivot: 0.0, scale: 0.0 })
            }
            Err(LuError::Generic(error)) => Err(failure(error, values.len())),
        }
    }

    /// Overwrites `x` by the solution of `A x = x`.
    pub(super) fn solve_in_place(&mut self, x: &mut [f64]) {
        let factors = LuRef::new_unchecked(&self.symbolic, &self.numeric);
        let stack = MemStack::new(&mut self.memory);
        factors.solve_in_place_with_conj(Conj::No, ColMut::from_slice_mut(x).as_mat_mut(), Par::Seq, stack);
    }
}

fn failure(error: FaerError, entries: usize) -> LinearError {
    match error {
        FaerError::OutOfMemory => LinearError::OutOfMemory { bytes: entries.saturating_mul(size_of::<f64>()) },
        _ => LinearError::FactorTooLarge { entries: entries as f64, limit: f64::from(i32::MAX) },
    }
}
