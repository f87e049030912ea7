//! Structure of a square sparse matrix with symmetric pattern, from the cliques of the elements.

use std::sync::Arc;

use super::error::LinearError;

/// Largest number of unknowns: indices are 32 bits wide and one value is kept as a mark.
const MAX_UNKNOWNS: usize = (i32::MAX - 1) as usize;
const UNMARKED: u32 = u32::MAX;

/// Which entries of the symmetric pattern are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Storage {
    /// Lower triangle with the diagonal; the values are symmetric.
    Lower,
    /// Every entry; the values may be unsymmetric.
    Full,
}

/// Structure of a square matrix with symmetric pattern in compressed columns.
///
/// Rows are sorted within a column and the diagonal is always present, so that the values of a matrix are one slice
/// of [`SparsePattern::nnz`] numbers. Unknowns that share all their elements (the components of a node) are found and
/// compressed by the analysis, wherever they are numbered. A clone shares the structure.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SparsePattern {
    n: usize,
    col_ptr: Arc<[usize]>,
    row_idx: Arc<[u32]>,
    storage: Storage,
}

impl SparsePattern {
    /// Pattern in which all unknowns of a clique (an element, a contact pair) are coupled with each other.
    ///
    /// Cost is one visit of every clique per unknown it holds, halved by unknowns in sequence that share their
    /// cliques; memory is the pattern and one index per entry of the cliques.
    ///
    /// # Errors
    /// [`LinearError::DofOutOfRange`] if a clique names an unknown beyond `n`, [`LinearError::TooManyUnknowns`] if
    /// `n` exceeds the 32-bit indices.
    pub fn from_cliques<'a, I>(n: usize, cliques: I, storage: Storage) -> Result<Self, LinearError>
    where
        I: IntoIterator<Item = &'a [u32]>,
    {
        if n > MAX_UNKNOWNS {
            return Err(LinearError::TooManyUnknowns { n, limit: MAX_UNKNOWNS });
        }
        let cliques: Vec<&[u32]> = cliques.into_iter().collect();
        check_range(n, &cliques)?;
        let incidence = Incidence::new(n, &cliques);
        let mut gather = Gather { marker: vec![UNMARKED; n], cliques: &cliques, storage };
        let col_ptr = column_pointers(&incidence, &mut gather);
        gather.marker.fill(UNMARKED);
        let row_idx = row_indices(&incidence, &mut gather, &col_ptr);
        Ok(Self { n, col_ptr: col_ptr.into(), row_idx: row_idx.into(), storage })
    }

    /// Number of unknowns.
    #[inline]
    pub fn n(&self) -> usize {
        self.n
    }

    /// Number of stored entries.
    #[inline]
    pub fn nnz(&self) -> usize {
        self.row_idx.len()
    }

    /// Entries stored.
    #[inline]
    pub fn storage(&self) -> Storage {
        self.storage
    }

    /// Start of every column in [`SparsePattern::row_indices`], `n + 1` numbers.
    #[inline]
    pub fn column_pointers(&self) -> &[usize] {
        &self.col_ptr
    }

    /// Row of every stored entry.
    #[inline]
    pub fn row_indices(&self) -> &[u32] {
        &self.row_idx
    }

    /// Rows stored in column `col`, in ascending order; none beyond the last column.
    #[inline]
    pub fn column(&self, col: usize) -> &[u32] {
        match (self.col_ptr.get(col), self.col_ptr.get(col + 1)) {
            (Some(&start), Some(&end)) => &self.row_idx[start..end],
            _ => &[],
        }
    }

    /// Position of entry (`row`, `col`) among the values; `None` if it is not stored.
    ///
    /// With [`Storage::Lower`] the entries above the diagonal are not stored.
    #[inline]
    pub fn slot(&self, row: usize, col: usize) -> Option<usize> {
        let row = u32::try_from(row).ok()?;
        let position = self.column(col).binary_search(&row).ok()?;
        Some(self.col_ptr[col] + position)
    }

    /// The same pattern with its lower triangle only.
    pub(super) fn lower(&self) -> Self {
        let mut col_ptr = vec![0];
        let mut row_idx = Vec::with_capacity(self.nnz() / 2 + self.n);
        for column in 0..self.n {
            row_idx.extend(self.column(column).iter().filter(|&&row| row as usize >= column));
            col_ptr.push(row_idx.len());
        }
        Self { n: self.n, col_ptr: col_ptr.into(), row_idx: row_idx.into(), storage: Storage::Lower }
    }

    /// Product `product = A vector` with the values of a matrix in this pattern.
    ///
    /// The sum runs over the columns in order, whatever the number of threads.
    ///
    /// # Errors
    /// [`LinearError::Length`] if a slice has the wrong length.
    pub fn multiply(&self, values: &[f64], vector: &[f64], product: &mut [f64]) -> Result<(), LinearError> {
        use super::error::Operand;
        expect_length(Operand::Values, self.nnz(), values.len())?;
        expect_length(Operand::Solution, self.n, vector.len())?;
        expect_length(Operand::RightHandSide, self.n, product.len())?;
        product.fill(0.0);
        match self.storage {
            Storage::Full => self.multiply_full(values, vector, product),
            Storage::Lower => self.multiply_lower(values, vector, product),
        }
        Ok(())
    }

    fn multiply_full(&self, values: &[f64], vector: &[f64], product: &mut [f64]) {
        for (span, &x) in self.col_ptr.windows(2).zip(vector) {
            let (rows, entries) = (&self.row_idx[span[0]..span[1]], &values[span[0]..span[1]]);
            for (&row, &value) in rows.iter().zip(entries) {
                product[row as usize] += value * x;
            }
        }
    }

    fn multiply_lower(&self, values: &[f64], vector: &[f64], product: &mut [f64]) {
        for (col, span) in self.col_ptr.windows(2).enumerate() {
            // The diagonal is the first row of a lower column.
            let x = vector[col];
            let mut mirrored = values[span[0]] * x;
            let (rows, entries) = (&self.row_idx[span[0] + 1..span[1]], &values[span[0] + 1..span[1]]);
            for (&row, &value) in rows.iter().zip(entries) {
                product[row as usize] += value * x;
                mirrored += value * vector[row as usize];
            }
            product[col] += mirrored;
        }
    }

    /// Largest absolute value of every row (of every row and column, as the pattern is symmetric), and the largest sum
    /// of absolute values along a row. `sums` is scratch of length `n`.
    pub(super) fn measure(&self, values: &[f64], scale: &mut [f64], sums: &mut [f64]) -> f64 {
        scale.fill(0.0);
        sums.fill(0.0);
        let mirror = self.storage == Storage::Lower;
        for (col, span) in self.col_ptr.windows(2).enumerate() {
            let (mut largest, mut sum) = (scale[col], 0.0);
            for (&row, &value) in self.row_idx[span[0]..span[1]].iter().zip(&values[span[0]..span[1]]) {
                let (row, size) = (row as usize, value.abs());
                sums[row] += size;
                sum += size;
                if size > scale[row] {
                    scale[row] = size;
                }
                if size > largest {
                    largest = size;
                }
            }
            scale[col] = largest;
            if mirror {
                // The diagonal is the first entry and counted already.
                sums[col] += sum - values[span[0]].abs();
            }
        }
        sums.iter().fold(0.0, |largest, &sum| largest.max(sum))
    }

    pub(super) fn bytes(&self) -> usize {
        self.col_ptr.len() * size_of::<usize>() + self.row_idx.len() * size_of::<u32>()
    }
}

pub(super) fn expect_length(what: super::error::Operand, expected: usize, actual: usize) -> Result<(), LinearError> {
    if expected == actual { Ok(()) } else { Err(LinearError::Length { what, expected, actual }) }
}

fn check_range(n: usize, cliques: &[&[u32]]) -> Result<(), LinearError> {
    for (clique, dofs) in cliques.iter().enumerate() {
        if let Some(&dof) = dofs.iter().find(|&&dof| dof as usize >= n) {
            return Err(LinearError::DofOutOfRange { clique, dof: dof as usize, n });
        }
    }
    Ok(())
}

/// Cliques of every unknown.
struct Incidence {
    start: Vec<usize>,
    clique: Vec<u32>,
}

impl Incidence {
    fn new(n: usize, cliques: &[&[u32]]) -> Self {
        let mut start = vec![0usize; n + 1];
        for &dof in cliques.iter().copied().flatten() {
            start[dof as usize + 1] += 1;
        }
        for i in 0..n {
            start[i + 1] += start[i];
        }
        let mut next = start.clone();
        let mut clique = vec![0u32; start[n]];
        for (number, dofs) in cliques.iter().enumerate() {
            for &dof in *dofs {
                clique[next[dof as usize]] = number as u32;
                next[dof as usize] += 1;
            }
        }
        Self { start, clique }
    }

    fn of(&self, dof: usize) -> &[u32] {
        &self.clique[self.start[dof]..self.start[dof + 1]]
    }

    fn same_as_previous(&self, dof: usize) -> bool {
        dof > 0 && !self.of(dof).is_empty() && self.of(dof) == self.of(dof - 1)
    }
}

struct Gather<'a> {
    marker: Vec<u32>,
    cliques: &'a [&'a [u32]],
    storage: Storage,
}

impl Gather<'_> {
    /// Hands every stored row of column `col` to `push` once, in no particular order.
    fn column(&mut self, col: usize, cliques_of_col: &[u32], mut push: impl FnMut(u32)) {
        let mark = col as u32;
        let first = if self.storage == Storage::Lower { mark } else { 0 };
        self.marker[col] = mark;
        push(mark);
        for &clique in cliques_of_col {
            for &row in self.cliques[clique as usize] {
                if row >= first && self.marker[row as usize] != mark {
                    self.marker[row as usize] = mark;
                    push(row);
                }
            }
        }
    }
}

fn column_pointers(incidence: &Incidence, gather: &mut Gather<'_>) -> Vec<usize> {
    let n = gather.marker.len();
    let drop = usize::from(gather.storage == Storage::Lower);
    let mut col_ptr = vec![0usize; n + 1];
    for col in 0..n {
        let mut count = 0;
        if incidence.same_as_previous(col) {
            count = col_ptr[col] - col_ptr[col - 1] - drop;
        } else {
            gather.column(col, incidence.of(col), |_| count += 1);
        }
        col_ptr[col + 1] = col_ptr[col] + count;
    }
    col_ptr
}

fn row_indices(incidence: &Incidence, gather: &mut Gather<'_>, col_ptr: &[usize]) -> Vec<u32> {
    let n = gather.marker.len();
    let drop = usize::from(gather.storage == Storage::Lower);
    let mut rows = vec![0u32; col_ptr[n]];
    for col in 0..n {
        if incidence.same_as_previous(col) {
            rows.copy_within(col_ptr[col - 1] + drop..col_ptr[col], col_ptr[col]);
        } else {
            let mut next = col_ptr[col];
            gather.column(col, incidence.of(col), |row| {
                rows[next] = row;
                next += 1;
            });
            rows[col_ptr[col]..next].sort_unstable();
        }
    }
    rows
}
