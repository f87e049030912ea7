//! Runs a law along every path of a file.

use nalgebra::Matrix3;
use subrope_material::driver::{PointDriver, PointStep};
use subrope_material::{BundleLaw, Law, mandel};

use super::error::{EntryFault, Place, PointError};
use super::record::{PathFile, PathRecord, StepRecord, Tensor, text};
use super::{displacement_gradient_of, parameters};
use crate::law;

/// Step in strain of the difference quotients \[-\].
const DIFFERENCE_STEP: f64 = 1e-6;

/// Fills in everything a law answers along every path; `name` is what errors call the file. With `differences` the
/// tangent by difference quotients stands beside the law's own.
///
/// # Errors
/// [`PointError::Entry`] for an entry that cannot be used, [`PointError::Law`] for a step without an answer.
pub fn compute(name: &str, paths: &PathFile, differences: bool) -> Result<PathFile, PointError> {
    let mut computed = paths.clone();
    computed.precision = text::precision();
    for (index, path) in computed.paths.iter_mut().enumerate() {
        let run = Run { file: name, index, name: path.name.clone() };
        run.path(path, differences)?;
    }
    Ok(computed)
}

/// One path, for errors.
struct Run<'a> {
    file: &'a str,
    index: usize,
    name: String,
}

impl Run<'_> {
    fn place(&self, step: Option<usize>) -> Box<Place> {
        Box::new(Place { file: self.file.to_owned(), path: Some(self.index), name: self.name.clone(), step })
    }

    fn entry(&self, step: Option<usize>) -> impl FnOnce(EntryFault) -> PointError {
        let place = self.place(step);
        move |fault| PointError::Entry { place, fault }
    }

    fn no_answer(&self, step: Option<usize>) -> impl FnOnce(subrope_material::LawError) -> PointError {
        let place = self.place(step);
        move |source| PointError::Law { place, source }
    }

    fn law(&self, path: &PathRecord) -> Result<Box<dyn Law>, PointError> {
        match &path.law {
            Some(own) => law::build(own).map_err(self.no_answer(None)),
            None => {
                let parameters = parameters::read(&path.params).map_err(self.entry(None))?;
                Ok(Box::new(BundleLaw::new(parameters).map_err(self.no_answer(None))?))
            }
        }
    }

    fn path(&self, path: &mut PathRecord, differences: bool) -> Result<(), PointError> {
        let law = self.law(path)?;
        let frame = rotation(&path.frame).map_err(self.entry(None))?;
        let mut driver = PointDriver::new(law.as_ref(), frame);
        if differences {
            driver = driver.with_difference_tangent(DIFFERENCE_STEP);
        }
        if path.state0.len() != 8 {
            return Err(self.entry(None)(EntryFault::State { found: path.state0.len() }));
        }
        let mut state = resized(&path.state0, law.state_len());
        for (index, step) in path.steps.iter_mut().enumerate() {
            let gradient = gradient(step, &frame).map_err(self.entry(Some(index)))?;
            let answer = driver.step(&state, &gradient).map_err(self.no_answer(Some(index)))?;
            record(step, &gradient, &frame, &state, &answer);
            state = answer.state;
        }
        Ok(())
    }
}

/// The numbers of a law's state that the file holds: what the file lacks is 0.
fn resized(state: &[f64], length: usize) -> Vec<f64> {
    let mut state = state.to_vec();
    state.resize(length, 0.0);
    state
}

fn matrix(rows: &Tensor) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| rows[i][j])
}

fn rows(matrix: &Matrix3<f64>) -> Tensor {
    std::array::from_fn(|i| std::array::from_fn(|j| matrix[(i, j)]))
}

/// The frame as a matrix, if it is a rotation.
fn rotation(frame: &Tensor) -> Result<Matrix3<f64>, EntryFault> {
    let frame = matrix(frame);
    let error = (frame.tr_mul(&frame) - Matrix3::identity()).amax();
    let deviation = if frame.determinant() < 0.0 { 2.0 } else { error };
    if deviation < 1e-9 { Ok(frame) } else { Err(EntryFault::Frame { deviation }) }
}

/// The global displacement gradient of a step: `H`, else `F - 1`, else from the modes.
fn gradient(step: &StepRecord, frame: &Matrix3<f64>) -> Result<Matrix3<f64>, EntryFault> {
    let (key, gradient) = match (&step.H, &step.F, &step.modes) {
        (Some(h), _, _) => ("H", matrix(h)),
        (None, Some(f), _) => ("F", matrix(f) - Matrix3::identity()),
        (None, None, Some(modes)) => ("modes", frame * displacement_gradient_of(modes) * frame.transpose()),
        (None, None, None) => return Err(EntryFault::NoDeformation),
    };
    if gradient.iter().all(|v| v.is_finite()) { Ok(gradient) } else { Err(EntryFault::NotFinite { key }) }
}

fn record(step: &mut StepRecord, gradient: &Matrix3<f64>, frame: &Matrix3<f64>, old: &[f64], answer: &PointStep) {
    let f = gradient + Matrix3::identity();
    let in_frame = f * frame;
    let c = in_frame.tr_mul(&in_frame);
    let modes = &answer.modes;
    let ([d1, d2], [g2, g3]) = (modes.distortion, modes.longitudinal_shear);
    step.F.get_or_insert(rows(&f));
    step.C_fibre = Some(mandel::PAIRS.map(|(i, j)| c[(i, j)]));
    step.I = Some([modes.elongation, modes.compaction, d1, d2, g2, g3]);
    step.q = answer.forces.as_ref().map(|f| f.to_array());
    step.p = answer.forces.as_ref().map(|f| f.compaction_pressure);
    step.slip = answer.forces.as_ref().map(|f| f.slides);
    step.W = Some(answer.response.stored_energy);
    step.S_fibre = Some(mandel::to_voigt_stress(&answer.response.second_piola));
    step.S_global = Some(mandel::to_voigt_stress(&answer.second_piola_global));
    step.D_fibre = Some(voigt(&answer.response.tangent));
    step.D_difference = answer.difference_tangent.as_ref().map(voigt);
    let (before, after) = (resized(old, 8), resized(&answer.state, 8));
    step.dW_dissip = Some([after[6] - before[6], after[7] - before[7]]);
    step.state = Some(after);
}

fn voigt(tangent: &nalgebra::Matrix6<f64>) -> [[f64; 6]; 6] {
    let voigt = mandel::to_voigt_tangent(tangent);
    std::array::from_fn(|i| std::array::from_fn(|j| voigt[(i, j)]))
}
