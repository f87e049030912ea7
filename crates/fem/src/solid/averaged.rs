//! What the bricks share that average a strain: two passes over eight points, and the terms that couple these.

use pulp::Simd;
use subrope_material::Law;

use super::formulation::{ElementFailure, ElementInput, ElementResult};
use super::kernel::{self, Buffers, NodeVector};
use super::pack::Pack;

/// A brick that goes through its eight points more than once, and keeps something of each pack in between.
pub(super) trait Averaging {
    /// [`Formulation::evaluate`](super::Formulation::evaluate) with the points in `PACKS` packs.
    fn passes<L: Law, S: Simd, const PACKS: usize, const SYMMETRIC: bool>(
        simd: S,
        input: &ElementInput<'_, 8, L>,
        new: &mut [f64],
        buffers: &mut Buffers<S, 8>,
        out: &mut ElementResult<8>,
    ) -> Result<(), ElementFailure>;
}

/// [`Averaging::passes`] with as many packs as the lanes make of eight points.
#[inline(always)]
pub(super) fn average<A: Averaging, L: Law, S: Simd, const SYMMETRIC: bool>(
    simd: S,
    input: &ElementInput<'_, 8, L>,
    new: &mut [f64],
    buffers: &mut Buffers<S, 8>,
    out: &mut ElementResult<8>,
) -> Result<(), ElementFailure> {
    // Constants, so that only one of them is compiled.
    if const { S::F64_LANES == 8 } {
        A::passes::<L, S, 1, SYMMETRIC>(simd, input, new, buffers, out)
    } else if const { S::F64_LANES == 4 } {
        A::passes::<L, S, 2, SYMMETRIC>(simd, input, new, buffers, out)
    } else if const { S::F64_LANES == 2 } {
        A::passes::<L, S, 4, SYMMETRIC>(simd, input, new, buffers, out)
    } else {
        A::passes::<L, S, 8, SYMMETRIC>(simd, input, new, buffers, out)
    }
}

/// The eight points in packs.
#[inline(always)]
pub(super) fn packs<'a, L, S: Simd, const PACKS: usize>(
    simd: S,
    input: &ElementInput<'a, 8, L>,
) -> [Pack<'a, S, 8>; PACKS] {
    let mut packs = [Pack::at(simd, input.brick, 0); PACKS];
    for (number, pack) in packs.iter_mut().enumerate() {
        *pack = Pack::at(simd, input.brick, number * S::F64_LANES);
        pack.deform(&input.displacement);
    }
    packs
}

/// Element sums of an averaged strain: its gradient and the couplings.
pub(super) struct MeanTerms {
    pub(super) gradient: NodeVector<8>,
    pub(super) stress_coupling: NodeVector<8>,
    pub(super) strain_coupling: NodeVector<8>,
    pub(super) stiffness: f64,
}

impl MeanTerms {
    pub(super) const ZERO: Self = Self {
        gradient: [[0.0; 8]; 3],
        stress_coupling: [[0.0; 8]; 3],
        strain_coupling: [[0.0; 8]; 3],
        stiffness: 0.0,
    };

    /// Adds `a (x) b + b (x) (c + h b)`.
    #[inline(always)]
    pub(super) fn add_to<S: Simd, const SYMMETRIC: bool>(&self, simd: S, out: &mut ElementResult<8>) {
        let (b, c) = (&self.gradient, &self.strain_coupling);
        let mut next = *c;
        for (next, b) in next.as_flattened_mut().iter_mut().zip(b.as_flattened()) {
            *next += self.stiffness * b;
        }
        kernel::add_dyads::<S, 8, SYMMETRIC>(simd, &self.stress_coupling, b, &next, &mut out.stiffness);
    }
}
