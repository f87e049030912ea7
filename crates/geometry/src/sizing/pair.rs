//! Two relations that lack the same two quantities.

use super::{Quantity, Relation};

/// Steps in which a change of sign is looked for.
const STEPS: usize = 96;

/// The values of `unknown` that fulfil both relations, `known` giving the others; `None` when no values or several do.
pub(super) fn solve_pair(
    relations: [Relation; 2],
    unknown: [Quantity; 2],
    gap: f64,
    known: impl Fn(Quantity) -> f64,
) -> Option<[f64; 2]> {
    let [outer, inner] = unknown;
    let at = |x: f64| {
        let given = |q: Quantity| if q == outer { x } else { known(q) };
        let y = relations[0].solve(inner, gap, given)?;
        let residual = relations[1].residual(gap, |q| if q == inner { y } else { given(q) });
        residual.is_finite().then_some((y, residual))
    };
    let (least, greatest) = outer.admissible();
    let value = |i: usize| least + (greatest - least) * i as f64 / STEPS as f64;
    let samples: Vec<_> = (0..=STEPS).map(|i| at(value(i)).map(|(_, residual)| residual)).collect();
    let crosses = |i: &usize| matches!((samples[*i], samples[i + 1]), (Some(a), Some(b)) if (a < 0.0) != (b < 0.0));
    let mut brackets = (0..STEPS).filter(crosses);
    let (Some(bracket), None) = (brackets.next(), brackets.next()) else { return None };
    let (mut low, mut high) = (value(bracket), value(bracket + 1));
    let negative = samples[bracket]? < 0.0;
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if (at(middle)?.1 < 0.0) == negative { low = middle } else { high = middle }
    }
    let x = 0.5 * (low + high);
    Some([x, at(x)?.0])
}
