//! Rigid bodies of a scene.

use nalgebra::Vector3;
use subrope_fem::kinematics::{Section, SectionKind};
use subrope_geometry::{Axis, extent};

use super::{MeshModel, ModelError};
use crate::scene::{RigidShape, Scene};

/// Nodes of a rigid body: the origin of its frame and one node along each axis, behind those of the mesh.
#[cfg_attr(not(feature = "contact"), expect(dead_code, reason = "only its surface asks for the shape"))]
pub(crate) struct RigidBody {
    pub(crate) nodes: [u32; 4],
    pub(crate) arm: f64,
    pub(crate) shape: RigidShape,
    pub(crate) radius: f64,
}

/// Adds the frames of rigid bodies to the nodes and ties each to its reference point.
pub(super) fn rigid_bodies(
    scene: &Scene,
    mesh: &MeshModel,
    positions: &mut Vec<Vector3<f64>>,
    sections: &mut Vec<Section>,
) -> Result<Vec<RigidBody>, ModelError> {
    let arm = size(scene, mesh);
    let mut out = Vec::new();
    for rigid in &scene.rigid {
        let axis = Axis::new(Vector3::from(rigid.point), Vector3::from(rigid.axis))?;
        let first = positions.len() as u32;
        let nodes = [first, first + 1, first + 2, first + 3];
        positions.push(axis.origin());
        positions.extend([axis.reference(), axis.transverse(), axis.direction()].map(|d| axis.origin() + d * arm));
        sections.push(Section {
            name: rigid.name.clone(),
            position: axis.origin(),
            axis: axis.direction(),
            nodes: nodes.to_vec(),
            kind: SectionKind::Rigid,
        });
        out.push(RigidBody { nodes, arm, shape: rigid.shape, radius: rigid.radius.unwrap_or_default() });
    }
    Ok(out)
}

/// Radius of a generated strand, else a length that belongs to the mesh.
pub(crate) fn size(scene: &Scene, mesh: &MeshModel) -> f64 {
    scene.strand_radius().unwrap_or_else(|| 0.1 * extent(&mesh.mesh.points))
}
