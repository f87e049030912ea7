//! The structured lattice behind a section: a square core, its boundary ring 0, and rings up to the circle.
//!
//! The quad9 section is the quad4 section of twice as many cells each way, taken two by two.

use super::{Section, SectionMesh};
use crate::CellKind;
use crate::quadrilateral::LATTICE;
use nalgebra::Vector2;
use std::f64::consts::PI;

/// Lattice of `side` x `side` core cells and `rings` rings; `order` lattice cells make one quadrilateral each way.
pub(super) struct Lattice {
    side: usize,
    rings: usize,
    order: usize,
}

impl Lattice {
    pub(super) fn new(section: &Section, kind: CellKind) -> Self {
        let order = kind.order();
        Self { side: section.core_cells * order, rings: section.rings * order, order }
    }

    /// The section of radius `radius`, its outer nodes on the circle.
    pub(super) fn section(&self, section: &Section, radius: f64) -> SectionMesh {
        let (cells, outer_cells) = self.cells();
        SectionMesh {
            nodes_per_cell: (self.order + 1) * (self.order + 1),
            points: self.points(section, radius),
            cells,
            outer: (0..self.around()).map(|q| self.ring_index(self.rings, q)).collect(),
            outer_cells,
            centre: self.core_index(self.side / 2, self.side / 2),
        }
    }

    fn around(&self) -> usize {
        4 * self.side
    }

    fn core_index(&self, i: usize, j: usize) -> u32 {
        (j * (self.side + 1) + i) as u32
    }

    /// Node `q` of ring `ring`, counter-clockwise from the corner (-, -); ring 0 is the boundary of the core.
    fn ring_index(&self, ring: usize, q: usize) -> u32 {
        let (n, q) = (self.side, q % self.around());
        if ring > 0 {
            return ((n + 1) * (n + 1) + (ring - 1) * self.around() + q) as u32;
        }
        match (q / n, q % n) {
            (0, i) => self.core_index(i, 0),
            (1, j) => self.core_index(n, j),
            (2, i) => self.core_index(n - i, n),
            (_, j) => self.core_index(0, n - j),
        }
    }

    fn points(&self, section: &Section, radius: f64) -> Vec<Vector2<f64>> {
        let mut points = self.core_points(section.core_fraction * radius, section.core_bulge);
        let angle = |q: usize| PI * (2.0 * q as f64 / self.around() as f64 - 0.75);
        for ring in 1..=self.rings {
            let weight = ring as f64 / self.rings as f64;
            for q in 0..self.around() {
                let (sin, cos) = angle(q).sin_cos();
                let inner = points[self.ring_index(0, q) as usize];
                points.push(inner * (1.0 - weight) + Vector2::new(cos, sin) * (radius * weight));
            }
        }
        points
    }

    /// Square of half side `half` whose sides bulge by `bulge * half` in their middle.
    fn core_points(&self, half: f64, bulge: f64) -> Vec<Vector2<f64>> {
        let n = self.side;
        let grid = |i: usize| (2.0 * i as f64 - n as f64) / n as f64;
        let point =
            |x: f64, y: f64| Vector2::new(x * (1.0 + bulge * (1.0 - y * y)), y * (1.0 + bulge * (1.0 - x * x))) * half;
        (0..=n).flat_map(|j| (0..=n).map(move |i| point(grid(i), grid(j)))).collect()
    }

    /// Connectivity, core first, then ring after ring, and the cells of the last ring.
    fn cells(&self) -> (Vec<u32>, Vec<u32>) {
        let (n, m, o) = (self.side / self.order, self.rings / self.order, self.order);
        let mut cells = Vec::new();
        for (j, i) in (0..n).flat_map(|j| (0..n).map(move |i| (j, i))) {
            cells.extend(self.local().map(|(a, b)| self.core_index(i * o + a, j * o + b)));
        }
        for (k, q) in (0..m).flat_map(|k| (0..4 * n).map(move |q| (k, q))) {
            cells.extend(self.local().map(|(a, b)| self.ring_index(k * o + a, q * o + b)));
        }
        let count = (n * (n + 4 * m)) as u32;
        (cells, (count - 4 * n as u32..count).collect())
    }

    /// Lattice steps of the nodes of one quadrilateral; in a ring the first goes outwards, the second around.
    fn local(&self) -> impl Iterator<Item = (usize, usize)> {
        let (nodes, order) = ((self.order + 1) * (self.order + 1), self.order);
        LATTICE.iter().take(nodes).map(move |&[a, b]| (a * order / 2, b * order / 2))
    }
}
