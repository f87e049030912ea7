//! A line held in its direction by the section that it ends in.

use nalgebra::{Matrix3, Vector3};

use super::arms::{Energy, Incidence};

/// Arms from the end of a line: `e` to the next node, `d1` and `d2` to nodes of its section.
pub const INCIDENCE: Incidence = [[-1.0, 1.0, 0.0, 0.0], [-1.0, 0.0, 1.0, 0.0], [-1.0, 0.0, 0.0, 1.0]];

/// Energy of the turning of the first edge against a rigid section that it is clamped in:
///
/// ```text
/// W = EI/l |t - w|^2,   t = e/|e|,   w = A d1 + B d2 + C d1 x d2
/// ```
///
/// with `w = t` at rest and l the length of the edge there. A rigid section turns w with it, so that
/// `|t - w| = 2 sin(theta/2)`; it stands for the half edge `l/2` next to the clamp, over which a line of curvature
/// kappa turns by
/// `theta = kappa l/2`.
#[derive(Clone, Copy, Debug)]
pub struct Hold {
    /// `A`, `B`, `C`.
    weights: Vector3<f64>,
    /// `2 EI/l` \[N mm\].
    stiffness: f64,
}

impl Hold {
    /// Of a stiffness EI \[N mm^2\], stress-free at arms \[mm\]; `None` where these have no directions.
    pub fn new(bending_stiffness: f64, [edge, d1, d2]: [Vector3<f64>; 3]) -> Option<Self> {
        let basis = Matrix3::from_columns(&[d1, d2, d1.cross(&d2)]);
        let weights = basis.try_inverse()? * edge.normalize();
        let stiffness = 2.0 * bending_stiffness / edge.norm();
        (weights.iter().all(|w| w.is_finite()) && stiffness.is_finite()).then_some(Self { weights, stiffness })
    }

    /// The energy with its derivatives by the arms; not finite where the edge has no length.
    pub fn energy(&self, [edge, d1, d2]: [Vector3<f64>; 3]) -> Energy {
        let length = edge.norm();
        let direction = edge / length;
        let [a, b, c]: [f64; 3] = self.weights.into();
        let held = a * d1 + b * d2 + c * d1.cross(&d2);
        let off = held - direction;
        // Derivatives of the held direction by d1 and d2.
        let one = Matrix3::identity();
        let turns = [a * one - c * d2.cross_matrix(), b * one + c * d1.cross_matrix()];
        let k = self.stiffness;
        let mut out =
            Energy { value: 0.5 * k * off.norm_squared(), gradient: Default::default(), hessian: Default::default() };
        out.gradient.fixed_rows_mut::<3>(0).copy_from(&(-k * held));
        for (i, turn) in turns.iter().enumerate() {
            let at = 3 * (i + 1);
            out.gradient.fixed_rows_mut::<3>(at).copy_from(&(k * turn.tr_mul(&off)));
            out.couple(0, i + 1, &(-k * turn));
            out.couple(i + 1, i + 1, &(0.5 * k * turn.tr_mul(turn)));
        }
        out.couple(1, 2, &(k * (turns[0].tr_mul(&turns[1]) - c * off.cross_matrix())));
        out.through_direction(0, &direction, length);
        out
    }
}
