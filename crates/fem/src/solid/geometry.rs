//! Geometry of the integration points of equal bricks.
//!
//! Gradients of shape functions by the brick's own coordinates, `dN_a/dxi_i`, are the same in all bricks; a point of a
//! brick keeps only `B = R^T J^-T`, which takes them to the fibre frame `R`: `g_j(a) = B_ji dN_a/dxi_i`.

#![allow(clippy::needless_range_loop, reason = "tensors are written by their indices, as in the formulas")]

use nalgebra::{Matrix3, Vector3};
use subrope_geometry::{GeometryError, Hexahedron, jacobian_of};
use subrope_material::lanes::MAX_LANES;

use super::kernel::NodeVector;

/// Numbers that begin on a cache line, so that no vector lies across two.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct OnLine<T>(pub(super) T);

/// One number of each point of a group.
pub(super) type Group = OnLine<[f64; MAX_LANES]>;

pub(super) const ZERO: Group = OnLine([0.0; MAX_LANES]);

/// Gradients of the shape functions by the brick's own coordinates at its integration points, `dN_a/dxi_i`.
#[derive(Clone, Debug)]
pub struct ReferenceGradients<const N: usize> {
    /// `[point][i][a]`.
    by_point: Vec<OnLine<NodeVector<N>>>,
    /// `[group][a][i][point of the group]`, the last point repeated.
    by_node: Vec<[[Group; 3]; N]>,
}

/// Geometry of [`MAX_LANES`] integration points of a brick, the last repeated where there are fewer.
#[derive(Clone, Debug)]
#[repr(C)] // In the order in which it is read.
pub struct PointGroup {
    /// Reference volumes of the points \[mm^3\].
    pub(super) volume: Group,
    /// `B = R^T J^-T` \[1/mm\].
    pub(super) to_fibre: [[Group; 3]; 3],
    /// Fibre frame, columns e1 e2 e3.
    pub(super) frame: [[Group; 3]; 3],
}

impl PointGroup {
    const ZERO: Self = Self { volume: ZERO, to_fibre: [[ZERO; 3]; 3], frame: [[ZERO; 3]; 3] };

    fn set(&mut self, lane: usize, point: &Point) {
        for i in 0..3 {
            for j in 0..3 {
                self.to_fibre[i][j].0[lane] = point.to_fibre[(i, j)];
                self.frame[i][j].0[lane] = point.frame[(i, j)];
            }
        }
        self.volume.0[lane] = point.volume;
    }
}

/// Geometry of one point.
struct Point {
    to_fibre: Matrix3<f64>,
    frame: Matrix3<f64>,
    volume: f64,
}

impl<const N: usize> ReferenceGradients<N> {
    /// At the points of a brick's rule.
    pub fn new<H: Hexahedron<N>>() -> Self {
        let by_point: Vec<_> = H::quadrature().iter().map(|point| OnLine(H::gradient(point.xi))).collect();
        let by_node = by_point.chunks(MAX_LANES).map(|points| {
            std::array::from_fn(|a| {
                std::array::from_fn(|i| OnLine(std::array::from_fn(|lane| points[lane.min(points.len() - 1)].0[i][a])))
            })
        });
        Self { by_node: by_node.collect(), by_point }
    }

    /// Points of a brick.
    #[inline(always)]
    pub fn points(&self) -> usize {
        self.by_point.len()
    }

    /// Groups of points of a brick.
    #[inline(always)]
    pub fn groups(&self) -> usize {
        self.by_node.len()
    }

    /// Adds the groups of a brick whose nodes are at `x`, with the fibre frames of its points.
    ///
    /// # Errors
    /// [`GeometryError::Inverted`] with the label.
    pub fn add_brick<H: Hexahedron<N>>(
        &self,
        x: &[Vector3<f64>; N],
        frames: &[Matrix3<f64>],
        label: u64,
        groups: &mut Vec<PointGroup>,
    ) -> Result<(), GeometryError> {
        for (number, points) in self.by_point.chunks(MAX_LANES).enumerate() {
            let mut group = PointGroup::ZERO;
            let first = number * MAX_LANES;
            for (q, gradients) in points.iter().enumerate() {
                let weight = H::quadrature()[first + q].weight;
                let point = Point::new(&gradients.0, x, (frames[first + q], weight), label)?;
                let end = if q + 1 < points.len() { q + 1 } else { MAX_LANES };
                (q..end).for_each(|lane| group.set(lane, &point));
            }
            groups.push(group);
        }
        Ok(())
    }
}

impl Point {
    fn new<const N: usize>(
        map: &NodeVector<N>,
        x: &[Vector3<f64>; N],
        (frame, weight): (Matrix3<f64>, f64),
        label: u64,
    ) -> Result<Self, GeometryError> {
        let jacobian = jacobian_of(x, map);
        let determinant = jacobian.determinant();
        let inverse = jacobian
            .try_inverse()
            .filter(|_| determinant > 0.0)
            .ok_or(GeometryError::Inverted { cell_label: label, determinant })?;
        Ok(Self { to_fibre: frame.transpose() * inverse.transpose(), frame, volume: determinant * weight })
    }
}

/// The integration points of a brick.
#[derive(Clone, Copy, Debug)]
pub struct BrickGeometry<'a, const N: usize> {
    reference: &'a ReferenceGradients<N>,
    groups: &'a [PointGroup],
}

impl<'a, const N: usize> BrickGeometry<'a, N> {
    /// The groups that [`ReferenceGradients::add_brick`] has added for a brick.
    #[must_use]
    pub fn new(reference: &'a ReferenceGradients<N>, groups: &'a [PointGroup]) -> Self {
        Self { reference, groups }
    }

    /// How many points.
    #[inline(always)]
    pub fn points(&self) -> usize {
        self.reference.points()
    }

    /// Reference volume of a point \[mm^3\].
    #[inline(always)]
    pub fn volume(&self, point: usize) -> f64 {
        self.groups[point / MAX_LANES].volume.0[point % MAX_LANES]
    }

    /// Reference volume of the brick \[mm^3\].
    #[inline(always)]
    pub fn total_volume(&self) -> f64 {
        (0..self.points()).map(|point| self.volume(point)).sum()
    }

    /// Fibre frame of a point, columns e1 e2 e3.
    pub fn frame(&self, point: usize) -> Matrix3<f64> {
        self.matrix(point, |group| &group.frame)
    }

    /// `HR`: the displacement gradient, spatial rows, fibre-frame columns.
    pub fn mixed_gradient(&self, point: usize, u: &NodeVector<N>) -> Matrix3<f64> {
        let map = &self.reference.by_point[point].0;
        let own = Matrix3::from_fn(|k, i| (0..N).map(|a| u[k][a] * map[i][a]).sum::<f64>());
        own * self.matrix(point, |group| &group.to_fibre).transpose()
    }

    fn matrix(&self, point: usize, of: impl Fn(&PointGroup) -> &[[Group; 3]; 3]) -> Matrix3<f64> {
        let numbers = of(&self.groups[point / MAX_LANES]);
        Matrix3::from_fn(|i, j| numbers[i][j].0[point % MAX_LANES])
    }

    /// The gradients `dN_a/dxi_i` of the points of a pack.
    #[inline(always)]
    pub(super) fn by_point(&self, first: usize, points: usize) -> &'a [OnLine<NodeVector<N>>] {
        &self.reference.by_point[first..first + points]
    }

    /// The gradients `dN_a/dxi_i` of the group of a point, by node.
    #[inline(always)]
    pub(super) fn by_node(&self, first: usize) -> &'a [[Group; 3]; N] {
        &self.reference.by_node[first / MAX_LANES]
    }

    /// The group of a point.
    #[inline(always)]
    pub(super) fn group(&self, first: usize) -> &'a PointGroup {
        &self.groups[first / MAX_LANES]
    }
}
