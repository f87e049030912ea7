//! Vectors of an increment, allocated once per system.

use super::factors::KeptFactors;
use crate::Energies;

/// A point of the iteration with everything evaluated there.
#[derive(Clone, Debug, Default)]
pub struct Iterate {
    /// Coordinates.
    pub q: Vec<f64>,
    /// Nodal displacements \[mm\].
    pub displacement: Vec<f64>,
    /// Generalised residual of all coordinates.
    pub residual: Vec<f64>,
    /// Energies of the contributions.
    pub energies: Energies,
    /// Incremental potential less the work of dead loads \[mJ\].
    pub potential: f64,
    /// Scaled norm of the residual of the unknowns.
    pub norm: f64,
    /// Scaled norm of reactions and loads: what the residual is measured against.
    pub reference: f64,
}

impl Iterate {
    pub fn new(coordinates: usize, nodes: usize) -> Self {
        Self {
            q: vec![0.0; coordinates],
            displacement: vec![0.0; 3 * nodes],
            residual: vec![0.0; coordinates],
            ..Self::default()
        }
    }
}

/// Loads and prescribed values at the end of an increment.
#[derive(Clone, Debug, Default)]
pub struct Target {
    /// Prescribed coordinates and their values.
    pub prescribed: Vec<(u32, f64)>,
    /// Dead nodal forces \[N\].
    pub nodal: Vec<f64>,
    /// Dead forces on coordinates.
    pub coordinates: Vec<f64>,
    /// Length of the increment \[s\].
    pub time_increment: f64,
}

/// Buffers of the iteration.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    /// Where the iteration stands.
    pub base: Iterate,
    /// Where it tries to go.
    pub trial: Iterate,
    /// Loads and motions aimed at.
    pub target: Target,
    /// Right-hand side and correction of the unknowns.
    pub rhs: Vec<f64>,
    /// Correction.
    pub correction: Vec<f64>,
    /// Displacements of a jump of the prescribed coordinates.
    pub jump: Vec<f64>,
    /// The factors at hand.
    pub factors: KeptFactors,
}

impl Workspace {
    /// Buffers for a model of so many coordinates, nodes and unknowns.
    pub fn new(coordinates: usize, nodes: usize, unknowns: usize) -> Self {
        Self {
            base: Iterate::new(coordinates, nodes),
            trial: Iterate::new(coordinates, nodes),
            target: Target {
                prescribed: Vec::new(),
                nodal: vec![0.0; 3 * nodes],
                coordinates: vec![0.0; coordinates],
                time_increment: 0.0,
            },
            rhs: vec![0.0; unknowns],
            correction: vec![0.0; unknowns],
            jump: vec![0.0; 3 * nodes],
            factors: KeptFactors::default(),
        }
    }
}
