//! Choice of the elimination order by the exact cost of each candidate.

use super::cross_sections::cross_sections;
use super::dissection::nested_dissection;
use super::error::LinearError;
use super::fill::{Elimination, FillEstimate, postorder};
use super::graph::Graph;
use super::levels::{Levels, Origin, components};
use super::wavefront::{self, Part};

/// Below this number of vertices nested dissection has nothing to dissect.
const DISSECTION_VERTICES: usize = 200;
/// Above this number of vertices the natural order is not tried.
const NATURAL_VERTICES: usize = 1000;
/// Above this number of separate bodies no wavefront is tried: each keeps an array of the length of the graph.
const MOST_PARTS: usize = 32;
/// Factor on the work up to which an order with independent branches is preferred to a chain.
const BRANCH_PREFERENCE: f64 = 1.05;

/// A way to order the elimination.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Ordering {
    /// As numbered by the caller.
    Natural,
    /// Layer by layer along the body, from one end to the other.
    Layers,
    /// Layer by layer from both ends to the middle: two independent branches.
    TwistedLayers,
    /// Vertex by vertex, so that the wavefront stays short, from one end to the other.
    Wavefront,
    /// The same from both ends to the middle: two independent branches.
    TwistedWavefront,
    /// Nested dissection by METIS.
    NestedDissection,
    /// Cuts across a slender body by METIS: the parts between them by nested dissection, then the cuts one after the
    /// other from both ends to the middle.
    CrossSections,
}

impl Ordering {
    /// Name for a log.
    pub fn name(self) -> &'static str {
        match self {
            Self::Natural => "natural",
            Self::Layers => "layers",
            Self::TwistedLayers => "layers from both ends",
            Self::Wavefront => "shortest wavefront",
            Self::TwistedWavefront => "shortest wavefront from both ends",
            Self::NestedDissection => "nested dissection",
            Self::CrossSections => "cross-sections from both ends",
        }
    }
}

/// An order that was tried, with its cost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Candidate {
    /// Way of ordering.
    pub ordering: Ordering,
    /// Cost of the LDLᵀ factorisation in that order.
    pub fill: FillEstimate,
}

/// The order taken.
pub(super) struct Choice {
    pub(super) candidate: Candidate,
    /// Position to vertex, children before parents.
    pub(super) order: Vec<u32>,
    pub(super) elimination: Elimination,
}

/// Tries all orders (or only `forced`) and takes the one with least work; all costs are returned.
pub(super) fn choose(graph: &Graph, forced: Option<Ordering>) -> Result<(Choice, Vec<Candidate>), LinearError> {
    let mut contest = Contest { graph, forced, best: None, tried: Vec::new() };
    let sections = components(graph, Origin::Section);
    contest.layers(&sections);
    contest.wavefronts(&sections);
    contest.dissections(&sections)?;
    if contest.wants(Ordering::Natural) && (forced.is_some() || graph.len() <= NATURAL_VERTICES) {
        contest.enter(Ordering::Natural, natural(graph));
    }
    let best = contest.best.unwrap_or_else(|| evaluate(graph, Ordering::Natural, natural(graph)));
    Ok((children_first(graph, best), contest.tried))
}

fn natural(graph: &Graph) -> Vec<u32> {
    (0..graph.len() as u32).collect()
}

/// Orders against each other.
struct Contest<'a> {
    graph: &'a Graph,
    forced: Option<Ordering>,
    best: Option<Choice>,
    tried: Vec<Candidate>,
}

impl Contest<'_> {
    fn wants(&self, ordering: Ordering) -> bool {
        self.forced.is_none_or(|only| only == ordering)
    }

    /// Enters an order; answers whether none before was better.
    fn enter(&mut self, ordering: Ordering, order: Vec<u32>) -> bool {
        let choice = evaluate(self.graph, ordering, order);
        self.tried.push(choice.candidate);
        let leads = self.best.as_ref().is_none_or(|current| better(&choice.candidate, &current.candidate));
        if leads {
            self.best = Some(choice);
        }
        leads
    }

    /// Layers from an end section on, and from one vertex.
    fn layers(&mut self, sections: &[Levels]) {
        let graph = self.graph;
        if !self.wants(Ordering::Layers) && !self.wants(Ordering::TwistedLayers) {
            return;
        }
        for levels in [sections, &components(graph, Origin::Vertex)] {
            if self.wants(Ordering::TwistedLayers) {
                self.enter(Ordering::TwistedLayers, concatenate(levels, |part| part.twisted(graph)));
            }
            if self.wants(Ordering::Layers) {
                self.enter(Ordering::Layers, concatenate(levels, |part| part.order.clone()));
            }
        }
    }

    /// With every pull, as long as the order from one end, which is that from both but for its middle, is the best so far.
    fn wavefronts(&mut self, sections: &[Levels]) {
        let graph = self.graph;
        let wanted = self.wants(Ordering::Wavefront) || self.wants(Ordering::TwistedWavefront);
        if !wanted || (self.forced.is_none() && sections.len() > MOST_PARTS) {
            return;
        }
        let parts: Vec<Part<'_>> = sections.iter().map(|levels| Part::new(graph, levels)).collect();
        for pull in wavefront::PULLS {
            let first: Vec<Vec<u32>> = parts.iter().map(|part| part.forward(graph, pull)).collect();
            if self.wants(Ordering::Wavefront) && !self.enter(Ordering::Wavefront, first.concat()) {
                return;
            }
            if self.wants(Ordering::TwistedWavefront) {
                let both = parts.iter().zip(&first).flat_map(|(part, first)| part.inward(graph, pull, first));
                self.enter(Ordering::TwistedWavefront, both.collect());
            }
        }
    }

    fn dissections(&mut self, sections: &[Levels]) -> Result<(), LinearError> {
        let graph = self.graph;
        let worth = if self.forced.is_some() { graph.len() > 1 } else { graph.len() >= DISSECTION_VERTICES };
        if !worth || graph.neighbour.is_empty() {
            return Ok(());
        }
        let slender = if self.wants(Ordering::CrossSections) { cross_sections(graph, sections)? } else { None };
        let (orders, nested) = slender.map_or_else(Default::default, |s| (s.orders, Some(s.nested)));
        if self.wants(Ordering::NestedDissection) {
            self.enter(Ordering::NestedDissection, nested.map_or_else(|| nested_dissection(graph), Ok)?);
        }
        for order in orders {
            self.enter(Ordering::CrossSections, order);
        }
        Ok(())
    }
}

fn concatenate(components: &[Levels], order: impl Fn(&Levels) -> Vec<u32>) -> Vec<u32> {
    components.iter().flat_map(order).collect()
}

fn evaluate(graph: &Graph, ordering: Ordering, order: Vec<u32>) -> Choice {
    let elimination = Elimination::new(graph, &order);
    let fill = elimination.estimate(graph, &order);
    Choice { candidate: Candidate { ordering, fill }, order, elimination }
}

/// Whether `new` is to replace `current`; an order with branches may cost a little more than one without.
fn better(new: &Candidate, current: &Candidate) -> bool {
    let weighted = |candidate: &Candidate| {
        let chain = matches!(candidate.ordering, Ordering::Layers | Ordering::Wavefront | Ordering::Natural);
        candidate.fill.flops * if chain { BRANCH_PREFERENCE } else { 1.0 }
    };
    weighted(new) < weighted(current)
}

/// The same elimination numbered in postorder of its tree, so that every subtree is contiguous.
fn children_first(graph: &Graph, choice: Choice) -> Choice {
    let post = postorder(&choice.elimination.parent);
    if post.iter().enumerate().all(|(rank, &position)| rank == position as usize) {
        return choice;
    }
    let order = post.iter().map(|&position| choice.order[position as usize]).collect();
    Choice { candidate: choice.candidate, ..evaluate(graph, choice.candidate.ordering, order) }
}
