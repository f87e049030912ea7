//! The order of a slender body that is too thick to be eliminated layer by layer.
//!
//! Nested dissection eliminates a cut of `s` unknowns when both sides of its part are gone, before the two cuts beyond:
//! a front of `3 s` unknowns, about `6 s^3` operations. One cut after the other along the body has only one cut beyond:
//! `2 s` unknowns, `2 s^3` operations, and the work grows with the length and no faster. What lies between the cuts is the
//! same in both. How many cuts pay is decided by the count of operations.

use super::dissection::{Cuts, cuts};
use super::error::LinearError;
use super::graph::Graph;
use super::levels::Levels;

/// Vertices of a part below which it is not cut again.
const PART_VERTICES: usize = 48;
/// Most times that parts are cut in two.
const DEEPEST: u32 = 8;

/// Orders of a slender body by one dissection.
pub(super) struct CrossSections {
    /// For every number of cuts that is worth a try.
    pub(super) orders: Vec<Vec<u32>>,
    /// The nested dissection that the cuts are of.
    pub(super) nested: Vec<u32>,
}

/// None of a graph that is not slender. `layers` are those of every component from an end section on.
///
/// # Errors
/// As [`cuts`].
pub(super) fn cross_sections(graph: &Graph, layers: &[Levels]) -> Result<Option<CrossSections>, LinearError> {
    let along = stations(graph, layers);
    let depth = (graph.len() / PART_VERTICES).checked_ilog2().unwrap_or(0).min(DEEPEST);
    if depth < 2 || !is_slender(graph, &along) {
        return Ok(None);
    }
    let cuts = cuts(graph, depth)?;
    let orders = (2..=depth).map(|levels| order(&cuts, levels, &along)).collect();
    Ok(Some(CrossSections { orders, nested: cuts.order }))
}

/// Number of the layer that every vertex lies in.
fn stations(graph: &Graph, layers: &[Levels]) -> Vec<u32> {
    let mut along = vec![0; graph.len()];
    for (vertex, number) in layers.iter().flat_map(Levels::numbered) {
        along[vertex as usize] = number as u32;
    }
    along
}

/// Whether there are more than half as many layers as a layer is vertices wide: contact bridges several rows of nodes, so
/// that the layers of a rope are fewer than those of its bricks.
fn is_slender(graph: &Graph, along: &[u32]) -> bool {
    let layers = along.iter().max().map_or(0, |&last| last as usize + 1);
    8.0 * (layers as f64).powi(3) > graph.len() as f64
}

/// Parts after `levels` bisections, then the cuts from both ends to the middle.
fn order(cuts: &Cuts, levels: u32, along: &[u32]) -> Vec<u32> {
    let mut sections: Vec<(f64, &[u32])> = Vec::new();
    let mut order = Vec::with_capacity(cuts.order.len());
    let mut stack = vec![(0_usize, 0_usize..cuts.order.len(), 0_u32)];
    while let Some((node, span, level)) = stack.pop() {
        if level == levels {
            order.extend_from_slice(&cuts.order[span]);
            continue;
        }
        let [left, right, end] = cuts.ends[node];
        let section = &cuts.order[right..end];
        sections.push((mean(section, along), section));
        stack.push((2 * node + 1, left..right, level + 1));
        stack.push((2 * node + 2, span.start..left, level + 1));
    }
    sections.sort_by(|a, b| a.0.total_cmp(&b.0));
    let middle = sections.len() / 2;
    let (first, second) = sections.split_at(middle);
    for (_, section) in first.iter().chain(second.iter().rev()) {
        order.extend_from_slice(section);
    }
    order
}

fn mean(section: &[u32], along: &[u32]) -> f64 {
    let sum: f64 = section.iter().map(|&vertex| f64::from(along[vertex as usize])).sum();
    sum / section.len().max(1) as f64
}
