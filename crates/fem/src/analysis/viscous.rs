//! Viscous stabilisation, only when asked: dashpots on all nodes, whose energy is reported.

use crate::FemError;
use crate::contribution::{Configuration, Contribution, Energies, Request, Sink};
use crate::state::{StateError, StateReader, StateWriter};

/// Dashpots `f = c_i (u - u_n)/dt` on nodes, `c_i` a damping per node \[N s/mm\]. Only as converged as the
/// increment is short; the energy spent is part of the balance.
#[derive(Clone, Debug)]
pub struct Viscous {
    nodes: Vec<u32>,
    damping: Vec<f64>,
}

impl Viscous {
    /// Dashpots of a viscosity \[MPa s/mm^2\] times each node's share of volume \[mm^3\].
    #[must_use]
    pub fn new(viscosity: f64, node_volumes: &[f64]) -> Self {
        let nodes = (0..node_volumes.len() as u32).collect();
        Self { nodes, damping: node_volumes.iter().map(|v| v * viscosity).collect() }
    }
}

impl Contribution for Viscous {
    fn element_count(&self) -> usize {
        self.nodes.len()
    }

    fn element_nodes(&self, element: usize) -> &[u32] {
        &self.nodes[element..=element]
    }

    fn is_symmetric(&self) -> bool {
        true
    }

    fn has_potential(&self) -> bool {
        true
    }

    fn assemble(
        &mut self,
        configuration: &Configuration<'_>,
        request: Request,
        sink: &mut dyn Sink,
    ) -> Result<Energies, FemError> {
        let mut out = Energies::default();
        for (e, (&node, damping)) in self.nodes.iter().zip(&self.damping).enumerate() {
            let c = damping / configuration.time_increment;
            let at = 3 * node as usize;
            let du: [f64; 3] =
                std::array::from_fn(|k| configuration.displacement[at + k] - configuration.committed[at + k]);
            let spent = c * du.iter().map(|d| d * d).sum::<f64>();
            out.potential += 0.5 * spent;
            out.stabilising += spent;
            let stiffness = [c, 0.0, 0.0, 0.0, c, 0.0, 0.0, 0.0, c];
            sink.add(e, &du.map(|d| c * d), (request == Request::Tangent).then_some(&stiffness));
        }
        Ok(out)
    }

    fn commit(&mut self) {}

    fn save(&self, _: &mut dyn StateWriter) -> Result<(), StateError> {
        Ok(())
    }

    fn restore(&mut self, _: &dyn StateReader) -> Result<(), StateError> {
        Ok(())
    }
}
