//! Images of the strand of a helical slice, which its contact needs beside it.

use std::collections::HashMap;
use std::f64::consts::TAU;

use nalgebra::Vector3;
use subrope_contact::{Contact, ContactError, ContactOptions, Smoothing, Surface};
use subrope_fem::kinematics::{Image, Screw};
use subrope_geometry::{Face, Mesh};

use super::super::{ContactCells, Pair};
use crate::analytic::LaidStrands;
use crate::model::{MeshModel, ModelError};

/// Layers beyond the touching point that the images of a strand reach at least.
const SPARE_LAYERS: i32 = 2;
/// The same as a part of the radius of a strand.
const SPARE_LENGTH: f64 = 0.5;

/// The screw of a slice while nodes are added to it.
struct Images<'a> {
    screw: &'a mut Screw,
    /// Master and layer of every node of the mesh.
    origins: Vec<(u32, i32)>,
    /// Nodes by master, strand and layer.
    known: HashMap<(u32, u32, i32), u32>,
    apart: f64,
}

impl<'a> Images<'a> {
    /// Those of the mesh, which the screw has already.
    fn new(screw: &'a mut Screw, strands: usize, mesh: &Mesh) -> Self {
        let mut origins: Vec<(u32, i32)> = (0..mesh.point_count() as u32).map(|node| (node, 0)).collect();
        for image in &screw.images {
            origins[image.node as usize] = (image.master, image.layer);
        }
        let known = (0..).zip(&origins).map(|(node, &(master, layer))| ((master, 0, layer), node)).collect();
        Self { screw, origins, known, apart: TAU / strands as f64 }
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
    screw: &mut Screw,
    wanted: &SliceContact<'_>,
    positions: &mut Vec<Vector3<f64>>,
) -> Result<Pair, ModelError> {
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
    let mut images = Images::new(screw, shape.strands, mesh);
    let (secondary, own) = images.surface(faces, 0, 0..=0, wanted.smoothing, positions)?;
    let (primary, other) = images.surface(faces, 1, -reach..=reach, wanted.smoothing, positions)?;
    let contact = Contact::new(wanted.name, primary, secondary, positions, wanted.options)?.confined();
    Ok((Box::new(contact), ContactCells { primary: other, secondary: own }))
}
