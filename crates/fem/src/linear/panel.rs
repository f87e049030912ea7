//! Dense work on the panels of supernodes: register kernels, and general matrix products for what is worth several
//! threads.

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};
use pulp::Arch;

use super::kernel::{BLOCK, COLUMNS, Factorisation, PACKED, Product};
use super::parallel::join;
use super::supernodes::{Run, Supernode, Supernodes};

/// Rows per part of a product that is worth a thread of its own.
const SPLIT_ROWS: usize = 512;
/// Work below which a product is not split \[flop\].
const SPLIT_FLOPS: usize = 20_000_000;
/// Rows and columns per piece from which an update goes straight to its target.
const DIRECT_ROWS: usize = 24;
const DIRECT_COLUMNS: usize = 12;
/// Columns of a panel factorised before the rest of it is updated.
const PANEL_COLUMNS: usize = 32;

/// Rows `source..source + len` of an updating panel that land on rows `target..` of another.
#[derive(Debug, Clone, Copy)]
struct Piece {
    source: usize,
    target: usize,
    len: usize,
}

/// Buffers of one branch, allocated once.
pub(super) struct Workspace {
    scaled: Vec<f64>,
    strips: Vec<f64>,
    product: Vec<f64>,
    pieces: Vec<Piece>,
    rows: Vec<u32>,
    pivots: Vec<f64>,
    arch: Arch,
}

/// Sizes of the buffers of a branch.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct WorkspaceSize {
    scaled: usize,
    product: usize,
    columns: usize,
    rows: usize,
    pieces: usize,
}

impl WorkspaceSize {
    /// Makes room for the factorisation of `target`.
    pub(super) fn include_panel(&mut self, target: &Supernode) {
        self.columns = self.columns.max(target.columns());
        self.rows = self.rows.max(target.rows);
        self.scaled = self.scaled.max(target.columns().next_multiple_of(COLUMNS) * PANEL_COLUMNS.max(BLOCK));
    }

    /// Makes room for an update of `target` by the rows of `source` from `first_row` on, in at most `runs` runs.
    pub(super) fn include_update(&mut self, target: &Supernode, source: &Supernode, first_row: usize, runs: usize) {
        let middle = target.columns().min(source.rows - first_row);
        self.columns = self.columns.max(source.columns());
        let rows = source.rows - first_row;
        self.rows = self.rows.max(rows);
        self.scaled = self.scaled.max(middle.next_multiple_of(COLUMNS) * source.columns());
        if is_heavy(rows, middle, source.columns()) {
            self.product = self.product.max(middle * rows);
        }
        self.pieces = self.pieces.max(runs + 2);
    }
}

impl Workspace {
    pub(super) fn new(size: &WorkspaceSize) -> Self {
        Self {
            scaled: vec![0.0; size.scaled],
            strips: vec![0.0; PACKED * size.columns],
            product: vec![0.0; size.product],
            pieces: Vec::with_capacity(size.pieces),
            rows: Vec::with_capacity(size.rows),
            pivots: vec![0.0; size.columns],
            arch: Arch::new(),
        }
    }

    pub(super) fn bytes(&self) -> usize {
        (self.scaled.len() + self.strips.len() + self.product.len() + self.pivots.len()) * size_of::<f64>()
            + self.pieces.capacity() * size_of::<Piece>()
            + self.rows.capacity() * size_of::<u32>()
    }
}

/// A finished column-major panel.
pub(super) fn panel<'a>(values: &'a [f64], supernode: &Supernode) -> MatRef<'a, f64> {
    MatRef::from_column_major_slice(values, supernode.rows, supernode.columns())
}

/// Subtracts from the panel of `target` what the finished panel `source` contributes, `L D Lᵀ` over their common rows.
pub(super) fn update(
    supernodes: &Supernodes,
    (target, target_values): (&Supernode, &mut [f64]),
    (source, source_values): (&Supernode, &[f64]),
    first_run: usize,
    work: &mut Workspace,
) {
    let runs = &supernodes.runs(source)[first_run..];
    let Some(first) = runs.first() else { return };
    let first_row = first.local as usize + target.begin.saturating_sub(first.begin as usize);
    let (middle, columns) = collect_pieces(supernodes, target, runs, first_row, &mut work.pieces);
    let rows = source.rows - first_row;
    let pivots = &mut work.pivots[..source.columns()];
    for (column, pivot) in pivots.iter_mut().enumerate() {
        *pivot = source_values[column * (source.rows + 1)];
    }
    let lower = &source_values[first_row..];
    if is_heavy(rows, middle, source.columns()) {
        let update = Heavy { stride: source.rows, lower, pivots, scaled: &mut work.scaled };
        update.apply(target_values, target.rows, (&work.pieces, columns), (rows, middle), &mut work.product);
        return;
    }
    work.rows.clear();
    work.rows.extend(work.pieces.iter().flat_map(|p| p.target as u32..(p.target + p.len) as u32));
    work.arch.dispatch(Product {
        target: target_values,
        target_stride: target.rows,
        lower,
        stride: source.rows,
        pivots,
        rows: &work.rows,
        columns: middle,
        strips: &mut work.strips,
        scaled: &mut work.scaled,
    });
}

/// The updating side of an update that is worth several threads.
struct Heavy<'a> {
    stride: usize,
    /// Its panel from the first of the rows that matter.
    lower: &'a [f64],
    pivots: &'a [f64],
    scaled: &'a mut [f64],
}

impl Heavy<'_> {
    /// Updates the target in place where its pieces are long, otherwise through `product`.
    fn apply(
        self,
        target: &mut [f64],
        target_stride: usize,
        (pieces, columns): (&[Piece], usize),
        (rows, middle): (usize, usize),
        product: &mut [f64],
    ) {
        if rows >= DIRECT_ROWS * (pieces.len() - 1) && middle >= DIRECT_COLUMNS * (columns - 1) {
            self.subtract(target, target_stride, pieces, columns);
            return;
        }
        let whole =
            [Piece { source: 0, target: 0, len: middle }, Piece { source: middle, target: middle, len: rows - middle }];
        let product = &mut product[..rows * middle];
        product.fill(0.0);
        self.subtract(product, rows, &whole, 1);
        add_pieces(target, target_stride, product, rows, pieces, columns);
    }

    /// `target -= L D Lᵀ` over the rows of `pieces`.
    fn subtract(self, target: &mut [f64], target_stride: usize, pieces: &[Piece], columns: usize) {
        let Self { stride, lower, pivots, scaled } = self;
        let depth = pivots.len();
        let mut matrix = strided_mut(target, target_stride);
        for (place, column) in pieces[..columns].iter().enumerate() {
            scale_rows(&lower[column.source..], stride, pivots, column.len, scaled);
            let factor = MatRef::from_column_major_slice(&scaled[..column.len * depth], column.len, depth).transpose();
            for row in pieces[place..].iter().filter(|row| row.len > 0) {
                let left = strided(&lower[row.source..], stride, row.len, depth);
                let part = matrix.as_mut().submatrix_mut(row.target, column.target, row.len, column.len);
                subtract_product(part, left, factor);
            }
        }
    }
}

/// Rows of the source from `first_row` on as pieces that are consecutive in the target; the number of rows that are
/// columns of the target, and the number of pieces that hold them.
fn collect_pieces(
    supernodes: &Supernodes,
    target: &Supernode,
    runs: &[Run],
    first_row: usize,
    pieces: &mut Vec<Piece>,
) -> (usize, usize) {
    pieces.clear();
    let (mut middle, mut columns) = (0, 0);
    let target_runs = supernodes.runs(target);
    let mut place = 0;
    for run in runs {
        let mut begin = (run.begin as usize).max(target.begin);
        let end = run.end as usize;
        while begin < end {
            let inside = begin < target.end;
            let (local, stop) = if inside {
                (begin - target.begin, target.end.min(end))
            } else {
                while target_runs[place].end as usize <= begin {
                    place += 1;
                }
                (target_runs[place].local as usize + begin - target_runs[place].begin as usize, end)
            };
            let source = run.local as usize + begin - run.begin as usize - first_row;
            let len = stop - begin;
            if inside {
                middle += len;
            }
            match pieces.last_mut() {
                Some(last) if last.target + last.len == local && (inside || pieces_end_below(last, target)) => {
                    last.len += len;
                }
                _ => {
                    columns += usize::from(inside);
                    pieces.push(Piece { source, target: local, len });
                }
            }
            begin = stop;
        }
    }
    (middle, columns)
}

/// Whether a piece lies below the diagonal block of the target.
fn pieces_end_below(piece: &Piece, target: &Supernode) -> bool {
    piece.target >= target.columns()
}

/// The columns of a panel as a matrix.
fn strided_mut(values: &mut [f64], stride: usize) -> MatMut<'_, f64> {
    let columns = values.len() / stride.max(1);
    MatMut::from_column_major_slice_mut(&mut values[..stride * columns], stride, columns)
}

/// Rows `0..rows` of a panel that starts in the middle of its first column.
fn strided(values: &[f64], stride: usize, rows: usize, columns: usize) -> MatRef<'_, f64> {
    MatRef::from_column_major_slice_with_stride(values, rows, columns, stride)
}

/// `scaled = lower D`, column-major of `rows` rows.
fn scale_rows(lower: &[f64], stride: usize, pivots: &[f64], rows: usize, scaled: &mut [f64]) {
    for ((target, source), &pivot) in scaled.chunks_exact_mut(rows).zip(lower.chunks(stride)).zip(pivots) {
        for (value, &entry) in target.iter_mut().zip(source) {
            *value = entry * pivot;
        }
    }
}

fn is_heavy(rows: usize, columns: usize, depth: usize) -> bool {
    rows >= 2 * SPLIT_ROWS && 2 * rows * columns * depth >= SPLIT_FLOPS
}

/// `target -= left right`.
fn subtract_product(target: MatMut<'_, f64>, left: MatRef<'_, f64>, right: MatRef<'_, f64>) {
    if is_heavy(target.nrows(), target.ncols(), left.ncols()) {
        let half = target.nrows() / 2;
        let (upper, lower) = target.split_at_row_mut(half);
        let (upper_left, lower_left) = left.split_at_row(half);
        join(|| subtract_product(upper, upper_left, right), || subtract_product(lower, lower_left, right));
    } else {
        matmul(target, Accum::Add, left, right, -1.0, Par::Seq);
    }
}

/// Adds the rows of `product` to their places in the target, on and below the diagonal.
fn add_pieces(target: &mut [f64], stride: usize, product: &[f64], rows: usize, pieces: &[Piece], columns: usize) {
    for (place, column) in pieces[..columns].iter().enumerate() {
        for offset in 0..column.len {
            let source = &product[(column.source + offset) * rows..][..rows];
            let entries = &mut target[(column.target + offset) * stride..][..stride];
            for row in &pieces[place..] {
                let from = &source[row.source..row.source + row.len];
                for (entry, &value) in entries[row.target..row.target + row.len].iter_mut().zip(from) {
                    *entry += value;
                }
            }
        }
    }
}

/// Factorises an updated panel: leaves L below the diagonal of its diagonal block, the pivots on it. The error is the
/// column that broke down.
pub(super) fn factorise(values: &mut [f64], supernode: &Supernode, work: &mut Workspace) -> Result<(), usize> {
    let (stride, columns) = (supernode.rows, supernode.columns());
    for first in (0..columns).step_by(PANEL_COLUMNS) {
        let width = PANEL_COLUMNS.min(columns - first);
        let panel = &mut values[first * stride + first..];
        let rows = stride - first;
        let scaled = &mut work.scaled[..];
        let kernel = Factorisation { values: panel, stride, rows, columns: width, scaled };
        work.arch.dispatch(kernel).map_err(|column| first + column)?;
        if first + width < columns {
            update_rest(values, supernode, first..first + width, work);
        }
    }
    Ok(())
}

/// Updates the columns of a panel behind `done` with those.
fn update_rest(values: &mut [f64], supernode: &Supernode, done: std::ops::Range<usize>, work: &mut Workspace) {
    let (stride, columns) = (supernode.rows, supernode.columns());
    let (finished, rest) = values.split_at_mut(done.end * stride);
    let pivots = &mut work.pivots[..done.len()];
    for (pivot, column) in pivots.iter_mut().zip(done.clone()) {
        *pivot = finished[column * (stride + 1)];
    }
    let lower = &finished[done.start * stride + done.end..];
    let (rows, left) = (stride - done.end, columns - done.end);
    if is_heavy(rows, left, done.len()) {
        scale_rows(lower, stride, pivots, left, &mut work.scaled);
        let factor = MatRef::from_column_major_slice(&work.scaled[..left * done.len()], left, done.len()).transpose();
        let target = strided_mut(rest, stride).subrows_mut(done.end, rows);
        subtract_product(target, strided(lower, stride, rows, done.len()), factor);
        return;
    }
    work.rows.clear();
    work.rows.extend(0..rows as u32);
    work.arch.dispatch(Product {
        target: &mut rest[done.end..],
        target_stride: stride,
        lower,
        stride,
        pivots,
        rows: &work.rows,
        columns: left,
        strips: &mut work.strips,
        scaled: &mut work.scaled,
    });
}
