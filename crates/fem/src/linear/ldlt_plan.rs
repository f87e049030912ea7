//! What a supernodal factorisation does with the values, known from the structure alone.

use super::error::LinearError;
use super::fill::invert;
use super::panel::WorkspaceSize;
use super::pattern::{SparsePattern, Storage};
use super::schedule::Schedule;
use super::supernodes::Supernodes;

/// One finished panel that contributes to another.
#[derive(Debug, Clone, Copy)]
pub(super) struct Update {
    pub(super) source: u32,
    /// First run of the source that reaches the target.
    pub(super) first_run: u32,
}

/// Consecutive values of the matrix and their places in a panel, down a column of it or along a row.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Entries {
    pub(super) slot: u32,
    pub(super) place: u32,
    /// How many there are.
    pub(super) len: u16,
    /// Whether they lie along a row.
    pub(super) along_row: bool,
}

impl Entries {
    /// Goes on with another value of a panel with so many rows, if it is the next one.
    fn take(&mut self, slot: usize, place: usize, rows: usize) -> bool {
        let len = usize::from(self.len);
        let follows = |step: usize| self.slot as usize + len == slot && self.place as usize + len * step == place;
        let (down, along) =
            (follows(1) && (len == 1 || !self.along_row), follows(rows) && (len == 1 || self.along_row));
        if self.len == u16::MAX || !(down || along) {
            return false;
        }
        self.along_row = !down;
        self.len += 1;
        true
    }
}

pub(super) struct Plan {
    pub(super) supernodes: Supernodes,
    pub(super) schedule: Schedule,
    update_start: Vec<usize>,
    updates: Vec<Update>,
    entry_start: Vec<usize>,
    entries: Vec<Entries>,
    /// Unknown of the caller at every position of the elimination.
    pub(super) order: Vec<u32>,
}

impl Plan {
    /// # Errors
    /// [`LinearError::FactorTooLarge`] if an index would not fit in 32 bits.
    pub(super) fn new(
        pattern: &SparsePattern,
        order: Vec<u32>,
        supernodes: Supernodes,
        branch_flops: f64,
    ) -> Result<Self, LinearError> {
        check_indices(pattern, &supernodes)?;
        let (update_start, updates) = updates(&supernodes);
        let (entry_start, entries) = entries(pattern, &order, &supernodes);
        let schedule = Schedule::new(&supernodes, branch_flops);
        Ok(Self { supernodes, schedule, update_start, updates, entry_start, entries, order })
    }

    pub(super) fn updates(&self, supernode: usize) -> &[Update] {
        &self.updates[self.update_start[supernode]..self.update_start[supernode + 1]]
    }

    pub(super) fn entries(&self, supernode: usize) -> &[Entries] {
        &self.entries[self.entry_start[supernode]..self.entry_start[supernode + 1]]
    }

    /// Buffers that the factorisation of `supernodes` needs.
    pub(super) fn workspace_size(&self, targets: impl Iterator<Item = usize>) -> WorkspaceSize {
        let mut size = WorkspaceSize::default();
        for number in targets {
            let target = &self.supernodes.list[number];
            size.include_panel(target);
            for update in self.updates(number) {
                let source = &self.supernodes.list[update.source as usize];
                let runs = &self.supernodes.runs(source)[update.first_run as usize..];
                if let Some(first) = runs.first() {
                    let row = first.local as usize + target.begin.saturating_sub(first.begin as usize);
                    let pieces = runs.len() + self.supernodes.runs(target).len();
                    size.include_update(target, source, row, pieces);
                }
            }
        }
        size
    }

    pub(super) fn bytes(&self) -> usize {
        self.supernodes.bytes()
            + (self.update_start.len() + self.entry_start.len()) * size_of::<usize>()
            + self.updates.len() * size_of::<Update>()
            + self.entries.len() * size_of::<Entries>()
            + self.order.len() * size_of::<u32>()
    }
}

fn check_indices(pattern: &SparsePattern, supernodes: &Supernodes) -> Result<(), LinearError> {
    let limit = u32::MAX as usize;
    let largest = supernodes.list.iter().map(|s| s.len()).max().unwrap_or(0).max(pattern.nnz());
    if largest >= limit {
        return Err(LinearError::FactorTooLarge { entries: largest as f64, limit: limit as f64 });
    }
    Ok(())
}

/// For every supernode, the supernodes before it with rows among its columns.
fn updates(supernodes: &Supernodes) -> (Vec<usize>, Vec<Update>) {
    let count = supernodes.list.len();
    let mut start = vec![0usize; count + 1];
    for source in &supernodes.list {
        for_each_target(
            supernodes,
            source.end,
            supernodes.runs(source).iter().map(|r| (r.begin, r.end)),
            |target, _| {
                start[target + 1] += 1;
            },
        );
    }
    for i in 0..count {
        start[i + 1] += start[i];
    }
    let mut next = start.clone();
    let mut updates = vec![Update { source: 0, first_run: 0 }; start[count]];
    for (number, source) in supernodes.list.iter().enumerate() {
        let runs = supernodes.runs(source).iter().map(|r| (r.begin, r.end));
        for_each_target(supernodes, source.end, runs, |target, first_run| {
            updates[next[target]] = Update { source: number as u32, first_run };
            next[target] += 1;
        });
    }
    (start, updates)
}

/// Visits every supernode that `runs` reach once, with the first run that reaches it.
fn for_each_target(
    supernodes: &Supernodes,
    mut from: usize,
    runs: impl Iterator<Item = (u32, u32)>,
    mut visit: impl FnMut(usize, u32),
) {
    for (number, (begin, end)) in runs.enumerate() {
        from = from.max(begin as usize);
        while from < end as usize {
            let target = supernodes.of_unknown[from] as usize;
            visit(target, number as u32);
            from = supernodes.list[target].end;
        }
    }
}

/// Places of the lower triangle in the panels. With full storage only the lower triangle in elimination order is read.
fn entries(pattern: &SparsePattern, order: &[u32], supernodes: &Supernodes) -> (Vec<usize>, Vec<Entries>) {
    let position = invert(order);
    // The components of a node are numbered one after the other, here and there: most values come in threes.
    let mut found: Vec<(u32, Entries)> = Vec::with_capacity(pattern.nnz() / 2);
    for_each_lower(pattern, &position, |slot, row, col| {
        let number = supernodes.of_unknown[col];
        let supernode = &supernodes.list[number as usize];
        let place = supernodes.local_row(supernode, row) + (col - supernode.begin) * supernode.rows;
        let continued = found.last_mut().is_some_and(|(n, run)| *n == number && run.take(slot, place, supernode.rows));
        if !continued {
            found.push((number, Entries { slot: slot as u32, place: place as u32, len: 1, along_row: false }));
        }
    });
    let mut start = vec![0usize; supernodes.list.len() + 1];
    found.iter().for_each(|(number, _)| start[*number as usize + 1] += 1);
    for i in 0..supernodes.list.len() {
        start[i + 1] += start[i];
    }
    let mut next = start.clone();
    let mut entries = vec![Entries::default(); found.len()];
    for (number, run) in found {
        let place = &mut next[number as usize];
        entries[*place] = run;
        *place += 1;
    }
    for span in start.windows(2) {
        entries[span[0]..span[1]].sort_unstable_by_key(|entries| entries.place);
    }
    (start, entries)
}

/// Visits slot, row and column (in elimination order) of every entry of the permuted lower triangle once.
fn for_each_lower(pattern: &SparsePattern, position: &[u32], mut visit: impl FnMut(usize, usize, usize)) {
    for (col, span) in pattern.column_pointers().windows(2).enumerate() {
        let col = position[col] as usize;
        for slot in span[0]..span[1] {
            let row = position[pattern.row_indices()[slot] as usize] as usize;
            if row >= col {
                visit(slot, row, col);
            } else if pattern.storage() == Storage::Lower {
                visit(slot, col, row);
            }
        }
    }
}
