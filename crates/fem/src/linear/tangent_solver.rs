//! Systems whose matrix may be unsymmetric, and may have more beside it than its values.
//!
//! A symmetric matrix alone is factorised and solved. Otherwise the `LDL^T` of its symmetric part preconditions GMRES:
//! what friction adds that is not symmetric is small or of low rank, so that a few iterations cost far less than an `LU`,
//! which has to leave the order of least fill. Where the symmetric part is no guide, the `LU` takes its place. In the same
//! way factors serve matrices near the one that they were made of.

use super::condition::condition;
use super::error::LinearError;
use super::gmres::{Gmres, GmresLimits, LinearOperator};
use super::options::{AnalysisReport, FactorReport, Method, SolverOptions};
use super::pattern::{SparsePattern, Storage};
use super::solver::LinearSolver;
use super::symmetric_part::SymmetricPart;

/// What a matrix has beside its values.
pub trait LinearTerm {
    /// Whether there is nothing.
    fn is_empty(&self) -> bool;

    /// `out += B x`.
    fn multiply_add(&self, x: &[f64], out: &mut [f64]);
}

/// A solver of systems of one pattern.
pub struct TangentSolver {
    pattern: SparsePattern,
    options: SolverOptions,
    solver: LinearSolver,
    /// Of a full pattern, unless its `LU` is wanted from the start.
    part: Option<SymmetricPart>,
    /// The `LU`, once it was needed.
    fallback: Option<Box<LinearSolver>>,
    gmres: Gmres,
    report: AnalysisReport,
}

impl TangentSolver {
    /// Orders the unknowns and builds the structure of the factors. A full pattern is solved through its symmetric part,
    /// unless the options name a method for unsymmetric values. The pattern is kept.
    ///
    /// # Errors
    /// As [`LinearSolver::analyse`].
    pub fn analyse(pattern: SparsePattern, options: &SolverOptions) -> Result<Self, LinearError> {
        let split = pattern.storage() == Storage::Full && options.unsymmetric.is_none();
        let part = split.then(|| SymmetricPart::new(&pattern));
        let solver = LinearSolver::analyse(part.as_ref().map_or(&pattern, SymmetricPart::pattern), options)?;
        let mut report = solver.analysis().clone();
        report.bytes += part.as_ref().map_or(0, SymmetricPart::bytes);
        Ok(Self { pattern, options: options.clone(), solver, part, fallback: None, gmres: Gmres::default(), report })
    }

    /// The pattern of the whole matrix.
    pub fn pattern(&self) -> &SparsePattern {
        &self.pattern
    }

    /// What the analysis found, of the symmetric part where that is factorised; its memory is without an `LU` that may be
    /// needed later.
    pub fn analysis(&self) -> &AnalysisReport {
        &self.report
    }

    /// Factorises the matrix with `values` in the order of the pattern, or its symmetric part.
    ///
    /// # Errors
    /// As [`LinearSolver::factorise`].
    pub fn factorise(&mut self, values: &[f64]) -> Result<FactorReport, LinearError> {
        match &mut self.part {
            None => self.solver.factorise(values),
            Some(part) => {
                let report = self.solver.factorise(part.of(values))?;
                // Those of the symmetric part say nothing of the eigenvalues of the matrix.
                Ok(FactorReport { negative_pivots: None, ..report })
            }
        }
    }

    /// Solves `(A + B) x = rhs` with `A` of the values last factorised; answers the iterations of GMRES that it took.
    ///
    /// # Errors
    /// As [`LinearSolver::solve`]; [`LinearError::Stalled`].
    pub fn solve(
        &mut self,
        values: &[f64],
        term: &dyn LinearTerm,
        rhs: &[f64],
        x: &mut [f64],
    ) -> Result<usize, LinearError> {
        if self.part.is_none() && term.is_empty() {
            self.solver.solve(values, rhs, x)?;
            return Ok(0);
        }
        match self.solve_by_kept_factors(values, term, &GmresLimits::default(), rhs, x) {
            Err(LinearError::Stalled { iterations, .. }) if self.part.is_some() => {
                Ok(iterations + self.solve_by_lu(values, term, rhs, x)?)
            }
            outcome => outcome,
        }
    }

    /// As [`TangentSolver::solve`] with `A` of any `values`, near enough to those last factorised for GMRES to come within
    /// its limits.
    ///
    /// # Errors
    /// As [`LinearSolver::solve_once`]; [`LinearError::Stalled`].
    pub fn solve_by_kept_factors(
        &mut self,
        values: &[f64],
        term: &dyn LinearTerm,
        limits: &GmresLimits,
        rhs: &[f64],
        x: &mut [f64],
    ) -> Result<usize, LinearError> {
        let Self { pattern, solver, part, gmres, .. } = self;
        let own_values = part.as_ref().map_or(values, SymmetricPart::values);
        let mut operator = Preconditioned { pattern, values, term, solver, own_values };
        Ok(gmres.solve(&mut operator, limits, rhs, x)?.iterations)
    }

    /// Iterations of GMRES that cost as much as a factorisation; zero where factors serve no values but their own.
    pub fn worth_of_factors(&self) -> f64 {
        let fill = &self.report.fill;
        if self.report.method == Method::Ldlt { fill.flops / (fill.nonzeros * SOLUTION) } else { 0.0 }
    }

    /// Estimate of the condition number \[-\] of the symmetric matrix last factorised, scaled to a unit diagonal:
    /// `|D A D|_1 |(D A D)^-1|_1` by Hager's and Higham's method, from a few solves. Of an unsymmetric matrix it is that of
    /// its symmetric part; none where neither was factorised.
    pub fn condition(&mut self, values: &[f64]) -> Option<f64> {
        let Self { pattern, solver, part, .. } = self;
        let (pattern, values) = match part {
            Some(part) => (part.pattern().clone(), part.of(values).to_vec()),
            None if pattern.storage() == Storage::Lower => (pattern.clone(), values.to_vec()),
            None => return None,
        };
        let estimate = condition((&pattern, &values), |b, x| solver.solve_once(&values, b, x));
        estimate.ok().filter(|c| c.is_finite())
    }

    fn solve_by_lu(
        &mut self,
        values: &[f64],
        term: &dyn LinearTerm,
        rhs: &[f64],
        x: &mut [f64],
    ) -> Result<usize, LinearError> {
        let Self { pattern, options, fallback, gmres, .. } = self;
        let solver = match fallback {
            Some(solver) => solver,
            None => fallback.insert(Box::new(LinearSolver::analyse(pattern, options)?)),
        };
        solver.factorise(values)?;
        let mut operator = Preconditioned { pattern, values, term, solver, own_values: values };
        Ok(gmres.solve(&mut operator, &GmresLimits::default(), rhs, x)?.iterations)
    }
}

/// Operations of a factorisation in the time of a solution, per entry of the factors: the one is bound by arithmetic, the
/// other by memory. Measured on forty million entries, where it was 33 to 38 on one machine.
const SOLUTION: f64 = 40.0;

/// Matrix and term, preconditioned by the factors of a solver.
struct Preconditioned<'a> {
    pattern: &'a SparsePattern,
    values: &'a [f64],
    term: &'a dyn LinearTerm,
    solver: &'a mut LinearSolver,
    /// Values in the pattern of the solver.
    own_values: &'a [f64],
}

impl LinearOperator for Preconditioned<'_> {
    fn apply(&mut self, x: &[f64], out: &mut [f64]) -> Result<(), LinearError> {
        self.pattern.multiply(self.values, x, out)?;
        self.term.multiply_add(x, out);
        Ok(())
    }

    fn precondition(&mut self, x: &[f64], out: &mut [f64]) -> Result<(), LinearError> {
        self.solver.solve_once(self.own_values, x, out)
    }
}
