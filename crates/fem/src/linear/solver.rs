//! Analyse once, factorise many times, solve with refinement and a check.

use super::block_lu::BlockLu;
use super::block_plan::{BlockPlan, cheapest_levels};
use super::error::{LinearError, Operand};
use super::fill::FillEstimate;
use super::graph::Graph;
use super::ldlt::Ldlt;
use super::ldlt_plan::Plan;
use super::options::{AnalysisReport, FactorReport, Method, SolveReport, SolverOptions};
use super::ordering::{Candidate, Ordering, choose};
use super::pattern::{SparsePattern, Storage, expect_length};
use super::sparse_lu::SparseLu;
use super::supernodes::{Limits, Supernodes};

/// Entries of a sparse LU with column ordering relative to those of an LU in the best symmetric order, as measured on
/// strands.
const COLUMN_ORDER_FILL: f64 = 4.0;

/// A direct solver for matrices of one pattern.
///
/// Symmetric values ([`Storage::Lower`]) are factorised by a supernodal LDLᵀ, unsymmetric ones ([`Storage::Full`]) by
/// LU. Factorisations and solutions allocate nothing (apart from [`Method::SparseLu`]). Results are bitwise equal for
/// any number of threads.
pub struct LinearSolver {
    pattern: SparsePattern,
    options: SolverOptions,
    report: AnalysisReport,
    backend: Backend,
    factorised: bool,
    norm: f64,
    /// Largest entry of every row.
    scale: Vec<f64>,
    residual: Vec<f64>,
    permuted: Vec<f64>,
    buffer: Vec<f64>,
}

enum Backend {
    Ldlt(Box<Ldlt>),
    Block(Box<BlockLu>),
    Sparse(Box<SparseLu>),
}

struct Prepared {
    backend: Backend,
    method: Method,
    ordering: Ordering,
    fill: FillEstimate,
    candidates: Vec<Candidate>,
    branches: usize,
}

impl LinearSolver {
    /// Orders the unknowns and builds the structure of the factors.
    ///
    /// # Errors
    /// [`LinearError::OutOfMemory`], [`LinearError::FactorTooLarge`], [`LinearError::TooManyUnknowns`],
    /// [`LinearError::Metis`].
    pub fn analyse(pattern: &SparsePattern, options: &SolverOptions) -> Result<Self, LinearError> {
        let graph = Graph::compress(pattern);
        let prepared = match pattern.storage() {
            Storage::Lower => symmetric(pattern, &graph, options)?,
            Storage::Full => unsymmetric(pattern, &graph, options)?,
        };
        let buffer = match &prepared.backend {
            Backend::Ldlt(ldlt) => ldlt.solve_buffer(),
            _ => 0,
        };
        let n = pattern.n();
        let mut solver = Self {
            report: report(pattern, &graph, &prepared),
            backend: prepared.backend,
            pattern: pattern.clone(),
            options: options.clone(),
            factorised: false,
            norm: 0.0,
            scale: vec![0.0; n],
            residual: vec![0.0; n],
            permuted: vec![0.0; n],
            buffer: vec![0.0; buffer],
        };
        solver.report.bytes = solver.bytes();
        Ok(solver)
    }

    /// What the analysis found.
    pub fn analysis(&self) -> &AnalysisReport {
        &self.report
    }

    /// The pattern analysed.
    pub fn pattern(&self) -> &SparsePattern {
        &self.pattern
    }

    fn bytes(&self) -> usize {
        let vectors = 3 * self.pattern.n() + self.buffer.len();
        let backend = match &self.backend {
            Backend::Ldlt(ldlt) => ldlt.bytes(),
            Backend::Block(block) => block.bytes(),
            Backend::Sparse(sparse) => sparse.bytes(),
        };
        backend + vectors * size_of::<f64>() + self.pattern.bytes()
    }

    /// Factorises the matrix with `values` in the order of the pattern.
    ///
    /// # Errors
    /// [`LinearError::Length`], [`LinearError::NonFiniteInput`]; [`LinearError::Singular`] if a pivot vanishes,
    /// [`LinearError::NonFinite`] if the factors overflow; [`LinearError::OutOfMemory`] or
    /// [`LinearError::FactorTooLarge`] with [`Method::SparseLu`].
    pub fn factorise(&mut self, values: &[f64]) -> Result<FactorReport, LinearError> {
        self.factorised = false;
        expect_length(Operand::Values, self.pattern.nnz(), values.len())?;
        check_finite(Operand::Values, values)?;
        self.norm = self.pattern.measure(values, &mut self.scale, &mut self.residual);
        let report = self.factorise_backend(values)?;
        self.factorised = true;
        Ok(report)
    }

    fn factorise_backend(&mut self, values: &[f64]) -> Result<FactorReport, LinearError> {
        let limit = self.options.singular_pivot;
        match &mut self.backend {
            Backend::Ldlt(ldlt) => {
                ldlt.factorise(values).map_err(|error| with_scale(error, &self.scale))?;
                Ok(check_pivots(ldlt.pivots(), ldlt.order(), &self.scale, limit)?)
            }
            Backend::Block(block) => {
                block.factorise(values);
                let report = check_pivots(block.pivots(), block.order(), &self.scale, limit)?;
                Ok(FactorReport { negative_pivots: None, ..report })
            }
            Backend::Sparse(sparse) => {
                sparse.factorise(values).map_err(|error| with_scale(error, &self.scale))?;
                probe(&mut self.residual);
                sparse.solve_in_place(&mut self.residual);
                check_probe(&self.residual, self.norm, limit)?;
                Ok(FactorReport { negative_pivots: None, smallest_pivot: None, smallest_pivot_dof: None })
            }
        }
    }

    /// Solves `A x = b` with the matrix last factorised, whose `values` are not kept: refines the solution and checks its
    /// residual.
    ///
    /// # Errors
    /// [`LinearError::NotFactorised`], [`LinearError::Length`], [`LinearError::NonFiniteInput`];
    /// [`LinearError::NonFinite`] if the solution overflows, [`LinearError::ResidualTooLarge`] if refinement does not
    /// bring the residual below the limit of the options.
    pub fn solve(&mut self, values: &[f64], rhs: &[f64], solution: &mut [f64]) -> Result<SolveReport, LinearError> {
        if !self.factorised {
            return Err(LinearError::NotFactorised);
        }
        expect_length(Operand::Values, self.pattern.nnz(), values.len())?;
        expect_length(Operand::RightHandSide, self.pattern.n(), rhs.len())?;
        expect_length(Operand::Solution, self.pattern.n(), solution.len())?;
        check_finite(Operand::RightHandSide, rhs)?;
        self.residual.copy_from_slice(rhs);
        self.apply_inverse(values);
        solution.copy_from_slice(&self.residual);
        check_solution(solution)?;
        let report = self.refine(values, rhs, solution)?;
        check_solution(solution)?;
        if report.residual > self.options.residual_limit {
            return Err(LinearError::ResidualTooLarge {
                residual: report.residual,
                tolerance: self.options.residual_limit,
                refinements: report.refinements,
            });
        }
        Ok(report)
    }

    /// As [`LinearSolver::solve`], without refinement and its checks: a preconditioner.
    ///
    /// # Errors
    /// [`LinearError::NotFactorised`], [`LinearError::Length`].
    pub fn solve_once(&mut self, values: &[f64], rhs: &[f64], solution: &mut [f64]) -> Result<(), LinearError> {
        if !self.factorised {
            return Err(LinearError::NotFactorised);
        }
        expect_length(Operand::Values, self.pattern.nnz(), values.len())?;
        expect_length(Operand::RightHandSide, self.pattern.n(), rhs.len())?;
        expect_length(Operand::Solution, self.pattern.n(), solution.len())?;
        self.residual.copy_from_slice(rhs);
        self.apply_inverse(values);
        solution.copy_from_slice(&self.residual);
        Ok(())
    }

    /// Iterative refinement in the working precision; a step that worsens the residual is undone.
    fn refine(&mut self, values: &[f64], rhs: &[f64], solution: &mut [f64]) -> Result<SolveReport, LinearError> {
        let first_residual = self.form_residual(values, rhs, solution)?;
        let mut report = SolveReport { residual: first_residual, first_residual, refinements: 0 };
        let target = self.options.target_residual;
        while report.refinements < self.options.most_refinements
            && report.residual > 0.0
            && (report.refinements < self.options.least_refinements || report.residual > target)
        {
            self.apply_inverse(values);
            add(solution, &self.residual, 1.0);
            // The correction is needed again if it has to be undone.
            self.permuted.copy_from_slice(&self.residual);
            let residual = self.form_residual(values, rhs, solution)?;
            report.refinements += 1;
            if residual > report.residual || residual.is_nan() {
                add(solution, &self.permuted, -1.0);
                break;
            }
            let stalled = residual > 0.5 * report.residual;
            report.residual = residual;
            if stalled {
                break;
            }
        }
        Ok(report)
    }

    /// `b - A x` in `self.residual`; returns its norm relative to `|A| |x| + |b|`.
    fn form_residual(&mut self, values: &[f64], rhs: &[f64], solution: &[f64]) -> Result<f64, LinearError> {
        self.pattern.multiply(values, solution, &mut self.residual)?;
        let mut largest = 0.0f64;
        for (residual, &b) in self.residual.iter_mut().zip(rhs) {
            *residual = b - *residual;
            largest = largest.max(residual.abs());
        }
        let scale = self.norm * norm(solution) + norm(rhs);
        Ok(if largest == 0.0 { 0.0 } else { largest / scale })
    }

    /// Overwrites `self.residual` by `A⁻¹` times itself. The block LU takes its couplings from `values`.
    fn apply_inverse(&mut self, values: &[f64]) {
        let Self { backend, residual, permuted, buffer, .. } = self;
        match backend {
            Backend::Ldlt(ldlt) => {
                gather(residual, ldlt.order(), permuted);
                ldlt.solve_in_place(permuted, buffer);
                scatter(permuted, ldlt.order(), residual);
            }
            Backend::Block(block) => {
                gather(residual, block.order(), permuted);
                block.solve_in_place(values, permuted);
                scatter(permuted, block.order(), residual);
            }
            Backend::Sparse(sparse) => sparse.solve_in_place(residual),
        }
    }
}

fn symmetric(pattern: &SparsePattern, graph: &Graph, options: &SolverOptions) -> Result<Prepared, LinearError> {
    let (choice, candidates) = choose(graph, options.ordering)?;
    let limits = Limits { relaxation: &options.relaxation, widest: options.widest_supernode.max(1) };
    let supernodes = Supernodes::new(graph, &choice.order, &choice.elimination, &limits);
    let plan = Plan::new(pattern, graph.expand(&choice.order), supernodes, options.branch_flops)?;
    let branches = plan.schedule.branches.len().max(1);
    Ok(Prepared {
        backend: Backend::Ldlt(Box::new(Ldlt::new(plan)?)),
        method: Method::Ldlt,
        ordering: choice.candidate.ordering,
        fill: choice.candidate.fill,
        candidates,
        branches,
    })
}

fn unsymmetric(pattern: &SparsePattern, graph: &Graph, options: &SolverOptions) -> Result<Prepared, LinearError> {
    let (choice, candidates) = choose(graph, options.ordering)?;
    let (levels, cost) = cheapest_levels(graph);
    let sparse_bytes = 2.0 * COLUMN_ORDER_FILL * choice.candidate.fill.nonzeros * size_of::<f64>() as f64;
    let too_large = cost.bytes > options.block_memory as f64 || cost.bytes > options.block_memory_ratio * sparse_bytes;
    let sparse = match options.unsymmetric {
        Some(method) => method == Method::SparseLu,
        None => too_large,
    };
    if sparse {
        return Ok(Prepared {
            backend: Backend::Sparse(Box::new(SparseLu::new(pattern)?)),
            method: Method::SparseLu,
            ordering: Ordering::Natural,
            fill: choice.candidate.fill,
            candidates,
            branches: 1,
        });
    }
    let plan = BlockPlan::new(pattern, graph, &levels)?;
    Ok(Prepared {
        fill: FillEstimate { nonzeros: plan.values() as f64, flops: cost.flops },
        backend: Backend::Block(Box::new(BlockLu::new(plan)?)),
        method: Method::BlockLu,
        ordering: Ordering::TwistedLayers,
        candidates,
        branches: 2,
    })
}

fn report(pattern: &SparsePattern, graph: &Graph, prepared: &Prepared) -> AnalysisReport {
    AnalysisReport {
        unknowns: pattern.n(),
        nonzeros: pattern.nnz(),
        vertices: graph.len(),
        method: prepared.method,
        ordering: prepared.ordering,
        fill: prepared.fill,
        candidates: prepared.candidates.clone(),
        bytes: 0,
        branches: prepared.branches,
    }
}

/// Signs of the pivots, given as position and value in elimination order, and the smallest one against its row.
fn check_pivots(
    pivots: impl Iterator<Item = (usize, f64)>,
    order: &[u32],
    scale: &[f64],
    limit: f64,
) -> Result<FactorReport, LinearError> {
    let (mut negative, mut smallest, mut smallest_dof) = (0, None, None);
    for (position, pivot) in pivots {
        let dof = order[position] as usize;
        if !pivot.is_finite() {
            return Err(LinearError::NonFinite { what: Operand::Factors, dof });
        }
        let relative = pivot.abs() / scale[dof];
        if relative.is_nan() || relative <= limit {
            return Err(LinearError::Singular { dof, pivot, scale: scale[dof] });
        }
        negative += usize::from(pivot < 0.0);
        if smallest.is_none_or(|least| relative < least) {
            (smallest, smallest_dof) = (Some(relative), Some(dof));
        }
    }
    Ok(FactorReport { negative_pivots: Some(negative), smallest_pivot: smallest, smallest_pivot_dof: smallest_dof })
}

/// A right-hand side of entries 1 and -1 without order, which has a part along any null vector.
fn probe(rhs: &mut [f64]) {
    for (number, entry) in rhs.iter_mut().enumerate() {
        *entry = if (number as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 63 == 0 { 1.0 } else { -1.0 };
    }
}

/// The sparse LU hides its pivots; the solution for the probe bounds the smallest singular value from above by
/// `1 / |x|`, which stands for the pivot.
fn check_probe(solution: &[f64], scale: f64, limit: f64) -> Result<(), LinearError> {
    let largest = (0..solution.len()).max_by(|&a, &b| solution[a].abs().total_cmp(&solution[b].abs()));
    let Some(dof) = largest else { return Ok(()) };
    let pivot = solution[dof].abs().recip();
    if pivot > limit * scale { Ok(()) } else { Err(LinearError::Singular { dof, pivot, scale }) }
}

fn with_scale(error: LinearError, row_scale: &[f64]) -> LinearError {
    match error {
        LinearError::Singular { dof, pivot, .. } => {
            LinearError::Singular { dof, pivot, scale: row_scale.get(dof).copied().unwrap_or(0.0) }
        }
        other => other,
    }
}

fn check_finite(what: Operand, entries: &[f64]) -> Result<(), LinearError> {
    match entries.iter().position(|entry| !entry.is_finite()) {
        Some(index) => Err(LinearError::NonFiniteInput { what, index, value: entries[index] }),
        None => Ok(()),
    }
}

pub(super) fn check_solution(solution: &[f64]) -> Result<(), LinearError> {
    match solution.iter().position(|entry| !entry.is_finite()) {
        Some(dof) => Err(LinearError::NonFinite { what: Operand::Solution, dof }),
        None => Ok(()),
    }
}

fn norm(vector: &[f64]) -> f64 {
    vector.iter().fold(0.0, |largest, entry| largest.max(entry.abs()))
}

/// `target += factor vector`.
pub(super) fn add(target: &mut [f64], vector: &[f64], factor: f64) {
    target.iter_mut().zip(vector).for_each(|(entry, &value)| *entry += factor * value);
}

fn gather(source: &[f64], order: &[u32], target: &mut [f64]) {
    target.iter_mut().zip(order).for_each(|(entry, &dof)| *entry = source[dof as usize]);
}

fn scatter(source: &[f64], order: &[u32], target: &mut [f64]) {
    source.iter().zip(order).for_each(|(&entry, &dof)| target[dof as usize] = entry);
}
