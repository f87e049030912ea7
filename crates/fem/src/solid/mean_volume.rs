//! The brick that averages the volume ratio.

#![allow(clippy::needless_range_loop, reason = "tensors are written by their indices, as in the formulas")]

use pulp::Simd;
use subrope_material::lanes::{Lanes, volume_growth};
use subrope_material::mandel::{PAIRS, WEIGHTS};
use subrope_material::{LaneFailure, LaneResponse, Law, LawError};

use super::averaged::{self, Averaging, MeanTerms};
use super::formulation::{ElementFailure, ElementInput, ElementResult, Formulation};
use super::kernel::{self, Buffers};
use super::pack::{MANDEL, Pack};
use super::wide::Wide;
use crate::contribution::Request;

/// The volume ratio averaged over the element (what Abaqus calls C3D8): the law sees `F_bar = (J_bar/J)^(1/3) F`,
/// `J_bar = sum(w J)/sum(w)`. Forces are the derivative of the energy of `F_bar`, so the tangent is symmetric whenever
/// the law's is.
///
/// With `v = ln J`, `psi = 2/3 (ln J_bar - v)`, `C_bar = e^psi C`, `S* = e^psi S(C_bar)`, `s = S*:C/2`, `G = C^-1`:
/// `S_eff = S* + 2/3 (w_J mean(s) - s) G` with `w_J = J/J_bar`, and the tangent follows by one more variation.
#[derive(Clone, Copy, Debug)]
pub struct MeanVolume;

/// A pack between the two passes over the element.
#[derive(Clone, Copy)]
struct Half<S: Simd> {
    /// `J - 1`.
    dilation: Wide<S>,
    /// `C`, Mandel.
    right: [Wide<S>; 6],
    /// `s`.
    pressure: Wide<S>,
    response: LaneResponse<Wide<S>>,
}

impl Formulation<8> for MeanVolume {
    const NEEDS_FIBRE_TERM: bool = false;

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

impl Averaging for MeanVolume {
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
        let half = Half { dilation: zero, right: [zero; 6], pressure: zero, response: LaneResponse::zero(zero) };
        let mut halves = [half; PACKS];
        for (number, (pack, half)) in packs.iter().zip(&mut halves).enumerate() {
            half.dilation = volume_growth(&pack.gradient);
            half.right = right_cauchy_green(&pack.gradient);
            if let Some((lane, jacobian)) = (half.dilation + 1.0).first_not_positive() {
                let failure = LaneFailure { lane, source: LawError::Inverted { jacobian } };
                return Err(ElementFailure::in_lane((number * lanes, failure), &pack.gradient, None));
            }
            pack.integrate(half.dilation, &mut mean);
        }
        mean /= volume;
        if mean.is_nan() || mean <= -1.0 {
            return Err(ElementFailure::MeanVolume(1.0 + mean));
        }
        let mut total = 0.0;
        for (number, (pack, half)) in packs.iter().zip(&mut halves).enumerate() {
            half.evaluate_law(input, (number * lanes, pack), mean, new)?;
            pack.integrate(half.pressure, &mut total);
            out.add_energies(pack, &half.response);
        }
        let mut terms = MeanTerms::ZERO;
        // Second variation of ln J_bar: the part that the mean itself carries.
        terms.stiffness = -2.0 / 3.0 * total;
        for (number, (pack, half)) in packs.iter().zip(&halves).enumerate() {
            let weight = (half.dilation + 1.0) * (1.0 / (1.0 + mean) / volume);
            let inverse = inverse_of(&pack.gradient, half.dilation + 1.0);
            let share = weight * total;
            let stress = half.effective_stress(&inverse, share);
            out.keep_stress(number * lanes, &stress);
            pack.add_force(&stress, pack.volume, &mut out.force);
            if input.request == Request::Tangent {
                let split = VolumeSplit::new(half, &inverse, share);
                let tangent = split.tangent();
                pack.put_elasticity::<SYMMETRIC>(&stress, &tangent, &mut buffers.group);
                let [row, column] = split.couplings();
                pack.add_force(&inverse, pack.volume * weight, &mut terms.gradient);
                pack.add_force(&row, pack.volume, &mut terms.stress_coupling);
                pack.add_force(&column, pack.volume, &mut terms.strain_coupling);
                pack.integrate(split.stiffness, &mut terms.stiffness);
            }
        }
        if input.request == Request::Tangent {
            kernel::add_group::<S, 8, SYMMETRIC>(simd, (input.brick, 0), &mut buffers.group, &mut out.stiffness);
            terms.add_to::<S, SYMMETRIC>(simd, out);
        }
        Ok(())
    }
}

impl<S: Simd> Half<S> {
    /// `S*`, `s`, and `e^2psi` times the law's tangent at `C_bar` when one is wanted.
    #[inline(always)]
    fn evaluate_law<L: Law>(
        &mut self,
        input: &ElementInput<'_, 8, L>,
        (first, pack): (usize, &Pack<'_, S, 8>),
        mean: f64,
        new: &mut [f64],
    ) -> Result<(), ElementFailure> {
        let psi = (-self.dilation.ln_1p() + mean.ln_1p()) * (2.0 / 3.0);
        let grow = (psi * 0.5).map(f64::exp_m1);
        let mut gradient = pack.gradient;
        for (i, row) in gradient.iter_mut().enumerate() {
            for h in row.iter_mut() {
                *h = h.mul_add(grow, *h);
            }
            row[i] += grow;
        }
        let strain = input.strain(pack.points, gradient, None);
        input.call(pack.simd, (first, &strain), new, &mut self.response)?;
        let factor = psi.map(f64::exp);
        for stress in &mut self.response.second_piola {
            *stress = *stress * factor;
        }
        self.pressure = dot6(&self.response.second_piola, &self.right) * 0.5;
        if input.request == Request::Tangent {
            for modulus in self.response.tangent.as_flattened_mut() {
                *modulus = *modulus * factor * factor;
            }
        }
        Ok(())
    }

    /// `S* + 2/3 (share - s) G`, `G = C^-1`; `share` is `sum(w s) J/(J_bar V)`: `2/3 share G` is the stress that the mean
    /// returns to the point.
    #[inline(always)]
    fn effective_stress(&self, inverse: &[Wide<S>; 6], share: Wide<S>) -> [Wide<S>; 6] {
        let back = (share - self.pressure) * (2.0 / 3.0);
        let mut stress = self.response.second_piola;
        for i in 0..6 {
            stress[i] = inverse[i].mul_add(back, stress[i]);
        }
        stress
    }
}

/// What the tangent of a pack is made of.
struct VolumeSplit<'a, S: Simd> {
    half: &'a Half<S>,
    /// `G = C^-1`, gradient of `ln J` by `E`.
    inverse: &'a [Wide<S>; 6],
    /// `D C` and `C D` of the law's tangent.
    dc: [Wide<S>; 6],
    cd: [Wide<S>; 6],
    /// `d2W/d(ln J_bar)2 = (C D C + 4 s)/9`.
    stiffness: Wide<S>,
    share: Wide<S>,
}

impl<'a, S: Simd> VolumeSplit<'a, S> {
    #[inline(always)]
    fn new(half: &'a Half<S>, inverse: &'a [Wide<S>; 6], share: Wide<S>) -> Self {
        let (right, columns) = (&half.right, &half.response.tangent);
        let (mut dc, mut cd) = (*right, *right);
        for i in 0..6 {
            cd[i] = dot6(&columns[i], right);
            let mut row = *right;
            for j in 0..6 {
                row[j] = columns[j][i];
            }
            dc[i] = dot6(&row, right);
        }
        let stiffness = dot6(&dc, right) * (1.0 / 9.0) + half.pressure * (4.0 / 9.0);
        Self { half, inverse, dc, cd, stiffness, share }
    }

    /// Columns of the effective tangent: `P = 1 - C G/3` takes `dE` to the isochoric part that the law sees.
    #[inline(always)]
    fn tangent(&self) -> [[Wide<S>; 6]; 6] {
        let (g, s, law) = (self.inverse, &self.half.response.second_piola, &self.half.response.tangent);
        let both = self.stiffness + self.share * (2.0 / 3.0);
        // Second variation of ln J: -G sym-odot G.
        let turning = (self.share - self.half.pressure) * (4.0 / 3.0);
        let mut out = *law;
        for j in 0..6 {
            for i in 0..6 {
                let once = (self.dc[i] + s[i] * 2.0) * g[j] + g[i] * (self.cd[j] + s[j] * 2.0);
                out[j][i] = law[j][i] - once * (1.0 / 3.0) + g[i] * g[j] * both - odot(g, i, j) * turning;
            }
        }
        out
    }

    /// `d2W/dE d(ln J_bar)`, row and column version.
    #[inline(always)]
    fn couplings(&self) -> [[Wide<S>; 6]; 2] {
        let mut out = [self.dc, self.cd];
        for coupling in &mut out {
            for i in 0..6 {
                let own = self.half.response.second_piola[i] * (2.0 / 3.0) - self.inverse[i] * self.stiffness;
                coupling[i] = coupling[i] * (1.0 / 3.0) + own;
            }
        }
        out
    }
}

#[inline(always)]
fn dot6<V: Lanes>(a: &[V; 6], b: &[V; 6]) -> V {
    let mut sum = a[0] * b[0];
    for i in 1..6 {
        sum = a[i].mul_add(b[i], sum);
    }
    sum
}

/// `F` by its columns.
#[inline(always)]
fn deformation<V: Lanes>(h: &[[V; 3]; 3]) -> [[V; 3]; 3] {
    let mut out = *h;
    for i in 0..3 {
        for j in 0..3 {
            out[j][i] = if i == j { h[i][j] + 1.0 } else { h[i][j] };
        }
    }
    out
}

/// Products of three vectors, Mandel: `C` from the columns of `F`, `C^-1` from the rows of `F^-1`.
#[inline(always)]
fn products<V: Lanes>(vectors: &[[V; 3]; 3]) -> [V; 6] {
    let mut out = [vectors[0][0]; 6];
    for (at, (i, j)) in PAIRS.into_iter().enumerate() {
        let ([a, b, c], [x, y, z]) = (vectors[i], vectors[j]);
        out[at] = (a * x + b * y + c * z) * WEIGHTS[at];
    }
    out
}

#[inline(always)]
fn right_cauchy_green<V: Lanes>(h: &[[V; 3]; 3]) -> [V; 6] {
    products(&deformation(h))
}

/// `C^-1` from the displacement gradient.
#[inline(always)]
fn inverse_of<V: Lanes>(h: &[[V; 3]; 3], jacobian: V) -> [V; 6] {
    let f = deformation(h);
    let one_by = jacobian.splat(1.0) / jacobian;
    // Rows of F^-1: cofactors of the columns.
    let mut inverse = f;
    for i in 0..3 {
        let (a, b) = (f[(i + 1) % 3], f[(i + 2) % 3]);
        for k in 0..3 {
            let (r, s) = ((k + 1) % 3, (k + 2) % 3);
            inverse[i][k] = (a[r] * b[s] - a[s] * b[r]) * one_by;
        }
    }
    products(&inverse)
}

/// Entry of the tensor of a Mandel vector.
#[inline(always)]
fn entry<V: Lanes>(g: &[V; 6], i: usize, j: usize) -> V {
    if i == j { g[i] } else { g[MANDEL[i][j]] * std::f64::consts::FRAC_1_SQRT_2 }
}

/// Entry of the Mandel matrix of `dE -> sym(G dE G)`, `g` a Mandel vector.
#[inline(always)]
fn odot<V: Lanes>(g: &[V; 6], row: usize, column: usize) -> V {
    let ((i, j), (k, l)) = (PAIRS[row], PAIRS[column]);
    (entry(g, i, k) * entry(g, j, l) + entry(g, i, l) * entry(g, j, k)) * (0.5 * WEIGHTS[row] * WEIGHTS[column])
}
