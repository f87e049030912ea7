//! One patch of a surface: positions linear in those of its nodes, x(xi) = sum N_a(xi) x_a, whatever its kind.

use nalgebra::Vector3;

use crate::spline::cubic;

/// Most nodes of a patch.
pub const PATCH_NODES: usize = 16;

/// Indices of the second derivatives 11, 12, 22 by the two coordinates.
pub const SECOND: [[usize; 2]; 2] = [[0, 1], [1, 2]];

/// Values and derivatives of the shape functions of a patch at one point.
#[derive(Clone, Debug)]
pub struct Shape {
    /// Number of nodes.
    pub n: usize,
    /// Values.
    pub value: [f64; PATCH_NODES],
    /// First derivatives.
    pub first: [[f64; PATCH_NODES]; 2],
    /// Second derivatives 11, 12, 22.
    pub second: [[f64; PATCH_NODES]; 3],
    /// Third derivatives 111, 112, 122, 222.
    pub third: [[f64; PATCH_NODES]; 4],
}

impl Shape {
    fn zero(n: usize) -> Self {
        let none = [0.0; PATCH_NODES];
        Self { n, value: none, first: [none; 2], second: [none; 3], third: [none; 4] }
    }

    /// Combination of nodal vectors with some weights.
    #[inline]
    pub fn combine(&self, weights: &[f64; PATCH_NODES], nodal: &[Vector3<f64>; PATCH_NODES]) -> Vector3<f64> {
        let mut sum = Vector3::zeros();
        for (w, x) in weights.iter().zip(nodal).take(self.n) {
            sum += x * *w;
        }
        sum
    }
}

/// Control points of a spline patch at the edge of a surface: those outside are continued linearly from the nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct Stencil {
    /// `[control point][node]`, four by four control points, first coordinate fastest.
    pub weights: Vec<[f64; PATCH_NODES]>,
    /// Number of nodes.
    pub nodes: usize,
}

/// What a patch is.
#[derive(Clone, Debug, PartialEq)]
pub enum PatchKind {
    /// Facet of four nodes, bilinear.
    Bilinear,
    /// Facet of nine nodes, biquadratic.
    Biquadratic,
    /// Uniform bicubic B-spline; without a stencil its sixteen nodes are the control points.
    Spline(Option<Box<Stencil>>),
    /// Cylinder about the third axis of a rigid frame of four nodes (origin and one node per axis, `arm` \[mm\] away):
    /// coordinates are the angle \[rad\] and the axial position \[mm\].
    Cylinder {
        /// Radius \[mm\].
        radius: f64,
        /// Distance of the nodes from the origin of the frame \[mm\].
        arm: f64,
    },
    /// Plane through the origin of such a frame, its normal the third axis: coordinates \[mm\] along the other two.
    Plane {
        /// Distance of the nodes from the origin of the frame \[mm\].
        arm: f64,
    },
}

impl PatchKind {
    /// Whether it has no edges.
    #[must_use]
    pub fn is_unbounded(&self) -> bool {
        matches!(self, Self::Cylinder { .. } | Self::Plane { .. })
    }

    /// Shape functions at `xi` with derivatives up to the third.
    #[must_use]
    pub fn shape(&self, xi: [f64; 2]) -> Shape {
        match self {
            Self::Bilinear => product(&[linear(xi[0]), linear(xi[1])], &QUAD4, 4),
            Self::Biquadratic => product(&[quadratic(xi[0]), quadratic(xi[1])], &QUAD9, 9),
            Self::Spline(stencil) => {
                let full = product(&[cubic(xi[0]), cubic(xi[1])], &GRID, 16);
                stencil.as_ref().map_or(full.clone(), |s| through(s, &full))
            }
            Self::Cylinder { radius, arm } => cylinder(radius / arm, 1.0 / arm, xi),
            Self::Plane { arm } => {
                let mut shape = Shape::zero(4);
                frame(&mut shape.value, [xi[0] / arm, xi[1] / arm, 0.0], 1.0);
                frame(&mut shape.first[0], [1.0 / arm, 0.0, 0.0], 0.0);
                frame(&mut shape.first[1], [0.0, 1.0 / arm, 0.0], 0.0);
                shape
            }
        }
    }
}

const QUAD4: [[usize; 2]; 4] = [[0, 0], [1, 0], [1, 1], [0, 1]];
const QUAD9: [[usize; 2]; 9] = [[0, 0], [2, 0], [2, 2], [0, 2], [1, 0], [2, 1], [1, 2], [0, 1], [1, 1]];
const GRID: [[usize; 2]; 16] = {
    let mut grid = [[0; 2]; 16];
    let mut k = 0;
    while k < 16 {
        grid[k] = [k % 4, k / 4];
        k += 1;
    }
    grid
};

/// Linear polynomials on -1, 1 and their derivatives, `[order][function]`.
fn linear(x: f64) -> [[f64; 4]; 4] {
    [[0.5 * (1.0 - x), 0.5 * (1.0 + x), 0.0, 0.0], [-0.5, 0.5, 0.0, 0.0], [0.0; 4], [0.0; 4]]
}

/// Quadratic polynomials on -1, 0, 1.
fn quadratic(x: f64) -> [[f64; 4]; 4] {
    [
        [0.5 * x * (x - 1.0), 1.0 - x * x, 0.5 * x * (x + 1.0), 0.0],
        [x - 0.5, -2.0 * x, x + 0.5, 0.0],
        [1.0, -2.0, 1.0, 0.0],
        [0.0; 4],
    ]
}

/// Products of functions of one coordinate each; `places` names the two functions of every node.
fn product(line: &[[[f64; 4]; 4]; 2], places: &[[usize; 2]], n: usize) -> Shape {
    let mut shape = Shape::zero(n);
    let [x, y] = line;
    for (a, &[i, j]) in places.iter().enumerate() {
        shape.value[a] = x[0][i] * y[0][j];
        shape.first[0][a] = x[1][i] * y[0][j];
        shape.first[1][a] = x[0][i] * y[1][j];
        shape.second[0][a] = x[2][i] * y[0][j];
        shape.second[1][a] = x[1][i] * y[1][j];
        shape.second[2][a] = x[0][i] * y[2][j];
        shape.third[0][a] = x[3][i] * y[0][j];
        shape.third[1][a] = x[2][i] * y[1][j];
        shape.third[2][a] = x[1][i] * y[2][j];
        shape.third[3][a] = x[0][i] * y[3][j];
    }
    shape
}

/// From control points to nodes.
fn through(stencil: &Stencil, full: &Shape) -> Shape {
    let mut shape = Shape::zero(stencil.nodes);
    let rows = |out: &mut [f64; PATCH_NODES], from: &[f64; PATCH_NODES]| {
        for (value, weights) in from.iter().zip(&stencil.weights) {
            out.iter_mut().zip(weights).for_each(|(o, w)| *o += value * w);
        }
    };
    rows(&mut shape.value, &full.value);
    (0..2).for_each(|k| rows(&mut shape.first[k], &full.first[k]));
    (0..3).for_each(|k| rows(&mut shape.second[k], &full.second[k]));
    (0..4).for_each(|k| rows(&mut shape.third[k], &full.third[k]));
    shape
}

/// Weights of the nodes of a frame for local coordinates in units of its arm; `origin` is 1 for points, 0 for vectors.
fn frame(out: &mut [f64; PATCH_NODES], [x, y, z]: [f64; 3], origin: f64) {
    out[..4].copy_from_slice(&[origin - x - y - z, x, y, z]);
}

fn cylinder(radius: f64, scale: f64, [angle, axial]: [f64; 2]) -> Shape {
    let (s, c) = angle.sin_cos();
    let mut shape = Shape::zero(4);
    frame(&mut shape.value, [radius * c, radius * s, axial * scale], 1.0);
    frame(&mut shape.first[0], [-radius * s, radius * c, 0.0], 0.0);
    frame(&mut shape.first[1], [0.0, 0.0, scale], 0.0);
    frame(&mut shape.second[0], [-radius * c, -radius * s, 0.0], 0.0);
    frame(&mut shape.third[0], [radius * s, -radius * c, 0.0], 0.0);
    shape
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_agree_with_differences() {
        let h = 1e-5;
        let kinds = [
            PatchKind::Bilinear,
            PatchKind::Biquadratic,
            PatchKind::Spline(None),
            PatchKind::Cylinder { radius: 2.0, arm: 3.0 },
            PatchKind::Plane { arm: 2.0 },
        ];
        for kind in kinds {
            let at = |x: f64, y: f64| kind.shape([x, y]);
            let shape = at(0.3, -0.4);
            let steps = [(at(0.3 + h, -0.4), at(0.3 - h, -0.4)), (at(0.3, -0.4 + h), at(0.3, -0.4 - h))];
            assert!((shape.value.iter().sum::<f64>() - 1.0).abs() < 1e-14);
            for a in 0..shape.n {
                for (k, (up, down)) in steps.iter().enumerate() {
                    let slope = |u: f64, d: f64| (u - d) / (2.0 * h);
                    assert!((slope(up.value[a], down.value[a]) - shape.first[k][a]).abs() < 1e-9);
                    for (m, &at) in SECOND[k].iter().enumerate() {
                        let second = shape.second[at][a];
                        assert!((slope(up.first[m][a], down.first[m][a]) - second).abs() < 1e-9, "{kind:?}");
                    }
                    for m in 0..3 {
                        let third = shape.third[k + m][a];
                        assert!((slope(up.second[m][a], down.second[m][a]) - third).abs() < 1e-9, "{kind:?}");
                    }
                }
            }
        }
    }
}
