//! Errors of the kernel.

use subrope_geometry::GeometryError;
use subrope_material::LawError;

use crate::linear::LinearError;
use crate::solid::FailedPoint;

/// What went wrong. [`FemError::is_recoverable`] tells whether a shorter increment may help.
#[derive(Clone, Debug, thiserror::Error)]
pub enum FemError {
    /// A law gave no answer at an integration point.
    #[error("element {element}, integration point {point}: {source}")]
    Law {
        /// Label of the element.
        element: u64,
        /// Integration point, from 0.
        point: usize,
        /// Cause.
        source: LawError,
        /// What the law was asked.
        asked: Box<FailedPoint>,
    },
    /// The volume of an element vanished or turned inside out, so that its mean does not exist.
    #[error("element {element}: the mean volume ratio {ratio:e} is not positive: shorten the increment")]
    MeanVolume {
        /// Label of the element.
        element: u64,
        /// Mean of J over the element.
        ratio: f64,
    },
    /// A line of nodes with a bending stiffness has no direction at a node, or folds back there.
    #[error(
        "the line of nodes that bends at node {node} (from 0) folds back, or an edge of it vanished: shorten the increment; \
         at rest, give the mesh edges of some length along and across the line"
    )]
    FoldedLine {
        /// Index of the node.
        node: usize,
    },
    /// The residual holds a number that is not finite.
    #[error("the residual is not finite: shorten the increment")]
    NonFiniteResidual,
    /// An iterate has left the model by orders of magnitude: the tangent is singular but for rounding.
    #[error(
        "a node moves by {displacement:e} mm, and the model measures {extent:e} mm: nothing holds a part, or not any more; \
         hold it, or shorten the increment"
    )]
    RunsAway {
        /// Largest component of a nodal displacement \[mm\].
        displacement: f64,
        /// Diagonal of the box around the model \[mm\].
        extent: f64,
    },
    /// Surfaces touch where the pattern of the matrix has no place for them.
    #[error("surfaces touch outside the candidates of the search: search again")]
    SearchOutdated,
    /// A contribution of another crate gave no answer.
    #[error("{source}")]
    Contribution {
        /// Cause.
        source: std::sync::Arc<dyn std::error::Error + Send + Sync>,
        /// Whether a shorter increment may help.
        recoverable: bool,
    },
    /// A state cannot be taken up.
    #[error(transparent)]
    State(#[from] crate::StateError),
    /// The linear solver gave up.
    #[error(transparent)]
    Linear(#[from] LinearError),
    /// The mesh does not carry finite elements.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// Newton did not converge within its iterations.
    #[error("no convergence in {iterations} iterations (residual {residual:e}, wanted {tolerance:e})")]
    NotConverged {
        /// Iterations spent.
        iterations: usize,
        /// Relative residual reached.
        residual: f64,
        /// Relative residual wanted.
        tolerance: f64,
    },
    /// The increments became too short.
    #[error(
        "step {step}, {fraction:.6} of it done: the increment fell below {minimum:e} of the step; last cause: {cause}"
    )]
    IncrementTooShort {
        /// Name of the step.
        step: String,
        /// Converged part of the step.
        fraction: f64,
        /// Shortest increment allowed.
        minimum: f64,
        /// What failed last.
        cause: Box<FemError>,
    },
    /// An increment along a path went back on the way that the last one had come.
    #[error("the path turns back on itself near {fraction:.6} of the step")]
    TurnsBack {
        /// Where.
        fraction: f64,
    },
    /// A fixed increment failed.
    #[error(
        "step {step}, fixed increment {increment} failed: {cause}; allow automatic increments or take more of them"
    )]
    FixedIncrementFailed {
        /// Name of the step.
        step: String,
        /// Number of the increment in the step, from 1.
        increment: usize,
        /// Why.
        cause: Box<FemError>,
    },
    /// More increments than allowed.
    #[error("step {step} took the {limit} increments allowed and reached {fraction:.6} of it: raise max_count")]
    TooManyIncrements {
        /// Name of the step.
        step: String,
        /// Converged part of the step.
        fraction: f64,
        /// Limit.
        limit: usize,
    },
    /// A body can still move as a whole.
    #[error(
        "step {step}: {count} rigid motion(s) are not held: {motions}; prescribe them at a reference point or on nodes"
    )]
    RigidModes {
        /// Name of the step.
        step: String,
        /// How many.
        count: usize,
        /// What they are.
        motions: String,
    },
    /// Two sections claim a node.
    #[error("node {node} belongs to section {name} and to another section as well")]
    NodeTiedTwice {
        /// Index of the node.
        node: usize,
        /// Section that came second.
        name: String,
    },
    /// A set refers to a node that does not exist.
    #[error("{name}: there is no node with index {node}")]
    UnknownNode {
        /// Index of the node.
        node: usize,
        /// Where it is named.
        name: String,
    },
    /// An image of a node that is not free.
    #[error("node {node} is the image of node {master}, which does not move freely: take a free node")]
    ImageOfTied {
        /// Index of the image.
        node: usize,
        /// Index of its master.
        master: usize,
    },
    /// A node that does not lie where a screw puts it.
    #[error("node {node} lies {distance:.3e} mm from where the screw puts the image of node {master}")]
    NotAnImage {
        /// Index of the image.
        node: usize,
        /// Index of its master.
        master: usize,
        /// Distance \[mm\].
        distance: f64,
    },
    /// A section whose nodes lie on a line or in a point.
    #[error("the nodes of section {name} lie on one line, so that a rotation about it moves none: take more nodes")]
    DegenerateSection {
        /// Name.
        name: String,
    },
    /// A part of a section that cannot slide.
    #[error(
        "part {part} of section {name} cannot slide: it needs a direction, and nodes of that section that slide in no \
        other part"
    )]
    BadSlide {
        /// Name of the section.
        name: String,
        /// Number of the part, from 1.
        part: usize,
    },
    /// A section without nodes.
    #[error("section {name} has no nodes")]
    EmptySection {
        /// Name.
        name: String,
    },
    /// A single component of a node of a section was prescribed.
    #[error("node {node} belongs to a section: prescribe the motion of its reference point instead")]
    PrescribedTiedNode {
        /// Index of the node.
        node: usize,
    },
    /// An element with an averaged fibre elongation needs a law that has a fibre term.
    #[error("law `{law}` has no separate fibre term, so its elongation cannot be averaged: choose another element")]
    NoFibreTerm {
        /// Name of the law.
        law: &'static str,
    },
    /// The number of frames or cells does not fit the mesh.
    #[error("{what}: {found} given, {expected} needed")]
    Count {
        /// What was counted.
        what: &'static str,
        /// Given.
        found: usize,
        /// Needed.
        expected: usize,
    },
    /// The observer asked to stop.
    #[error("interrupted after a converged increment")]
    Interrupted,
    /// The observer failed (results could not be written).
    #[error("{0}")]
    Observer(String),
    /// The pool of threads could not be made.
    #[error("could not start {threads} threads")]
    Threads {
        /// How many.
        threads: usize,
    },
}

impl FemError {
    /// The point at which a law gave no answer, if that is what ended a step or an attempt: label of the element, number of
    /// the point, what it was asked, and why it has no answer.
    #[must_use]
    pub fn failed_point(&self) -> Option<(u64, usize, &FailedPoint, &LawError)> {
        match self {
            Self::Law { element, point, source, asked } => Some((*element, *point, asked, source)),
            Self::IncrementTooShort { cause, .. } | Self::FixedIncrementFailed { cause, .. } => cause.failed_point(),
            _ => None,
        }
    }

    /// Whether a shorter increment from the committed state may succeed.
    #[must_use]
    pub fn is_recoverable(&self) -> bool {
        match self {
            Self::Law { source, .. } => !matches!(source, LawError::Parameter { .. } | LawError::NoFibreTerm),
            Self::MeanVolume { .. }
            | Self::FoldedLine { .. }
            | Self::NonFiniteResidual
            | Self::RunsAway { .. }
            | Self::SearchOutdated
            | Self::Linear(_)
            | Self::TurnsBack { .. }
            | Self::NotConverged { .. } => true,
            Self::Contribution { recoverable, .. } => *recoverable,
            _ => false,
        }
    }
}
