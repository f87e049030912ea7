//! Why a scene makes no model.

use std::path::PathBuf;

use subrope_fem::FemError;
use subrope_geometry::GeometryError;
use subrope_io::IoError;
use subrope_material::LawError;

use crate::contact::ContactError;

/// Why a scene makes no model.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// More than the memory of the machine holds.
    #[error("{what} need at least {needed_gb:.3e} GB of memory, and {available_gb:.1} GB are left")]
    TooLarge {
        /// What.
        what: String,
        /// Estimate of what it needs \[GB\].
        needed_gb: f64,
        /// What there is \[GB\].
        available_gb: f64,
    },
    /// The mesh cannot be made or is not sound.
    #[error("mesh: {0}")]
    Geometry(#[from] GeometryError),
    /// The mesh of a deck is not sound.
    #[error("deck {}: {cause}", path.display())]
    DeckMesh {
        /// The deck.
        path: PathBuf,
        /// What is wrong.
        #[source]
        cause: Box<GeometryError>,
    },
    /// The deck cannot be read.
    #[error(transparent)]
    Deck(#[from] IoError),
    /// A parameter of the law is impossible.
    #[error("law: {0}")]
    Law(#[from] LawError),
    /// The kernel refuses the model.
    #[error("{0}")]
    Fem(Box<FemError>),
    /// Surfaces that cannot be in contact, or a program without contact.
    #[error("contact: {0}")]
    Contact(#[from] ContactError),
    /// A set that does not exist.
    #[error("there is no {kind} \"{name}\"; there are: {}", available.join(", "))]
    UnknownSet {
        /// Node set, surface, reference point.
        kind: &'static str,
        /// The name asked for.
        name: String,
        /// The names there are.
        available: Vec<String>,
    },
    /// Elements without a fibre direction.
    #[error(
        "{count} element(s) of the deck have no orientation (the first is element {first}): give them a *SOLID SECTION \
         with ORIENTATION, or say fibres = {{ helix = {{ .. }} }} in [deck]"
    )]
    MissingFibres {
        /// Label of the first.
        first: u64,
        /// How many.
        count: usize,
    },
    /// The element does not fit the mesh.
    #[error("formulation \"{formulation}\" needs bricks of {needed} nodes, the mesh has {found}")]
    WrongElement {
        /// Formulation asked for.
        formulation: &'static str,
        /// Nodes it needs.
        needed: usize,
        /// Nodes of the mesh.
        found: usize,
    },
    /// An averaged elongation without a fibre term.
    #[error("formulation \"hex8_mean_elongation\" averages the fibre term of a law, and law \"{law}\" has none")]
    NoFibreTerm {
        /// The law.
        law: &'static str,
    },
    /// Rope-yarns that bend without mesh lines along them.
    #[error(
        "the mesh has no lines of nodes from end to end along the rope-yarns, which their bending stiffness needs: leave \
         out [strand.yarn_bending]"
    )]
    NoYarnLines,
    /// A minimisation was asked for, and forces have no potential.
    #[error(
        "solver.trust_region = \"always\" minimises the incremental potential of all forces, which they have not: friction grows \
         with pressure (mu_t, mu_l), or that of contacts is exact; leave mu_t and mu_l out and set contact.tangent = \
         \"symmetric\", or write trust_region = \"auto\""
    )]
    NoPotential,
    /// Branches are to be switched, and the tangent does not tell where they fork.
    #[error(
        "solver.branch = \"switch\" needs a symmetric tangent, whose pivots tell where equilibrium forks: friction grows with pressure \
         (mu_t, mu_l), or that of contacts is exact; leave mu_t and mu_l out and set contact.tangent = \"symmetric\", or write \
         branch = \"follow\""
    )]
    NoPivots,
    /// The normal of a section free in radius is not defined.
    #[error("the nodes of section \"{name}\" do not span a plane, so that they have no radius")]
    NoSectionNormal {
        /// Reference point.
        name: String,
    },
    /// A moment as a load.
    #[error(
        "step \"{step}\": a moment on reference point \"{point}\" is not available as a load; prescribe the rotation and read the moment in history.csv"
    )]
    MomentLoad {
        /// Step.
        step: String,
        /// Reference point.
        point: String,
    },
    /// A component prescribed on nodes that a reference point carries.
    #[error(
        "constraint \"{constraint}\": node {node} is carried by a reference point; prescribe the motion of that instead"
    )]
    ConstrainedSectionNode {
        /// Constraint.
        constraint: String,
        /// Label of the node.
        node: u64,
    },
    /// A motion prescribed twice.
    #[error("step \"{step}\": component {component} of node {node} is prescribed by two constraints")]
    PrescribedTwice {
        /// Step.
        step: String,
        /// Component.
        component: &'static str,
        /// Label of the node.
        node: u64,
    },
    /// A corner of a history on a path with arc lengths.
    #[error(
        "step \"{step}\": a history has a corner at {knot} of the step: increments with control = \"arc_length\" need loads and \
         motions that grow linearly from its start to its end; divide the step there"
    )]
    KnotOnArc {
        /// Step.
        step: String,
        /// Fraction of the step.
        knot: f64,
    },
    /// A corner of a history between two fixed increments.
    #[error(
        "step \"{step}\": a history has a corner at {knot} of the step, which none of {count} fixed increments ends at"
    )]
    MissedKnot {
        /// Step.
        step: String,
        /// Fraction of the step.
        knot: f64,
        /// Fixed increments.
        count: usize,
    },
}
