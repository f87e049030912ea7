//! The lanes of the processor's vectors, for the laws and for the loops of an element.

use std::ops::{Add, AddAssign, BitAnd, BitOr, Div, Mul, Neg, Not, Sub, SubAssign};

use pulp::Simd;
use subrope_material::lanes::{Lanes, MAX_LANES};

/// A vector of the instruction set `S`. The token that travels with it takes no room.
///
/// Four lanes in memory do not lie across two cache lines.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub struct Wide<S: Simd> {
    simd: S,
    lanes: S::f64s,
}

/// Truth values of the lanes of a [`Wide`].
#[derive(Clone, Copy, Debug)]
pub struct WideMask<S: Simd> {
    simd: S,
    lanes: S::m64s,
}

impl<S: Simd> Wide<S> {
    /// The same number in all lanes.
    #[inline(always)]
    pub fn new(simd: S, value: f64) -> Self {
        Self { simd, lanes: simd.splat_f64s(value) }
    }

    /// The lanes of a pack that begins at the point `first` of a group.
    #[inline(always)]
    pub(super) fn of_group(simd: S, group: &[f64; MAX_LANES], first: usize) -> Self {
        // The remainder tells the compiler that the index is in bounds.
        let part = first / S::F64_LANES % (MAX_LANES / S::F64_LANES);
        Self { simd, lanes: S::as_simd_f64s(group).0[part] }
    }

    /// Puts the lanes of a pack that begins at the point `first` into their group.
    #[inline(always)]
    pub(super) fn put_into(self, group: &mut [f64; MAX_LANES], first: usize) {
        let part = first / S::F64_LANES % (MAX_LANES / S::F64_LANES);
        S::as_mut_simd_f64s(group).0[part] = self.lanes;
    }

    /// The first lane that holds no positive number, with what it holds.
    #[inline(always)]
    pub fn first_not_positive(self) -> Option<(usize, f64)> {
        if Self::all(self.splat(0.0).lt(self)) {
            return None;
        }
        let numbers = self.to_array();
        numbers.into_iter().take(S::F64_LANES).enumerate().find(|(_, number)| number.is_nan() || *number <= 0.0)
    }

    #[inline(always)]
    fn with(self, lanes: S::f64s) -> Self {
        Self { simd: self.simd, lanes }
    }

    #[inline(always)]
    fn mask(self, lanes: S::m64s) -> WideMask<S> {
        WideMask { simd: self.simd, lanes }
    }
}

impl<S: Simd> Lanes for Wide<S> {
    type Mask = WideMask<S>;

    const COUNT: usize = S::F64_LANES;

    #[inline(always)]
    fn splat(self, value: f64) -> Self {
        Self::new(self.simd, value)
    }

    #[inline(always)]
    fn load(self, numbers: &[f64; MAX_LANES]) -> Self {
        self.with(S::as_simd_f64s(&numbers[..S::F64_LANES]).0[0])
    }

    #[inline(always)]
    fn to_array(self) -> [f64; MAX_LANES] {
        let mut out = [0.0; MAX_LANES];
        S::as_mut_simd_f64s(&mut out[..S::F64_LANES]).0[0] = self.lanes;
        out
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        self.with(self.simd.mul_add_e_f64s(self.lanes, factor.lanes, addend.lanes))
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        self.with(self.simd.sqrt_f64s(self.lanes))
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.with(self.simd.max_f64s(self.lanes, other.lanes))
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.with(self.simd.min_f64s(self.lanes, other.lanes))
    }

    #[inline(always)]
    fn lt(self, other: Self) -> WideMask<S> {
        self.mask(self.simd.less_than_f64s(self.lanes, other.lanes))
    }

    #[inline(always)]
    fn equal(self, other: Self) -> WideMask<S> {
        self.mask(self.simd.equal_f64s(self.lanes, other.lanes))
    }

    #[inline(always)]
    fn select(mask: WideMask<S>, yes: Self, no: Self) -> Self {
        yes.with(yes.simd.select_f64s(mask.lanes, yes.lanes, no.lanes))
    }

    #[inline(always)]
    fn any(mask: WideMask<S>) -> bool {
        // A mask is all bits of a lane, or one bit per lane.
        if const { size_of::<S::m64s>() == 8 * S::F64_LANES } {
            let lanes: &[u64] = pulp::bytemuck::cast_slice(std::slice::from_ref(&mask.lanes));
            lanes.iter().fold(0, |bits, lane| bits | lane) != 0
        } else {
            pulp::bytemuck::bytes_of(&mask.lanes).iter().fold(0, |bits, byte| bits | byte) != 0
        }
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident, $simd:ident) => {
        impl<S: Simd> $trait for Wide<S> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.with(self.simd.$simd(self.lanes, other.lanes))
            }
        }
    };
    ($trait:ident, $method:ident, $simd:ident, by number) => {
        operator!($trait, $method, $simd);

        impl<S: Simd> $trait<f64> for Wide<S> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: f64) -> Self {
                self.with(self.simd.$simd(self.lanes, self.simd.splat_f64s(other)))
            }
        }
    };
}

operator!(Add, add, add_f64s, by number);
operator!(Sub, sub, sub_f64s, by number);
operator!(Mul, mul, mul_f64s, by number);
operator!(Div, div, div_f64s);

impl<S: Simd> Neg for Wide<S> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        self.with(self.simd.neg_f64s(self.lanes))
    }
}

impl<S: Simd> AddAssign for Wide<S> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<S: Simd> SubAssign for Wide<S> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl<S: Simd> BitAnd for WideMask<S> {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self { simd: self.simd, lanes: self.simd.and_m64s(self.lanes, other.lanes) }
    }
}

impl<S: Simd> BitOr for WideMask<S> {
    type Output = Self;

    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self { simd: self.simd, lanes: self.simd.or_m64s(self.lanes, other.lanes) }
    }
}

impl<S: Simd> Not for WideMask<S> {
    type Output = Self;

    #[inline(always)]
    fn not(self) -> Self {
        Self { simd: self.simd, lanes: self.simd.not_m64s(self.lanes) }
    }
}
