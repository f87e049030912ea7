//! The laws of a contact point: normal pressure and Coulomb friction, per reference area.

use nalgebra::{Matrix2, Vector2, Vector3};

use crate::foot::Local;
use crate::patch::SECOND;

/// Pressure against depth: `eps d^2 / (2 t)` in a toe of depth `t`, `eps (d - t/2)` beyond; without a toe `eps d`.
///
/// Where long surfaces just touch, a toe lets pressure set in gradually, so that Newton's iteration need not find out point
/// by point which of them touch. It leaves surfaces closer by `t/2`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Normal {
    /// Penalty `eps` \[MPa/mm\].
    pub penalty: f64,
    /// Depth of the toe `t` \[mm\].
    pub toe: f64,
}

impl Normal {
    /// Pressure \[MPa\] and its slope by the gap `g`: that of depth `d_0 - g`, where `d_0` has the pressure of the
    /// multiplier. Without a toe it is `<lambda - eps g>`.
    #[must_use]
    pub fn pressure(&self, multiplier: f64, gap: f64) -> (f64, f64) {
        let depth = self.depth(multiplier) - gap;
        if depth <= 0.0 {
            (0.0, 0.0)
        } else if depth < self.toe {
            (self.penalty * depth * depth / (2.0 * self.toe), -self.penalty * depth / self.toe)
        } else {
            (self.penalty * (depth - 0.5 * self.toe), -self.penalty)
        }
    }

    /// Depth \[mm\] at which the pressure is `pressure`.
    fn depth(&self, pressure: f64) -> f64 {
        if pressure < 0.5 * self.penalty * self.toe {
            (2.0 * self.toe * pressure / self.penalty).sqrt()
        } else {
            pressure / self.penalty + 0.5 * self.toe
        }
    }

    /// Work of the pressure from the surface to a depth \[mJ/mm^2\].
    #[must_use]
    pub fn energy(&self, depth: f64) -> f64 {
        let (t, d) = (self.toe, depth.max(0.0));
        self.penalty * if d < t { d * d * d / (6.0 * t) } else { 0.5 * d * (d - t) + t * t / 6.0 }
    }

    /// Potential of the gap \[mJ/mm^2\] whose negative slope is the pressure, zero where the surfaces meet.
    #[must_use]
    pub fn potential(&self, multiplier: f64, gap: f64) -> f64 {
        let touching = self.depth(multiplier);
        self.energy(touching - gap) - self.energy(touching)
    }
}

/// Potential of friction \[mJ/mm^2\] whose trial traction is `trial` and whose limit does not follow the pressure: `T^2/(2
/// eps)` up to the limit, straight beyond.
#[must_use]
pub fn friction_potential(trial: f64, limit: f64, penalty: f64) -> f64 {
    let stuck = trial.min(limit);
    stuck * (trial - 0.5 * stuck) / penalty
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
    /// Covariant traction `t_i = t . a_i`.
    pub traction: Vector2<f64>,
    /// `dt_i/dxi_j` through the way.
    pub by_place: Matrix2<f64>,
    /// `dt_i/dg`.
    pub by_gap: Vector2<f64>,
    /// `dt_i/dm_jk`, the change by the metric of the current configuration; one matrix per component.
    pub by_metric: [Matrix2<f64>; 2],
    /// Magnitude of the traction \[MPa\].
    pub magnitude: f64,
    /// Elastic slip left, contravariant.
    pub elastic: Vector2<f64>,
    /// Energy of the elastic slip \[mJ/mm^2\].
    pub stored: f64,
    /// Length slipped \[mm\].
    pub slipped: f64,
}

/// Coulomb's law with an elastic slip. In the committed configuration the trial slip is `s = s_e + share way`, with
/// components `s^i`; carried to the current one its traction is `T_i = eps_t m_ij s^j` with the current metric `m`. It
/// sticks while `|T| <= mu p`, else `t = mu p T/|T|`: the traction is `mu p` in the current configuration, and a rigid motion
/// after any stretch leaves it as it is.
///
/// Closed-form return; the derivatives are those of this update.
#[must_use]
pub fn friction(
    slip: &Slip<'_>,
    metric: &Matrix2<f64>,
    penalty: f64,
    coefficient: f64,
    (p, slope): (f64, f64),
) -> Friction {
    let Trial { slip: s, by_place, by_gap } = Trial::new(slip);
    let trial = metric * s * penalty;
    let norm = (penalty * trial.dot(&s)).max(0.0).sqrt();
    let limit = coefficient * p;
    let sticks = norm <= limit;
    let (scale, magnitude) = if sticks { (1.0, norm) } else { (limit / norm, limit) };
    // Through the direction only once it slips: the part along the traction is taken out.
    let turn =
        |change: Vector2<f64>, growth: f64| if sticks { change } else { (change - trial * (growth / norm)) * scale };
    let through = |ds: Vector2<f64>| turn(metric * ds * penalty, penalty * trial.dot(&ds) / norm);
    let columns = [0, 1].map(|k| through(by_place.column(k).into_owned()));
    let pressing = if sticks { Vector2::zeros() } else { trial * (coefficient * slope / norm) };
    let by_metric = |j: usize, k: usize| {
        let mut change = Vector2::zeros();
        change[j] = penalty * s[k];
        turn(change, 0.5 * penalty * penalty * s[j] * s[k] / norm)
    };
    let entries = [[by_metric(0, 0), by_metric(0, 1)], [by_metric(1, 0), by_metric(1, 1)]];
    Friction {
        traction: trial * scale,
        by_place: Matrix2::from_columns(&columns),
        by_gap: through(by_gap) + pressing,
        by_metric: [0, 1].map(|i| Matrix2::from_fn(|j, k| entries[j][k][i])),
        magnitude,
        elastic: s * scale,
        stored: 0.5 * magnitude * magnitude / penalty,
        slipped: (norm - magnitude) / penalty,
    }
}

/// Components of the trial slip and their derivatives by place and gap.
struct Trial {
    slip: Vector2<f64>,
    by_place: Matrix2<f64>,
    by_gap: Vector2<f64>,
}

impl Trial {
    /// From `M_ij s^j = A_i . (s_e + share way)`, all in the committed configuration.
    fn new(slip: &Slip<'_>) -> Self {
        let (a, second) = (&slip.local.tangents, &slip.local.second);
        let (share, share_slope) = slip.share;
        let total = slip.elastic + slip.way * share;
        let metric = slip.local.metric();
        let dual = metric.try_inverse().unwrap_or_else(Matrix2::zeros);
        let along = |v: &Vector3<f64>| Vector2::new(a[0].dot(v), a[1].dot(v));
        let s = dual * along(&total);
        let column = |k: usize| {
            let own = Vector2::from_fn(|i, _| second[SECOND[i][k]].dot(&total) + share * metric[(i, k)]);
            let change = Matrix2::from_fn(|i, j| second[SECOND[i][k]].dot(&a[j]) + a[i].dot(&second[SECOND[j][k]]));
            dual * (own - change * s)
        };
        Self {
            slip: s,
            by_place: Matrix2::from_columns(&[column(0), column(1)]),
            by_gap: dual * along(&slip.way) * share_slope,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pressure_is_the_slope_of_the_potential_and_the_multiplier_at_no_gap() {
        let h = 1e-6;
        for toe in [0.0, 0.01] {
            let normal = Normal { penalty: 300.0, toe };
            for multiplier in [0.0, 0.4, 7.0] {
                assert!((normal.pressure(multiplier, 0.0).0 - multiplier).abs() < 1e-12);
                for gap in [0.03, 0.004, -0.003, -0.02] {
                    let (p, slope) = normal.pressure(multiplier, gap);
                    let along = |f: &dyn Fn(f64) -> f64| (f(gap + h) - f(gap - h)) / (2.0 * h);
                    assert!((along(&|g| normal.potential(multiplier, g)) + p).abs() < 1e-6, "{toe} {multiplier} {gap}");
                    assert!((along(&|g| normal.pressure(multiplier, g).0) - slope).abs() < 1e-6 * normal.penalty);
                }
            }
        }
    }
}
