//! First derivatives of tied nodes, and what they make of an element's forces and stiffness.

use nalgebra::{Matrix3, Vector3};

use super::{Kinematics, NodeRule, Rotation};

/// Derivative of a tied node's position: `dx = du_c + rotation d(omega) + slide d(rho)`.
#[derive(Clone, Debug, Default)]
pub struct Tie {
    first: u32,
    /// `-[R a] T`.
    rotation: Matrix3<f64>,
    /// Coordinate and current direction of the sliding motion.
    slide: Option<(u32, Vector3<f64>)>,
}

impl Tie {
    pub(super) fn new(
        first: u32,
        rotation: &Rotation,
        arm: &Vector3<f64>,
        slide: Option<(u32, Vector3<f64>, f64)>,
    ) -> Self {
        let slid = slide.map_or(*arm, |(_, direction, rho)| arm + direction * rho);
        Self {
            first,
            rotation: -rotation.rotate(&slid).cross_matrix() * rotation.tangent(),
            slide: slide.map(|(c, direction, _)| (c, rotation.rotate(&direction))),
        }
    }

    /// Adds `J^T f`.
    pub(super) fn reduce(&self, f: &Vector3<f64>, out: &mut [f64]) {
        let first = self.first as usize;
        let moment = self.rotation.transpose() * f;
        for k in 0..3 {
            out[first + k] += f[k];
            out[first + 3 + k] += moment[k];
        }
        if let Some((c, direction)) = &self.slide {
            out[*c as usize] += direction.dot(f);
        }
    }

    /// The coordinates that move the node.
    pub(crate) fn coordinates(&self) -> impl Iterator<Item = u32> {
        (self.first..self.first + 6).chain(self.slide.iter().map(|(c, _)| *c))
    }

    /// Column of the derivative that belongs to a coordinate.
    pub(crate) fn column(&self, coordinate: u32) -> Vector3<f64> {
        match coordinate.wrapping_sub(self.first) {
            k @ 0..=2 => Vector3::ith(k as usize, 1.0),
            k @ 3..=5 => self.rotation.column(k as usize - 3).into_owned(),
            _ => match &self.slide {
                Some((c, direction)) if *c == coordinate => *direction,
                _ => Vector3::zeros(),
            },
        }
    }
}

/// The coordinates that move the nodes of one element, in the order of its reduced matrix.
#[derive(Clone, Debug)]
pub struct ElementMap {
    /// Coordinates, each once.
    pub coordinates: Vec<u32>,
    /// Whether some node is tied: the reduced matrix is then not the nodal one.
    pub tied: bool,
}

impl ElementMap {
    /// Coordinates of an element's nodes.
    #[must_use]
    pub fn new(kinematics: &Kinematics, nodes: &[u32]) -> Self {
        let mut coordinates = Vec::with_capacity(3 * nodes.len());
        let mut tied = false;
        let mut push = |c: u32| {
            if !coordinates.contains(&c) {
                coordinates.push(c);
            }
        };
        for &node in nodes {
            match &kinematics.rules()[node as usize] {
                NodeRule::Free { first } => (0..3).for_each(|k| push(first + k)),
                NodeRule::Tied { point, slide, .. } => {
                    tied = true;
                    let first = kinematics.points()[*point as usize].first;
                    (0..6).for_each(|k| push(first + k));
                    if let Some((c, _)) = slide {
                        push(*c);
                    }
                }
            }
        }
        Self { coordinates, tied }
    }
}

/// Buffers to reduce the matrices of elements with tied nodes, used again from element to element.
#[derive(Clone, Debug, Default)]
pub struct Reduction {
    /// Full nodal matrix, row-major, component-major dofs: the caller fills it.
    pub nodal: Vec<f64>,
    jacobian: Vec<f64>,
    half: Vec<f64>,
    /// Reduced matrix, row-major in the element's coordinates.
    pub reduced: Vec<f64>,
}

impl Reduction {
    /// `J^T K J` of the nodal matrix into `reduced`.
    pub fn apply(&mut self, kinematics: &Kinematics, ties: &[Tie], nodes: &[u32], map: &ElementMap) {
        let (rows, m) = (3 * nodes.len(), map.coordinates.len());
        self.fill_jacobian(kinematics, ties, nodes, &map.coordinates);
        self.half.clear();
        self.half.resize(rows * m, 0.0);
        multiply_add(&self.nodal, &self.jacobian, rows, m, &mut self.half);
        self.reduced.clear();
        self.reduced.resize(m * m, 0.0);
        for (j, h) in self.jacobian.chunks_exact(m).zip(self.half.chunks_exact(m)) {
            for (line, &value) in self.reduced.chunks_exact_mut(m).zip(j) {
                if value != 0.0 {
                    line.iter_mut().zip(h).for_each(|(o, v)| *o += value * v);
                }
            }
        }
    }

    /// Row `k n + a` holds the derivative of component `k` of node `a` by the coordinates.
    fn fill_jacobian(&mut self, kinematics: &Kinematics, ties: &[Tie], nodes: &[u32], coordinates: &[u32]) {
        let (n, m) = (nodes.len(), coordinates.len());
        self.jacobian.clear();
        self.jacobian.resize(3 * n * m, 0.0);
        for (a, &node) in nodes.iter().enumerate() {
            for (c, &coordinate) in coordinates.iter().enumerate() {
                let column = match &kinematics.rules()[node as usize] {
                    NodeRule::Free { first } => match coordinate.wrapping_sub(*first) {
                        k @ 0..=2 => Vector3::ith(k as usize, 1.0),
                        _ => continue,
                    },
                    NodeRule::Tied { tie, .. } => ties[*tie as usize].column(coordinate),
                };
                for k in 0..3 {
                    self.jacobian[(k * n + a) * m + c] = column[k];
                }
            }
        }
    }
}

/// `out += matrix * right`, `matrix` square with `rows` rows, `right` with `m` columns.
fn multiply_add(matrix: &[f64], right: &[f64], rows: usize, m: usize, out: &mut [f64]) {
    for (line, target) in matrix.chunks_exact(rows).zip(out.chunks_exact_mut(m)) {
        for (&value, source) in line.iter().zip(right.chunks_exact(m)) {
            target.iter_mut().zip(source).for_each(|(o, v)| *o += value * v);
        }
    }
}
