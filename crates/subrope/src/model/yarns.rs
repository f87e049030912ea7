//! The bending stiffness of rope-yarns on the mesh lines of a strand.

use subrope_fem::{BendingLine, LineBending};
use subrope_geometry::{Mesh, NodeLines};

use super::{MeshModel, ModelError, RopeModel};
use crate::scene::{EndKind, Scene};

/// The lines of the strand with their share of the stiffness of its rope-yarns; none where the scene gives them none.
pub(super) fn bending(scene: &Scene, model: &MeshModel) -> Result<Option<LineBending>, ModelError> {
    let Some(entry) = scene.strand.as_ref().and_then(|strand| strand.yarn_bending.as_ref()) else { return Ok(None) };
    let mesh = &model.mesh;
    let NodeLines { lines, across } = mesh.node_lines().ok_or(ModelError::NoYarnLines)?;
    let clamped = ["END_A", "END_B"].map(|set| is_clamped(scene, set));
    let volumes = model.node_volumes()?;
    let per_volume = entry.yarns as f64 * entry.stiffness / volumes.iter().sum::<f64>();
    let line = |nodes: Vec<u32>| {
        let stiffness = per_volume * nodes.iter().map(|&node| volumes[node as usize]).sum::<f64>();
        let beside = beside(mesh, &nodes, &across)?;
        Some(BendingLine { nodes, beside, stiffness, clamped })
    };
    let lines = lines.into_iter().map(line).collect::<Option<Vec<_>>>().ok_or(ModelError::NoYarnLines)?;
    Ok(Some(LineBending::new(&mesh.points, &lines)?))
}

impl RopeModel {
    /// The bending stiffness of its rope-yarns, where it has one.
    #[must_use]
    pub fn yarn_bending(&self) -> Option<&LineBending> {
        let contributions = &self.analysis.model().contributions;
        contributions.iter().find_map(|contribution| contribution.as_any()?.downcast_ref())
    }
}

/// Whether a rigid end carries a section and with it the direction of the rope-yarns there.
fn is_clamped(scene: &Scene, set: &str) -> bool {
    scene.end.iter().any(|end| end.kind == EndKind::Rigid && end.set().eq_ignore_ascii_case(set))
}

/// Of every node of a line the two neighbours across it whose arms are most nearly normal to the line and to each
/// other.
fn beside(mesh: &Mesh, line: &[u32], across: &[Vec<u32>]) -> Option<Vec<[u32; 2]>> {
    let place = |node: u32| mesh.points[node as usize];
    let choose = |i: usize| {
        let along = (place(*line.get(i + 1).unwrap_or(&line[i])) - place(line[i.saturating_sub(1)])).normalize();
        let arm = |node: u32| (place(node) - place(line[i])).normalize();
        let neighbours = &across[line[i] as usize];
        let first = first_largest(neighbours, |node| along.cross(&arm(node)).norm())?;
        let normal = along.cross(&arm(first));
        let second = first_largest(neighbours, |node| normal.dot(&arm(node)).abs())?;
        Some([first, second])
    };
    (0..line.len()).map(choose).collect()
}

/// Values that differ by less are equal: which node is chosen does not hang on rounding.
const EQUAL: f64 = 1e-9;

/// The first of the nodes with the largest value.
fn first_largest(nodes: &[u32], value: impl Fn(u32) -> f64) -> Option<u32> {
    let largest = nodes.iter().map(|&node| value(node)).fold(f64::NEG_INFINITY, f64::max);
    nodes.iter().copied().find(|&node| value(node) >= largest - EQUAL)
}
