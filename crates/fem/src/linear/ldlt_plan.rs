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

/// One value of the matrix and its place in a panel.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entry {
    pub(super) slot: u32,
    pub(super) place: u32,
}

pub(super) struct Plan {
    pub(super) supernodes: Supernodes,
    pub(super) schedule: Schedule,
    update_start: Vec<usize>,
    updates: Vec<Update>,
    entry_start: Vec<usize>,
    entries: Vec<Entry>,
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

    pub(super) fn entries(&self, supernode: usize) -> &[Entry] {
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
            + self.entries.len() * size_of::<Entry>()
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
fn entries(pattern: &SparsePattern, order: &[u32], supernodes: &Supernodes) -> (Vec<usize>, Vec<Entry>) {
    let position = invert(order);
    let mut start = vec![0usize; supernodes.list.len() + 1];
    for_each_lower(pattern, &position, |_, _, col| start[supernodes.of_unknown[col] as usize + 1] += 1);
    for i in 0..supernodes.list.len() {
        start[i + 1] += start[i];
    }
    let mut next = start.clone();
    let mut entries = vec![Entry { slot: 0, place: 0 }; start[supernodes.list.len()]];
    for_each_lower(pattern, &position, |slot, row, col| {
        let number = supernodes.of_unknown[col] as usize;
        let supernode = &supernodes.list[number];
        let place = supernodes.local_row(supernode, row) + (col - supernode.begin) * supernode.rows;
        entries[next[number]] = Entry { slot: slot as u32, place: place as u32 };
        next[number] += 1;
    });
    for span in start.windows(2) {
        entries[span[0]..span[1]].sort_unstable_by_key(|entry| entry.place);
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
