//! The laws of a contact point: normal pressure and Coulomb friction, per reference area.

use nalgebra::{Matrix2, Vector2, Vector3};

use crate::foot::Local;
use crate::patch::SECOND;

/// Pressure `p = <lambda - eps g>` \[MPa\] and its slope `dp/dg`.
#[must_use]
pub fn pressure(multiplier: f64, penalty: f64, gap: f64) -> (f64, f64) {
    let p = multiplier - penalty * gap;
    if p > 0.0 { (p, -penalty) } else { (0.0, 0.0) }
}

/// What friction needs to know of the committed state: all vectors stand in the committed configuration, so that a rigid
/// motion of the pair slips nothing.
#[derive(Clone, Debug)]
pub struct Slip<'a> {
    /// Surface at the present foot, committed configuration.
    pub local: &'a Local,
    /// Way on the surface from the committed foot to the present one \[mm\].
    pub way: Vector3<f64>,
    /// Elastic slip carried over \[mm\].
    pub elastic: Vector3<f64>,
    /// Part of the way that was gone in contact, and its derivative by the gap (a point that closes within the increment).
    pub share: (f64, f64),
}

/// Friction of a point and its derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    /// Covariant traction `t_i = t . A_i`.
    pub traction: Vector2<f64>,
    /// `dt_i/dxi_j`.
    pub by_place: Matrix2<f64>,
    /// `dt_i/dg`.
    pub by_gap: Vector2<f64>,
    /// Magnitude of the traction \[MPa\].
    pub magnitude: f64,
    /// Elastic slip left, contravariant.
    pub elastic: Vector2<f64>,
    /// Energy of the elastic slip \[mJ/mm^2\].
    pub stored: f64,
    /// Length slipped \[mm\].
    pub slipped: f64,
}

/// Coulomb's law with an elastic slip: trial `T_i = eps_t A_i . (s_e + share way)`; it sticks while `|T| <= mu p`, else
/// `t = mu p T/|T|`. Norms by the metric of the committed configuration.
///
/// Closed-form return; the derivatives are those of this update.
#[must_use]
pub fn friction(slip: &Slip<'_>, penalty: f64, coefficient: f64, (p, slope): (f64, f64)) -> Friction {
    let a = &slip.local.tangents;
    let (share, share_slope) = slip.share;
    let total = slip.elastic + slip.way * share;
    let trial = Vector2::new(a[0].dot(&total), a[1].dot(&total)) * penalty;
    let by_way = Vector2::new(a[0].dot(&slip.way), a[1].dot(&slip.way)) * (penalty * share_slope);
    let metric = slip.local.metric();
    let trial_slope =
        Matrix2::from_fn(|i, j| penalty * (total.dot(&slip.local.second[SECOND[i][j]]) + share * metric[(i, j)]));
    let dual = metric.try_inverse().unwrap_or_else(Matrix2::zeros);
    let raised = dual * trial;
    let norm = trial.dot(&raised).max(0.0).sqrt();
    let limit = coefficient * p;
    if norm <= limit {
        return Friction {
            traction: trial,
            by_place: trial_slope,
            by_gap: by_way,
            magnitude: norm,
            elastic: raised / penalty,
            stored: 0.5 * norm * norm / penalty,
            slipped: 0.0,
        };
    }
    let direction = trial / norm;
    // d|T|/dxi_k: the metric changes with the place too.
    let metric_change = |k: usize| -> f64 {
        let change = |i: usize, j: usize| {
            slip.local.second[SECOND[i][k]].dot(&a[j]) + a[i].dot(&slip.local.second[SECOND[j][k]])
        };
        (0..2).flat_map(|i| (0..2).map(move |j| (i, j))).map(|(i, j)| raised[i] * raised[j] * change(i, j)).sum()
    };
    let norm_slope = Vector2::from_fn(|k, _| (raised.dot(&trial_slope.column(k)) - 0.5 * metric_change(k)) / norm);
    let norm_by_gap = raised.dot(&by_way) / norm;
    let scale = limit / norm;
    Friction {
        traction: direction * limit,
        by_place: (trial_slope - direction * norm_slope.transpose()) * scale,
        by_gap: direction * (coefficient * slope) + (by_way - direction * norm_by_gap) * scale,
        magnitude: limit,
        elastic: raised * (scale / penalty),
        stored: 0.5 * limit * limit / penalty,
        slipped: (norm - limit) / penalty,
    }
}
