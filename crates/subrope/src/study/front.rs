//! What is worth its cost: the Pareto front, the cheapest that is good enough, and the cost at equal error.

use serde::Serialize;

/// Indices of the points that no other beats in both cost and error, by rising cost. Points are (cost, error); those that
/// are `None` take no part.
#[must_use]
pub fn pareto(points: &[Option<(f64, f64)>]) -> Vec<usize> {
    let mut order: Vec<(usize, f64, f64)> =
        points.iter().enumerate().filter_map(|(i, p)| p.map(|(cost, error)| (i, cost, error))).collect();
    order.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.2.total_cmp(&b.2)));
    let mut best = f64::INFINITY;
    let mut front = Vec::new();
    for (index, _, error) in order {
        if error < best {
            best = error;
            front.push(index);
        }
    }
    front
}

/// Index of the cheapest point whose error is at most the target.
#[must_use]
pub fn cheapest(points: &[Option<(f64, f64)>], target: f64) -> Option<usize> {
    let good =
        points.iter().enumerate().filter_map(|(i, p)| p.filter(|(_, e)| *e <= target).map(|(cost, _)| (i, cost)));
    good.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(index, _)| index)
}

/// What a series needs to reach an error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", tag = "kind")]
pub enum CostAt {
    /// Between two levels, straight on logarithmic scales.
    Between {
        /// The cost.
        cost: f64,
    },
    /// Already the coarsest level is better.
    AtMost {
        /// Cost of that level.
        cost: f64,
    },
    /// The finest level is not good enough.
    MoreThan {
        /// Cost of that level.
        cost: f64,
        /// The line through the last two levels drawn on: an estimate.
        estimate: Option<f64>,
    },
}

/// Cost from which a series stays at or below an error: a level that is good by chance, with a worse one after it, does
/// not count. Points are (cost, error) from coarse to fine.
#[must_use]
pub fn cost_at(points: &[(f64, f64)], target: f64) -> Option<CostAt> {
    let (first, last) = (points.first()?, points.last()?);
    let Some(bad) = points.iter().rposition(|(_, error)| *error > target) else {
        return Some(CostAt::AtMost { cost: first.0 });
    };
    let Some(&good) = points.get(bad + 1) else {
        let before = points.len().checked_sub(2).map(|i| points[i]);
        return Some(CostAt::MoreThan { cost: last.0, estimate: before.and_then(|b| drawn_on(b, *last, target)) });
    };
    // An error of zero has no logarithm.
    let floor = 1e-6 * target;
    let (high, low) = (points[bad].1.ln(), good.1.max(floor).ln());
    let t = (high - target.ln()) / (high - low);
    Some(CostAt::Between { cost: (points[bad].0.ln() + t * (good.0.ln() - points[bad].0.ln())).exp() })
}

/// How many times the cost of the last level a line is drawn on: what lies beyond is no estimate.
const FAR: f64 = 100.0;

fn drawn_on(a: (f64, f64), b: (f64, f64), target: f64) -> Option<f64> {
    let slope = (a.1 / b.1).ln() / (b.0 / a.0).ln();
    let factor = (b.1 / target).powf(1.0 / slope);
    (slope > 0.0 && (1.0..FAR).contains(&factor)).then_some(b.0 * factor)
}

/// How many times more one series costs than another.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Ratio {
    /// The ratio, or its bound.
    pub value: f64,
    /// Whether the ratio is this one, at least this one or at most this one.
    pub bound: Bound,
    /// An estimate where the ratio is only bounded.
    pub estimate: Option<f64>,
}

/// What is known of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Bound {
    /// The number.
    Equal,
    /// A number below it.
    AtLeast,
    /// A number above it.
    AtMost,
    /// Nothing but an estimate.
    Estimated,
}

impl CostAt {
    /// The cost, or its bound.
    #[must_use]
    pub fn cost(self) -> f64 {
        match self {
            Self::Between { cost } | Self::AtMost { cost } | Self::MoreThan { cost, .. } => cost,
        }
    }

    fn best_guess(self) -> Option<f64> {
        match self {
            Self::Between { cost } => Some(cost),
            Self::AtMost { .. } => None,
            Self::MoreThan { estimate, .. } => estimate,
        }
    }

    /// This cost over another; `None` when nothing can be said.
    #[must_use]
    pub fn over(self, other: Self) -> Option<Ratio> {
        use CostAt::{AtMost, Between, MoreThan};
        let bound = match (self, other) {
            (Between { .. }, Between { .. }) => Bound::Equal,
            (Between { .. } | MoreThan { .. }, AtMost { .. }) | (MoreThan { .. }, Between { .. }) => Bound::AtLeast,
            (AtMost { .. }, Between { .. } | MoreThan { .. }) | (Between { .. }, MoreThan { .. }) => Bound::AtMost,
            (AtMost { .. }, AtMost { .. }) => return None,
            (MoreThan { .. }, MoreThan { .. }) => Bound::Estimated,
        };
        let guess = self.best_guess().zip(other.best_guess()).map(|(a, b)| a / b);
        if bound == Bound::Estimated {
            return guess.map(|value| Ratio { value, bound, estimate: None });
        }
        Some(Ratio { value: self.cost() / other.cost(), bound, estimate: guess.filter(|_| bound != Bound::Equal) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_front_has_what_nothing_beats() {
        let points = [Some((1.0, 0.5)), Some((2.0, 0.6)), None, Some((3.0, 0.1)), Some((3.0, 0.2)), Some((9.0, 0.1))];
        assert_eq!(pareto(&points), [0, 3]);
        assert_eq!(cheapest(&points, 0.2), Some(3));
        assert_eq!(cheapest(&points, 0.01), None);
    }

    #[test]
    fn cost_between_levels_is_straight_on_logarithmic_scales() {
        let points = [(1.0, 0.1), (100.0, 0.001)];
        let Some(CostAt::Between { cost }) = cost_at(&points, 0.01) else { panic!("not between") };
        assert!((cost - 10.0).abs() < 1e-9, "{cost}");
        assert_eq!(cost_at(&points, 0.2), Some(CostAt::AtMost { cost: 1.0 }));
        let Some(CostAt::MoreThan { cost: 100.0, estimate: Some(estimate) }) = cost_at(&points, 1e-4) else {
            panic!("not beyond")
        };
        assert!((estimate - 1000.0).abs() < 1e-6, "{estimate}");
        let flat = [(1.0, 0.1), (2.0, 0.099)];
        assert_eq!(cost_at(&flat, 0.01), Some(CostAt::MoreThan { cost: 2.0, estimate: None }));
        // Good by chance in the middle.
        let lucky = [(1.0, 0.1), (2.0, 0.001), (4.0, 0.05), (16.0, 0.005)];
        let Some(CostAt::Between { cost }) = cost_at(&lucky, 0.01) else { panic!("not between") };
        assert!(cost > 4.0 && cost < 16.0);
        assert_eq!(cost_at(&[], 0.1), None);
    }

    #[test]
    fn ratios_know_what_they_do_not_know() {
        let between = CostAt::Between { cost: 2.0 };
        let more = CostAt::MoreThan { cost: 10.0, estimate: Some(40.0) };
        let ratio = more.over(between).unwrap();
        assert_eq!(ratio, Ratio { value: 5.0, bound: Bound::AtLeast, estimate: Some(20.0) });
        assert_eq!(between.over(more).unwrap().bound, Bound::AtMost);
        assert_eq!(between.over(between).unwrap(), Ratio { value: 1.0, bound: Bound::Equal, estimate: None });
        let estimated = Ratio { value: 1.0, bound: Bound::Estimated, estimate: None };
        assert_eq!(more.over(more), Some(estimated));
        assert_eq!(more.over(CostAt::MoreThan { cost: 1.0, estimate: None }), None);
        assert_eq!(more.over(CostAt::AtMost { cost: 1.0 }).unwrap().estimate, None);
    }
}
