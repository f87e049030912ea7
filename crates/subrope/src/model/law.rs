//! The law of a scene, and the block of bricks that it fills.

use subrope_fem::solid::{Formulation as Element, Full, MeanElongation, MeanVolume, SolidBlock, SolidMesh};
use subrope_fem::{Contribution, FemError};
use subrope_geometry::{Hex8, Hex20, Hex20R, Hex27};
use subrope_material::Law;

use super::{MeshModel, ModelError};
use crate::scene::{self, Formulation};

/// One block of equal bricks over the whole mesh.
pub(super) fn solid(
    mesh: &MeshModel,
    law: &scene::Law,
    formulation: Formulation,
) -> Result<Box<dyn Contribution>, ModelError> {
    use scene::Law as Kind;
    if formulation == Formulation::Hex8MeanElongation && !law.has_fibre_term() {
        return Err(ModelError::NoFibreTerm { law: law.word() });
    }
    match law {
        Kind::Bundle(p) => block(mesh, crate::law::bundle(p)?, formulation),
        Kind::Orthotropic(p) => block(mesh, crate::law::orthotropic(p)?, formulation),
        // Laws for verification: a call through a pointer at every point costs less than compiling a block for each.
        other => block(mesh, crate::law::build(other)?, formulation),
    }
}

fn block<L: Law + 'static>(
    mesh: &MeshModel,
    law: L,
    formulation: Formulation,
) -> Result<Box<dyn Contribution>, ModelError> {
    let solid = SolidMesh {
        positions: &mesh.mesh.points,
        cells: &mesh.mesh.cells,
        labels: &mesh.mesh.cell_labels,
        frames: &mesh.frames,
    };
    Ok(match formulation {
        Formulation::Hex8 => hex8::<L, Full>(&solid, law)?,
        Formulation::Hex8MeanVolume => hex8::<L, MeanVolume>(&solid, law)?,
        Formulation::Hex8MeanElongation => hex8::<L, MeanElongation>(&solid, law)?,
        Formulation::Hex20 => Box::new(SolidBlock::<20, L, Full>::new::<Hex20>(&solid, law)?),
        Formulation::Hex20R => Box::new(SolidBlock::<20, L, Full>::new::<Hex20R>(&solid, law)?),
        Formulation::Hex27 => Box::new(SolidBlock::<27, L, Full>::new::<Hex27>(&solid, law)?),
    })
}

fn hex8<L: Law + 'static, F: Element<8>>(mesh: &SolidMesh<'_>, law: L) -> Result<Box<dyn Contribution>, FemError> {
    Ok(Box::new(SolidBlock::<8, L, F>::new::<Hex8>(mesh, law)?))
}
