//! Several points at once: the arithmetic of a law in as many lanes as a processor has.
//!
//! A law written for [`Lanes`] is written once: one lane is plain `f64`, and whoever owns the instruction set brings the
//! wider ones. Where a formula has branches both sides are evaluated only when the lanes disagree.
//!
//! Code for lanes is loops and functions marked `#[inline(always)]`, down to the instructions: what is not inlined into
//! the function that was compiled for an instruction set is compiled without it. That excludes `array::map` and
//! `array::from_fn`, and closures but the smallest.

use std::fmt::Debug;
use std::ops::{Add, AddAssign, BitAnd, BitOr, Div, Mul, Neg, Not, Sub, SubAssign};

use crate::mandel::{PAIRS, WEIGHTS};

/// Most lanes of any implementation.
pub const MAX_LANES: usize = 8;

/// `yes` or `no`, arrays of lanes, lane by lane; what no lane wants is not evaluated. A macro, because closures in a
/// method are not inlined for certain.
macro_rules! branch {
    ($lanes:ty, $mask:expr, $yes:expr, $no:expr) => {{
        let mask = $mask;
        let yes = if <$lanes>::any(mask) { Some($yes) } else { None };
        match yes {
            Some(yes) if <$lanes>::all(mask) => yes,
            yes => {
                let no = $no;
                match yes {
                    Some(yes) => <$lanes>::select_each(mask, yes, no),
                    None => no,
                }
            }
        }
    }};
}
pub(crate) use branch;

/// Numbers of several points, worked on together.
///
/// There is no constructor without a witness: the value that a new one is made beside may carry the proof that the
/// processor has the instructions.
pub trait Lanes:
    Copy
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + AddAssign
    + SubAssign
{
    /// One truth value per lane.
    type Mask: Copy + Debug + BitAnd<Output = Self::Mask> + BitOr<Output = Self::Mask> + Not<Output = Self::Mask>;

    /// How many lanes, at most [`MAX_LANES`].
    const COUNT: usize;

    /// The same number in all lanes.
    fn splat(self, value: f64) -> Self;
    /// Lane by lane; what is behind the last lane is left out.
    fn load(self, numbers: &[f64; MAX_LANES]) -> Self;
    /// The lanes, zeros behind the last.
    fn to_array(self) -> [f64; MAX_LANES];
    /// `self * factor + addend`, with one rounding where that is fast.
    fn mul_add(self, factor: Self, addend: Self) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// The larger one.
    fn max(self, other: Self) -> Self;
    /// The smaller one.
    fn min(self, other: Self) -> Self;
    /// Where `self < other`; nowhere a number is missing.
    fn lt(self, other: Self) -> Self::Mask;
    /// Where `self == other`.
    fn equal(self, other: Self) -> Self::Mask;
    /// `yes` where the mask holds, `no` elsewhere.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// Whether the mask holds in any lane.
    fn any(mask: Self::Mask) -> bool;

    /// Lane by lane.
    #[inline(always)]
    fn fill(self, mut value: impl FnMut(usize) -> f64) -> Self {
        let mut numbers = [0.0; MAX_LANES];
        for (lane, number) in numbers.iter_mut().enumerate().take(Self::COUNT) {
            *number = value(lane);
        }
        self.load(&numbers)
    }

    /// Whether the mask holds in all lanes.
    #[inline(always)]
    fn all(mask: Self::Mask) -> bool {
        !Self::any(!mask)
    }

    /// Absolute value.
    #[inline(always)]
    fn abs(self) -> Self {
        self.max(-self)
    }

    /// A function of single numbers: for what is rare or has no vector form.
    #[inline(always)]
    fn map(self, function: impl Fn(f64) -> f64) -> Self {
        let numbers = self.to_array();
        self.fill(|i| function(numbers[i]))
    }

    /// [`Lanes::select`] of several numbers.
    #[inline(always)]
    fn select_each<const N: usize>(mask: Self::Mask, yes: [Self; N], no: [Self; N]) -> [Self; N] {
        let mut out = no;
        for i in 0..N {
            out[i] = Self::select(mask, yes[i], no[i]);
        }
        out
    }

    /// `ln(1 + x)`, to a rounding unit also for small `x`.
    #[inline(always)]
    fn ln_1p(self) -> Self {
        let near = self.splat(LOG_NEAR[0]).lt(self) & self.lt(self.splat(LOG_NEAR[1]));
        let [out] = branch!(Self, near, [log_near(self)], [self.map(f64::ln_1p)]);
        out
    }
}

/// Arguments of `ln(1 + x)` that the polynomial serves: `1 + x` between `1/sqrt 2` and `sqrt 2`.
const LOG_NEAR: [f64; 2] = [-0.2928, 0.4142];

/// `(2 atanh(s)/s - 2)/s^2` as a polynomial in `s^2`, `|s| < 0.1716`, to 2^-58 (W. Kahan and K. Ng, the C library's
/// coefficients, since 1993).
const LOG_SERIES: [f64; 7] = [
    6.666_666_666_666_735e-1,
    3.999_999_999_940_942e-1,
    2.857_142_874_366_239e-1,
    2.222_219_843_214_978_4e-1,
    1.818_357_216_161_805e-1,
    1.531_383_769_920_937_3e-1,
    1.479_819_860_511_658_6e-1,
];

/// `ln(1 + x) = x - (x^2/2 - s (x^2/2 + R))`, `s = x/(2 + x)`, `R = 2 atanh(s)/s - 2`.
#[inline(always)]
fn log_near<V: Lanes>(x: V) -> V {
    let s = x / (x + 2.0);
    let z = s * s;
    let mut series = x.splat(LOG_SERIES[6]);
    for coefficient in LOG_SERIES[..6].iter().rev() {
        series = series.mul_add(z, x.splat(*coefficient));
    }
    let half_square = x * x * 0.5;
    x - (half_square - s * z.mul_add(series, half_square))
}

/// Where all of the numbers are finite.
#[inline(always)]
pub(crate) fn finite<V: Lanes>(numbers: &[V]) -> V::Mask {
    let zero = numbers[0].splat(0.0);
    // Sums that do not wait for each other.
    let mut sums = [zero; 4];
    let (fours, rest) = numbers.as_chunks::<4>();
    for four in fours {
        for i in 0..4 {
            sums[i] = four[i].mul_add(zero, sums[i]);
        }
    }
    for number in rest {
        sums[0] = number.mul_add(zero, sums[0]);
    }
    ((sums[0] + sums[1]) + (sums[2] + sums[3])).equal(zero)
}

/// `J - 1 = tr H + (tr^2 H - tr H^2)/2 + det H` of a displacement gradient: no cancellation at small strain.
#[must_use]
#[inline(always)]
pub fn volume_growth<V: Lanes>(h: &[[V; 3]; 3]) -> V {
    let mut minors = h[0][0].splat(0.0);
    let mut determinant = minors;
    for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
        minors += h[i][i] * h[j][j] - h[i][j] * h[j][i];
        determinant += h[0][i] * (h[1][j] * h[2][k] - h[1][k] * h[2][j]);
    }
    h[0][0] + h[1][1] + h[2][2] + minors + determinant
}

/// Green-Lagrange strain `E = sym H + 1/2 H^T H`, Mandel, without cancellation at small strain.
#[must_use]
#[inline(always)]
pub fn green_lagrange<V: Lanes>(h: &[[V; 3]; 3]) -> [V; 6] {
    let mut out = [h[0][0]; 6];
    for (at, (i, j)) in PAIRS.into_iter().enumerate() {
        let square = h[2][i].mul_add(h[2][j], h[1][i].mul_add(h[1][j], h[0][i] * h[0][j]));
        out[at] = (h[i][j] + h[j][i] + square) * (0.5 * WEIGHTS[at]);
    }
    out
}

impl Lanes for f64 {
    type Mask = bool;

    const COUNT: usize = 1;

    #[inline(always)]
    fn splat(self, value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn load(self, numbers: &[f64; MAX_LANES]) -> Self {
        numbers[0]
    }

    #[inline(always)]
    fn to_array(self) -> [f64; MAX_LANES] {
        let mut out = [0.0; MAX_LANES];
        out[0] = self;
        out
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        self * factor + addend
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        self.sqrt()
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }

    #[inline(always)]
    fn lt(self, other: Self) -> bool {
        self < other
    }

    #[inline(always)]
    fn equal(self, other: Self) -> bool {
        self == other
    }

    #[inline(always)]
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }

    #[inline(always)]
    fn any(mask: bool) -> bool {
        mask
    }
}

#[cfg(test)]
mod tests {
    use super::{LOG_NEAR, Lanes, finite};

    #[test]
    fn logarithm_to_a_rounding_unit() {
        for i in 0..=4000 {
            let x = LOG_NEAR[0] + (LOG_NEAR[1] - LOG_NEAR[0]) * f64::from(i) / 4000.0;
            let (exact, found) = (f64::ln_1p(x), Lanes::ln_1p(x));
            assert!((found - exact).abs() <= 1.5 * f64::EPSILON * exact.abs(), "{x}: {found} {exact}");
        }
        for x in [1e-300, -1e-14, 1e-14, 1e-8, -0.9, 3.0, 1e10] {
            let (exact, found) = (f64::ln_1p(x), Lanes::ln_1p(x));
            assert!((found - exact).abs() <= f64::EPSILON * exact.abs(), "{x}: {found} {exact}");
        }
    }

    #[test]
    fn finite_means_every_number() {
        assert!(finite(&[1.0, -1e308, 0.0]));
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(!finite(&[1.0, bad, 0.0]));
        }
    }
}
