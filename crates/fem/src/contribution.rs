//! What adds to the residual and to the tangent: one interface for solids, springs, dashpots and whatever comes.

use crate::FemError;
use crate::solid::SolidFields;

/// How much an assembly must produce.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Request {
    /// Forces and energies.
    Residual,
    /// Forces, energies and stiffness.
    Tangent,
}

/// Where a contribution is evaluated.
#[derive(Clone, Copy, Debug)]
pub struct Configuration<'a> {
    /// Trial nodal displacements \[mm\], three per node.
    pub displacement: &'a [f64],
    /// Displacements of the last committed state \[mm\].
    pub committed: &'a [f64],
    /// Length of the time increment \[s\].
    pub time_increment: f64,
    /// Temperature \[K\].
    pub temperature: f64,
    /// Whether the calling thread may share its work.
    pub parallel: bool,
}

/// Energies of a body or of a whole model \[mJ\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energies {
    /// Stored: elastic potential and back-stress energy.
    pub stored: f64,
    /// Incremental potential of this trial, up to a constant (meaningful when every contribution has one).
    pub potential: f64,
    /// Dissipated in this increment by transverse and longitudinal sliding, mid-point value.
    pub dissipated_mid: [f64; 2],
    /// Spent in this increment by viscous stabilisation.
    pub stabilising: f64,
}

impl std::ops::AddAssign for Energies {
    fn add_assign(&mut self, other: Self) {
        self.stored += other.stored;
        self.potential += other.potential;
        self.dissipated_mid[0] += other.dissipated_mid[0];
        self.dissipated_mid[1] += other.dissipated_mid[1];
        self.stabilising += other.stabilising;
    }
}

/// Takes the forces and the stiffness of one element.
///
/// Vectors and matrices of an element with `n` nodes are component-major: entry `k * n + a` is component `k` of node `a`;
/// matrices are row-major in that order. When the contribution is symmetric only entries with row node <= column node
/// are read.
pub trait Sink {
    /// Adds one element.
    fn add(&mut self, element: usize, force: &[f64], stiffness: Option<&[f64]>);
}

/// Something that adds to the residual and to the tangent.
pub trait Contribution: Send {
    /// How many elements (small dense blocks).
    fn element_count(&self) -> usize;

    /// Nodes of an element.
    fn element_nodes(&self, element: usize) -> &[u32];

    /// Whether its tangent is symmetric for every input.
    fn is_symmetric(&self) -> bool;

    /// Whether its forces derive from an incremental potential.
    fn has_potential(&self) -> bool;

    /// Evaluates at a trial configuration, leaving the committed state alone.
    ///
    /// # Errors
    /// A recoverable [`FemError`] when the configuration is out of reach.
    fn assemble(
        &mut self,
        configuration: &Configuration<'_>,
        request: Request,
        sink: &mut dyn Sink,
    ) -> Result<Energies, FemError>;

    /// The trial becomes the committed state.
    fn commit(&mut self);

    /// Its integration points, when it is a solid.
    fn fields(&self) -> Option<&dyn SolidFields> {
        None
    }

    /// Totals dissipated since the start by transverse and longitudinal sliding \[mJ\] (end values, as in the fields).
    fn dissipated(&self) -> [f64; 2] {
        [0.0; 2]
    }
}
