//! Energies of three arms, vectors between the four nodes of an element, and their way to the nodes.

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

/// Derivatives by the components of three vectors.
pub type Vector9 = SVector<f64, 9>;
/// Second derivatives by the components of three vectors.
pub type Matrix9 = SMatrix<f64, 9, 9>;

/// An energy \[mJ\] with its derivatives by three vectors, one after the other.
#[derive(Clone, Copy, Debug)]
pub struct Energy {
    /// Value \[mJ\].
    pub value: f64,
    /// First derivatives.
    pub gradient: Vector9,
    /// Second derivatives.
    pub hessian: Matrix9,
}

/// Which node takes part in which arm with which sign: rows are arms, columns nodes.
pub type Incidence = [[f64; 4]; 3];

/// What an element gives: component-major, as [`Sink::add`](crate::Sink::add) takes it.
#[derive(Clone, Copy, Debug)]
pub struct Reaction {
    /// Energy \[mJ\].
    pub energy: f64,
    /// Forces \[N\], entry `4 k + a` is component k at node a.
    pub force: [f64; 12],
    /// Stiffness \[N/mm\].
    pub stiffness: [[f64; 12]; 12],
}

impl Reaction {
    /// Nothing.
    pub const NONE: Self = Self { energy: 0.0, force: [0.0; 12], stiffness: [[0.0; 12]; 12] };

    /// Whether all of it is finite.
    pub fn is_finite(&self) -> bool {
        self.energy.is_finite() && self.force.iter().all(|f| f.is_finite())
    }
}

/// The arms between four nodes.
pub fn arms(incidence: &Incidence, nodes: &[Vector3<f64>; 4]) -> [Vector3<f64>; 3] {
    incidence.map(|signs| signs.iter().zip(nodes).map(|(sign, x)| *sign * x).sum())
}

impl Energy {
    /// Passes on from the direction `t = e/|e|`, the vector number `arm`, to `e` itself:
    ///
    /// ```text
    /// dt = P de/|e|,   P = 1 - t t
    /// g.d2t = -(P g t + t P g + (t.g) P)/|e|^2
    /// ```
    pub fn through_direction(&mut self, arm: usize, direction: &Vector3<f64>, length: f64) {
        let projector = Matrix3::identity() - direction * direction.transpose();
        let turn = projector / length;
        let at = 3 * arm;
        let gradient: Vector3<f64> = self.gradient.fixed_rows::<3>(at).into_owned();
        let across = projector * gradient;
        let mixed = across * direction.transpose();
        let curved = -(mixed + mixed.transpose() + direction.dot(&gradient) * projector) / (length * length);
        self.gradient.fixed_rows_mut::<3>(at).copy_from(&(turn * gradient));
        let rows = turn * self.hessian.fixed_rows::<3>(at);
        self.hessian.fixed_rows_mut::<3>(at).copy_from(&rows);
        let columns = self.hessian.fixed_columns::<3>(at) * turn;
        self.hessian.fixed_columns_mut::<3>(at).copy_from(&columns);
        let mut own = self.hessian.fixed_view_mut::<3, 3>(at, at);
        own += curved;
    }

    /// Adds a block of second derivatives and its mirror image.
    pub fn couple(&mut self, first: usize, second: usize, block: &Matrix3<f64>) {
        let mut upper = self.hessian.fixed_view_mut::<3, 3>(3 * first, 3 * second);
        upper += block;
        let mut lower = self.hessian.fixed_view_mut::<3, 3>(3 * second, 3 * first);
        lower += block.transpose();
    }

    /// Forces and stiffness of the nodes.
    pub fn at_nodes(&self, incidence: &Incidence, with_stiffness: bool, out: &mut Reaction) {
        *out = Reaction { energy: self.value, ..Reaction::NONE };
        for (i, own) in incidence.iter().enumerate() {
            for (k, a) in components() {
                out.force[4 * k + a] += own[a] * self.gradient[3 * i + k];
            }
        }
        if !with_stiffness {
            return;
        }
        for (i, own) in incidence.iter().enumerate() {
            for (j, other) in incidence.iter().enumerate() {
                for (k, a) in components().filter(|&(_, a)| own[a] != 0.0) {
                    for (m, b) in components() {
                        out.stiffness[4 * k + a][4 * m + b] += own[a] * other[b] * self.hessian[(3 * i + k, 3 * j + m)];
                    }
                }
            }
        }
    }
}

/// Components and nodes in the order of a component-major vector.
fn components() -> impl Iterator<Item = (usize, usize)> {
    (0..3).flat_map(|k| (0..4).map(move |a| (k, a)))
}
