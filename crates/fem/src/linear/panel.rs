//! Dense kernels on the panels of supernodes.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::ldlt::factor::{LdltParams, LdltRegularization, cholesky_in_place};
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::solve_unit_lower_triangular_in_place;
use faer::{Accum, MatMut, MatRef, Par, Spec};

use super::parallel::join;
use super::supernodes::{Run, Supernode, Supernodes};

/// Rows per part of a product or solve that is worth a thread of its own.
const SPLIT_ROWS: usize = 512;
/// Work below which a product is not split [flop].
const SPLIT_FLOPS: usize = 20_000_000;
/// Rows and columns per piece from which an update goes straight to its target.
const DIRECT_ROWS: usize = 24;
const DIRECT_COLUMNS: usize = 12;

/// Rows `source..source + len` of the updating panel that land on rows `target..` of the updated one.
#[derive(Debug, Clone, Copy)]
struct Piece {
    source: usize,
    target: usize,
    len: usize,
}

/// Buffers of one branch, allocated once.
pub(super) struct Workspace {
    scaled: Vec<f64>,
    product: Vec<f64>,
    pieces: Vec<Piece>,
    stack: MemBuffer,
}

/// Sizes of the buffers of a branch.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct WorkspaceSize {
    pub(super) scaled: usize,
    pub(super) product: usize,
    pub(super) columns: usize,
    pub(super) pieces: usize,
}

impl WorkspaceSize {
    pub(super) fn include(&mut self, target: &Supernode, source: &Supernode, first_row: usize, runs: usize) {
        let middle = target.columns().min(source.rows - first_row);
        self.scaled = self.scaled.max(middle * source.columns());
        self.product = self.product.max(middle * (source.rows - first_row));
        self.pieces = self.pieces.max(runs + 2);
    }
}

impl Workspace {
    pub(super) fn new(size: &WorkspaceSize) -> Self {
        use faer::linalg::cholesky::ldlt::factor::cholesky_in_place_scratch;
        let params = Spec::<LdltParams, f64>::default();
        Self {
            scaled: vec![0.0; size.scaled],
            product: vec![0.0; size.product],
            pieces: Vec::with_capacity(size.pieces),
            stack: MemBuffer::new(cholesky_in_place_scratch::<f64>(size.columns, Par::Seq, params)),
        }
    }

    pub(super) fn bytes(&self) -> usize {
        (self.scaled.len() + self.product.len()) * size_of::<f64>() + self.pieces.capacity() * size_of::<Piece>()
    }
}

/// A column-major panel being updated.
pub(super) fn panel_mut<'a>(values: &'a mut [f64], supernode: &Supernode) -> MatMut<'a, f64> {
    MatMut::from_column_major_slice_mut(values, supernode.rows, supernode.columns())
}

/// A finished column-major panel.
pub(super) fn panel<'a>(values: &'a [f64], supernode: &Supernode) -> MatRef<'a, f64> {
    MatRef::from_column_major_slice(values, supernode.rows, supernode.columns())
}

/// Subtracts from the panel of `target` what the finished panel `source` contributes, `L D Lᵀ` over their common rows.
pub(super) fn update(
    supernodes: &Supernodes,
    (target, mut target_panel): (&Supernode, MatMut<'_, f64>),
    (source, source_panel): (&Supernode, MatRef<'_, f64>),
    first_run: usize,
    work: &mut Workspace,
) {
    let runs = &supernodes.runs(source)[first_run..];
    let Some(first) = runs.first() else { return };
    let first_row = first.local as usize + target.begin.saturating_sub(first.begin as usize);
    let (middle, columns) = collect_pieces(supernodes, target, runs, first_row, &mut work.pieces);
    let rows = source.rows - first_row;
    let depth = source.columns();
    let lower = source_panel.subrows(first_row, rows);
    let mut scaled = MatMut::from_column_major_slice_mut(&mut work.scaled[..middle * depth], middle, depth);
    scale_columns(scaled.as_mut(), lower.subrows(0, middle), source_panel);
    let (scaled, pieces) = (scaled.as_ref(), &work.pieces[..]);
    if rows >= DIRECT_ROWS * (pieces.len() - 1) && middle >= DIRECT_COLUMNS * (columns - 1) {
        for (place, column) in pieces[..columns].iter().enumerate() {
            let factor = scaled.subrows(column.source, column.len).transpose();
            for row in &pieces[place..] {
                let part =
                    target_panel.as_mut().submatrix_mut(row.target, column.target, row.len, column.len);
                subtract_product(part, lower.subrows(row.source, row.len), factor);
            }
        }
    } else {
        let mut product = MatMut::from_column_major_slice_mut(&mut work.product[..rows * middle], rows, middle);
        product_into(product.as_mut(), lower, scaled.transpose());
        subtract_pieces(target_panel, product.as_ref(), pieces, columns);
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

/// `scaled = lower D` with the pivots on the diagonal of the panel.
fn scale_columns(mut scaled: MatMut<'_, f64>, lower: MatRef<'_, f64>, source_panel: MatRef<'_, f64>) {
    for column in 0..lower.ncols() {
        let pivot = source_panel[(column, column)];
        let source = lower.col(column).try_as_col_major().map(|c| c.as_slice());
        let target = scaled.as_mut().col_mut(column).try_as_col_major_mut().map(|c| c.as_slice_mut());
        if let (Some(source), Some(target)) = (source, target) {
            for (value, &entry) in target.iter_mut().zip(source) {
                *value = entry * pivot;
            }
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

/// `target = left right`.
fn product_into(target: MatMut<'_, f64>, left: MatRef<'_, f64>, right: MatRef<'_, f64>) {
    if is_heavy(target.nrows(), target.ncols(), left.ncols()) {
        let half = target.nrows() / 2;
        let (upper, lower) = target.split_at_row_mut(half);
        let (upper_left, lower_left) = left.split_at_row(half);
        join(|| product_into(upper, upper_left, right), || product_into(lower, lower_left, right));
    } else {
        matmul(target, Accum::Replace, left, right, 1.0, Par::Seq);
    }
}

/// Subtracts the rows of `product` from their places in the target, on and below the diagonal.
fn subtract_pieces(mut target: MatMut<'_, f64>, product: MatRef<'_, f64>, pieces: &[Piece], columns: usize) {
    for (place, column) in pieces[..columns].iter().enumerate() {
        for offset in 0..column.len {
            let source = product.col(column.source + offset).try_as_col_major().map(|c| c.as_slice());
            let entries = target.as_mut().col_mut(column.target + offset).try_as_col_major_mut().map(|c| c.as_slice_mut());
            let (Some(source), Some(entries)) = (source, entries) else { continue };
            for row in &pieces[place..] {
                let from = &source[row.source..row.source + row.len];
                for (entry, &value) in entries[row.target..row.target + row.len].iter_mut().zip(from) {
                    *entry -= value;
                }
            }
        }
    }
}

/// Factorises the diagonal block of an updated panel and solves for its rows below. Leaves L below the diagonal, the
/// pivots on it. Returns the column that broke down, if one did.
pub(super) fn factorise(mut values: MatMut<'_, f64>, work: &mut Workspace) -> Result<(), usize> {
    use faer::linalg::cholesky::ldlt::factor::LdltError;
    let columns = values.ncols();
    let (mut top, bottom) = values.as_mut().split_at_row_mut(columns);
    let stack = MemStack::new(&mut work.stack);
    let regularisation = LdltRegularization::default();
    let params = Spec::<LdltParams, f64>::default();
    match cholesky_in_place(top.as_mut(), regularisation, Par::Seq, stack, params) {
        Ok(_) => {}
        Err(LdltError::ZeroPivot { index }) => return Err(index),
    }
    solve_rows(top.as_ref(), bottom);
    Ok(())
}

/// `bottom = bottom L⁻ᵀ D⁻¹` with L and D of the diagonal block.
fn solve_rows(top: MatRef<'_, f64>, bottom: MatMut<'_, f64>) {
    let columns = top.ncols();
    if is_heavy(bottom.nrows(), columns, columns) {
        let half = bottom.nrows() / 2;
        let (upper, lower) = bottom.split_at_row_mut(half);
        join(|| solve_rows(top, upper), || solve_rows(top, lower));
        return;
    }
    let mut bottom = bottom;
    solve_unit_lower_triangular_in_place(top, bottom.as_mut().transpose_mut(), Par::Seq);
    for column in 0..columns {
        let inverse = top[(column, column)].recip();
        if let Some(entries) = bottom.as_mut().col_mut(column).try_as_col_major_mut() {
            entries.as_slice_mut().iter_mut().for_each(|entry| *entry *= inverse);
        }
    }
}
