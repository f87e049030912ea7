//! Nested dissection by METIS.
//!
//! The crate `metis` builds and links the library but wraps its partitioning only; the ordering functions are declared
//! here. This is the one module of the solvers with unsafe code.
#![allow(unsafe_code)]

use std::ptr::null_mut;
use std::sync::{Mutex, PoisonError};

use metis::Idx;

use super::error::LinearError;
use super::graph::Graph;

const METIS_OK: i32 = 1;

/// METIS draws from the process-wide `rand`, which it seeds at the start of every call.
static SEEDED: Mutex<()> = Mutex::new(());

unsafe extern "C" {
    fn METIS_NodeND(
        vertices: *mut Idx,
        start: *mut Idx,
        neighbour: *mut Idx,
        weight: *mut Idx,
        options: *mut Idx,
        order: *mut Idx,
        position: *mut Idx,
    ) -> i32;

    fn METIS_NodeNDP(
        vertices: Idx,
        start: *mut Idx,
        neighbour: *mut Idx,
        weight: *mut Idx,
        parts: Idx,
        options: *mut Idx,
        order: *mut Idx,
        position: *mut Idx,
        sizes: *mut Idx,
    ) -> i32;
}

/// A graph in the index type of METIS.
struct Arrays {
    start: Vec<Idx>,
    neighbour: Vec<Idx>,
    weight: Vec<Idx>,
    order: Vec<Idx>,
    position: Vec<Idx>,
}

impl Arrays {
    /// # Errors
    /// [`LinearError::TooManyUnknowns`] if the edges exceed the indices of METIS.
    fn new(graph: &Graph) -> Result<Self, LinearError> {
        let limit = Idx::MAX as usize;
        if graph.neighbour.len() > limit {
            return Err(LinearError::TooManyUnknowns { n: graph.len(), limit });
        }
        Ok(Self {
            start: graph.start.iter().map(|&s| s as Idx).collect(),
            neighbour: graph.neighbour.iter().map(|&v| v as Idx).collect(),
            weight: graph.weight.iter().map(|&w| w as Idx).collect(),
            order: vec![0; graph.len()],
            position: vec![0; graph.len()],
        })
    }

    fn order(self, status: i32) -> Result<Vec<u32>, LinearError> {
        if status != METIS_OK {
            return Err(LinearError::Metis { status, vertices: self.order.len() });
        }
        Ok(self.order.into_iter().map(|vertex| vertex as u32).collect())
    }
}

/// A nested dissection of which the first cuts are known: a binary tree in which every node is the cut of its part.
pub(super) struct Cuts {
    /// Position to vertex: of every part first its left, then its right side, then its cut.
    pub(super) order: Vec<u32>,
    /// Position after the end of the left side, of the right side and of the cut of every node, the root first; the
    /// sides of node `i` are the nodes `2 i + 2` (left) and `2 i + 1`.
    pub(super) ends: Vec<[usize; 3]>,
}

/// Nested-dissection order (position to vertex) of `graph`; the same for every call.
///
/// # Errors
/// [`LinearError::Metis`] if METIS refuses the graph, [`LinearError::TooManyUnknowns`] if its edges exceed the
/// indices of METIS.
pub(super) fn nested_dissection(graph: &Graph) -> Result<Vec<u32>, LinearError> {
    let mut arrays = Arrays::new(graph)?;
    let mut vertices = graph.len() as Idx;
    let guard = SEEDED.lock().unwrap_or_else(PoisonError::into_inner);
    // SAFETY: the arrays have the lengths METIS documents (`start` one more than the vertices, `neighbour` as many as
    // the last of `start`, the others one per vertex), indices lie in range, the graph is symmetric without loops,
    // all arrays outlive the call, and a null pointer stands for the default options.
    let status = unsafe {
        METIS_NodeND(
            &mut vertices,
            arrays.start.as_mut_ptr(),
            arrays.neighbour.as_mut_ptr(),
            arrays.weight.as_mut_ptr(),
            null_mut(),
            arrays.order.as_mut_ptr(),
            arrays.position.as_mut_ptr(),
        )
    };
    drop(guard);
    arrays.order(status)
}

/// Nested dissection of `graph` with the cuts into `2^depth` parts; the same for every call.
///
/// # Errors
/// As [`nested_dissection`].
pub(super) fn cuts(graph: &Graph, depth: u32) -> Result<Cuts, LinearError> {
    let mut arrays = Arrays::new(graph)?;
    let parts = 1_usize << depth;
    let mut sizes = vec![0 as Idx; 2 * parts];
    let guard = SEEDED.lock().unwrap_or_else(PoisonError::into_inner);
    // SAFETY: as in `nested_dissection`; `sizes` has the two entries per part that METIS documents.
    let status = unsafe {
        METIS_NodeNDP(
            graph.len() as Idx,
            arrays.start.as_mut_ptr(),
            arrays.neighbour.as_mut_ptr(),
            arrays.weight.as_mut_ptr(),
            parts as Idx,
            null_mut(),
            arrays.order.as_mut_ptr(),
            arrays.position.as_mut_ptr(),
            sizes.as_mut_ptr(),
        )
    };
    drop(guard);
    let order = arrays.order(status)?;
    // METIS stores the tree from the end; a node that was cut holds the weight of its cut, a leaf that of its part.
    let weight: Vec<usize> = (0..2 * parts - 1).map(|node| sizes[2 * parts - 2 - node] as usize).collect();
    let ends = ends_of(graph, &order, &weight, parts - 1);
    Ok(Cuts { order, ends })
}

/// Positions at which the sides and the cut of each of `inner` nodes end, from the weights of all nodes.
fn ends_of(graph: &Graph, order: &[u32], weight: &[usize], inner: usize) -> Vec<[usize; 3]> {
    let mut total = weight.to_vec();
    for node in (0..inner).rev() {
        total[node] += total[2 * node + 1] + total[2 * node + 2];
    }
    let mut passed = Vec::with_capacity(order.len() + 1);
    passed.push(0);
    for &vertex in order {
        passed.push(passed[passed.len() - 1] + graph.weight[vertex as usize] as usize);
    }
    let position = |unknowns: usize| passed.partition_point(|&p| p < unknowns);
    let mut begin = vec![0; weight.len()];
    let mut ends = Vec::with_capacity(inner);
    for node in 0..inner {
        let (right, left) = (2 * node + 1, 2 * node + 2);
        let middle = begin[node] + total[left];
        (begin[left], begin[right]) = (begin[node], middle);
        ends.push([middle, middle + total[right], begin[node] + total[node]].map(position));
    }
    ends
}
