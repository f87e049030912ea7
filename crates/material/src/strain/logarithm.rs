//! The function `h(Y) = atanh(sqrt Y)/sqrt Y` behind the distortion, with its divided differences.

use crate::lanes::Lanes;

/// Below this `Y` the series is used: the closed divided differences lose digits there.
const SERIES_LIMIT: f64 = 0.2;
/// Below this `Y` ten terms of the series are exact to double precision.
const SHORT_SERIES_LIMIT: f64 = 0.02;

/// `h = sum Y^j/(2j+1)`, `k = (h - 1)/Y = sum Y^j/(2j+3)`, `l = (3k - 1)/Y = sum 3 Y^j/(2j+5)`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LogarithmFactors<V = f64> {
    pub(crate) h: V,
    pub(crate) k: V,
    pub(crate) l: V,
}

impl<V: Lanes> LogarithmFactors<V> {
    /// Factors at `Y = R/m^2`; `complement` is `1 - Y = s^2/m^2`, never formed by subtraction.
    #[inline(always)]
    pub(crate) fn new(y: V, complement: V) -> Self {
        if V::all(y.lt(y.splat(SHORT_SERIES_LIMIT))) {
            Self::from_series(y, series::<V, 10>(y))
        } else if V::all(y.lt(y.splat(SERIES_LIMIT))) {
            Self::from_series(y, series::<V, 24>(y))
        } else {
            Self::each(y, complement)
        }
    }

    #[inline(always)]
    fn from_series(y: V, l: V) -> Self {
        let k = y.mul_add(l, y.splat(1.0)) * (1.0 / 3.0);
        Self { h: y.mul_add(k, y.splat(1.0)), k, l }
    }

    /// Lane by lane, where at least one is beyond the series.
    #[inline(never)]
    fn each(y: V, complement: V) -> Self {
        let (numbers, complements) = (y.to_array(), complement.to_array());
        let factors = std::array::from_fn(|i| {
            if numbers[i] < SERIES_LIMIT {
                LogarithmFactors::from_series(numbers[i], series::<f64, 24>(numbers[i]))
            } else {
                LogarithmFactors::closed(numbers[i], complements[i])
            }
        });
        let factors: [LogarithmFactors; crate::lanes::MAX_LANES] = factors;
        let gather = |part: fn(&LogarithmFactors) -> f64| y.fill(|i| part(&factors[i]));
        Self { h: gather(|f| f.h), k: gather(|f| f.k), l: gather(|f| f.l) }
    }
}

impl LogarithmFactors {
    /// `h = ln((1 + sqrt Y)/sqrt(1 - Y))/sqrt Y`.
    fn closed(y: f64, complement: f64) -> Self {
        let root = y.sqrt();
        let h = ((1.0 + root) / complement.sqrt()).ln() / root;
        let k = (h - 1.0) / y;
        Self { h, k, l: (3.0 * k - 1.0) / y }
    }
}

/// `sum_{j < TERMS} 3 y^j/(2j + 5)`, `TERMS` even: two interleaved Horner chains in `y^2`, which do not wait for each
/// other.
#[inline(always)]
fn series<V: Lanes, const TERMS: usize>(y: V) -> V {
    let square = y * y;
    let (mut even, mut odd) = (y.splat(0.0), y.splat(0.0));
    for j in (0..TERMS / 2).rev() {
        even = even.mul_add(square, y.splat(3.0 / (4 * j + 5) as f64));
        odd = odd.mul_add(square, y.splat(3.0 / (4 * j + 7) as f64));
    }
    y.mul_add(odd, even)
}

#[cfg(test)]
mod tests {
    use super::LogarithmFactors;

    #[test]
    fn series_and_closed_form_agree_at_the_switch() {
        let (below, above) = (LogarithmFactors::new(0.2 - 1e-17, 0.8), LogarithmFactors::closed(0.2 - 1e-17, 0.8));
        assert!((below.h - above.h).abs() < 1e-15);
        assert!((below.k - above.k).abs() < 1e-14);
        assert!((below.l - above.l).abs() < 2e-13);
    }

    #[test]
    fn short_and_long_series_agree_at_the_switch() {
        let y = 0.02_f64;
        let (short, long) = (super::series::<f64, 10>(y), super::series::<f64, 24>(y));
        assert!((short - long).abs() < 1e-16, "{short} {long}");
    }

    #[test]
    fn h_is_the_inverse_hyperbolic_tangent() {
        for y in [1e-12_f64, 1e-4, 0.1, 0.3, 0.9] {
            let exact = y.sqrt().atanh() / y.sqrt();
            assert!((LogarithmFactors::new(y, 1.0 - y).h / exact - 1.0).abs() < 4e-16, "{y}");
        }
    }
}
