//! Newton's method and the choice of increments.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Newton's method and the choice of increments. Every key has a default.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Solver {
    /// Converged when the residual force is below this fraction of the largest force at work \[-\].
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 1))]
    pub residual_tolerance: f64,
    /// Also required: the work of the residual on the last correction below this fraction of the work of the first
    /// correction of the increment \[-\].
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 1))]
    pub energy_tolerance: f64,
    /// Iterations before the increment is cut \[-\].
    #[schemars(range(min = 1))]
    pub max_iterations: usize,
    /// "auto": a line search when a full correction does not improve; on the energy where there is one. "off": full
    /// corrections always.
    pub line_search: LineSearch,
    /// "auto": where an increment fails and no shorter one can be tried (`fixed`, `minimum`), contacts are softened
    /// and Newton's method goes on from the state found with less and less of that, to none. "off": never. Not with
    /// an augmented Lagrangian.
    pub smoothing: Smoothing,
    /// Minimisation of the incremental potential within a trust region, which ends in a stable state; possible without
    /// friction that grows with pressure (`mu_t`, `mu_l`) and with `contact.friction = 0` or `contact.tangent =
    /// "symmetric"`. "auto": where Newton's method fails again and again, or at the shortest of automatic increments.
    /// "off": never. "always": in every increment, refused
    /// where it is not possible.
    pub trust_region: TrustRegion,
    /// Where equilibrium forks and the branch becomes unstable, "follow": go on along it; "switch": leave for the
    /// branch that forks off. That needs a symmetric tangent (no `mu_t`, `mu_l`; `contact.friction = 0` or
    /// `contact.tangent = "symmetric"`).
    pub branch: BranchChoice,
    /// Start each increment from the extrapolated last one.
    pub extrapolate: bool,
    /// Let large factors serve later iterations of an increment as the preconditioner of GMRES, where that costs less
    /// than new ones.
    pub keep_factors: bool,
    /// Factor of the next increment after quick convergence \[-\], at least 1.
    #[schemars(range(min = 1.0))]
    pub growth: f64,
    /// Factor of an increment that failed \[-\], between 0 and 1.
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 1))]
    pub cutback: f64,
    /// Artificial damping, off when left out. Its work is reported with the energies.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stabilisation: Option<Stabilisation>,
    /// Threads \[-\]; all cores when left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1))]
    pub threads: Option<usize>,
}

impl Default for Solver {
    fn default() -> Self {
        Self {
            residual_tolerance: 1e-8,
            energy_tolerance: 1e-10,
            max_iterations: 20,
            line_search: LineSearch::Auto,
            smoothing: Smoothing::Auto,
            trust_region: TrustRegion::Auto,
            branch: BranchChoice::Follow,
            extrapolate: true,
            keep_factors: true,
            growth: 1.5,
            cutback: 0.5,
            stabilisation: None,
            threads: None,
        }
    }
}

/// When to search along a correction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LineSearch {
    /// When a full correction does not improve.
    Auto,
    /// Never.
    Off,
}

/// What to do where equilibrium forks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum BranchChoice {
    /// Stay on the branch.
    Follow,
    /// Leave for the other.
    Switch,
}

/// When to go by way of softened contacts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Smoothing {
    /// Where nothing shorter can be tried.
    Auto,
    /// Never.
    Off,
}

/// When to minimise the incremental potential.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TrustRegion {
    /// Where Newton's method fails again and again, or at the shortest of automatic increments.
    Auto,
    /// Never.
    Off,
    /// In every increment.
    Always,
}

/// Artificial damping against sudden jumps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Stabilisation {
    /// Damping force per velocity and volume \[N s/mm^4\].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub viscosity: f64,
}
