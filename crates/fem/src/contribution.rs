//! What adds to the residual and to the tangent: one interface for solids, springs, dashpots and whatever comes.

use crate::FemError;
use crate::solid::SolidFields;
use crate::state::{StateError, StateReader, StateWriter};

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
    /// Time at the end of the increment \[s\].
    pub time: f64,
    /// Temperature \[K\].
    pub temperature: f64,
    /// Whether this is the linear first step of an increment, from the committed state: surfaces that are about to close
    /// may resist already.
    pub predicting: bool,
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
    /// Stored in the compliance of contacts; not part of `stored`.
    pub contact_stored: f64,
    /// Dissipated in this increment by friction of contacts, mid-point value.
    pub contact_friction: f64,
    /// Put in during this increment by pressing apart surfaces that overlapped at the start, mid-point value.
    pub interference: f64,
}

impl Energies {
    /// None of any kind.
    pub const ZERO: Self = Self {
        stored: 0.0,
        potential: 0.0,
        dissipated_mid: [0.0; 2],
        stabilising: 0.0,
        contact_stored: 0.0,
        contact_friction: 0.0,
        interference: 0.0,
    };
}

impl std::ops::AddAssign for Energies {
    fn add_assign(&mut self, other: Self) {
        self.stored += other.stored;
        self.potential += other.potential;
        self.dissipated_mid[0] += other.dissipated_mid[0];
        self.dissipated_mid[1] += other.dissipated_mid[1];
        self.stabilising += other.stabilising;
        self.contact_stored += other.contact_stored;
        self.contact_friction += other.contact_friction;
        self.interference += other.interference;
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

    /// Adds products `row column^T` to the stiffness of an element, beside what [`Sink::add`] got. They need not be
    /// symmetric: a few of them say what friction couples to pressure, and leave the rest symmetric.
    fn add_products(&mut self, element: usize, products: &[Product<'_>]);
}

/// A stiffness `row column^T` of one element; both vectors are component-major.
#[derive(Clone, Copy, Debug)]
pub struct Product<'a> {
    /// Forces.
    pub row: &'a [f64],
    /// Weights of the displacements.
    pub column: &'a [f64],
}

/// What a contribution says of a converged iteration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The state can be committed.
    Accepted,
    /// The contribution has moved its multipliers: iterate on.
    Augmented,
}

/// Something that adds to the residual and to the tangent.
pub trait Contribution: Send {
    /// How many elements (small dense blocks).
    fn element_count(&self) -> usize;

    /// Nodes of an element.
    fn element_nodes(&self, element: usize) -> &[u32];

    /// Whether the stiffness that it gives to [`Sink::add`] is symmetric for every input.
    fn is_symmetric(&self) -> bool;

    /// Whether its tangent has a part that it gives to [`Sink::add_products`].
    fn has_products(&self) -> bool {
        false
    }

    /// Whether its forces derive from an incremental potential once [`Contribution::freeze`] has fixed what does not.
    fn has_potential(&self) -> bool;

    /// Fixes, at the trial evaluated last, what its potential takes as given: the limit of friction, which follows the
    /// pressure. Forces at that trial are then those of the potential. Answers by how much the potential has changed.
    fn freeze(&mut self) -> f64 {
        0.0
    }

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

    /// A new attempt starts from the committed state.
    fn revert(&mut self) {}

    /// Keeps all that later increments depend on, as it is right after [`Contribution::commit`]: the committed state, and
    /// whatever else changes in a run, such as the list of elements. One that remembers nothing keeps nothing.
    ///
    /// # Errors
    /// [`StateError`].
    fn save(&self, state: &mut dyn StateWriter) -> Result<(), StateError>;

    /// Takes up what [`Contribution::save`] kept of an equal contribution; what follows is the same bit by bit.
    ///
    /// # Errors
    /// [`StateError`]; the contribution is then of no use any more.
    fn restore(&mut self, state: &dyn StateReader) -> Result<(), StateError>;

    /// Makes the list of elements fit for nodal displacements \[mm\]; says whether it has changed, so that the pattern
    /// must be made again. Only contacts have elements that come and go.
    ///
    /// # Errors
    /// A [`FemError`] when bodies have moved where no list can follow.
    fn prepare(&mut self, displacement: &[f64]) -> Result<bool, FemError> {
        let _ = displacement;
        Ok(false)
    }

    /// Looks at a converged iteration: an augmented Lagrangian moves its multipliers here.
    ///
    /// # Errors
    /// A recoverable [`FemError`] when that does not help.
    fn review(&mut self) -> Result<Verdict, FemError> {
        Ok(Verdict::Accepted)
    }

    /// Softens what sets in abruptly, by a part between 0 (as it is) and 1, until told otherwise; says whether there is anything
    /// to soften. Where Newton's method finds no way it starts from a softened model.
    fn soften(&mut self, part: f64) -> bool {
        let _ = part;
        false
    }

    /// Whether an assembly leaves out most of its elements: the places of their entries are then found on first use.
    fn is_intermittent(&self) -> bool {
        false
    }

    /// The contribution itself, for those who know its type and read its results.
    fn as_any(&self) -> Option<&dyn std::any::Any> {
        None
    }

    /// Its integration points, when it is a solid.
    fn fields(&self) -> Option<&dyn SolidFields> {
        None
    }

    /// Totals dissipated since the start by transverse and longitudinal sliding \[mJ\] (end values, as in the fields).
    fn dissipated(&self) -> [f64; 2] {
        [0.0; 2]
    }
}
