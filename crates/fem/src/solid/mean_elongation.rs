//! The brick that averages the fibre elongation.

use pulp::Simd;
use subrope_material::lanes::Lanes;
use subrope_material::{LaneResponse, Law, LawError};

use super::formulation::{ElementFailure, ElementInput, ElementResult, Formulation, PackStrain};
use super::kernel::{self, NodeVector, PointProducts, Stiffness};
use super::pack::Pack;
use super::wide::Wide;
use crate::contribution::Request;

/// The fibre elongation averaged over the element: `I_bar = sum(w I_elong)/sum(w)` in the axial energy; all other strain
/// modes at the point. Cures fibre locking. Symmetric whenever the law is.
///
/// With `V = 2 dI_elong/dC = e1 e1/C11`, `b = dI_bar/du`, `s = dW/dI_bar` meaned over the element:
/// `S = S_law + s_bar V`, and the tangent gets `-2 s_bar e1e1e1e1/C11^2` at the point and
/// `a (x) b + b (x) c + h b (x) b` over the element.
#[derive(Clone, Copy, Debug)]
pub struct MeanElongation;

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

/// A pack between the two passes over the element.
#[derive(Clone, Copy)]
struct Half<'a, S: Simd> {
    pack: Pack<'a, S, 8>,
    /// `C11`.
    stretch: Wide<S>,
    response: LaneResponse<Wide<S>>,
}

impl Formulation<8> for MeanElongation {
    const NEEDS_FIBRE_TERM: bool = true;

    #[inline(always)]
    fn evaluate<L: Law, S: Simd, const SYMMETRIC: bool>(
        simd: S,
        input: &ElementInput<'_, 8, L>,
        new: &mut [f64],
        product: &mut PointProducts<8>,
        out: &mut ElementResult<8>,
    ) -> Result<(), ElementFailure> {
        // Constants, so that only one of them is compiled.
        if const { S::F64_LANES == 8 } {
            evaluate::<L, S, 1, SYMMETRIC>(simd, input, new, product, out)
        } else if const { S::F64_LANES == 4 } {
            evaluate::<L, S, 2, SYMMETRIC>(simd, input, new, product, out)
        } else if const { S::F64_LANES == 2 } {
            evaluate::<L, S, 4, SYMMETRIC>(simd, input, new, product, out)
        } else {
            evaluate::<L, S, 8, SYMMETRIC>(simd, input, new, product, out)
        }
    }
}

/// With the eight points in `PACKS` packs.
#[inline(always)]
fn evaluate<L: Law, S: Simd, const PACKS: usize, const SYMMETRIC: bool>(
    simd: S,
    input: &ElementInput<'_, 8, L>,
    new: &mut [f64],
    product: &mut PointProducts<8>,
    out: &mut ElementResult<8>,
) -> Result<(), ElementFailure> {
    let (zero, lanes) = (Wide::new(simd, 0.0), S::F64_LANES);
    let (mut mean, mut volume) = (0.0, 0.0);
    let pack = Pack::new(simd, &input.points[..lanes], &input.displacement);
    let mut halves = [Half { pack, stretch: zero, response: LaneResponse::zero(zero) }; PACKS];
    for (number, half) in halves.iter_mut().enumerate() {
        if number > 0 {
            half.pack = Pack::new(simd, &input.points[number * lanes..(number + 1) * lanes], &input.displacement);
        }
        let growth = fibre_growth(&half.pack);
        half.stretch = growth + 1.0;
        if let Some((lane, jacobian)) = half.stretch.first_not_positive() {
            return Err(ElementFailure::Law(number * lanes + lane, LawError::Inverted { jacobian }));
        }
        half.pack.integrate(growth.ln_1p() * 0.5, &mut mean);
        half.pack.integrate(zero + 1.0, &mut volume);
    }
    mean /= volume;
    let mut fibre_stress = 0.0;
    for (number, Half { pack, response, .. }) in halves.iter_mut().enumerate() {
        let (first, mean_elongation) = (number * lanes, Some(zero.splat(mean)));
        input.call(
            simd,
            &PackStrain { first, points: lanes, gradient: pack.gradient, mean_elongation },
            new,
            response,
        )?;
        pack.integrate(response.fibre.fibre_stress, &mut fibre_stress);
        out.add_energies(pack, response);
    }
    fibre_stress /= volume;
    let mut terms = MeanTerms::ZERO;
    for (number, Half { pack, response, stretch }) in halves.iter_mut().enumerate() {
        let inverse = zero.splat(1.0) / *stretch;
        response.second_piola[0] += inverse * fibre_stress;
        out.keep_stress(number * lanes, &response.second_piola);
        pack.add_force(&response.second_piola, pack.volume, &mut out.force);
        if input.request == Request::Tangent {
            response.tangent[0][0] -= inverse * inverse * (2.0 * fibre_stress);
            let (s, d) = (&response.second_piola, &response.tangent);
            let stiffness = Stiffness { matrix: &mut out.stiffness, product: &mut *product };
            pack.add_stiffness::<SYMMETRIC>(s, d, number == 0, stiffness);
            let fibre = &response.fibre;
            let measure = [inverse, zero, zero, zero, zero, zero];
            pack.add_force(&measure, pack.volume * (1.0 / volume), &mut terms.gradient);
            pack.add_force(&fibre.stress_by_elongation, pack.volume, &mut terms.stress_coupling);
            pack.add_force(&fibre.fibre_stress_by_strain, pack.volume, &mut terms.strain_coupling);
            pack.integrate(fibre.fibre_stiffness, &mut terms.stiffness);
        }
    }
    if input.request == Request::Tangent {
        terms.add_to::<S, SYMMETRIC>(simd, out);
    }
    Ok(())
}

/// `C11 - 1 = 2 H11 + sum_k H_k1^2`, in the fibre frame.
#[inline(always)]
fn fibre_growth<S: Simd>(pack: &Pack<'_, S, 8>) -> Wide<S> {
    let [[a, ..], [b, ..], [c, ..]] = pack.gradient;
    a.mul_add(a, b.mul_add(b, c * c)) + a * 2.0
}
