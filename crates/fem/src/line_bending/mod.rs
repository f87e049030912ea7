//! Bending stiffness of lines of nodes: rods that a mesh follows, and whose bending its bricks do not know of.
//!
//! The energy of a line is that of a rod of stiffness EI, `EI/2` times the integral of the square of the change of its
//! curvature vector from rest, seen from the matter around it ([`turning`]); at an end that a rigid section clamps,
//! the half edge next to it counts as well ([`hold`]). Elastic, symmetric, objective, stress-free at rest; second
//! order in the length of the edges.

mod arms;
mod hold;
mod jet;
#[cfg(test)]
mod tests;
mod turning;

use nalgebra::Vector3;

use crate::contribution::{Configuration, Contribution, Energies, Request, Sink};
use crate::state::{StateError, StateReader, StateWriter};
use crate::{FemError, parallel};
use arms::{Incidence, Reaction, arms};
use hold::Hold;
use turning::Turning;

/// Elements evaluated before their results are scattered, in index order: sums do not depend on threads.
const BATCH: usize = 128;

/// A line of nodes with a bending stiffness.
#[derive(Clone, Debug, PartialEq)]
pub struct BendingLine {
    /// Its nodes, one after the other; three at least.
    pub nodes: Vec<u32>,
    /// Of every node of the line two nodes beside it that move with the matter there; their arms and the line are not
    /// in one plane. The first tells how the line turns with the matter.
    pub beside: Vec<[u32; 2]>,
    /// Bending stiffness EI \[N mm^2\].
    pub stiffness: f64,
    /// Whether the section of its first and of its last node is rigid and clamps it.
    pub clamped: [bool; 2],
}

/// Bending stiffness of lines of nodes, a [`Contribution`] of elements of four nodes.
///
/// A line that is curved at rest, such as a yarn in a strand, keeps that curvature when it turns with the matter. Its
/// stretching is left to the bricks: l is the length at rest.
#[derive(Clone, Debug)]
pub struct LineBending {
    nodes: Vec<[u32; 4]>,
    elements: Vec<Element>,
    /// Reference coordinates of the nodes of every element \[mm\], from its first.
    rest: Vec<[Vector3<f64>; 4]>,
    results: Vec<Reaction>,
    trial: f64,
    committed: f64,
}

/// An element.
#[derive(Clone, Copy, Debug)]
enum Element {
    Turning(Turning),
    Hold(Hold),
}

impl Element {
    fn incidence(&self) -> &'static Incidence {
        match self {
            Self::Turning(_) => &turning::INCIDENCE,
            Self::Hold(_) => &hold::INCIDENCE,
        }
    }

    fn react(&self, nodes: &[Vector3<f64>; 4], request: Request, out: &mut Reaction) {
        let arms = arms(self.incidence(), nodes);
        let energy = match self {
            Self::Turning(turning) => turning.energy(arms),
            Self::Hold(hold) => hold.energy(arms),
        };
        energy.at_nodes(self.incidence(), request == Request::Tangent, out);
    }
}

impl LineBending {
    /// Of lines through nodes at reference positions \[mm\].
    ///
    /// # Errors
    /// [`FemError::Count`] for a line of fewer than three nodes or with nodes beside that are not its own,
    /// [`FemError::UnknownNode`], [`FemError::FoldedLine`] for edges without a direction.
    pub fn new(positions: &[Vector3<f64>], lines: &[BendingLine]) -> Result<Self, FemError> {
        let mut out = Self {
            nodes: Vec::new(),
            elements: Vec::new(),
            rest: Vec::new(),
            results: Vec::new(),
            trial: 0.0,
            committed: 0.0,
        };
        lines.iter().try_for_each(|line| out.add(positions, line))?;
        out.results = vec![Reaction::NONE; BATCH.min(out.elements.len())];
        Ok(out)
    }

    /// Energy stored in bending at the committed state \[mJ\].
    #[must_use]
    pub fn stored(&self) -> f64 {
        self.committed
    }

    fn add(&mut self, positions: &[Vector3<f64>], line: &BendingLine) -> Result<(), FemError> {
        let BendingLine { nodes, beside, stiffness, clamped } = line;
        if nodes.len() < 3 {
            return Err(FemError::Count { what: "nodes of a line that bends", found: nodes.len(), expected: 3 });
        }
        if beside.len() != nodes.len() {
            return Err(FemError::Count { what: "nodes beside a line", found: beside.len(), expected: nodes.len() });
        }
        for (triple, [beside, _]) in nodes.windows(3).zip(&beside[1..]) {
            let element = |arms| Turning::new(*stiffness, arms).map(Element::Turning);
            self.push(positions, [triple[0], triple[1], triple[2], *beside], &turning::INCIDENCE, element)?;
        }
        let last = nodes.len() - 1;
        for (end, next, _) in [(0, 1, clamped[0]), (last, last - 1, clamped[1])].into_iter().filter(|end| end.2) {
            let element = |arms| Hold::new(*stiffness, arms).map(Element::Hold);
            let [first, second] = beside[end];
            self.push(positions, [nodes[end], nodes[next], first, second], &hold::INCIDENCE, element)?;
        }
        Ok(())
    }

    fn push(
        &mut self,
        positions: &[Vector3<f64>],
        nodes: [u32; 4],
        incidence: &Incidence,
        element: impl FnOnce([Vector3<f64>; 3]) -> Option<Element>,
    ) -> Result<(), FemError> {
        let mut rest = [Vector3::zeros(); 4];
        for (place, &node) in rest.iter_mut().zip(&nodes) {
            let unknown = || FemError::UnknownNode { node: node as usize, name: "line that bends".into() };
            *place = *positions.get(node as usize).ok_or_else(unknown)?;
        }
        // Differences to the first node: coordinates far from the origin lose no digits.
        let origin = rest[0];
        let rest = rest.map(|x| x - origin);
        let folded = FemError::FoldedLine { node: nodes[1] as usize };
        self.elements.push(element(arms(incidence, &rest)).ok_or(folded)?);
        self.nodes.push(nodes);
        self.rest.push(rest);
        Ok(())
    }

    fn current(&self, element: usize, displacement: &[f64]) -> [Vector3<f64>; 4] {
        let mut out = self.rest[element];
        for (x, &node) in out.iter_mut().zip(&self.nodes[element]) {
            *x += Vector3::from_column_slice(&displacement[3 * node as usize..3 * node as usize + 3]);
        }
        out
    }

    fn batch(&self, first: usize, at: &Configuration<'_>, request: Request, out: &mut [Reaction]) {
        if at.parallel && out.len() > 16 {
            let middle = out.len() / 2;
            let (left, right) = out.split_at_mut(middle);
            parallel::join(|| self.batch(first, at, request, left), || self.batch(first + middle, at, request, right));
            return;
        }
        for (i, result) in out.iter_mut().enumerate() {
            self.elements[first + i].react(&self.current(first + i, at.displacement), request, result);
        }
    }

    fn assemble_with(
        &self,
        at: &Configuration<'_>,
        request: Request,
        sink: &mut dyn Sink,
        results: &mut [Reaction],
    ) -> Result<f64, FemError> {
        let mut stored = 0.0;
        for first in (0..self.elements.len()).step_by(BATCH) {
            let count = BATCH.min(self.elements.len() - first);
            self.batch(first, at, request, &mut results[..count]);
            for (element, result) in (first..).zip(&results[..count]) {
                if !result.is_finite() {
                    return Err(FemError::FoldedLine { node: self.nodes[element][1] as usize });
                }
                stored += result.energy;
                let stiffness = (request == Request::Tangent).then_some(result.stiffness.as_flattened());
                sink.add(element, &result.force, stiffness);
            }
        }
        Ok(stored)
    }
}

impl Contribution for LineBending {
    fn element_count(&self) -> usize {
        self.nodes.len()
    }

    fn element_nodes(&self, element: usize) -> &[u32] {
        &self.nodes[element]
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
        let mut results = std::mem::take(&mut self.results);
        let outcome = self.assemble_with(configuration, request, sink, &mut results);
        self.results = results;
        self.trial = outcome?;
        Ok(Energies { stored: self.trial, potential: self.trial, ..Energies::ZERO })
    }

    fn commit(&mut self) {
        self.committed = self.trial;
    }

    fn save(&self, state: &mut dyn StateWriter) -> Result<(), StateError> {
        state.numbers("stored", 1, &mut std::iter::once(self.committed))
    }

    fn restore(&mut self, state: &dyn StateReader) -> Result<(), StateError> {
        let mut stored = [0.0];
        state.read_numbers("stored", &mut stored)?;
        [self.committed] = stored;
        Ok(())
    }

    fn as_any(&self) -> Option<&dyn std::any::Any> {
        Some(self)
    }
}
