//! Failures of the sparse direct solvers.

use thiserror::Error;

/// Failure of a pattern, an analysis, a factorisation or a solution.
///
/// [`LinearError::is_recoverable`] tells the failures of the values, which a shorter increment may cure, from those of
/// the structure.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum LinearError {
    /// A list of degrees of freedom names one that does not exist.
    #[error("degree of freedom {dof} in clique {clique} is outside the {n} unknowns")]
    DofOutOfRange {
        /// Position of the clique in the order given.
        clique: usize,
        /// The offending degree of freedom.
        dof: usize,
        /// Number of unknowns.
        n: usize,
    },
    /// The system is too large for the 32-bit indices of the structure.
    #[error("{n} unknowns exceed the {limit} that the structure can index")]
    TooManyUnknowns {
        /// Number of unknowns.
        n: usize,
        /// Largest number supported.
        limit: usize,
    },
    /// The factors would hold more entries than can be indexed.
    #[error("factors of {entries:.3e} entries exceed the {limit:.3e} that can be indexed")]
    FactorTooLarge {
        /// Estimated number of entries of the factors.
        entries: f64,
        /// Largest number supported.
        limit: f64,
    },
    /// Memory for the factors could not be reserved.
    #[error("no memory for {bytes} bytes of factors")]
    OutOfMemory {
        /// Size of the request \[B\].
        bytes: usize,
    },
    /// A slice has the wrong length.
    #[error("{what:?} has {actual} entries, {expected} expected")]
    Length {
        /// The slice concerned.
        what: Operand,
        /// Entries it should have.
        expected: usize,
        /// Entries it has.
        actual: usize,
    },
    /// METIS refused the graph.
    #[error("METIS returned status {status} on a graph of {vertices} vertices")]
    Metis {
        /// Status returned (1 means success).
        status: i32,
        /// Vertices of the compressed graph.
        vertices: usize,
    },
    /// A solution was asked for before any successful factorisation.
    #[error("no factorisation is available")]
    NotFactorised,
    /// A value of the matrix or of the right-hand side is not finite.
    #[error("{what:?} holds the value {value} at entry {index}")]
    NonFiniteInput {
        /// The slice concerned.
        what: Operand,
        /// Its first entry that is not finite.
        index: usize,
        /// That entry.
        value: f64,
    },
    /// A pivot vanishes relative to its row of the matrix.
    #[error("singular matrix: pivot {pivot:.3e} of unknown {dof} against a scale of {scale:.3e}")]
    Singular {
        /// Unknown (in the caller's numbering) of the pivot.
        dof: usize,
        /// The pivot.
        pivot: f64,
        /// Scale it is compared with.
        scale: f64,
    },
    /// The factorisation or the solution overflowed.
    #[error("{what:?} is not finite at unknown {dof}")]
    NonFinite {
        /// Where it happened.
        what: Operand,
        /// Unknown in the caller's numbering.
        dof: usize,
    },
    /// The solution does not satisfy the system although refined.
    #[error("relative residual {residual:.3e} above {tolerance:.1e} after {refinements} refinements")]
    ResidualTooLarge {
        /// `|A x - b| / (|A| |x| + |b|)` in the maximum norm \[-\].
        residual: f64,
        /// Tolerance \[-\].
        tolerance: f64,
        /// Steps of iterative refinement taken.
        refinements: usize,
    },
    /// An iterative solution came to a standstill.
    #[error("relative residual {residual:.3e} after {iterations} iterations of GMRES, wanted below {limit:.1e}")]
    Stalled {
        /// Iterations.
        iterations: usize,
        /// `|b - A x| / |b|` \[-\].
        residual: f64,
        /// Largest useful one \[-\].
        limit: f64,
    },
}

/// The operand a [`LinearError`] speaks of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Operand {
    /// Values of the matrix, in the order of the pattern.
    Values,
    /// Right-hand side.
    RightHandSide,
    /// Solution.
    Solution,
    /// Triangular factors.
    Factors,
}

impl LinearError {
    /// Whether other values on the same pattern may succeed (a shorter increment, another iterate).
    pub fn is_recoverable(&self) -> bool {
        matches!(
            self,
            Self::Singular { .. }
                | Self::NonFinite { .. }
                | Self::NonFiniteInput { .. }
                | Self::ResidualTooLarge { .. }
                | Self::Stalled { .. }
        )
    }
}
