//! Turning of a line at a node, seen from the matter beside it.

use nalgebra::{Matrix3, SMatrix, Vector3};

use super::arms::{Energy, Incidence, Matrix9, Vector9};
use super::jet::Jet;

/// Arms between the nodes before, at and after the turn and the one beside: `e1 = b - a`, `e2 = c - b`, `d = p - b`.
pub const INCIDENCE: Incidence = [[-1.0, 1.0, 0.0, 0.0], [0.0, -1.0, 1.0, 0.0], [0.0, -1.0, 0.0, 1.0]];

/// Energy of the turning between two edges against that at rest:
///
/// ```text
/// W = EI/(2 l) |w - w_rest|^2,   w = (k.m1, k.m2),   k = 2 t1 x t2/(1 + t1.t2)
/// ```
///
/// with `t1`, `t2` the directions of the edges, `l` the mean of their lengths at rest, and `k` the curvature binormal
/// of discrete elastic rods, of length `2 tan(theta/2)` for an angle theta between the edges. What the line turns
/// about is told in the frame of the matter: `t = (t1 + t2)/|t1 + t2|`, `m1` the part normal to t of the arm d to a
/// node beside, made a unit vector, `m2 = t x m1`. With `S = 2 (1 + t1.t2)` and `U = S d.d - (t1.d + t2.d)^2` that
/// comes to
///
/// ```text
/// k.m1 = 4 det(t1, t2, d)/sqrt(S U),   k.m2 = 2 (t2.d - t1.d)/sqrt(U)
/// ```
///
/// Three nodes alone would not do where a line is curved at rest: all that is objective in them are two lengths and an
/// angle, and a change of the angle does not know of a turn out of the plane of the curve at rest.
///
/// Source of the binormal: Bergou, Wardetzky, Robinson, Audoly, Grinspun, "Discrete elastic rods", ACM Trans. Graph. 27
/// (2008) 63, equation 1.
#[derive(Clone, Copy, Debug)]
pub struct Turning {
    /// `w` at rest \[-\].
    rest: [f64; 2],
    /// `EI/l` \[N mm\].
    stiffness: f64,
}

/// Directions, lengths and what they make.
struct Shape {
    directions: [Vector3<f64>; 2],
    lengths: [f64; 2],
    beside: Vector3<f64>,
}

impl Shape {
    fn new([first, second, beside]: [Vector3<f64>; 3]) -> Self {
        let lengths = [first.norm(), second.norm()];
        Self { directions: [first / lengths[0], second / lengths[1]], lengths, beside }
    }

    /// `t1.t2`, `t1.d`, `t2.d`, `d.d`, `det(t1, t2, d)`.
    fn invariants(&self) -> [f64; 5] {
        let ([t1, t2], d) = (self.directions, self.beside);
        [t1.dot(&t2), t1.dot(&d), t2.dot(&d), d.norm_squared(), t1.cross(&t2).dot(&d)]
    }

    /// Derivatives of the invariants by t1, t2, d.
    fn gradients(&self) -> SMatrix<f64, 5, 9> {
        let ([t1, t2], d, o) = (self.directions, self.beside, Vector3::zeros());
        let rows = [[t2, t1, o], [d, o, t1], [o, d, t2], [o, o, 2.0 * d], [t2.cross(&d), d.cross(&t1), t1.cross(&t2)]];
        SMatrix::from_fn(|i, j| rows[i][j / 3][j % 3])
    }
}

/// The two components of the turning.
fn turning([cosine, p, q, square, volume]: [Jet; 5]) -> [Jet; 2] {
    let s = Jet::constant(2.0) + 2.0 * cosine;
    let along = p + q;
    let u = s * square - along * along;
    [4.0 * volume * (s * u).inverse_root(), 2.0 * (q - p) * u.inverse_root()]
}

impl Turning {
    /// Of a stiffness EI \[N mm^2\], stress-free at arms \[mm\]; `None` where these have no direction.
    pub fn new(bending_stiffness: f64, arms: [Vector3<f64>; 3]) -> Option<Self> {
        let shape = Shape::new(arms);
        let rest = turning(Jet::variables(shape.invariants())).map(|w| w.value);
        let stiffness = 2.0 * bending_stiffness / (shape.lengths[0] + shape.lengths[1]);
        (rest.iter().all(|w| w.is_finite()) && stiffness.is_finite()).then_some(Self { rest, stiffness })
    }

    /// The energy with its derivatives by the arms; not finite where the line folds back or the arm beside lies in it.
    pub fn energy(&self, arms: [Vector3<f64>; 3]) -> Energy {
        let shape = Shape::new(arms);
        let variables = Jet::variables(shape.invariants());
        let [first, second] = turning(variables);
        let change = [first - Jet::constant(self.rest[0]), second - Jet::constant(self.rest[1])];
        let energy = 0.5 * self.stiffness * (change[0] * change[0] + change[1] * change[1]);
        let gradients = shape.gradients();
        let gradient: Vector9 = gradients.tr_mul(&energy.gradient);
        let hessian: Matrix9 = gradients.tr_mul(&(energy.hessian * gradients));
        let mut out = Energy { value: energy.value, gradient, hessian };
        shape.add_second_derivatives(&energy.gradient.into(), &mut out);
        out.through_direction(0, &shape.directions[0], shape.lengths[0]);
        out.through_direction(1, &shape.directions[1], shape.lengths[1]);
        out
    }
}

impl Shape {
    /// What the second derivatives of the invariants by t1, t2, d add, each times the derivative of the energy by it.
    fn add_second_derivatives(&self, [cosine, p, q, square, volume]: &[f64; 5], out: &mut Energy) {
        let ([t1, t2], d) = (self.directions, self.beside);
        let one = Matrix3::identity();
        out.couple(0, 1, &(*cosine * one - *volume * d.cross_matrix()));
        out.couple(0, 2, &(*p * one + *volume * t2.cross_matrix()));
        out.couple(1, 2, &(*q * one - *volume * t1.cross_matrix()));
        out.couple(2, 2, &(*square * one));
    }
}
