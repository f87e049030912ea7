//! Blocks of bricks by the name of their formulation.

use std::any::Any;

use nalgebra::Matrix3;
use subrope_fem::solid::{Full, MeanElongation, MeanVolume, SolidBlock, SolidFields, SolidMesh};
use subrope_fem::{Contribution, FemError};
use subrope_geometry::{CellKind, Hex8, Hex20, Hex20R, Hex27, Mesh};
use subrope_material::{BundleLaw, EngineeringConstants, Law, StVenantKirchhoff};

/// A brick and what it averages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Brick {
    /// Eight nodes, full integration.
    Plain,
    /// Eight nodes, mean volume ratio.
    MeanVolume,
    /// Eight nodes, mean fibre elongation.
    MeanElongation,
    /// 20 nodes, full integration.
    Serendipity,
    /// 20 nodes, 2 x 2 x 2 points.
    Reduced,
    /// 27 nodes, full integration.
    Quadratic,
}

impl Brick {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Plain, Self::MeanVolume, Self::MeanElongation, Self::Serendipity, Self::Reduced, Self::Quadratic];

    /// Kind of cell.
    #[must_use]
    pub fn kind(self) -> CellKind {
        match self {
            Self::Plain | Self::MeanVolume | Self::MeanElongation => CellKind::Hex8,
            Self::Serendipity => CellKind::Hex20,
            Self::Reduced => CellKind::Hex20R,
            Self::Quadratic => CellKind::Hex27,
        }
    }

    /// Whether a law can fill it.
    #[must_use]
    pub fn takes(self, law: &dyn Law) -> bool {
        self != Self::MeanElongation || law.has_fibre_term()
    }
}

/// A block of bricks over a whole mesh.
///
/// # Errors
/// As [`SolidBlock::new`].
pub fn brick<L: Law + 'static>(
    kind: Brick,
    mesh: &Mesh,
    frames: &[Matrix3<f64>],
    law: L,
) -> Result<Box<dyn Contribution>, FemError> {
    let solid = SolidMesh { positions: &mesh.points, cells: &mesh.cells, labels: &mesh.cell_labels, frames };
    compiled(kind, &solid, Compiled::new(law))
}

/// A law whose blocks are compiled here: a test that made its own would compile every element for its laws, which takes
/// most of a minute.
enum Compiled {
    Bundle(BundleLaw),
    Linear(StVenantKirchhoff),
    /// Any other, through a pointer.
    Other(Box<dyn Law>),
}

impl Compiled {
    fn new<L: Law + 'static>(law: L) -> Self {
        let mut law = Some(law);
        let known: &mut dyn Any = &mut law;
        if let Some(bundle) = known.downcast_mut::<Option<BundleLaw>>().and_then(Option::take) {
            return Self::Bundle(bundle);
        }
        if let Some(linear) = known.downcast_mut::<Option<StVenantKirchhoff>>().and_then(Option::take) {
            return Self::Linear(linear);
        }
        Self::Other(Box::new(law.unwrap()))
    }
}

fn compiled(kind: Brick, solid: &SolidMesh<'_>, law: Compiled) -> Result<Box<dyn Contribution>, FemError> {
    match law {
        Compiled::Bundle(law) => block(kind, solid, law),
        Compiled::Linear(law) => block(kind, solid, law),
        Compiled::Other(law) => block(kind, solid, law),
    }
}

fn block<L: Law + 'static>(kind: Brick, solid: &SolidMesh<'_>, law: L) -> Result<Box<dyn Contribution>, FemError> {
    Ok(match kind {
        Brick::Plain => Box::new(SolidBlock::<8, L, Full>::new::<Hex8>(solid, law)?),
        Brick::MeanVolume => Box::new(SolidBlock::<8, L, MeanVolume>::new::<Hex8>(solid, law)?),
        Brick::MeanElongation => Box::new(SolidBlock::<8, L, MeanElongation>::new::<Hex8>(solid, law)?),
        Brick::Serendipity => Box::new(SolidBlock::<20, L, Full>::new::<Hex20>(solid, law)?),
        Brick::Reduced => Box::new(SolidBlock::<20, L, Full>::new::<Hex20R>(solid, law)?),
        Brick::Quadratic => Box::new(SolidBlock::<27, L, Full>::new::<Hex27>(solid, law)?),
    })
}

/// The same frame at every integration point.
#[must_use]
pub fn constant_frames(mesh: &Mesh, frame: Matrix3<f64>) -> Vec<Matrix3<f64>> {
    vec![frame; mesh.cell_count() * mesh.kind.points()]
}

/// The integration points of the solid among some contributions.
#[must_use]
pub fn fields_of(contributions: &[Box<dyn Contribution>]) -> &dyn SolidFields {
    contributions.iter().find_map(|c| c.fields()).unwrap()
}

/// The orthotropic law of the races with other programs: E1 300 MPa, E2 = E3 60 MPa, G12 = G13 50 MPa, Poisson's ratios .3,
/// isotropic across.
#[must_use]
pub fn peer_law() -> StVenantKirchhoff {
    let (e1, e2, nu, g) = (300.0, 60.0, 0.3, 50.0);
    let constants = EngineeringConstants {
        e1,
        e2,
        e3: e2,
        nu12: nu,
        nu13: nu,
        nu23: nu,
        g12: g,
        g13: g,
        g23: e2 / (2.0 * (1.0 + nu)),
    };
    StVenantKirchhoff::orthotropic(&constants).unwrap()
}
