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
    /// Place of every element in `slots`; empty until it is placed.
    places: Vec<Place>,
    slots: Vec<u32>,
    /// Reduced coordinates of the elements with tied nodes, by element.
    tied: Vec<(u32, ElementMap)>,
}

/// Where the positions of an element stand in the list of all.
#[derive(Clone, Copy, Default)]
struct Place {
    start: usize,
    len: u32,
    form: Form,
}

/// How the positions of an element are kept.
#[derive(Clone, Copy, Default, PartialEq, Eq)]
enum Form {
    /// One by one.
    #[default]
    Each,
    /// First positions of the columns between two nodes: the three components of a node follow each other in every column.
    Columns,
}

/// Marks a first position whose column belongs to the second node of a pair, so that the components of the first follow
/// each other. Positions are below it wherever it is used.
const OF_SECOND: u32 = 1 << 31;

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

impl Finder<'_> {
    /// First positions of the three columns between two nodes, less the number of components that stand before; `None`
    /// where components do not follow each other. Of a symmetric block on the diagonal the columns begin there.
    fn columns(&self, first: &[u32; 3], second: &[u32; 3], symmetric: bool) -> Option<[u32; 3]> {
        let equation = |coordinate: u32| self.equations.of(coordinate as usize);
        let of_second = !symmetric || equation(first[0])? > equation(second[0])?;
        let (columns, rows) = if of_second { (second, first) } else { (first, second) };
        let mut starts = [0; 3];
        for (k, (start, &column)) in starts.iter_mut().zip(columns).enumerate() {
            let before = if symmetric && first == second { k } else { 0 };
            *start = self.slot(rows[before], column).checked_sub(before as u32)?;
            let follow = |m: usize| self.slot(rows[m], column) == *start + m as u32 && *start + (m as u32) < self.spare;
            if !(before..3).all(follow) {
                return None;
            }
            *start |= if of_second { OF_SECOND } else { 0 };
        }
        Some(starts)
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
        let mut map = Self { places: vec![Place::default(); count], slots: Vec::new(), tied: Vec::new() };
        if !contribution.is_intermittent() {
            for e in 0..count {
                map.place(e, kinematics, equations, pattern, contribution.element_nodes(e));
            }
            map.slots.shrink_to_fit();
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
        if self.places[element].len > 0 {
            return;
        }
        let finder = Finder { pattern, equations, spare: pattern.nnz() as u32 };
        let symmetric = pattern.storage() == Storage::Lower;
        let (start, mut form) = (self.slots.len(), Form::Each);
        let map = ElementMap::new(kinematics, nodes);
        if map.tied {
            self.push_tied(&finder, &map.coordinates, symmetric);
            let at = self.tied.partition_point(|(e, _)| (*e as usize) < element);
            self.tied.insert(at, (element as u32, map));
        } else if self.push_columns(&finder, &map.coordinates, symmetric) {
            form = Form::Columns;
        } else {
            self.slots.truncate(start);
            self.push_free(&finder, &map.coordinates, symmetric);
        }
        self.places[element] = Place { start, len: (self.slots.len() - start) as u32, form };
    }

    /// First positions, three for every pair of nodes; whether that says it all.
    fn push_columns(&mut self, finder: &Finder<'_>, coordinates: &[u32], symmetric: bool) -> bool {
        if finder.spare >= OF_SECOND {
            return false;
        }
        let (nodes, []) = coordinates.as_chunks::<3>() else { return false };
        for (a, first) in nodes.iter().enumerate() {
            for second in &nodes[if symmetric { a } else { 0 }..] {
                let Some(starts) = finder.columns(first, second, symmetric) else { return false };
                self.slots.extend(starts);
            }
        }
        true
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
        let Place { start, len, .. } = self.places[element];
        &self.slots[start..start + len as usize]
    }

    /// Reduced coordinates of an element with tied nodes.
    pub fn tied(&self, element: usize) -> Option<&ElementMap> {
        let at = self.tied.binary_search_by_key(&(element as u32), |(e, _)| *e).ok()?;
        Some(&self.tied[at].1)
    }

    /// Adds the matrix (component-major) of an element whose nodes are free.
    pub fn add_free(&self, element: usize, nodes: usize, symmetric: bool, matrix: &[f64], values: &mut [f64]) {
        let slots = self.slots_of(element);
        if self.places[element].form == Form::Columns {
            return add_columns(slots, nodes, symmetric, matrix, values);
        }
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

/// Adds the matrix (component-major) of an element whose positions are kept by columns.
fn add_columns(starts: &[u32], n: usize, symmetric: bool, matrix: &[f64], values: &mut [f64]) {
    let mut starts = starts.as_chunks::<3>().0.iter();
    for a in 0..n {
        for (b, starts) in (if symmetric { a } else { 0 }..n).zip(&mut starts) {
            let entry = |k: usize, m: usize| matrix[((k * n + a) * 3 + m) * n + b];
            let first_row = |column: usize| if symmetric && a == b { column } else { 0 };
            for (column, start) in starts.iter().enumerate() {
                let place = (start & !OF_SECOND) as usize;
                let rows = values[place..place + 3].iter_mut().enumerate().skip(first_row(column));
                if start & OF_SECOND == 0 {
                    rows.for_each(|(row, value)| *value += entry(column, row));
                } else {
                    rows.for_each(|(row, value)| *value += entry(row, column));
                }
            }
        }
    }
}
