//! Where the entries of element matrices go: positions in the values of the sparse matrix, found once.

use super::Equations;
use crate::contribution::Contribution;
use crate::kinematics::{ElementMap, Kinematics};
use crate::linear::{SparsePattern, Storage};

/// Positions of one contribution's entries. Entries that belong to prescribed coordinates, and the lower half of a
/// symmetric diagonal block, go to a spare position behind the last value.
///
/// Elements that come and go are placed when they are first needed: of all the pairs of faces that may touch few do.
pub struct ScatterMap {
    /// Range of every element in `slots`; empty until it is placed.
    ranges: Vec<(usize, usize)>,
    slots: Vec<u32>,
    /// Reduced coordinates of the elements with tied nodes, by element.
    tied: Vec<(u32, ElementMap)>,
}

/// Equations of every element of a contribution, for the pattern.
pub fn cliques(kinematics: &Kinematics, equations: &Equations, contribution: &dyn Contribution, out: &mut Cliques) {
    for e in 0..contribution.element_count() {
        let map = ElementMap::new(kinematics, contribution.element_nodes(e));
        out.push(map.coordinates.iter().filter_map(|&c| equations.of(c as usize)));
    }
}

/// Lists of equations, flat.
#[derive(Default)]
pub struct Cliques {
    starts: Vec<usize>,
    members: Vec<u32>,
}

impl Cliques {
    /// Adds one list.
    pub fn push(&mut self, members: impl Iterator<Item = u32>) {
        self.starts.push(self.members.len());
        self.members.extend(members);
    }

    /// All lists.
    pub fn iter(&self) -> impl Iterator<Item = &[u32]> {
        let ends = self.starts.iter().skip(1).copied().chain(std::iter::once(self.members.len()));
        self.starts.iter().zip(ends).map(|(&s, e)| &self.members[s..e])
    }
}

/// Finds positions; keeps what is common.
struct Finder<'a> {
    pattern: &'a SparsePattern,
    equations: &'a Equations,
    spare: u32,
}

impl Finder<'_> {
    /// Position of an entry of the matrix between two coordinates.
    fn slot(&self, row: u32, column: u32) -> u32 {
        let (Some(r), Some(c)) = (self.equations.of(row as usize), self.equations.of(column as usize)) else {
            return self.spare;
        };
        let (r, c) = match self.pattern.storage() {
            Storage::Lower => (r.max(c), r.min(c)),
            Storage::Full => (r, c),
        };
        self.pattern.slot(r as usize, c as usize).map_or(self.spare, |s| s as u32)
    }
}

impl ScatterMap {
    /// Finds the position of every entry; of an intermittent contribution none yet.
    pub fn new(
        kinematics: &Kinematics,
        equations: &Equations,
        pattern: &SparsePattern,
        contribution: &dyn Contribution,
    ) -> Self {
        let count = contribution.element_count();
        let mut map = Self { ranges: vec![(0, 0); count], slots: Vec::new(), tied: Vec::new() };
        if !contribution.is_intermittent() {
            for e in 0..count {
                map.place(e, kinematics, equations, pattern, contribution.element_nodes(e));
            }
        }
        map
    }

    /// Finds the positions of one element unless they are known.
    pub fn place(
        &mut self,
        element: usize,
        kinematics: &Kinematics,
        equations: &Equations,
        pattern: &SparsePattern,
        nodes: &[u32],
    ) {
        if self.ranges[element].1 > 0 {
            return;
        }
        let finder = Finder { pattern, equations, spare: pattern.nnz() as u32 };
        let symmetric = pattern.storage() == Storage::Lower;
        let start = self.slots.len();
        let map = ElementMap::new(kinematics, nodes);
        if map.tied {
            self.push_tied(&finder, &map.coordinates, symmetric);
            let at = self.tied.partition_point(|(e, _)| (*e as usize) < element);
            self.tied.insert(at, (element as u32, map));
        } else {
            self.push_free(&finder, &map.coordinates, symmetric);
        }
        self.ranges[element] = (start, self.slots.len());
    }

    /// Order of [`add_free`]: row node, row component, column component, column node.
    fn push_free(&mut self, finder: &Finder<'_>, coordinates: &[u32], symmetric: bool) {
        let n = coordinates.len() / 3;
        for a in 0..n {
            for k in 0..3 {
                for m in 0..3 {
                    for b in if symmetric { a } else { 0 }..n {
                        let mirrored = symmetric && a == b && m < k;
                        let (row, column) = (coordinates[3 * a + k], coordinates[3 * b + m]);
                        self.slots.push(if mirrored { finder.spare } else { finder.slot(row, column) });
                    }
                }
            }
        }
    }

    fn push_tied(&mut self, finder: &Finder<'_>, coordinates: &[u32], symmetric: bool) {
        for (r, &row) in coordinates.iter().enumerate() {
            for &column in &coordinates[if symmetric { r } else { 0 }..] {
                self.slots.push(finder.slot(row, column));
            }
        }
    }

    fn slots_of(&self, element: usize) -> &[u32] {
        let (start, end) = self.ranges[element];
        &self.slots[start..end]
    }

    /// Reduced coordinates of an element with tied nodes.
    pub fn tied(&self, element: usize) -> Option<&ElementMap> {
        let at = self.tied.binary_search_by_key(&(element as u32), |(e, _)| *e).ok()?;
        Some(&self.tied[at].1)
    }

    /// Adds the matrix (component-major) of an element whose nodes are free.
    pub fn add_free(&self, element: usize, nodes: usize, symmetric: bool, matrix: &[f64], values: &mut [f64]) {
        let slots = self.slots_of(element);
        let mut at = 0;
        for a in 0..nodes {
            let first = if symmetric { a } else { 0 };
            for k in 0..3 {
                for m in 0..3 {
                    let line = ((k * nodes + a) * 3 + m) * nodes;
                    let row = &matrix[line + first..line + nodes];
                    for (&slot, value) in slots[at..at + row.len()].iter().zip(row) {
                        values[slot as usize] += value;
                    }
                    at += row.len();
                }
            }
        }
    }

    /// Adds the reduced matrix (row-major) of an element with tied nodes.
    pub fn add_tied(&self, element: usize, size: usize, symmetric: bool, matrix: &[f64], values: &mut [f64]) {
        let slots = self.slots_of(element);
        let mut at = 0;
        for r in 0..size {
            let row = &matrix[r * size + if symmetric { r } else { 0 }..(r + 1) * size];
            for (&slot, value) in slots[at..at + row.len()].iter().zip(row) {
                values[slot as usize] += value;
            }
            at += row.len();
        }
    }
}
