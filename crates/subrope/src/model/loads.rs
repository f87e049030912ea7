//! Dead loads of a step as nodal forces.

use nalgebra::Vector3;
use subrope_fem::analysis::Load;
use subrope_fem::kinematics::Kinematics;
use subrope_geometry::quadrilateral::map_surface_point;
use subrope_geometry::{CellKind, Mesh, Quad4, Quad8, Quad9, Quadrilateral};

use super::{MeshModel, ModelError};
use crate::scene::{Component, LoadTarget};

/// Unit load of one component: what a factor of one does.
pub(super) fn unit_load(
    step: &str,
    target: &LoadTarget,
    component: Component,
    mesh: &MeshModel,
    kinematics: &Kinematics,
) -> Result<Load, ModelError> {
    let direction = Vector3::ith(component.index() % 3, 1.0);
    match target {
        LoadTarget::Point(name) => point_load(step, name, component, kinematics),
        LoadTarget::NodesEach(set) => Ok(nodal(mesh.node_set(set)?, &direction)),
        LoadTarget::NodesTotal(set) => {
            let nodes = mesh.node_set(set)?;
            Ok(nodal(nodes, &(direction / nodes.len() as f64)))
        }
        LoadTarget::Surface(name) => surface_load(name, &direction, &mesh.mesh),
    }
}

fn nodal(nodes: &[u32], force: &Vector3<f64>) -> Load {
    Load { nodal: nodes.iter().map(|&n| (n, *force)).collect(), coordinates: Vec::new() }
}

fn point_load(step: &str, name: &str, component: Component, kinematics: &Kinematics) -> Result<Load, ModelError> {
    if component.is_rotation() {
        return Err(ModelError::MomentLoad { step: step.into(), point: name.into() });
    }
    let index = super::steps::point(kinematics, name)?;
    let coordinate = kinematics.points()[index].first + component.index() as u32;
    Ok(Load { nodal: Vec::new(), coordinates: vec![(coordinate, 1.0)] })
}

/// `int N_a dA` times the direction, reference areas.
fn surface_load(name: &str, direction: &Vector3<f64>, mesh: &Mesh) -> Result<Load, ModelError> {
    let faces = mesh.surfaces.get(name).or_else(|| mesh.surfaces.get(&name.to_uppercase())).ok_or_else(|| {
        let available = mesh.surfaces.keys().cloned().collect();
        ModelError::UnknownSet { kind: "surface", name: name.into(), available }
    })?;
    let mut load = Load::default();
    for face in faces {
        match mesh.kind {
            CellKind::Hex8 => add_face::<Quad4, 4>(mesh, *face, direction, &mut load),
            CellKind::Hex20 | CellKind::Hex20R => add_face::<Quad8, 8>(mesh, *face, direction, &mut load),
            CellKind::Hex27 => add_face::<Quad9, 9>(mesh, *face, direction, &mut load),
        }
    }
    Ok(load)
}

fn add_face<Q: Quadrilateral<N>, const N: usize>(
    mesh: &Mesh,
    face: subrope_geometry::Face,
    direction: &Vector3<f64>,
    load: &mut Load,
) {
    let (Some(x), Some(nodes)) = (mesh.face_points::<N>(face), mesh.face_nodes(face)) else { return };
    let mut share = [0.0; N];
    for point in Q::quadrature() {
        let area = map_surface_point::<Q, N>(&x, point.xi).area_normal.norm() * point.weight;
        share.iter_mut().zip(Q::shape(point.xi)).for_each(|(s, n)| *s += area * n);
    }
    load.nodal.extend(nodes.zip(share).map(|(node, s)| (node, direction * s)));
}
