//! Nested dissection by METIS.
//!
//! The crate `metis` builds and links the library but wraps its partitioning only; the ordering function is declared
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
}

/// Nested-dissection order (position to vertex) of `graph`; the same for every call.
///
/// # Errors
/// [`LinearError::Metis`] if METIS refuses the graph, [`LinearError::TooManyUnknowns`] if its edges exceed the
/// indices of METIS.
pub(super) fn nested_dissection(graph: &Graph) -> Result<Vec<u32>, LinearError> {
    let limit = Idx::MAX as usize;
    if graph.neighbour.len() > limit {
        return Err(LinearError::TooManyUnknowns { n: graph.len(), limit });
    }
    let mut vertices = graph.len() as Idx;
    let mut start: Vec<Idx> = graph.start.iter().map(|&s| s as Idx).collect();
    let mut neighbour: Vec<Idx> = graph.neighbour.iter().map(|&v| v as Idx).collect();
    let mut weight: Vec<Idx> = graph.weight.iter().map(|&w| w as Idx).collect();
    let mut order = vec![0 as Idx; graph.len()];
    let mut position = vec![0 as Idx; graph.len()];
    let guard = SEEDED.lock().unwrap_or_else(PoisonError::into_inner);
    // SAFETY: the arrays have the lengths METIS documents (`start` one more than the vertices, `neighbour` as many as
    // the last of `start`, the others one per vertex), indices lie in range, the graph is symmetric without loops,
    // all arrays outlive the call, and a null pointer stands for the default options.
    let status = unsafe {
        METIS_NodeND(
            &mut vertices,
            start.as_mut_ptr(),
            neighbour.as_mut_ptr(),
            weight.as_mut_ptr(),
            null_mut(),
            order.as_mut_ptr(),
            position.as_mut_ptr(),
        )
    };
    drop(guard);
    if status != METIS_OK {
        return Err(LinearError::Metis { status, vertices: graph.len() });
    }
    Ok(order.into_iter().map(|vertex| vertex as u32).collect())
}
