//! Stress against the potential, tangent and fibre response against the stress.

use nalgebra::{Matrix6, SMatrix, Vector6};

use super::failure::{compare, largest};
use super::stencil::{self, Sample};
use super::walk::{Step, answer, no_answer, walk};
use super::{Path, TestkitFailure};
use crate::driver::strained;
use crate::law::{Law, PointInput, Response};

/// Accepted error of a difference quotient relative to the largest entry.
const TOLERANCE: f64 = 5e-7;
/// Mean elongations tried, relative to the point's own \[-\].
const OFFSETS: [f64; 3] = [-2e-3, 0.0, 7e-3];
/// Columns that must have been compared away from kinks.
const ENOUGH: usize = 4;

/// Derivatives of a sample by the six strain entries, with the columns that crossed a kink left out.
struct Jacobian {
    columns: Vec<(usize, Sample)>,
}

impl Jacobian {
    fn new(label: (&'static str, usize), law: &dyn Law, step: &Step) -> Result<Self, TestkitFailure> {
        let (check, index) = label;
        let mut columns = Vec::with_capacity(6);
        for entry in 0..6 {
            let moved = |size: f64| strained(&step.input, entry, size);
            let column = stencil::derivative(law, &step.old, moved).map_err(no_answer(check, index))?;
            columns.extend(column.map(|column| (entry, column)));
        }
        let compared = columns.len();
        if compared < ENOUGH {
            return Err(TestkitFailure::NothingCompared { check, step: index, compared });
        }
        Ok(Self { columns })
    }

    /// Compares row `row` of the Jacobian with a vector.
    fn compare_row(
        &self,
        label: (&'static str, usize),
        row: usize,
        found: &Vector6<f64>,
        tolerance: f64,
    ) -> Result<(), TestkitFailure> {
        let mut expected = *found;
        for (entry, column) in &self.columns {
            expected[*entry] = column[row];
        }
        compare(label, found.as_slice(), expected.as_slice(), 6, tolerance)
    }

    fn compare_tangent(
        &self,
        label: (&'static str, usize),
        found: &Matrix6<f64>,
        tolerance: f64,
    ) -> Result<(), TestkitFailure> {
        let mut expected = *found;
        for (entry, column) in &self.columns {
            expected.set_column(*entry, &column.fixed_rows::<6>(0));
        }
        compare(label, found.as_slice(), expected.as_slice(), 6, tolerance)
    }
}

/// `S = dV/dE`, `V` the incremental potential, by central differences.
///
/// # Errors
/// [`TestkitFailure`], also when the law says it has a potential and gives none.
pub fn stress_is_gradient(law: &dyn Law, path: &Path) -> Result<(), TestkitFailure> {
    const CHECK: &str = "stress against the incremental potential";
    walk(CHECK, law, path, |step| {
        if law.has_potential() != step.out.incremental_potential.is_some() {
            return Err(TestkitFailure::Contradiction { what: "has_potential" });
        }
        if !law.has_potential() {
            return Ok(());
        }
        gradient_of_step((CHECK, step.index), law, step)
    })
}

fn gradient_of_step(label: (&'static str, usize), law: &dyn Law, step: &Step) -> Result<(), TestkitFailure> {
    let scale = largest(step.out.second_piola.as_slice());
    // The truncation of the quotient is third order in the modulus.
    let tolerance = TOLERANCE * (scale + 1e-3 * largest(step.out.tangent.as_slice()));
    Jacobian::new(label, law, step)?.compare_row(label, 6, &step.out.second_piola, tolerance)
}

/// The tangent is the derivative of the stress of the discrete update, by central differences.
///
/// # Errors
/// [`TestkitFailure`].
pub fn tangent_is_derivative(law: &dyn Law, path: &Path) -> Result<(), TestkitFailure> {
    const CHECK: &str = "tangent against differences of the stress";
    walk(CHECK, law, path, |step| tangent_of_step((CHECK, step.index), law, step, TOLERANCE))
}

/// The tangent at one step, to an error relative to its largest entry.
pub(super) fn tangent_of_step(
    label: (&'static str, usize),
    law: &dyn Law,
    step: &Step,
    relative: f64,
) -> Result<(), TestkitFailure> {
    let tolerance = relative * largest(step.out.tangent.as_slice());
    Jacobian::new(label, law, step)?.compare_tangent(label, &step.out.tangent, tolerance)
}

/// With the point's own elongation as mean elongation the split response adds up to the plain one:
/// `S + fibre_stress g` and `D + dS/de (x) g + g (x) dfibre/dE + fibre_stiffness g (x) g - (2/C11^2) fibre_stress e11
/// (x) e11`, `g = 2 dI_elong/dC = e11/C11`.
///
/// # Errors
/// [`TestkitFailure`].
pub fn mean_elongation_split(law: &dyn Law, path: &Path) -> Result<(), TestkitFailure> {
    const CHECK: &str = "split response against the plain one";
    walk(CHECK, law, path, |step| {
        let (elongation, c11) = own_elongation(&step.input);
        let input = step.input.clone().with_mean_elongation(elongation);
        let (split, new) = answer(law, &input, &step.old).map_err(no_answer(CHECK, step.index))?;
        let label = (CHECK, step.index);
        let (stress, tangent) = recombine(&split, c11);
        let plain = &step.out;
        let scale = 1e-12 * largest(plain.tangent.as_slice());
        compare(label, stress.as_slice(), plain.second_piola.as_slice(), 6, scale)?;
        compare(label, tangent.as_slice(), plain.tangent.as_slice(), 6, scale)?;
        compare(label, &[split.stored_energy], &[plain.stored_energy], 1, scale)?;
        compare(label, &new, &step.new, new.len().max(1), 1e-12)
    })
}

/// Stress and tangent of the point from a response split off at its own elongation.
fn recombine(split: &Response, c11: f64) -> (Vector6<f64>, Matrix6<f64>) {
    let fibre = &split.fibre;
    let mut g = Vector6::zeros();
    g[0] = 1.0 / c11;
    let curvature = fibre.fibre_stiffness - 2.0 * fibre.fibre_stress;
    let tangent = split.tangent
        + fibre.stress_by_elongation * g.transpose()
        + g * fibre.fibre_stress_by_strain.transpose()
        + g * g.transpose() * curvature;
    (split.second_piola + g * fibre.fibre_stress, tangent)
}

/// The point's own elongation and `C11`.
fn own_elongation(input: &PointInput) -> (f64, f64) {
    let growth = 2.0 * crate::mandel::green_lagrange(&input.displacement_gradient)[0];
    (0.5 * growth.ln_1p(), 1.0 + growth)
}

/// All blocks of the response at mean elongations below, at and above the point's own, by central differences.
///
/// # Errors
/// [`TestkitFailure`].
pub fn mean_elongation_derivatives(law: &dyn Law, path: &Path) -> Result<(), TestkitFailure> {
    walk("response with mean elongation", law, path, |step| {
        let (own, _) = own_elongation(&step.input);
        OFFSETS.iter().try_for_each(|offset| averaged_step(law, step, own + offset))
    })
}

fn averaged_step(law: &dyn Law, step: &Step, elongation: f64) -> Result<(), TestkitFailure> {
    let index = step.index;
    let input = step.input.clone().with_mean_elongation(elongation);
    let (out, new) = answer(law, &input, &step.old).map_err(no_answer("response with mean elongation", index))?;
    let scale = largest(out.tangent.as_slice()) + out.fibre.fibre_stiffness.abs();
    let step = Step { index, input, old: step.old.clone(), new, out };
    let by_strain = Jacobian::new(("by strain, with mean elongation", index), law, &step)?;
    let tolerance = TOLERANCE * scale;
    let Step { out, .. } = &step;
    by_strain.compare_tangent(("tangent at fixed mean elongation", index), &out.tangent, tolerance)?;
    let fibre = &out.fibre;
    by_strain.compare_row(("fibre stress by strain", index), 7, &fibre.fibre_stress_by_strain, tolerance)?;
    if law.has_potential() {
        let label = ("stress at fixed mean elongation", index);
        by_strain.compare_row(label, 6, &out.second_piola, TOLERANCE * (1e-3 * scale))?;
    }
    by_elongation(law, &step, elongation, tolerance)
}

/// Derivatives by the mean elongation: stress, potential, fibre stress.
fn by_elongation(law: &dyn Law, step: &Step, elongation: f64, tolerance: f64) -> Result<(), TestkitFailure> {
    let moved = |size: f64| Ok(step.input.clone().with_mean_elongation(elongation + size));
    let label = ("derivatives by the mean elongation", step.index);
    let fibre = &step.out.fibre;
    let Some(expected) = stencil::derivative(law, &step.old, moved).map_err(no_answer(label.0, label.1))? else {
        return Ok(());
    };
    let mut found: Sample = SMatrix::zeros();
    found.fixed_rows_mut::<6>(0).copy_from(&fibre.stress_by_elongation);
    found[6] = if law.has_potential() { fibre.fibre_stress } else { 0.0 };
    found[7] = fibre.fibre_stiffness;
    compare(label, found.as_slice(), expected.as_slice(), 8, tolerance)
}
