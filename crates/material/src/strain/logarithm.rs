//! The function `h(Y) = atanh(sqrt Y)/sqrt Y` behind the distortion, with its divided differences.

/// Below this `Y` the series is used: the closed divided differences lose digits there.
const SERIES_LIMIT: f64 = 0.2;
/// Below this `Y` ten terms of the series are exact to double precision.
const SHORT_SERIES_LIMIT: f64 = 0.02;

/// `h = sum Y^j/(2j+1)`, `k = (h - 1)/Y = sum Y^j/(2j+3)`, `l = (3k - 1)/Y = sum 3 Y^j/(2j+5)`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LogarithmFactors {
    pub(crate) h: f64,
    pub(crate) k: f64,
    pub(crate) l: f64,
}

impl LogarithmFactors {
    /// Factors at `Y = R/m^2`; `complement` is `1 - Y = s^2/m^2`, never formed by subtraction.
    #[inline]
    pub(crate) fn new(y: f64, complement: f64) -> Self {
        if y < SERIES_LIMIT {
            let l = if y < SHORT_SERIES_LIMIT { series::<10>(y) } else { series::<24>(y) };
            let k = (1.0 + y * l) / 3.0;
            Self { h: 1.0 + y * k, k, l }
        } else {
            Self::closed(y, complement)
        }
    }

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
#[inline]
fn series<const TERMS: usize>(y: f64) -> f64 {
    let square = y * y;
    let (mut even, mut odd) = (0.0, 0.0);
    for j in (0..TERMS / 2).rev() {
        even = even * square + 3.0 / (4 * j + 5) as f64;
        odd = odd * square + 3.0 / (4 * j + 7) as f64;
    }
    even + y * odd
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
        let (short, long) = (super::series::<10>(y), super::series::<24>(y));
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
