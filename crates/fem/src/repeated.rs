//! Many equal copies of a contribution of which one is computed.

use crate::FemError;
use crate::contribution::{Configuration, Contribution, Energies, Product, Request, Sink, Verdict};
use crate::solid::SolidFields;
use crate::state::{StateError, StateReader, StateWriter};

/// A contribution that counts several times: forces, stiffness, energies and what it has dissipated are so many times its
/// own, and with them reactions and the balance of energy. What it tells of its points and elements is that of one copy.
///
/// Parts of a copy are allowed: a slice of a rope stands for length over height of them.
pub struct Repeated {
    inner: Box<dyn Contribution>,
    times: f64,
    forces: Vec<f64>,
    stiffness: Vec<f64>,
}

impl Repeated {
    /// `times` copies of a contribution.
    #[must_use]
    pub fn new(inner: Box<dyn Contribution>, times: f64) -> Self {
        Self { inner, times, forces: Vec::new(), stiffness: Vec::new() }
    }
}

impl std::ops::Mul<f64> for Energies {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self {
            stored: factor * self.stored,
            potential: factor * self.potential,
            dissipated_mid: self.dissipated_mid.map(|d| factor * d),
            stabilising: factor * self.stabilising,
            contact_stored: factor * self.contact_stored,
            contact_friction: factor * self.contact_friction,
            interference: factor * self.interference,
        }
    }
}

/// Hands on everything so many times.
struct Multiplier<'a> {
    sink: &'a mut dyn Sink,
    times: f64,
    forces: &'a mut Vec<f64>,
    stiffness: &'a mut Vec<f64>,
}

fn scale(from: &[f64], times: f64, into: &mut Vec<f64>) {
    into.clear();
    into.extend(from.iter().map(|v| times * v));
}

impl Sink for Multiplier<'_> {
    fn add(&mut self, element: usize, force: &[f64], stiffness: Option<&[f64]>) {
        scale(force, self.times, self.forces);
        if let Some(matrix) = stiffness {
            scale(matrix, self.times, self.stiffness);
        }
        let matrix = stiffness.map(|_| self.stiffness.as_slice());
        self.sink.add(element, self.forces, matrix);
    }

    fn add_products(&mut self, element: usize, products: &[Product<'_>]) {
        self.forces.clear();
        products.iter().for_each(|p| self.forces.extend(p.row.iter().map(|v| self.times * v)));
        let Some(n) = products.first().map(|p| p.row.len()) else { return };
        let rows = self.forces.chunks_exact(n);
        let scaled: Vec<_> = rows.zip(products).map(|(row, p)| Product { row, column: p.column }).collect();
        self.sink.add_products(element, &scaled);
    }
}

impl Contribution for Repeated {
    fn element_count(&self) -> usize {
        self.inner.element_count()
    }

    fn element_nodes(&self, element: usize) -> &[u32] {
        self.inner.element_nodes(element)
    }

    fn is_symmetric(&self) -> bool {
        self.inner.is_symmetric()
    }

    fn has_products(&self) -> bool {
        self.inner.has_products()
    }

    fn has_potential(&self) -> bool {
        self.inner.has_potential()
    }

    fn freeze(&mut self) -> f64 {
        self.times * self.inner.freeze()
    }

    fn assemble(
        &mut self,
        configuration: &Configuration<'_>,
        request: Request,
        sink: &mut dyn Sink,
    ) -> Result<Energies, FemError> {
        let Self { inner, times, forces, stiffness } = self;
        let mut multiplier = Multiplier { sink, times: *times, forces, stiffness };
        Ok(inner.assemble(configuration, request, &mut multiplier)? * *times)
    }

    fn commit(&mut self) {
        self.inner.commit();
    }

    fn revert(&mut self) {
        self.inner.revert();
    }

    fn save(&self, state: &mut dyn StateWriter) -> Result<(), StateError> {
        self.inner.save(state)
    }

    fn restore(&mut self, state: &dyn StateReader) -> Result<(), StateError> {
        self.inner.restore(state)
    }

    fn prepare(&mut self, displacement: &[f64]) -> Result<bool, FemError> {
        self.inner.prepare(displacement)
    }

    fn review(&mut self) -> Result<Verdict, FemError> {
        self.inner.review()
    }

    fn soften(&mut self, part: f64) -> bool {
        self.inner.soften(part)
    }

    fn is_intermittent(&self) -> bool {
        self.inner.is_intermittent()
    }

    fn as_any(&self) -> Option<&dyn std::any::Any> {
        self.inner.as_any()
    }

    fn fields(&self) -> Option<&dyn SolidFields> {
        self.inner.fields()
    }

    fn dissipated(&self) -> [f64; 2] {
        self.inner.dissipated().map(|d| self.times * d)
    }
}
