//! The structured grid of nodes on the surface of a strand.

use crate::Strand;
use crate::spline::cubic_weights;
use nalgebra::Vector3;

/// Nodes on the surface of a strand: rings one above the other, closed around.
///
/// Within a ring the nodes follow each other counter-clockwise seen against the direction of the axis; rings follow
/// along the axis. The first direction times the second (around x along) points outwards.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SurfaceGrid {
    /// Nodes of a ring.
    pub around: usize,
    /// Rings; both ends are rings.
    pub levels: usize,
    /// Node indices, ring after ring.
    pub nodes: Vec<u32>,
}

impl SurfaceGrid {
    /// The node `q` (modulo `around`) of ring `level`.
    ///
    /// # Panics
    /// When `level >= self.levels`.
    #[inline]
    pub fn node(&self, level: usize, q: usize) -> u32 {
        self.nodes[level * self.around + q % self.around]
    }

    /// The nodes of one ring.
    ///
    /// # Panics
    /// When `level >= self.levels`.
    pub fn ring(&self, level: usize) -> &[u32] {
        &self.nodes[level * self.around..(level + 1) * self.around]
    }

    /// The same grid with node numbers counted from `first` instead of 0.
    #[must_use]
    pub fn shifted(&self, first: u32) -> Self {
        Self { nodes: self.nodes.iter().map(|node| node + first).collect(), ..*self }
    }

    /// Point \[mm\] of the uniform bicubic B-spline surface with the nodes as control points: `u` around, of period
    /// `around`, `v` along, counted in rings. `None` outside 1 <= v <= levels - 2, where control points are missing.
    ///
    /// `points` are the positions of all nodes of the mesh \[mm\].
    pub fn smooth_point(&self, points: &[Vector3<f64>], u: f64, v: f64) -> Option<Vector3<f64>> {
        if self.levels < 4 || !(1.0..=(self.levels - 2) as f64).contains(&v) {
            return None;
        }
        // The last ring that starts a span; v = levels - 2 is the end of its span.
        let level = (v.floor() as usize).min(self.levels - 3);
        let first = u.floor();
        let q = first.rem_euclid(self.around as f64) as usize + self.around - 1;
        let (around, along) = (cubic_weights(u - first), cubic_weights(v - level as f64));
        let mut point = Vector3::zeros();
        for (j, b) in along.into_iter().enumerate() {
            for (i, a) in around.into_iter().enumerate() {
                point += points.get(self.node(level - 1 + j, q + i) as usize)? * (a * b);
            }
        }
        Some(point)
    }
}

impl Strand {
    /// The grid of surface nodes in the numbering of [`Strand::mesh`]. 27-node bricks have their middle nodes in it:
    /// twice as many nodes around, and twice as many levels less one. 20-node bricks have only their corners in it, since
    /// their faces have no node in the middle.
    pub fn surface_grid(&self) -> SurfaceGrid {
        if self.kind.is_serendipity() {
            return self.corner_grid();
        }
        let order = self.kind.order();
        let (side, rings) = (self.section.core_cells * order, self.section.rings * order);
        let (around, levels) = (4 * side, self.layers * order + 1);
        // The outer ring comes last on every level.
        let per_level = (side + 1) * (side + 1) + around * rings;
        let ring = |level: usize| (level + 1) * per_level - around..(level + 1) * per_level;
        SurfaceGrid { around, levels, nodes: (0..levels).flat_map(ring).map(|node| node as u32).collect() }
    }

    /// The grid of the corners of 20-node bricks.
    fn corner_grid(&self) -> SurfaceGrid {
        let (n, m) = (self.section.core_cells, self.section.rings);
        let (around, levels, cells) = (4 * n, self.layers + 1, n * (n + 4 * m));
        // Levels of corners have all nodes of a section but those in the middle of its cells; those between have the corners.
        let corners = (n + 1) * (n + 1) + around * m;
        let level = (2 * n + 1) * (2 * n + 1) + 4 * around * m - cells;
        let ring = |l: usize| (0..around).map(move |q| l * (level + corners) + level - 2 * around + 2 * q);
        SurfaceGrid { around, levels, nodes: (0..levels).flat_map(ring).map(|node| node as u32).collect() }
    }
}
