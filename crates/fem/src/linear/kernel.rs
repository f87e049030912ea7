//! Register-blocked kernels on panels, in the vector width of the processor.
//!
//! Panels are column-major with a stride. An update of one panel by another packs a strip of rows of the updating panel
//! that fills two vectors and takes its columns six at a time: twelve accumulators run through the depth of the product
//! with eight loads for twelve multiplications, as in a general matrix product, and go to their places in the other panel
//! straight from the registers. (Three vectors and four columns would need one register more than there are: compilers
//! spill an accumulator then, which doubles the time.) A panel is factorised eight columns at a time without packing.

use std::ops::Range;

use pulp::{Simd, WithSimd};

/// Columns taken at a time in a factorisation.
pub(super) const BLOCK: usize = 8;
/// Columns of the target taken at a time in an update.
pub(super) const COLUMNS: usize = 6;
/// Vectors in a strip of rows.
const VECTORS: usize = 2;
/// Lanes of the widest vectors.
const WIDEST: usize = 8;
/// Strips that are packed at a time: long pieces of every column.
const STRIPS: usize = 4;
/// Most rows that are packed at a time.
pub(super) const PACKED: usize = STRIPS * VECTORS * WIDEST;

/// `target -= L D Lᵀ` over the rows that two panels share, on and below the diagonal of the target.
pub(super) struct Product<'a> {
    pub(super) target: &'a mut [f64],
    pub(super) target_stride: usize,
    /// The updating panel from the first of its rows that matter.
    pub(super) lower: &'a [f64],
    pub(super) stride: usize,
    /// D.
    pub(super) pivots: &'a [f64],
    /// Row of the target for each of the rows of `lower`, ascending.
    pub(super) rows: &'a [u32],
    /// Leading rows that are columns of the target.
    pub(super) columns: usize,
    /// Buffer of [`PACKED`] entries per pivot.
    pub(super) strips: &'a mut [f64],
    /// Buffer of as many entries per pivot as there are columns, in whole blocks of [`COLUMNS`].
    pub(super) scaled: &'a mut [f64],
}

/// LDLᵀ of a panel: leaves L below the diagonal of its leading block, D on it. The result is the column that broke
/// down, if one did.
pub(super) struct Factorisation<'a> {
    /// The panel from its first diagonal entry.
    pub(super) values: &'a mut [f64],
    pub(super) stride: usize,
    pub(super) rows: usize,
    pub(super) columns: usize,
    /// Buffer of [`BLOCK`] entries per column.
    pub(super) scaled: &'a mut [f64],
}

/// Widest block of a fixed size within `left` columns.
#[inline(always)]
fn width(left: usize) -> usize {
    match left {
        8.. => 8,
        4.. => 4,
        2.. => 2,
        _ => 1,
    }
}

impl WithSimd for Product<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        self.pack_columns();
        let (tall, count) = (VECTORS * S::F64_LANES, self.rows.len());
        for first in (0..count).step_by(STRIPS * tall) {
            let end = count.min(first + STRIPS * tall);
            self.pack_rows(simd, first..end);
            for (number, row) in (first..end).step_by(tall).enumerate() {
                self.strip(simd, number, row..end.min(row + tall));
            }
        }
    }
}

impl Product<'_> {
    /// `D Lᵀ` in blocks of [`COLUMNS`] columns, row by row; what is missing of the last block is zero.
    #[inline(always)]
    fn pack_columns(&mut self) {
        let depth = self.pivots.len();
        for (number, block) in self.scaled.chunks_exact_mut(COLUMNS * depth).enumerate() {
            let first = number * COLUMNS;
            if first + COLUMNS <= self.columns {
                scale::<COLUMNS>(&self.lower[first..], self.stride, self.pivots, block);
            } else if first < self.columns {
                let left = self.columns - first;
                let rows = block.as_chunks_mut::<COLUMNS>().0.iter_mut();
                for ((row, column), &pivot) in rows.zip(self.lower[first..].chunks(self.stride)).zip(self.pivots) {
                    *row = [0.0; COLUMNS];
                    row.iter_mut().zip(&column[..left]).for_each(|(entry, &value)| *entry = value * pivot);
                }
            } else {
                break;
            }
        }
    }

    /// Updates the rows of the strip `number` of those that are packed.
    #[inline(always)]
    fn strip<S: Simd>(&mut self, simd: S, number: usize, rows: Range<usize>) {
        let (depth, lanes) = (self.pivots.len(), S::F64_LANES);
        let size = VECTORS * lanes * depth;
        let strip = &self.strips[number * size..][..size];
        let places = &self.rows[rows.clone()];
        let adjoining: [bool; VECTORS] = std::array::from_fn(|v| {
            let vector = places.get(v * lanes..(v + 1) * lanes);
            vector.is_some_and(|p| p[lanes - 1] - p[0] == lanes as u32 - 1)
        });
        // Rows above a column are not of the lower triangle.
        for column in (0..self.columns.min(rows.end)).step_by(COLUMNS) {
            let factors = self.scaled[column * depth..][..COLUMNS * depth].as_chunks::<COLUMNS>().0;
            let sums = product::<S>(simd, strip, factors);
            let end = self.columns.min(column + COLUMNS);
            for (&place, sums) in self.rows[column..end].iter().zip(&sums) {
                let target = &mut self.target[place as usize * self.target_stride..];
                for ((places, &sum), adjoining) in places.chunks(lanes).zip(sums).zip(adjoining) {
                    if adjoining {
                        let entry = &mut S::as_mut_simd_f64s(&mut target[places[0] as usize..][..lanes]).0[0];
                        *entry = simd.sub_f64s(*entry, sum);
                    } else {
                        let mut values = [0.0; WIDEST];
                        S::as_mut_simd_f64s(&mut values[..lanes]).0[0] = sum;
                        places.iter().zip(&values).for_each(|(&row, value)| target[row as usize] -= value);
                    }
                }
            }
        }
    }

    /// Packs rows into strips of [`VECTORS`] vectors, each column by column; the last strip is filled up with zeros.
    #[inline(always)]
    fn pack_rows<S: Simd>(&mut self, simd: S, rows: Range<usize>) {
        let depth = self.pivots.len();
        let strips = S::as_mut_simd_f64s(self.strips).0.as_chunks_mut::<VECTORS>().0;
        for (k, column) in self.lower.chunks(self.stride).take(depth).enumerate() {
            let (vectors, rest) = S::as_simd_f64s(&column[rows.clone()]);
            let (pairs, last) = vectors.as_chunks::<VECTORS>();
            for (number, pair) in pairs.iter().enumerate() {
                strips[number * depth + k] = *pair;
            }
            if !(last.is_empty() && rest.is_empty()) {
                let end = &mut strips[pairs.len() * depth + k];
                let rest = simd.partial_load_f64s(rest);
                *end = match last {
                    [first] => [*first, rest],
                    _ => [rest, simd.splat_f64s(0.0)],
                };
            }
        }
    }
}

/// `Σ_k strip[k] factors[k]`, column by column.
#[inline(always)]
fn product<S: Simd>(simd: S, strip: &[f64], factors: &[[f64; COLUMNS]]) -> [[S::f64s; VECTORS]; COLUMNS] {
    let mut sums = [[simd.splat_f64s(0.0); VECTORS]; COLUMNS];
    let rows = S::as_simd_f64s(strip).0.as_chunks::<VECTORS>().0;
    for (rows, factors) in rows.iter().zip(factors) {
        for (sums, &factor) in sums.iter_mut().zip(factors) {
            let factor = simd.splat_f64s(factor);
            sums.iter_mut().zip(rows).for_each(|(sum, &row)| *sum = simd.mul_add_f64s(row, factor, *sum));
        }
    }
    sums
}

/// `scaled[k][c] = lower[c, k] pivots[k]` of `W` rows.
#[inline(always)]
fn scale<const W: usize>(lower: &[f64], stride: usize, pivots: &[f64], scaled: &mut [f64]) {
    let blocks = scaled.as_chunks_mut::<W>().0.iter_mut();
    for ((block, column), &pivot) in blocks.zip(lower.chunks(stride)).zip(pivots) {
        for (entry, &value) in block.iter_mut().zip(&column[..W]) {
            *entry = value * pivot;
        }
    }
}

#[inline(always)]
fn load<S: Simd, const FULL: bool>(simd: S, slice: &[f64]) -> S::f64s {
    if FULL { S::as_simd_f64s(slice).0[0] } else { simd.partial_load_f64s(slice) }
}

#[inline(always)]
fn store<S: Simd, const FULL: bool>(simd: S, slice: &mut [f64], value: S::f64s) {
    if FULL {
        S::as_mut_simd_f64s(slice).0[0] = value;
    } else {
        simd.partial_store_f64s(slice, value);
    }
}

/// Columns of a panel from one of its rows on.
#[derive(Clone, Copy)]
struct Columns<'a> {
    values: &'a [f64],
    stride: usize,
}

/// `target[r, c] -= Σ_k lower[r, k] factors[k][c]` of `rows` rows; the target has a stride too.
#[inline(always)]
fn subtract<S: Simd, const W: usize>(
    simd: S,
    (target, stride): (&mut [f64], usize),
    lower: Columns<'_>,
    rows: usize,
    factors: &[[f64; W]],
) {
    let lanes = S::F64_LANES;
    let full = rows - rows % lanes;
    for row in (0..full).step_by(lanes) {
        subtract_rows::<S, W, true>(simd, (target, stride), lower, row..row + lanes, factors);
    }
    if full < rows {
        subtract_rows::<S, W, false>(simd, (target, stride), lower, full..rows, factors);
    }
}

#[inline(always)]
fn subtract_rows<S: Simd, const W: usize, const FULL: bool>(
    simd: S,
    (target, stride): (&mut [f64], usize),
    lower: Columns<'_>,
    rows: Range<usize>,
    factors: &[[f64; W]],
) {
    let sums = load_rows::<S, W, FULL>(simd, Columns { values: target, stride }, rows.clone());
    let sums = accumulate::<S, W, FULL>(simd, sums, lower, rows.clone(), factors);
    for (c, &sum) in sums.iter().enumerate() {
        store::<S, FULL>(simd, &mut target[c * stride + rows.start..c * stride + rows.end], sum);
    }
}

#[inline(always)]
fn load_rows<S: Simd, const W: usize, const FULL: bool>(
    simd: S,
    source: Columns<'_>,
    rows: Range<usize>,
) -> [S::f64s; W] {
    let mut loaded = [simd.splat_f64s(0.0); W];
    for (c, entry) in loaded.iter_mut().enumerate() {
        *entry = load::<S, FULL>(simd, &source.values[c * source.stride + rows.start..c * source.stride + rows.end]);
    }
    loaded
}

/// `sums[c] - Σ_k lower[rows, k] factors[k][c]`.
#[inline(always)]
fn accumulate<S: Simd, const W: usize, const FULL: bool>(
    simd: S,
    mut sums: [S::f64s; W],
    lower: Columns<'_>,
    rows: Range<usize>,
    factors: &[[f64; W]],
) -> [S::f64s; W] {
    for (column, factor) in lower.values.chunks(lower.stride).zip(factors) {
        let entry = load::<S, FULL>(simd, &column[rows.start..rows.end]);
        for (sum, &factor) in sums.iter_mut().zip(factor) {
            *sum = simd.negate_mul_add_f64s(entry, simd.splat_f64s(factor), *sum);
        }
    }
    sums
}

impl WithSimd for Factorisation<'_> {
    type Output = Result<(), usize>;

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) -> Self::Output {
        let mut first = 0;
        while first < self.columns {
            let width = width(self.columns - first);
            match width {
                8 => self.block::<S, 8>(simd, first)?,
                4 => self.block::<S, 4>(simd, first)?,
                2 => self.block::<S, 2>(simd, first)?,
                _ => self.block::<S, 1>(simd, first)?,
            }
            first += width;
        }
        Ok(())
    }
}

impl Factorisation<'_> {
    /// Updates the `W` columns from `first` on with those before and factorises them.
    #[inline(always)]
    fn block<S: Simd, const W: usize>(&mut self, simd: S, first: usize) -> Result<(), usize> {
        let stride = self.stride;
        let (left, own) = self.values.split_at_mut(first * stride);
        let blocks = self.scaled.as_chunks_mut::<W>().0.iter_mut();
        for (k, (block, column)) in blocks.zip(left.chunks_exact(stride)).enumerate() {
            for (entry, &value) in block.iter_mut().zip(&column[first..first + W]) {
                *entry = value * column[k];
            }
        }
        let factors = &self.scaled.as_chunks::<W>().0[..first];
        if first > 0 {
            let lower = Columns { values: &left[first..], stride };
            subtract(simd, (&mut own[first..], stride), lower, W, factors);
        }
        let corner = Corner::<W>::factorise(&mut own[first..], stride).map_err(|column| first + column)?;
        let (lanes, begin) = (S::F64_LANES, first + W);
        let full = self.rows - (self.rows - begin) % lanes;
        for row in (begin..full).step_by(lanes) {
            corner.rows::<S, true>(simd, (left, own, stride), row..row + lanes, factors);
        }
        if full < self.rows {
            corner.rows::<S, false>(simd, (left, own, stride), full..self.rows, factors);
        }
        Ok(())
    }
}

/// Factors of a diagonal block: `lower[c][r]` below the diagonal and the reciprocal pivots.
struct Corner<const W: usize> {
    lower: [[f64; W]; W],
    inverse: [f64; W],
}

impl<const W: usize> Corner<W> {
    /// Factorises the `W` x `W` block at the start of `values` in place.
    #[inline(always)]
    fn factorise(values: &mut [f64], stride: usize) -> Result<Self, usize> {
        let mut corner = Self { lower: [[0.0; W]; W], inverse: [0.0; W] };
        let mut block = [[0.0; W]; W];
        for (c, column) in block.iter_mut().enumerate() {
            column.copy_from_slice(&values[c * stride..c * stride + W]);
        }
        for c in 0..W {
            let pivot = block[c][c];
            if pivot == 0.0 || !pivot.is_finite() {
                values[c * stride + c] = pivot;
                return Err(c);
            }
            corner.inverse[c] = pivot.recip();
            let (done, rest) = block.split_at_mut(c + 1);
            let lower = &mut corner.lower[c];
            for (entry, &value) in lower[c + 1..].iter_mut().zip(&done[c][c + 1..]) {
                *entry = value * corner.inverse[c];
            }
            for (column, &factor) in rest.iter_mut().zip(&done[c][c + 1..]) {
                for (entry, &value) in column[c + 1..].iter_mut().zip(&lower[c + 1..]) {
                    *entry -= value * factor;
                }
            }
            values[c * stride + c] = pivot;
            values[c * stride + c + 1..c * stride + W].copy_from_slice(&corner.lower[c][c + 1..]);
        }
        Ok(corner)
    }

    /// Updates rows below the block with the columns `left` of it and solves them for L.
    #[inline(always)]
    fn rows<S: Simd, const FULL: bool>(
        &self,
        simd: S,
        (left, own, stride): (&[f64], &mut [f64], usize),
        rows: Range<usize>,
        factors: &[[f64; W]],
    ) {
        let sums = load_rows::<S, W, FULL>(simd, Columns { values: own, stride }, rows.clone());
        let mut sums = accumulate::<S, W, FULL>(simd, sums, Columns { values: left, stride }, rows.clone(), factors);
        for c in 0..W {
            let solved = sums[c];
            for (sum, &factor) in sums[c + 1..].iter_mut().zip(&self.lower[c][c + 1..]) {
                *sum = simd.negate_mul_add_f64s(solved, simd.splat_f64s(factor), *sum);
            }
            let entries = &mut own[c * stride + rows.start..c * stride + rows.end];
            store::<S, FULL>(simd, entries, simd.mul_f64s(solved, simd.splat_f64s(self.inverse[c])));
        }
    }
}
