//! The brick that averages the fibre elongation.

use pulp::Simd;
use subrope_material::lanes::Lanes;
use subrope_material::{LaneFailure, LaneResponse, Law, LawError};

use super::averaged::{self, Averaging, MeanTerms};
use super::formulation::{ElementFailure, ElementInput, ElementResult, Formulation};
use super::kernel::{self, Buffers};
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

impl Formulation<8> for MeanElongation {
    const NEEDS_FIBRE_TERM: bool = true;

    #[inline(always)]
    fn evaluate<L: Law, S: Simd, const SYMMETRIC: bool>(
        simd: S,
        input: &ElementInput<'_, 8, L>,
        new: &mut [f64],
        buffers: &mut Buffers<S, 8>,
        out: &mut ElementResult<8>,
    ) -> Result<(), ElementFailure> {
        averaged::average::<Self, L, S, SYMMETRIC>(simd, input, new, buffers, out)
    }
}

impl Averaging for MeanElongation {
    #[inline(always)]
    fn passes<L: Law, S: Simd, const PACKS: usize, const SYMMETRIC: bool>(
        simd: S,
        input: &ElementInput<'_, 8, L>,
        new: &mut [f64],
        buffers: &mut Buffers<S, 8>,
        out: &mut ElementResult<8>,
    ) -> Result<(), ElementFailure> {
        let (zero, lanes) = (Wide::new(simd, 0.0), S::F64_LANES);
        let (mut mean, volume) = (0.0, input.brick.total_volume());
        let packs = averaged::packs::<L, S, PACKS>(simd, input);
        let mut stretches = [zero; PACKS];
        for (number, (pack, stretch)) in packs.iter().zip(&mut stretches).enumerate() {
            let growth = fibre_growth(pack);
            *stretch = growth + 1.0;
            if let Some((lane, jacobian)) = stretch.first_not_positive() {
                let failure = LaneFailure { lane, source: LawError::Inverted { jacobian } };
                return Err(ElementFailure::in_lane((number * lanes, failure), &pack.gradient, None));
            }
            pack.integrate(growth.ln_1p() * 0.5, &mut mean);
        }
        mean /= volume;
        let mut responses = [LaneResponse::zero(zero); PACKS];
        let mut fibre_stress = 0.0;
        for (number, (pack, response)) in packs.iter().zip(&mut responses).enumerate() {
            let (first, mean_elongation) = (number * lanes, Some(zero.splat(mean)));
            let strain = input.strain(lanes, pack.gradient, mean_elongation);
            input.call(simd, (first, &strain), new, response)?;
            pack.integrate(response.fibre.fibre_stress, &mut fibre_stress);
            out.add_energies(pack, response);
        }
        fibre_stress /= volume;
        let mut terms = MeanTerms::ZERO;
        for (number, ((pack, response), stretch)) in packs.iter().zip(&mut responses).zip(&stretches).enumerate() {
            let inverse = zero.splat(1.0) / *stretch;
            response.second_piola[0] += inverse * fibre_stress;
            out.keep_stress(number * lanes, &response.second_piola);
            pack.add_force(&response.second_piola, pack.volume, &mut out.force);
            if input.request == Request::Tangent {
                response.tangent[0][0] -= inverse * inverse * (2.0 * fibre_stress);
                let (s, d) = (&response.second_piola, &response.tangent);
                pack.put_elasticity::<SYMMETRIC>(s, d, &mut buffers.group);
                let fibre = &response.fibre;
                let measure = [inverse, zero, zero, zero, zero, zero];
                pack.add_force(&measure, pack.volume * (1.0 / volume), &mut terms.gradient);
                pack.add_force(&fibre.stress_by_elongation, pack.volume, &mut terms.stress_coupling);
                pack.add_force(&fibre.fibre_stress_by_strain, pack.volume, &mut terms.strain_coupling);
                pack.integrate(fibre.fibre_stiffness, &mut terms.stiffness);
            }
        }
        if input.request == Request::Tangent {
            kernel::add_group::<S, 8, SYMMETRIC>(simd, (input.brick, 0), &mut buffers.group, &mut out.stiffness);
            terms.add_to::<S, SYMMETRIC>(simd, out);
        }
        Ok(())
    }
}

/// `C11 - 1 = 2 H11 + sum_k H_k1^2`, in the fibre frame.
#[inline(always)]
fn fibre_growth<S: Simd>(pack: &Pack<'_, S, 8>) -> Wide<S> {
    let [[a, ..], [b, ..], [c, ..]] = pack.gradient;
    a.mul_add(a, b.mul_add(b, c * c)) + a * 2.0
}
