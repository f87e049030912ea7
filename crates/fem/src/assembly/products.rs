//! The part of the tangent that is a sum of products of sparse vectors.

use nalgebra::Vector3;

use super::Equations;
use crate::contribution::Product;
use crate::kinematics::{Kinematics, NodeRule, Tie};
use crate::linear::LinearTerm;

/// Products `row column^T` in the unknowns, gathered element by element.
#[derive(Default)]
pub struct Products {
    groups: Vec<Group>,
    equations: Vec<u32>,
    /// Of every product its row and its column, one after the other.
    values: Vec<f64>,
}

/// The products of one element: all on the same unknowns.
struct Group {
    equations: std::ops::Range<usize>,
    values: usize,
    count: usize,
}

impl Products {
    /// Forgets all.
    pub fn clear(&mut self) {
        self.groups.clear();
        self.equations.clear();
        self.values.clear();
    }

    /// Adds the products of an element with some nodes, `J^T row (J^T column)^T`.
    pub fn push(
        &mut self,
        kinematics: &Kinematics,
        ties: &[Tie],
        equations: &Equations,
        nodes: &[u32],
        products: &[Product<'_>],
    ) {
        let start = self.equations.len();
        let places = Places::new(kinematics, ties, equations, nodes);
        self.equations.extend(places.0.iter().map(|p| p.equation));
        let group = Group { equations: start..self.equations.len(), values: self.values.len(), count: products.len() };
        for vector in products.iter().flat_map(|p| [p.row, p.column]) {
            self.values.extend(places.0.iter().map(|p| p.value(vector, nodes.len())));
        }
        self.groups.push(group);
    }
}

impl LinearTerm for Products {
    fn is_empty(&self) -> bool {
        self.groups.is_empty()
    }

    /// `out += sum row (column . x)`.
    fn multiply_add(&self, x: &[f64], out: &mut [f64]) {
        for group in &self.groups {
            let equations = &self.equations[group.equations.clone()];
            let n = equations.len();
            for product in self.values[group.values..group.values + 2 * group.count * n].chunks_exact(2 * n) {
                let (row, column) = product.split_at(n);
                let factor: f64 = column.iter().zip(equations).map(|(c, &e)| c * x[e as usize]).sum();
                row.iter().zip(equations).for_each(|(r, &e)| out[e as usize] += r * factor);
            }
        }
    }
}

/// One unknown that moves one node.
struct Place {
    equation: u32,
    node: usize,
    derivative: Derivative,
}

enum Derivative {
    Component(usize),
    Column(Vector3<f64>),
}

impl Place {
    fn value(&self, vector: &[f64], n: usize) -> f64 {
        match &self.derivative {
            Derivative::Component(k) => vector[k * n + self.node],
            Derivative::Column(c) => (0..3).map(|k| c[k] * vector[k * n + self.node]).sum(),
        }
    }
}

/// The unknowns of an element; one may stand for several of its nodes.
struct Places(Vec<Place>);

impl Places {
    fn new(kinematics: &Kinematics, ties: &[Tie], equations: &Equations, nodes: &[u32]) -> Self {
        let mut out = Vec::with_capacity(3 * nodes.len());
        let mut push = |coordinate: u32, node: usize, derivative: Derivative| {
            if let Some(equation) = equations.of(coordinate as usize) {
                out.push(Place { equation, node, derivative });
            }
        };
        for (node, &global) in nodes.iter().enumerate() {
            match &kinematics.rules()[global as usize] {
                NodeRule::Free { first } => {
                    (0..3).for_each(|k| push(first + k, node, Derivative::Component(k as usize)))
                }
                NodeRule::Tied { tie, .. } | NodeRule::Image { tie, .. } => {
                    ties[*tie as usize].columns().for_each(|(c, column)| push(c, node, Derivative::Column(column)));
                }
            }
        }
        Self(out)
    }
}
