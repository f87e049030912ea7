//! What stands in the place of contact in a program without it.

use nalgebra::Vector3;
use subrope_fem::analysis::Analysis;
use subrope_fem::kinematics::Screw;

use super::{LEFT_OUT, Pair, PairLoads, PairSummary};
use crate::model::{MeshModel, ModelError, RigidBody, RopeModel};
use crate::plan::PlanPart;
use crate::scene::Scene;

#[cfg(feature = "hdf5")]
pub(crate) use field::{field, friction_work, friction_work_since};

/// A scene with contact, which the check of scenes refuses; one made by other means is refused here.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{LEFT_OUT}")]
pub struct ContactError;

/// None; a scene that has some is refused.
pub fn contacts(scene: &Scene, _: &MeshModel, _: &[RigidBody], _: &[Vector3<f64>]) -> Result<Vec<Pair>, ModelError> {
    if scene.contact.is_empty() { Ok(Vec::new()) } else { Err(ContactError.into()) }
}

/// None; a scene that has one is refused.
pub fn slice_contact(
    scene: &Scene,
    _: &MeshModel,
    _: &mut Screw,
    _: &mut Vec<Vector3<f64>>,
) -> Result<Option<Pair>, ModelError> {
    if scene.contact.is_empty() { Ok(None) } else { Err(ContactError.into()) }
}

/// Nothing touches.
pub fn is_any(_: &Analysis) -> bool {
    false
}

/// No pairs.
pub fn summaries(_: &MeshModel, _: &Analysis) -> Vec<PairSummary> {
    Vec::new()
}

/// No pairs.
pub fn loads(_: &Analysis) -> Vec<PairLoads> {
    Vec::new()
}

/// No contact, and why.
pub fn plan(_: &RopeModel) -> PlanPart {
    PlanPart::new("contact", "none").without("surfaces, search, projection", "built without the feature `contact`")
}

#[cfg(feature = "hdf5")]
mod field {
    use subrope_fem::analysis::Analysis;
    use subrope_geometry::Mesh;

    use super::super::{ContactCells, ContactField};

    /// Zero in every cell.
    pub fn field(_: ContactField, mesh: &Mesh, _: &Analysis, _: &[ContactCells]) -> Vec<f64> {
        vec![0.0; mesh.cell_count()]
    }

    /// Zero in every cell.
    pub fn friction_work_since(_: &[Vec<f64>], mesh: &Mesh, _: &Analysis, _: &[ContactCells]) -> Vec<f64> {
        vec![0.0; mesh.cell_count()]
    }

    /// No contacts.
    pub fn friction_work(_: &Analysis) -> Vec<Vec<f64>> {
        Vec::new()
    }
}
