//! Element formulations: what of the strain is taken at the point and what is averaged over the element.

use nalgebra::{Matrix3, Matrix6, Vector6};
use subrope_material::{Law, LawError, PointInput, Request as LawRequest, Response};

use super::kernel::{self, NodeMatrix, NodeVector, PointGeometry};
use crate::contribution::{Energies, Request};

/// Most integration points of an element.
const MAX_POINTS: usize = 27;

/// Integration points of the bricks that average a strain.
const POINTS: usize = 8;

/// What one element is evaluated from.
pub struct ElementInput<'a, const N: usize, L> {
    /// The law.
    pub law: &'a L,
    /// Integration points.
    pub points: &'a [PointGeometry<N>],
    /// Nodal displacements.
    pub displacement: NodeVector<N>,
    /// Committed state of all points.
    pub old: &'a [f64],
    /// Length of the time increment \[s\].
    pub time_increment: f64,
    /// Temperature \[K\].
    pub temperature: f64,
    /// What is wanted.
    pub request: Request,
}

/// Why an element has no answer.
#[derive(Clone, Debug)]
pub enum ElementFailure {
    /// The law failed at a point.
    Law(usize, LawError),
    /// The mean volume ratio is not positive.
    MeanVolume(f64),
}

/// Forces, stiffness and energies of one element.
#[derive(Clone, Debug)]
pub struct ElementResult<const N: usize> {
    /// Stiffness, component-major.
    pub stiffness: NodeMatrix<N>,
    /// Forces \[N\].
    pub force: NodeVector<N>,
    /// Energies \[mJ\].
    pub energies: Energies,
    /// Effective second Piola-Kirchhoff stress of every point \[MPa\], Mandel, fibre frame.
    pub second_piola: [Vector6<f64>; MAX_POINTS],
    /// Why there is none.
    pub failure: Option<ElementFailure>,
}

impl<const N: usize> ElementResult<N> {
    /// All zero.
    pub fn zero() -> Self {
        Self {
            second_piola: [Vector6::zeros(); MAX_POINTS],
            stiffness: [[[[0.0; N]; 3]; N]; 3],
            force: [[0.0; N]; 3],
            energies: Energies::ZERO,
            failure: None,
        }
    }
}

/// How an element turns displacements into strains. `SYMMETRIC` fills only the upper node triangle.
pub trait Formulation<const N: usize>: Send + Sync + 'static {
    /// Whether it needs the law's fibre term.
    const NEEDS_FIBRE_TERM: bool;

    /// Evaluates one element into `out` (zeroed by the caller) and the new state.
    fn evaluate<L: Law, const SYMMETRIC: bool>(
        input: &ElementInput<'_, N, L>,
        new: &mut [f64],
        out: &mut ElementResult<N>,
    ) -> Result<(), ElementFailure>;
}

impl<const N: usize, L: Law> ElementInput<'_, N, L> {
    /// `HR` of a point.
    #[inline(always)]
    pub fn gradient(&self, point: usize) -> Matrix3<f64> {
        kernel::mixed_gradient(&self.displacement, &self.points[point].gradient)
    }

    /// Calls the law at a point with a displacement gradient in the fibre frame.
    #[inline(always)]
    fn call(
        &self,
        point: usize,
        gradient: Matrix3<f64>,
        mean_elongation: Option<f64>,
        new: &mut [f64],
        response: &mut Response,
    ) -> Result<(), ElementFailure> {
        let n = self.law.state_len();
        let (from, to) = (point * n, (point + 1) * n);
        let input = PointInput {
            displacement_gradient: gradient,
            mean_elongation,
            time_increment: self.time_increment,
            temperature: self.temperature,
        };
        let request = match self.request {
            Request::Residual => LawRequest::Stress,
            Request::Tangent => LawRequest::Tangent,
        };
        self.law
            .evaluate(&input, &self.old[from..to], &mut new[from..to], request, response)
            .map_err(|e| ElementFailure::Law(point, e))
    }
}

#[inline(always)]
fn add_energies(response: &Response, volume: f64, out: &mut Energies) {
    out.stored += volume * response.stored_energy;
    out.potential += volume * response.incremental_potential.unwrap_or(0.0);
    out.dissipated_mid[0] += volume * response.dissipated_mid[0];
    out.dissipated_mid[1] += volume * response.dissipated_mid[1];
}

/// Every strain at the point: full integration.
#[derive(Clone, Copy, Debug)]
pub struct Full;

impl<const N: usize> Formulation<N> for Full {
    const NEEDS_FIBRE_TERM: bool = false;

    #[inline(always)]
    fn evaluate<L: Law, const SYMMETRIC: bool>(
        input: &ElementInput<'_, N, L>,
        new: &mut [f64],
        out: &mut ElementResult<N>,
    ) -> Result<(), ElementFailure> {
        let mut response = Response::default();
        for (q, point) in input.points.iter().enumerate() {
            let hr = input.gradient(q);
            let fr = point.frame + hr;
            input.call(q, point.frame.tr_mul(&hr), None, new, &mut response)?;
            out.second_piola[q] = response.second_piola;
            kernel::add_force(&fr, &response.second_piola, point.volume, &point.gradient, &mut out.force);
            if input.request == Request::Tangent {
                let (s, d) = (&response.second_piola, &response.tangent);
                kernel::add_stiffness::<N, SYMMETRIC>(&fr, s, d, point, &mut out.stiffness);
            }
            add_energies(&response, point.volume, &mut out.energies);
        }
        Ok(())
    }
}

/// The fibre elongation averaged over the element: `I_bar = sum(w I_elong)/sum(w)` in the axial energy; all other strain
/// modes at the point. Cures fibre locking. Symmetric whenever the law is.
///
/// With `V = 2 dI_elong/dC = e1 e1/C11`, `b = dI_bar/du`, `s = dW/dI_bar` meaned over the element:
/// `S = S_law + s_bar V`, and the tangent gets `-2 s_bar e1e1e1e1/C11^2` at the point and
/// `a (x) b + b (x) c + h b (x) b` over the element.
#[derive(Clone, Copy, Debug)]
pub struct MeanElongation;

/// Element sums of an averaged strain: its gradient and the couplings.
struct MeanTerms {
    gradient: NodeVector<8>,
    stress_coupling: NodeVector<8>,
    strain_coupling: NodeVector<8>,
    stiffness: f64,
}

impl MeanTerms {
    const fn zero() -> Self {
        Self { gradient: [[0.0; 8]; 3], stress_coupling: [[0.0; 8]; 3], strain_coupling: [[0.0; 8]; 3], stiffness: 0.0 }
    }

    #[inline(always)]
    fn add_to(&self, out: &mut NodeMatrix<8>) {
        kernel::add_dyad(&self.stress_coupling, &self.gradient, 1.0, out);
        kernel::add_dyad(&self.gradient, &self.strain_coupling, 1.0, out);
        kernel::add_dyad(&self.gradient, &self.gradient, self.stiffness, out);
    }
}

impl Formulation<8> for MeanElongation {
    const NEEDS_FIBRE_TERM: bool = true;

    #[inline(always)]
    fn evaluate<L: Law, const SYMMETRIC: bool>(
        input: &ElementInput<'_, 8, L>,
        new: &mut [f64],
        out: &mut ElementResult<8>,
    ) -> Result<(), ElementFailure> {
        let mut gradients = [Matrix3::zeros(); POINTS];
        let mut stretch = [0.0; POINTS];
        let (mut mean, mut volume) = (0.0, 0.0);
        for (q, point) in input.points.iter().enumerate() {
            let hr = input.gradient(q);
            let e11 = fibre_strain(&point.frame, &hr);
            if e11.is_nan() || e11 <= -0.5 {
                return Err(ElementFailure::Law(q, LawError::Inverted { jacobian: 1.0 + 2.0 * e11 }));
            }
            (gradients[q], stretch[q]) = (hr, 1.0 + 2.0 * e11);
            mean += point.volume * 0.5 * (2.0 * e11).ln_1p();
            volume += point.volume;
        }
        mean /= volume;
        let mut responses: [Response; POINTS] = std::array::from_fn(|_| Response::default());
        let mut fibre_stress = 0.0;
        for (q, point) in input.points.iter().enumerate() {
            let response = &mut responses[q];
            input.call(q, point.frame.tr_mul(&gradients[q]), Some(mean), new, response)?;
            fibre_stress += point.volume * response.fibre.fibre_stress / volume;
            add_energies(response, point.volume, &mut out.energies);
        }
        let mut terms = MeanTerms::zero();
        for (q, point) in input.points.iter().enumerate() {
            let response = &mut responses[q];
            let fr = point.frame + gradients[q];
            let measure = Vector6::new(1.0 / stretch[q], 0.0, 0.0, 0.0, 0.0, 0.0);
            response.second_piola[0] += fibre_stress / stretch[q];
            out.second_piola[q] = response.second_piola;
            kernel::add_force(&fr, &response.second_piola, point.volume, &point.gradient, &mut out.force);
            if input.request == Request::Tangent {
                response.tangent[(0, 0)] -= 2.0 * fibre_stress / (stretch[q] * stretch[q]);
                let (s, d) = (&response.second_piola, &response.tangent);
                kernel::add_stiffness::<8, SYMMETRIC>(&fr, s, d, point, &mut out.stiffness);
                let (g, w, f) = (&point.gradient, point.volume, &response.fibre);
                kernel::add_force(&fr, &measure, w / volume, g, &mut terms.gradient);
                kernel::add_force(&fr, &f.stress_by_elongation, w, g, &mut terms.stress_coupling);
                kernel::add_force(&fr, &f.fibre_stress_by_strain, w, g, &mut terms.strain_coupling);
                terms.stiffness += w * f.fibre_stiffness;
            }
        }
        if input.request == Request::Tangent {
            terms.add_to(&mut out.stiffness);
        }
        Ok(())
    }
}

/// `E11` in the fibre frame, from `HR`.
#[inline(always)]
fn fibre_strain(frame: &Matrix3<f64>, hr: &Matrix3<f64>) -> f64 {
    let (e, h) = (frame.column(0), hr.column(0));
    e.dot(&h) + 0.5 * h.dot(&h)
}

/// The volume ratio averaged over the element (what Abaqus calls C3D8): the law sees `F_bar = (J_bar/J)^(1/3) F`,
/// `J_bar = sum(w J)/sum(w)`. Forces are the derivative of the energy of `F_bar`, so the tangent is symmetric whenever
/// the law's is.
///
/// With `v = ln J`, `psi = 2/3 (ln J_bar - v)`, `C_bar = e^psi C`, `S* = e^psi S(C_bar)`, `s = S*:C/2`, `G = C^-1`:
/// `S_eff = S* + 2/3 (w_J mean(s) - s) G` with `w_J = J/J_bar`, and the tangent follows by one more variation.
#[derive(Clone, Copy, Debug)]
pub struct MeanVolume;

/// A point of the mean-volume brick between its two passes.
#[derive(Clone, Copy)]
struct VolumePoint {
    hr: Matrix3<f64>,
    h: Matrix3<f64>,
    /// `J - 1`.
    dilation: f64,
}

impl Formulation<8> for MeanVolume {
    const NEEDS_FIBRE_TERM: bool = false;

    #[inline(always)]
    fn evaluate<L: Law, const SYMMETRIC: bool>(
        input: &ElementInput<'_, 8, L>,
        new: &mut [f64],
        out: &mut ElementResult<8>,
    ) -> Result<(), ElementFailure> {
        let zero = VolumePoint { hr: Matrix3::zeros(), h: Matrix3::zeros(), dilation: 0.0 };
        let mut kinematics = [zero; POINTS];
        let (mut mean, mut volume) = (0.0, 0.0);
        for (q, point) in input.points.iter().enumerate() {
            let hr = input.gradient(q);
            let h = point.frame.tr_mul(&hr);
            let dilation = dilation(&h);
            if dilation.is_nan() || dilation <= -1.0 {
                return Err(ElementFailure::Law(q, LawError::Inverted { jacobian: 1.0 + dilation }));
            }
            kinematics[q] = VolumePoint { hr, h, dilation };
            mean += point.volume * dilation;
            volume += point.volume;
        }
        mean /= volume;
        if mean.is_nan() || mean <= -1.0 {
            return Err(ElementFailure::MeanVolume(1.0 + mean));
        }
        let mut responses: [Response; POINTS] = std::array::from_fn(|_| Response::default());
        let mut pressure = [0.0; POINTS];
        let mut total = 0.0;
        for (q, point) in input.points.iter().enumerate() {
            let (k, response) = (&kinematics[q], &mut responses[q]);
            let psi = (mean.ln_1p() - k.dilation.ln_1p()) * (2.0 / 3.0);
            let grow = (0.5 * psi).exp_m1();
            input.call(q, k.h * (1.0 + grow) + Matrix3::identity() * grow, None, new, response)?;
            response.second_piola *= psi.exp();
            response.tangent *= (2.0 * psi).exp();
            pressure[q] = 0.5 * response.second_piola.dot(&right_cauchy_green(&k.h));
            total += point.volume * pressure[q];
            add_energies(response, point.volume, &mut out.energies);
        }
        let mut terms = MeanTerms::zero();
        // Second variation of ln J_bar: the part that the mean itself carries.
        let mut volumetric = -2.0 / 3.0 * total;
        for (q, point) in input.points.iter().enumerate() {
            let (k, w, g) = (&kinematics[q], point.volume, &point.gradient);
            let fr = point.frame + k.hr;
            let weight = (1.0 + k.dilation) / (1.0 + mean) / volume;
            let split = VolumeSplit::new(k, &responses[q], pressure[q], total * weight);
            out.second_piola[q] = split.stress;
            kernel::add_force(&fr, &split.stress, w, g, &mut out.force);
            if input.request == Request::Tangent {
                kernel::add_stiffness::<8, SYMMETRIC>(&fr, &split.stress, &split.tangent, point, &mut out.stiffness);
                kernel::add_force(&fr, &split.inverse, w * weight, g, &mut terms.gradient);
                kernel::add_force(&fr, &split.coupling, w, g, &mut terms.stress_coupling);
                kernel::add_force(&fr, &split.coupling_transposed, w, g, &mut terms.strain_coupling);
                volumetric += w * split.stiffness;
            }
        }
        if input.request == Request::Tangent {
            terms.stiffness = volumetric;
            terms.add_to(&mut out.stiffness);
        }
        Ok(())
    }
}

/// Effective stress and tangent of a point of the mean-volume brick.
struct VolumeSplit {
    stress: Vector6<f64>,
    tangent: Matrix6<f64>,
    /// `G = C^-1`, gradient of `ln J` by `E`.
    inverse: Vector6<f64>,
    /// `d2W/dE d(ln J_bar)`, row and column version.
    coupling: Vector6<f64>,
    coupling_transposed: Vector6<f64>,
    /// `d2W/d(ln J_bar)2`.
    stiffness: f64,
}

impl VolumeSplit {
    /// `share`: `sum(w s) * J/(J_bar V)`, so that `2/3 share G` is the stress that the mean returns to this point.
    #[inline(always)]
    fn new(k: &VolumePoint, response: &Response, s: f64, share: f64) -> Self {
        let c = right_cauchy_green(&k.h);
        let inverse_tensor = inverse_of(&k.h, 1.0 + k.dilation);
        let g = mandel(&inverse_tensor);
        let stress = response.second_piola + g * (2.0 / 3.0 * (share - s));
        // P = 1 - c g/3 takes dE to the isochoric part that the law sees (times e^psi).
        let dc = response.tangent * c;
        let cd = response.tangent.tr_mul(&c);
        let cdc = c.dot(&dc);
        let mut tangent = response.tangent - (dc * g.transpose() + g * cd.transpose()) / 3.0;
        tangent += g * g.transpose() * (cdc / 9.0 + 4.0 / 9.0 * s + 2.0 / 3.0 * share);
        tangent -= (response.second_piola * g.transpose() + g * response.second_piola.transpose()) * (2.0 / 3.0);
        // Second variation of ln J: -G sym-odot G.
        tangent -= odot(&inverse_tensor) * (2.0 / 3.0 * (share - s)) * 2.0;
        let own = response.second_piola * (2.0 / 3.0) - g * (4.0 / 9.0 * s);
        Self {
            stress,
            tangent,
            inverse: g,
            coupling: dc / 3.0 - g * (cdc / 9.0) + own,
            coupling_transposed: cd / 3.0 - g * (cdc / 9.0) + own,
            stiffness: cdc / 9.0 + 4.0 / 9.0 * s,
        }
    }
}

/// `J - 1 = tr H + (tr^2 H - tr H^2)/2 + det H`: no cancellation at small strain.
#[inline(always)]
fn dilation(h: &Matrix3<f64>) -> f64 {
    let minors = h[(0, 0)] * h[(1, 1)] - h[(0, 1)] * h[(1, 0)] + h[(0, 0)] * h[(2, 2)] - h[(0, 2)] * h[(2, 0)]
        + h[(1, 1)] * h[(2, 2)]
        - h[(1, 2)] * h[(2, 1)];
    h.trace() + minors + h.determinant()
}

#[inline(always)]
fn right_cauchy_green(h: &Matrix3<f64>) -> Vector6<f64> {
    let f = h + Matrix3::identity();
    mandel(&f.tr_mul(&f))
}

/// `C^-1` from the displacement gradient.
#[inline(always)]
fn inverse_of(h: &Matrix3<f64>, jacobian: f64) -> Matrix3<f64> {
    let f = h + Matrix3::identity();
    let (a, b, c) = (f.column(0), f.column(1), f.column(2));
    let (bc, ca, ab) = (b.cross(&c), c.cross(&a), a.cross(&b));
    let inverse = Matrix3::from_rows(&[bc.transpose(), ca.transpose(), ab.transpose()]) / jacobian;
    inverse * inverse.transpose()
}

#[inline(always)]
fn mandel(m: &Matrix3<f64>) -> Vector6<f64> {
    const R: f64 = std::f64::consts::SQRT_2;
    Vector6::new(m[(0, 0)], m[(1, 1)], m[(2, 2)], R * m[(0, 1)], R * m[(0, 2)], R * m[(1, 2)])
}

/// Mandel matrix of `dE -> sym(G dE G)`.
#[inline(always)]
fn odot(g: &Matrix3<f64>) -> Matrix6<f64> {
    const PAIR: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];
    const R: f64 = std::f64::consts::SQRT_2;
    Matrix6::from_fn(|r, c| {
        let ((i, j), (k, l)) = (PAIR[r], PAIR[c]);
        let scale = if r < 3 { 1.0 } else { R } * if c < 3 { 1.0 } else { R };
        scale * 0.5 * (g[(i, k)] * g[(j, l)] + g[(i, l)] * g[(j, k)])
    })
}
