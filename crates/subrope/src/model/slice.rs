//! The helical slice: one layer of one strand, whose images under a screw are the whole rope.

use subrope_fem::kinematics::{Image, Screw};
use subrope_geometry::{Mesh, RopeSlice};

/// What one layer of one strand stands for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SliceShape {
    /// Number n of strands.
    pub strands: usize,
    /// Layers in the length of the rope \[-\].
    pub layers: usize,
    /// Turn of a layer at rest \[rad\].
    pub angle: f64,
    /// Height of a layer at rest \[mm\].
    pub height: f64,
    /// The node that keeps the slice from moving along and about z: on the axis of the strand, where that meets the x axis.
    pub held: u32,
}

impl SliceShape {
    /// Of a layer of a rope of so many strands and layers.
    pub(super) fn new(slice: &RopeSlice, strands: usize, layers: usize) -> Self {
        let held = slice.mesh.node_sets.get("AXIS_1").and_then(|axis| axis.first()).copied().unwrap_or_default();
        Self { strands, layers, angle: slice.angle, height: slice.height, held }
    }

    /// How often the strand of the slice counts.
    #[must_use]
    pub fn copies(&self) -> f64 {
        (self.strands * self.layers) as f64
    }

    /// How often a contact with the next strand counts: two strands touch each other once, three and more in a ring.
    #[must_use]
    pub fn contact_copies(&self) -> f64 {
        let pairs = if self.strands == 2 { 1 } else { self.strands };
        (pairs * self.layers) as f64
    }
}

/// The screw of a slice: nodes on the top of the layer are images of those at its bottom.
pub(super) fn screw(shape: &SliceShape, mesh: &Mesh, name: &str) -> Screw {
    let set = |name: &str| mesh.node_sets.get(name).map_or(&[][..], Vec::as_slice);
    let image = |(&master, &node): (&u32, &u32)| Image { node, master, turn: 0.0, layer: 1 };
    let images = set("END_A_1").iter().zip(set("END_B_1")).map(image).collect();
    let share = 1.0 / shape.layers as f64;
    Screw { name: name.into(), angle: shape.angle, height: shape.height, share, images }
}
