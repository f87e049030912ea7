//! What a step asks for.

use std::sync::Arc;

use nalgebra::Vector3;

use crate::kinematics::ReferencePoint;

/// A value as a function of the fraction of a step, 0 to 1, and of the value reached before the step.
pub type Path = Arc<dyn Fn(f64, f64) -> f64 + Send + Sync>;

/// The factor of a load as a function of the fraction of a step and of what acted before.
pub type LoadPath = Arc<dyn Fn(f64, LoadBefore) -> f64 + Send + Sync>;

/// Forces on the coordinate of a load at the start of a step; zero for loads on nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LoadBefore {
    /// Load at the start of the step \[N\].
    pub load: f64,
    /// Load and reaction together where they were largest so far \[N\].
    pub peak: f64,
}

/// The motion of one coordinate.
#[derive(Clone)]
pub struct Prescription {
    /// Coordinate.
    pub coordinate: u32,
    /// Its value \[mm or rad\] over the step.
    pub path: Path,
}

/// A dead load at factor one.
#[derive(Clone, Debug, Default)]
pub struct Load {
    /// Forces on nodes \[N\].
    pub nodal: Vec<(u32, Vector3<f64>)>,
    /// Forces on coordinates \[N\], such as the displacement of a reference point.
    pub coordinates: Vec<(u32, f64)>,
}

/// A load and its factor.
#[derive(Clone)]
pub struct StepLoad {
    /// The load at factor one.
    pub load: Load,
    /// Its factor over the step.
    pub path: LoadPath,
}

/// How a step is divided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Increments {
    /// So many equal increments, neither grown nor cut.
    Fixed(usize),
    /// Cut on failure, grown when convergence is easy. All lengths as fractions of the step, or of an arc that is measured
    /// like them.
    Automatic {
        /// What a length is.
        control: PathControl,
        /// First increment.
        initial: f64,
        /// Below this the step is given up.
        minimum: f64,
        /// Longest increment.
        maximum: f64,
        /// Most converged increments.
        max_count: usize,
    },
}

/// What an increment goes on by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PathControl {
    /// The fraction of the step.
    #[default]
    Load,
    /// Arc length along the equilibrium path: the fraction is an unknown, which may go back. For motions and loads without
    /// corners, from the start of the step to its end.
    ArcLength,
}

/// One step: motions and loads that change together.
#[derive(Clone)]
pub struct Step {
    /// Name.
    pub name: String,
    /// Duration \[s\].
    pub duration: f64,
    /// Prescribed coordinates; all others are free.
    pub prescriptions: Vec<Prescription>,
    /// Loads; those of earlier steps that go on are named again.
    pub loads: Vec<StepLoad>,
    /// Division.
    pub increments: Increments,
    /// Fractions in \]0, 1\[ at which a path has a corner, rising: automatic increments end there.
    pub knots: Vec<f64>,
}

impl Increments {
    /// Whether the fraction of the step is an unknown.
    #[must_use]
    pub fn are_arcs(&self) -> bool {
        matches!(self, Self::Automatic { control: PathControl::ArcLength, .. })
    }
}

impl Prescription {
    /// A coordinate that goes linearly from where it stands to a value \[mm or rad\].
    #[must_use]
    pub fn ramp(coordinate: u32, value: f64) -> Self {
        Self { coordinate, path: Arc::new(move |fraction, reached| reached + (value - reached) * fraction) }
    }
}

impl Step {
    /// A step of one second in which nothing is prescribed yet.
    #[must_use]
    pub fn new(name: &str, increments: Increments) -> Self {
        let (prescriptions, loads, knots) = (Vec::new(), Vec::new(), Vec::new());
        Self { name: name.into(), duration: 1.0, prescriptions, loads, increments, knots }
    }

    /// Moves a coordinate linearly from where it stands to a value \[mm or rad\]; what was said of it before is dropped.
    #[must_use]
    pub fn prescribe(mut self, coordinate: u32, value: f64) -> Self {
        self.prescriptions.retain(|p| p.coordinate != coordinate);
        self.prescriptions.push(Prescription::ramp(coordinate, value));
        self
    }

    /// Moves all coordinates of a reference point to zero, where they stand at first.
    #[must_use]
    pub fn hold(self, point: &ReferencePoint) -> Self {
        point.coordinates().fold(self, |step, coordinate| step.prescribe(coordinate, 0.0))
    }
}

/// When an increment is found as a minimum of the incremental potential within a trust region. That needs a potential and a
/// symmetric tangent: no friction that grows with pressure, no exact friction of contacts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TrustRegion {
    /// Where Newton's method fails again and again, or at the shortest of automatic increments.
    #[default]
    Auto,
    /// Never.
    Off,
    /// In every increment but those with arc lengths: only stable states are found. Without a potential as never.
    Always,
}

/// What becomes of an increment that has passed a fork of equilibrium.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BranchChoice {
    /// It stays on the branch it has come on, which is unstable from there.
    #[default]
    Follow,
    /// It leaves for the branch that forks off, if one is found. That needs a symmetric tangent, whose pivots tell.
    Switch,
}

/// Settings of the Newton iteration and of the stepping.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NewtonOptions {
    /// Largest residual over the norm of reactions and loads.
    pub force_tolerance: f64,
    /// Largest energy of a correction over the largest one of the increment.
    pub energy_tolerance: f64,
    /// Most iterations of an increment.
    pub max_iterations: usize,
    /// Whether corrections may be shortened.
    pub line_search: bool,
    /// Whether a softened model may lead the way where an increment fails and no shorter one can be tried.
    pub smoothing: bool,
    /// When the incremental potential is minimised instead.
    pub trust_region: TrustRegion,
    /// What becomes of an increment that has passed a fork of equilibrium.
    pub branch: BranchChoice,
    /// Whether the first iterate continues the last increment.
    pub extrapolate: bool,
    /// Whether large factors serve later iterates of an attempt, as the preconditioner of GMRES.
    pub keep_factors: bool,
    /// Factor on the increment after easy convergence.
    pub growth: f64,
    /// Factor on the increment after a failure.
    pub cutback: f64,
    /// Up to so many iterations count as easy.
    pub easy_iterations: usize,
    /// Temperature \[K\].
    pub temperature: f64,
}

impl Default for NewtonOptions {
    fn default() -> Self {
        Self {
            force_tolerance: 1e-8,
            energy_tolerance: 1e-9,
            max_iterations: 25,
            line_search: true,
            smoothing: true,
            trust_region: TrustRegion::Auto,
            branch: BranchChoice::Follow,
            extrapolate: true,
            keep_factors: true,
            growth: 1.5,
            cutback: 0.5,
            easy_iterations: 6,
            temperature: crate::REFERENCE_TEMPERATURE,
        }
    }
}
