//! Breadth-first level structures: the layers of a slender body along its axis.

use super::graph::Graph;

const OUTSIDE: u32 = u32::MAX;
/// Fraction bits of a mean position.
const FRACTION_BITS: u32 = 12;

/// Vertices grouped in levels; a vertex has neighbours in its own and the two adjacent levels only.
#[derive(Debug, Clone, Default)]
pub(super) struct Levels {
    /// Vertices, level by level.
    pub(super) order: Vec<u32>,
    /// Start of every level in `order`, with the end.
    pub(super) start: Vec<usize>,
}

impl Levels {
    pub(super) fn len(&self) -> usize {
        self.start.len().saturating_sub(1)
    }

    pub(super) fn level(&self, number: usize) -> &[u32] {
        &self.order[self.start[number]..self.start[number + 1]]
    }

    /// Every vertex with the number of its level.
    pub(super) fn numbered(&self) -> impl Iterator<Item = (u32, usize)> {
        (0..self.len()).flat_map(|number| self.level(number).iter().map(move |&vertex| (vertex, number)))
    }

    pub(super) fn last(&self) -> &[u32] {
        if self.len() == 0 { &[] } else { self.level(self.len() - 1) }
    }

    /// The level at which the work on both sides, estimated as `Σ w³`, is equal.
    fn middle(&self, graph: &Graph) -> usize {
        let work: Vec<f64> = (0..self.len())
            .map(|number| self.level(number).iter().map(|&v| f64::from(graph.weight[v as usize])).sum::<f64>().powi(3))
            .collect();
        let half = 0.5 * work.iter().sum::<f64>();
        let mut sum = 0.0;
        work.iter()
            .position(|w| {
                sum += w;
                sum >= half
            })
            .unwrap_or(0)
    }

    /// Order from both ends to the middle level, which comes last: two independent branches of equal work.
    pub(super) fn twisted(&self, graph: &Graph) -> Vec<u32> {
        if self.len() < 3 {
            return self.order.clone();
        }
        let middle = self.middle(graph);
        let mut order = Vec::with_capacity(self.order.len());
        order.extend_from_slice(&self.order[..self.start[middle]]);
        for number in (middle + 1..self.len()).rev() {
            order.extend_from_slice(self.level(number));
        }
        order.extend_from_slice(self.level(middle));
        order
    }
}

/// From where the levels of a component are counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Origin {
    /// One pseudo-peripheral vertex.
    Vertex,
    /// The whole last level seen from that vertex: the end section of a slender body.
    Section,
}

/// Level structure of every connected component, in the order of their first vertices.
pub(super) fn components(graph: &Graph, origin: Origin) -> Vec<Levels> {
    let mut search = Search::new(graph);
    let mut components = Vec::new();
    for seed in 0..graph.len() as u32 {
        if search.region[seed as usize] != 0 {
            continue;
        }
        let levels = search.component(seed, origin);
        for &vertex in &levels.order {
            search.region[vertex as usize] = OUTSIDE;
        }
        components.push(levels);
    }
    components
}

/// Breadth-first searches restricted to a region of the graph.
struct Search<'a> {
    graph: &'a Graph,
    /// Region of every vertex: 0 at first, [`OUTSIDE`] when done, another number while a part is being swept.
    region: Vec<u32>,
    /// Stamp of the search that reached a vertex last.
    reached: Vec<u32>,
    stamp: u32,
    position: Vec<u32>,
}

impl<'a> Search<'a> {
    fn new(graph: &'a Graph) -> Self {
        let n = graph.len();
        Self { graph, region: vec![0; n], reached: vec![0; n], stamp: 0, position: vec![0; n] }
    }

    fn component(&mut self, seed: u32, origin: Origin) -> Levels {
        let first = self.peripheral_levels(seed, 0);
        if origin == Origin::Vertex {
            return self.sorted_levels(&first.order[..1], 0);
        }
        let section = first.last().to_vec();
        let roots = self.sweep(&section);
        self.sorted_levels(&roots, 0)
    }

    /// Levels from a pseudo-peripheral vertex (George and Liu, ACM Trans. Math. Softw. 5, 1979).
    fn peripheral_levels(&mut self, seed: u32, region: u32) -> Levels {
        let mut levels = self.plain_levels(seed, region);
        loop {
            let degree = |&&v: &&u32| self.graph.neighbours(v).len();
            let Some(&candidate) = levels.last().iter().min_by_key(degree) else { return levels };
            let deeper = self.plain_levels(candidate, region);
            if deeper.len() <= levels.len() {
                return levels;
            }
            levels = deeper;
        }
    }

    fn plain_levels(&mut self, root: u32, region: u32) -> Levels {
        self.levels(&[root], region, |_, _| {})
    }

    /// Levels in which every vertex stands at the mean position of its neighbours in the level before, so that all
    /// levels are swept in the same direction.
    fn sorted_levels(&mut self, roots: &[u32], region: u32) -> Levels {
        let mut keys = Vec::new();
        self.levels(roots, region, |search, fresh| {
            keys.clear();
            keys.extend(fresh.iter().map(|&vertex| search.mean_position(vertex)));
            keys.sort_unstable();
            for (slot, key) in fresh.iter_mut().zip(&keys) {
                *slot = key.2;
            }
        })
    }

    /// Mean and least position of the numbered neighbours of `vertex`, and `vertex`.
    fn mean_position(&self, vertex: u32) -> (u64, u32, u32) {
        let (mut sum, mut count, mut least) = (0u64, 0u64, u32::MAX);
        for &neighbour in self.graph.neighbours(vertex) {
            let position = self.position[neighbour as usize];
            if self.reached[neighbour as usize] == self.stamp && position != OUTSIDE {
                sum += u64::from(position);
                count += 1;
                least = least.min(position);
            }
        }
        ((sum << FRACTION_BITS) / count.max(1), least, vertex)
    }

    fn levels(&mut self, roots: &[u32], region: u32, mut arrange: impl FnMut(&Self, &mut [u32])) -> Levels {
        self.stamp += 1;
        let mut levels = Levels { order: roots.to_vec(), start: vec![0] };
        for &root in roots {
            self.reached[root as usize] = self.stamp;
        }
        let mut begin = 0;
        while begin < levels.order.len() {
            let end = levels.order.len();
            levels.start.push(end);
            for place in begin..end {
                self.position[levels.order[place] as usize] = place as u32;
            }
            for place in begin..end {
                self.extend(levels.order[place], region, &mut levels.order);
            }
            arrange(self, &mut levels.order[end..]);
            begin = end;
        }
        levels
    }

    /// Appends the neighbours of `vertex` in the region that no level holds yet.
    fn extend(&mut self, vertex: u32, region: u32, order: &mut Vec<u32>) {
        for &neighbour in self.graph.neighbours(vertex) {
            let i = neighbour as usize;
            if self.reached[i] != self.stamp && self.region[i] == region {
                self.reached[i] = self.stamp;
                self.position[i] = OUTSIDE;
                order.push(neighbour);
            }
        }
    }

    /// Order of a set of vertices by a sweep through the graph they induce.
    fn sweep(&mut self, set: &[u32]) -> Vec<u32> {
        const SWEPT: u32 = 1;
        for &vertex in set {
            self.region[vertex as usize] = SWEPT;
        }
        let mut order = Vec::with_capacity(set.len());
        for &vertex in set {
            if self.region[vertex as usize] != SWEPT {
                continue;
            }
            let root = self.peripheral_levels(vertex, SWEPT).order[0];
            let part = self.sorted_levels(&[root], SWEPT);
            for &done in &part.order {
                self.region[done as usize] = 0;
            }
            order.extend(part.order);
        }
        order
    }
}
