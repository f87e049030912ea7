//! Settings and reports of the solvers.

use super::fill::FillEstimate;
use super::ordering::{Candidate, Ordering};
use super::supernodes::Relaxation;

/// Way to factorise.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Method {
    /// Supernodal LDLᵀ of a symmetric matrix, definite or not.
    Ldlt,
    /// LU over the levels of the graph, with pivoting inside the levels.
    BlockLu,
    /// Sparse LU with column ordering and partial pivoting.
    SparseLu,
}

impl Method {
    /// Name for a log.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ldlt => "supernodal LDLᵀ",
            Self::BlockLu => "block LU over levels",
            Self::SparseLu => "sparse LU",
        }
    }
}

/// Settings of an analysis and of the solutions that follow.
#[derive(Debug, Clone, PartialEq)]
pub struct SolverOptions {
    /// Order of the symmetric factorisation; `None` takes the cheapest.
    pub ordering: Option<Ordering>,
    /// Factorisation of unsymmetric values, [`Method::BlockLu`] or [`Method::SparseLu`]; `None` chooses by memory.
    /// Symmetric values are always factorised by [`Method::Ldlt`].
    pub unsymmetric: Option<Method>,
    /// Memory above which the block LU gives way to the sparse LU \[B\].
    pub block_memory: usize,
    /// Ratio of the memory of the block LU to the estimate for the sparse LU above which it gives way \[-\].
    pub block_memory_ratio: f64,
    /// Pivot below which the matrix is called singular, relative to the largest entry of its row \[-\]. With
    /// [`Method::SparseLu`] a bound of the smallest singular value relative to the norm of the matrix.
    pub singular_pivot: f64,
    /// Relative residual that ends the refinement \[-\].
    pub target_residual: f64,
    /// Largest relative residual accepted \[-\].
    pub residual_limit: f64,
    /// Steps of iterative refinement always taken.
    pub least_refinements: usize,
    /// Most steps of iterative refinement.
    pub most_refinements: usize,
    /// Limits for merging supernodes.
    pub relaxation: Vec<Relaxation>,
    /// Most columns of a supernode.
    pub widest_supernode: usize,
    /// Work from which branches of the elimination tree are worked at the same time \[flop\].
    pub branch_flops: f64,
}

impl Default for SolverOptions {
    fn default() -> Self {
        Self {
            ordering: None,
            unsymmetric: None,
            block_memory: 4 << 30,
            block_memory_ratio: 4.0,
            singular_pivot: 1e-13,
            target_residual: 1e-15,
            residual_limit: 1e-9,
            least_refinements: 1,
            most_refinements: 5,
            relaxation: vec![Relaxation { columns: 12, zeros: 0.8 }, Relaxation { columns: 40, zeros: 0.1 }],
            widest_supernode: 40,
            branch_flops: 2e7,
        }
    }
}

/// What an analysis found.
#[derive(Debug, Clone, PartialEq)]
pub struct AnalysisReport {
    /// Unknowns.
    pub unknowns: usize,
    /// Stored entries of the matrix.
    pub nonzeros: usize,
    /// Vertices of the compressed graph (nodes).
    pub vertices: usize,
    /// Factorisation prepared.
    pub method: Method,
    /// Order of the symmetric factorisation; the levels for [`Method::BlockLu`], the caller's for
    /// [`Method::SparseLu`], which orders the columns itself.
    pub ordering: Ordering,
    /// Entries and operations: those of LDLᵀ in that order, or those of the dense blocks of [`Method::BlockLu`].
    pub fill: FillEstimate,
    /// All orders tried for LDLᵀ.
    pub candidates: Vec<Candidate>,
    /// Memory held by the solver \[B\]; without the factors for [`Method::SparseLu`].
    pub bytes: usize,
    /// Branches of the elimination that are worked at the same time.
    pub branches: usize,
}

/// What a factorisation found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FactorReport {
    /// Negative pivots, equal to the negative eigenvalues (Sylvester); `None` for unsymmetric values.
    pub negative_pivots: Option<usize>,
    /// Smallest pivot relative to the largest entry of its row \[-\]; `None` for [`Method::SparseLu`].
    pub smallest_pivot: Option<f64>,
    /// Unknown of the smallest pivot.
    pub smallest_pivot_dof: Option<usize>,
}

/// What a solution attained.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SolveReport {
    /// `|A x - b| / (|A| |x| + |b|)` in the maximum norm \[-\].
    pub residual: f64,
    /// The same before refinement \[-\].
    pub first_residual: f64,
    /// Steps of iterative refinement taken.
    pub refinements: usize,
}

impl SolveReport {
    /// Decimal digits of the residual, at most those of the arithmetic.
    pub fn digits(&self) -> f64 {
        -self.residual.max(f64::EPSILON / 2.0).log10()
    }
}
