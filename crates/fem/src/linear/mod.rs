//! Sparse direct solvers of structurally symmetric systems from finite elements.
//!
//! A [`SparsePattern`] is built once from the unknowns of the elements. [`LinearSolver::analyse`] compresses its graph to
//! nodes, compares elimination orders by their exact cost (layer by layer along a slender body or with the shortest
//! wavefront, from one end or from both; nested dissection; cuts across the body one after the other) and prepares the
//! factors; [`LinearSolver::factorise`] and [`LinearSolver::solve`] repeat without allocation. Symmetric values are
//! factorised by a supernodal LDLᵀ whose pivots give the inertia, unsymmetric ones by LU. Every solution is refined and its
//! residual checked. A [`TangentSolver`] spares the LU where it can: the LDLᵀ of the symmetric part preconditions GMRES,
//! and so do factors of an earlier matrix that is near enough.
//!
//! Work is divided at places that do not depend on the number of threads and combined in a fixed order, and every part
//! runs on sequential dense kernels: results are bitwise equal for any number of threads.

mod block_lu;
mod block_plan;
mod condition;
mod cross_sections;
mod dissection;
mod error;
mod fill;
mod gmres;
mod graph;
mod kernel;
mod ldlt;
mod ldlt_plan;
mod ldlt_solve;
mod levels;
mod options;
mod ordering;
mod panel;
mod parallel;
mod pattern;
mod schedule;
mod solver;
mod sparse_lu;
mod supernodes;
mod symmetric_part;
mod tangent_solver;
#[cfg(test)]
mod tests;
mod wavefront;

pub use error::{LinearError, Operand};
pub use fill::FillEstimate;
pub use gmres::{Gmres, GmresLimits, GmresReport, LinearOperator};
pub use options::{AnalysisReport, FactorReport, Method, SolveReport, SolverOptions};
pub use ordering::{Candidate, Ordering};
pub use pattern::{SparsePattern, Storage};
pub use solver::LinearSolver;
pub use supernodes::Relaxation;
pub use tangent_solver::{LinearTerm, TangentSolver};
