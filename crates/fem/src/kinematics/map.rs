//! First derivatives of tied nodes, and what they make of an element's forces and stiffness.

use nalgebra::{Matrix3, Vector3};

use super::{Kinematics, NodeRule, Rotation};

/// Most coordinates that move one node: six of a reference point and one slide.
const MOST: usize = 7;

/// Derivative of a tied node's position: one column for every coordinate that moves it.
#[derive(Clone, Debug, Default)]
pub struct Tie {
    count: usize,
    coordinates: [u32; MOST],
    columns: [Vector3<f64>; MOST],
}

impl Tie {
    /// Of a node of a section: `dx = du_c - [R a] T d(omega) + R d d(rho)`.
    pub(super) fn of_section(
        first: u32,
        rotation: &Rotation,
        arm: &Vector3<f64>,
        slide: Option<(u32, Vector3<f64>, f64)>,
    ) -> Self {
        let slid = slide.map_or(*arm, |(_, direction, rho)| arm + direction * rho);
        let turning = -rotation.rotate(&slid).cross_matrix() * rotation.tangent();
        let mut out = Self::default();
        (0..3).for_each(|k| out.push(first + k, Vector3::ith(k as usize, 1.0)));
        (0..3).for_each(|k| out.push(first + 3 + k, turning.column(k as usize).into_owned()));
        if let Some((coordinate, direction, _)) = slide {
            out.push(coordinate, rotation.rotate(&direction));
        }
        out
    }

    /// Of an image: three coordinates of its master from `first`, turned, and the two of the screw.
    pub(super) fn of_image(first: u32, rotation: &Matrix3<f64>, screw: [(u32, Vector3<f64>); 2]) -> Self {
        let mut out = Self::default();
        (0..3).for_each(|k| out.push(first + k, rotation.column(k as usize).into_owned()));
        screw.into_iter().for_each(|(coordinate, column)| out.push(coordinate, column));
        out
    }

    fn push(&mut self, coordinate: u32, column: Vector3<f64>) {
        self.coordinates[self.count] = coordinate;
        self.columns[self.count] = column;
        self.count += 1;
    }

    /// Adds `J^T f`.
    pub(super) fn reduce(&self, f: &Vector3<f64>, out: &mut [f64]) {
        self.columns().for_each(|(coordinate, column)| out[coordinate as usize] += column.dot(f));
    }

    /// The coordinates that move the node, each with its column of the derivative.
    pub(crate) fn columns(&self) -> impl Iterator<Item = (u32, Vector3<f64>)> {
        self.coordinates.iter().copied().zip(self.columns.iter().copied()).take(self.count)
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
                    kinematics.points()[*point as usize].coordinates().for_each(&mut push);
                    if let Some((c, _)) = slide {
                        push(*c);
                    }
                }
                NodeRule::Image { image, .. } => {
                    tied = true;
                    kinematics.image_coordinates(*image).into_iter().for_each(&mut push);
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
    /// Derivatives of all nodes: place of the coordinate in the reduced matrix, column.
    columns: Vec<(usize, Vector3<f64>)>,
    /// Where those of every node end.
    ends: Vec<usize>,
    half: Vec<f64>,
    /// Reduced matrix, row-major in the element's coordinates.
    pub reduced: Vec<f64>,
}

impl Reduction {
    /// `J^T K J` of the nodal matrix into `reduced`. Several nodes may follow one coordinate: their shares add up.
    pub fn apply(&mut self, kinematics: &Kinematics, ties: &[Tie], nodes: &[u32], map: &ElementMap) {
        let (n, m) = (nodes.len(), map.coordinates.len());
        self.find_columns(kinematics, ties, nodes, &map.coordinates);
        self.half.clear();
        self.half.resize(3 * n * m, 0.0);
        for (line, half) in self.nodal.chunks_exact(3 * n).zip(self.half.chunks_exact_mut(m)) {
            let mut start = 0;
            for (a, &end) in self.ends.iter().enumerate() {
                let row = Vector3::new(line[a], line[n + a], line[2 * n + a]);
                self.columns[start..end].iter().for_each(|(place, column)| half[*place] += row.dot(column));
                start = end;
            }
        }
        self.reduced.clear();
        self.reduced.resize(m * m, 0.0);
        let mut start = 0;
        for (a, &end) in self.ends.iter().enumerate() {
            for (place, column) in &self.columns[start..end] {
                let target = &mut self.reduced[place * m..(place + 1) * m];
                for (k, &value) in column.iter().enumerate().filter(|(_, v)| **v != 0.0) {
                    let half = &self.half[(k * n + a) * m..(k * n + a + 1) * m];
                    target.iter_mut().zip(half).for_each(|(o, h)| *o += value * h);
                }
            }
            start = end;
        }
    }

    fn find_columns(&mut self, kinematics: &Kinematics, ties: &[Tie], nodes: &[u32], coordinates: &[u32]) {
        self.columns.clear();
        self.ends.clear();
        for &node in nodes {
            let columns = &mut self.columns;
            let mut push = |coordinate: u32, column: Vector3<f64>| {
                let place = coordinates.iter().position(|c| *c == coordinate);
                columns.extend(place.map(|place| (place, column)));
            };
            match &kinematics.rules()[node as usize] {
                NodeRule::Free { first } => (0..3).for_each(|k| push(first + k, Vector3::ith(k as usize, 1.0))),
                NodeRule::Tied { tie, .. } | NodeRule::Image { tie, .. } => {
                    ties[*tie as usize].columns().for_each(|(c, column)| push(c, column));
                }
            }
            self.ends.push(self.columns.len());
        }
    }
}
