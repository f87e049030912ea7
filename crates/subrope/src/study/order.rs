//! Observed orders and Richardson's extrapolation.

use serde::Serialize;

/// Orders that Richardson's extrapolation is trusted with.
const TRUSTED: std::ops::RangeInclusive<f64> = 0.5..=6.0;

/// Why three values cannot be extrapolated.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NotExtrapolated {
    /// They do not approach anything from one side.
    #[error("the last three levels do not converge monotonically")]
    NotMonotone,
    /// They approach too slowly or too quickly to be trusted.
    #[error("the order seen on the last three levels, {0:.2}, is outside .5 to 6")]
    Order(f64),
    /// Their sizes do not fall.
    #[error("the sizes of the last three levels do not fall")]
    Sizes,
}

/// A value at size zero and the order of the way there.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Extrapolated {
    /// The value.
    pub value: f64,
    /// The order.
    pub order: f64,
}

/// Richardson's extrapolation of three levels: `q(h) = q0 + c h^p` through all three, for sizes that fall.
///
/// # Errors
/// [`NotExtrapolated`]; the finest value is then the best there is.
pub fn richardson(sizes: [f64; 3], values: [f64; 3]) -> Result<Extrapolated, NotExtrapolated> {
    let [a, b, c] = sizes;
    if !(c > 0.0 && b > c && a > b && a.is_finite()) {
        return Err(NotExtrapolated::Sizes);
    }
    let (first, second) = (values[1] - values[0], values[2] - values[1]);
    if second == 0.0 && first == 0.0 {
        return Ok(Extrapolated { value: values[2], order: 0.0 });
    }
    let ratio = first / second;
    // Also what is not a number.
    if !(ratio > 0.0 && ratio.is_finite()) {
        return Err(NotExtrapolated::NotMonotone);
    }
    let order = order_of(ratio, sizes);
    if !TRUSTED.contains(&order) {
        return Err(NotExtrapolated::Order(order));
    }
    Ok(Extrapolated { value: values[2] + second / ((b / c).powf(order) - 1.0), order })
}

/// The `p` at which `(a^p - b^p)/(b^p - c^p)` is the ratio of the differences; it grows with `p`. Bisection between -8 and
/// 16.
fn order_of(ratio: f64, [a, b, c]: [f64; 3]) -> f64 {
    let part = |x: f64, p: f64| if p.abs() < 1e-9 { x.ln() } else { (x.powf(p) - 1.0) / p };
    let of = |p: f64| part(a / b, p) / -part(c / b, p);
    let (mut low, mut high) = (-8.0, 16.0);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if of(middle) < ratio {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// Order between neighbouring levels, `ln(e1/e2)/ln(h1/h2)`; `None` where an error is unknown or zero or the size does not
/// fall.
#[must_use]
pub fn observed(sizes: &[f64], errors: &[Option<f64>]) -> Vec<Option<f64>> {
    let between = |h: &[f64], e: &[Option<f64>]| {
        let (first, second) = (e[0].filter(|e| *e > 0.0)?, e[1].filter(|e| *e > 0.0)?);
        (h[0] > 1.000_001 * h[1] && h[1] > 0.0).then(|| (first / second).ln() / (h[0] / h[1]).ln())
    };
    sizes.windows(2).zip(errors.windows(2)).map(|(h, e)| between(h, e)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_are_extrapolated_exactly() {
        for (order, sizes) in [(2.0, [4.0, 2.0, 1.0]), (1.0, [3.0, 2.0, 1.5]), (3.7, [0.9, 0.5, 0.1])] {
            let values = sizes.map(|h: f64| 5.0 - 0.3 * h.powf(order));
            let found = richardson(sizes, values).unwrap();
            assert!((found.value - 5.0).abs() < 1e-9, "{found:?}");
            assert!((found.order - order).abs() < 1e-6, "{found:?}");
        }
    }

    #[test]
    fn what_does_not_converge_is_refused() {
        assert_eq!(richardson([4.0, 2.0, 1.0], [1.0, 2.0, 1.5]), Err(NotExtrapolated::NotMonotone));
        assert_eq!(richardson([4.0, 2.0, 1.0], [1.0, 1.0, 1.5]), Err(NotExtrapolated::NotMonotone));
        assert_eq!(richardson([4.0, 2.0, 1.0], [1.0, 2.0, 2.0]), Err(NotExtrapolated::NotMonotone));
        assert!(matches!(richardson([4.0, 2.0, 1.0], [1.0, 2.0, 3.0]), Err(NotExtrapolated::Order(_))));
        assert_eq!(richardson([1.0, 2.0, 1.0], [1.0, 2.0, 3.0]), Err(NotExtrapolated::Sizes));
        assert_eq!(richardson([4.0, 2.0, 1.0], [3.0; 3]).unwrap().value, 3.0);
    }

    #[test]
    fn orders_between_levels() {
        let errors = [Some(0.4), Some(0.1), None, Some(0.0)];
        assert_eq!(observed(&[4.0, 2.0, 1.0, 0.5], &errors), [Some(2.0), None, None]);
        assert_eq!(observed(&[1.0, 1.0], &[Some(0.4), Some(0.1)]), [None]);
    }
}
