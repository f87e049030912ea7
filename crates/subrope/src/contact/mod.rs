//! Contact, as the models and runs of scenes know it: what is built with the feature `contact`, and what stands in its
//! place in a program without, where no scene has a contact.

#[cfg(not(feature = "contact"))]
mod absent;
#[cfg(feature = "contact")]
mod present;

#[cfg(not(feature = "contact"))]
pub(crate) use absent::*;
#[cfg(feature = "contact")]
pub(crate) use present::*;

use serde::Serialize;
use subrope_fem::Contribution;
use subrope_geometry::Face;

/// What a scene with contact is told by a program that is built without.
pub(crate) const LEFT_OUT: &str = "contact is left out of this program: it is built without the feature `contact`";
/// How to get it.
pub(crate) const HOW_TO_GET: &str =
    "build it in: cargo install --locked --path crates/subrope --features contact (it is in by default)";

/// A contact and the faces of its surfaces.
pub(crate) type Pair = (Box<dyn Contribution>, ContactCells);

/// Faces that the patches of a contact belong to.
#[derive(Clone, Debug, Default)]
pub struct ContactCells {
    /// Of the primary surface; none of a rigid body.
    pub primary: Vec<Face>,
    /// Of the secondary surface.
    pub secondary: Vec<Face>,
}

/// A pair of surfaces at the end of a run.
#[derive(Clone, Debug, Serialize)]
pub struct PairSummary {
    /// Name of the pair.
    pub name: String,
    /// Integration points under pressure.
    pub touching_points: usize,
    /// Reference area under pressure \[mm^2\].
    pub area_mm2: f64,
    /// Sum of the pressure over the reference area \[N\].
    pub normal_force_n: f64,
    /// Sum of the magnitude of friction traction over the reference area \[N\].
    pub friction_force_n: f64,
    /// Largest pressure \[MPa\].
    pub largest_pressure_mpa: f64,
    /// Largest penetration \[mm\].
    pub largest_penetration_mm: f64,
    /// Energy dissipated by friction, end values as in the fields \[mJ\].
    pub friction_work_mj: f64,
    /// Normal penalty \[MPa/mm\].
    pub penalty_mpa_per_mm: f64,
}

/// What the points of a pair carry.
#[derive(Debug)]
pub(crate) struct PairLoads {
    /// Name of the pair.
    pub name: String,
    /// Up to where surfaces are looked for \[mm\].
    pub reach: f64,
    /// Its integration points.
    pub points: Vec<PointLoad>,
}

/// What an integration point carries, committed state.
#[derive(Debug)]
pub(crate) struct PointLoad {
    /// Its face among those of the secondary surface.
    pub face: usize,
    /// Reference area \[mm^2\].
    pub area: f64,
    /// Pressure \[MPa\].
    pub pressure: f64,
    /// Magnitude of the traction of friction \[MPa\].
    pub friction: f64,
    /// Friction work so far \[mJ/mm^2\], end value.
    pub work: f64,
    /// Gap \[mm\], where a surface is within reach.
    pub gap: Option<f64>,
}

#[cfg(feature = "hdf5")]
/// A quantity on the cells whose faces touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactField {
    /// Smallest gap \[mm\]; the reach of the search where nothing is nearer.
    Gap,
    /// Pressure \[MPa\], mean over the face by reference area.
    Pressure,
    /// Traction of friction on the cell \[MPa\], mean over the face.
    Traction,
    /// Friction work per area \[mJ/mm^2\], mean over the face.
    FrictionWork,
    /// Slipped length \[mm\], mean over the points that have slipped.
    Slip,
}
