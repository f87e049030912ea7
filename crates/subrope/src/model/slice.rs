//! The helical slice: one layer of one strand, whose images under a screw are the whole rope.

use std::collections::HashMap;
use std::f64::consts::TAU;

use nalgebra::Vector3;
use subrope_contact::{Contact, ContactError, ContactOptions, Smoothing, Surface};
use subrope_fem::kinematics::{Image, Screw};
use subrope_geometry::{Face, Mesh, RopeSlice};

use super::{ContactCells, MeshModel, ModelError};
use crate::analytic::LaidStrands;

/// Layers beyond the touching point that the images of a strand reach at least.
const SPARE_LAYERS: i32 = 2;
/// The same as a part of the radius of a strand.
const SPARE_LENGTH: f64 = 0.5;

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

/// The screw of a slice while nodes are added to it.
pub(super) struct Images {
    pub(super) screw: Screw,
    /// Master and layer of every node of the mesh.
    origins: Vec<(u32, i32)>,
    /// Nodes by master, strand and layer.
    known: HashMap<(u32, u32, i32), u32>,
    apart: f64,
}

impl Images {
    /// The nodes of the mesh: those on the top of the layer are images of those at its bottom.
    pub(super) fn new(shape: &SliceShape, mesh: &Mesh, name: &str) -> Self {
        let set = |name: &str| mesh.node_sets.get(name).map_or(&[][..], Vec::as_slice);
        let mut origins: Vec<(u32, i32)> = (0..mesh.point_count() as u32).map(|node| (node, 0)).collect();
        let share = 1.0 / shape.layers as f64;
        let mut screw =
            Screw { name: name.into(), angle: shape.angle, height: shape.height, share, images: Vec::new() };
        for (&master, &node) in set("END_A_1").iter().zip(set("END_B_1")) {
            origins[node as usize] = (master, 1);
            screw.images.push(Image { node, master, turn: 0.0, layer: 1 });
        }
        let known = (0..).zip(&origins).map(|(node, &(master, layer))| ((master, 0, layer), node)).collect();
        Self { screw, origins, known, apart: TAU / shape.strands as f64 }
    }

    /// The image of a node of the mesh some strands back and some layers up; made unless it is there.
    fn of(&mut self, node: u32, strand: u32, layer: i32, positions: &mut Vec<Vector3<f64>>) -> u32 {
        let (master, own) = self.origins[node as usize];
        let layer = own + layer;
        *self.known.entry((master, strand, layer)).or_insert_with(|| {
            let (node, turn) = (positions.len() as u32, -f64::from(strand) * self.apart);
            positions.push(self.screw.place(&positions[master as usize], turn, layer));
            self.screw.images.push(Image { node, master, turn, layer });
            node
        })
    }

    /// The lateral surface of a strand, from one layer to another, and the faces of the mesh that it is made of.
    fn surface(
        &mut self,
        (mesh, faces): (&Mesh, &[Face]),
        strand: u32,
        layers: std::ops::RangeInclusive<i32>,
        smoothing: Smoothing,
        positions: &mut Vec<Vector3<f64>>,
    ) -> Result<(Surface, Vec<Face>), ContactError> {
        let mut lists = Vec::new();
        // One layer more on both sides gives the spline the nodes that it needs.
        for layer in layers.start() - 1..=layers.end() + 1 {
            for face in faces {
                let nodes = mesh.face_nodes(*face).ok_or(ContactError::NoFace { cell: face.cell, face: face.face })?;
                lists.push(nodes.map(|node| self.of(node, strand, layer, positions)).collect::<Vec<u32>>());
            }
        }
        let all = Surface::of_faces(&lists, mesh.kind, smoothing)?;
        let inner = faces.len()..lists.len() - faces.len();
        let origin = faces.iter().cycle().take(inner.len()).copied().collect();
        Ok((all.part(inner), origin))
    }
}

/// How a contact of a slice is made.
pub(super) struct SliceContact<'a> {
    pub(super) name: &'a str,
    pub(super) smoothing: Smoothing,
    pub(super) options: ContactOptions,
}

/// The contact of the strand with the one before it, which is its image; as between the strands of a whole rope the second
/// of two neighbours carries the points.
pub(super) fn contact(
    model: &MeshModel,
    images: &mut Images,
    wanted: &SliceContact<'_>,
    positions: &mut Vec<Vector3<f64>>,
) -> Result<(Contact, ContactCells), ModelError> {
    let (Some(shape), Some(rope)) = (&model.slice, &model.rope) else {
        return Err(ContactError::Empty { name: wanted.name.into() }.into());
    };
    let mesh = &model.mesh;
    let lateral = mesh.surfaces.get("LATERAL_1").map_or(&[][..], Vec::as_slice);
    let radius = rope.strands.first().map_or(0.0, |s| s.radius);
    let (angle, a) = (rope.shape.lay_angle, rope.shape.helix_radius);
    let laid = LaidStrands { strands: shape.strands, lay_angle: angle, helix_radius: a, tube_radius: radius };
    // Nearest points of neighbouring axes do not lie in one plane across the rope.
    let offset = (a * angle.tan() * laid.touching_angle().sin()).abs() + SPARE_LENGTH * radius;
    let reach = (offset / shape.height).ceil() as i32 + SPARE_LAYERS;
    let faces = (mesh, lateral);
    let (secondary, own) = images.surface(faces, 0, 0..=0, wanted.smoothing, positions)?;
    let (primary, other) = images.surface(faces, 1, -reach..=reach, wanted.smoothing, positions)?;
    let contact = Contact::new(wanted.name, primary, secondary, positions, wanted.options)?.confined();
    Ok((contact, ContactCells { primary: other, secondary: own }))
}
