//! Orders of a slender body that keep the wavefront short: vertex by vertex from an end, the next one being that which
//! takes least into the front for how far it has been left behind (S. W. Sloan, Int. J. Numer. Methods Eng. 23, 1986).
//!
//! The layers of a breadth-first search are as thick as the longest edge: where contact bridges several rows of nodes on the
//! surfaces of a rope, they take as many rows of its inside. A wavefront is thick at the surface and thin inside.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::graph::Graph;
use super::levels::Levels;

/// Unknowns, in those of a mean vertex, that a vertex may take into the front for every layer that it has been left behind:
/// few follow thick bodies, many thin ones.
pub(super) const PULLS: [f64; 2] = [4.0, 8.0];
/// Times that stations are averaged. A layer of contact is several rows of nodes, which have one and the same level; averages
/// tell them apart.
const AVERAGES: usize = 8;

/// A connected part of the graph along its axis.
pub(super) struct Part<'a> {
    /// From an end section on.
    levels: &'a Levels,
    /// Place along the axis in layers, of every vertex of the graph; 0 outside the part.
    station: Vec<f64>,
    /// Mean weight of a vertex.
    weight: f64,
}

impl<'a> Part<'a> {
    pub(super) fn new(graph: &Graph, levels: &'a Levels) -> Self {
        let mut station = vec![0.0; graph.len()];
        levels.numbered().for_each(|(vertex, number)| station[vertex as usize] = number as f64);
        // None of a part of one or two levels.
        let inside = levels.level(0).len()..levels.order.len() - levels.last().len();
        let inside = levels.order.get(inside).unwrap_or_default();
        for _ in 0..AVERAGES {
            let before = station.clone();
            for &vertex in inside {
                let neighbours = graph.neighbours(vertex);
                let sum: f64 = neighbours.iter().map(|&n| before[n as usize]).sum();
                station[vertex as usize] = 0.5 * (before[vertex as usize] + sum / neighbours.len() as f64);
            }
        }
        let weight: f64 = levels.order.iter().map(|&vertex| f64::from(graph.weight[vertex as usize])).sum();
        Self { weight: weight / levels.order.len() as f64, levels, station }
    }

    /// From the first end to the last.
    pub(super) fn forward(&self, graph: &Graph, pull: f64) -> Vec<u32> {
        Sweep::new(graph, self, -pull).run(self.levels.level(0))
    }

    /// From both ends to the wavefront in the middle, which comes last: two independent branches. `first` is the order
    /// from the first end.
    pub(super) fn inward(&self, graph: &Graph, pull: f64, first: &[u32]) -> Vec<u32> {
        let mut order = first[..first.len() / 2].to_vec();
        let mut taken = vec![false; graph.len()];
        order.iter().for_each(|&vertex| taken[vertex as usize] = true);
        let rest = Sweep::new(graph, self, pull).run(self.levels.last());
        let rest = rest.into_iter().filter(|&vertex| !taken[vertex as usize]);
        let is_front = |&vertex: &u32| graph.neighbours(vertex).iter().any(|&n| taken[n as usize]);
        let (front, beyond): (Vec<u32>, Vec<u32>) = rest.partition(is_front);
        order.extend(beyond);
        order.extend(front);
        order
    }
}

/// How far a vertex has come, in the order of time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Status {
    /// Outside the front.
    Waiting,
    /// In the front: a neighbour is numbered.
    Active,
    Numbered,
}

/// Numbers the vertices of a part.
struct Sweep<'a> {
    graph: &'a Graph,
    status: Vec<Status>,
    /// How far a vertex has been left behind less what it would take into the front, in unknowns.
    priority: Vec<i64>,
    /// The front and its neighbours, once more whenever their priority has risen; entries with an earlier one are stale.
    queue: BinaryHeap<(i64, Reverse<u32>)>,
    /// Vertices whose priority has risen since a vertex was numbered.
    risen: Vec<u32>,
    is_risen: Vec<bool>,
}

impl<'a> Sweep<'a> {
    fn new(graph: &'a Graph, part: &Part<'_>, pull: f64) -> Self {
        let mut priority = vec![0; graph.len()];
        let weight = |vertex: u32| i64::from(graph.weight[vertex as usize]);
        for &vertex in &part.levels.order {
            let taken = weight(vertex) + graph.neighbours(vertex).iter().map(|&n| weight(n)).sum::<i64>();
            let left_behind = (pull * part.weight * part.station[vertex as usize]).round() as i64;
            priority[vertex as usize] = left_behind - taken;
        }
        let (status, is_risen) = (vec![Status::Waiting; graph.len()], vec![false; graph.len()]);
        Self { graph, status, priority, queue: BinaryHeap::new(), risen: Vec::new(), is_risen }
    }

    fn run(mut self, end: &[u32]) -> Vec<u32> {
        let mut order = Vec::new();
        self.queue.extend(end.iter().map(|&vertex| (self.priority[vertex as usize], Reverse(vertex))));
        while let Some((priority, Reverse(vertex))) = self.queue.pop() {
            let number = vertex as usize;
            if self.status[number] == Status::Numbered || priority < self.priority[number] {
                continue;
            }
            self.activate(vertex);
            self.status[number] = Status::Numbered;
            self.graph.neighbours(vertex).iter().for_each(|&neighbour| self.activate(neighbour));
            self.enqueue_risen();
            order.push(vertex);
        }
        order
    }

    fn enqueue_risen(&mut self) {
        for vertex in self.risen.drain(..) {
            self.is_risen[vertex as usize] = false;
            if self.status[vertex as usize] != Status::Numbered {
                self.queue.push((self.priority[vertex as usize], Reverse(vertex)));
            }
        }
    }

    /// Takes a vertex into the front: nobody has to take it any more.
    fn activate(&mut self, vertex: u32) {
        if self.status[vertex as usize] != Status::Waiting {
            return;
        }
        self.status[vertex as usize] = Status::Active;
        let weight = i64::from(self.graph.weight[vertex as usize]);
        for &taker in self.graph.neighbours(vertex).iter().chain([&vertex]) {
            self.priority[taker as usize] += weight;
            if !std::mem::replace(&mut self.is_risen[taker as usize], true) {
                self.risen.push(taker);
            }
        }
    }
}
