//! Errors of the laws.

/// Why a law gave no answer at a point. All but the parameter error are recoverable by a shorter increment.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LawError {
    /// The deformation gradient turns matter inside out.
    #[error("the volume ratio J = {jacobian:e} is not positive: shorten the increment")]
    Inverted {
        /// Volume ratio.
        jacobian: f64,
    },
    /// The section is packed beyond what the lock-up allows.
    #[error("compaction z = {compaction:.6} has reached the lock-up at {limit:.6}: shorten the increment")]
    LockedUp {
        /// `z = I_comp + nu I_elong`.
        compaction: f64,
        /// `z_lock`.
        limit: f64,
    },
    /// A number that came in is not finite.
    #[error("the displacement gradient or the state holds a number that is not finite")]
    NonFiniteInput,
    /// A number that would go out is not finite.
    #[error("the response is not finite at this deformation: shorten the increment")]
    NonFiniteResponse,
    /// A parameter has an impossible value.
    #[error("law parameter {name} = {value:e}: {requirement}")]
    Parameter {
        /// Symbol.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it must satisfy.
        requirement: &'static str,
    },
    /// A slice of state numbers has the wrong length.
    #[error("the law keeps {expected} state numbers per point, {found} were given")]
    StateLength {
        /// What the law needs.
        expected: usize,
        /// What was given.
        found: usize,
    },
    /// A mean elongation was given to a law that has no fibre term of its own.
    #[error("the law has no separate fibre term, so its elongation cannot be averaged: choose another element")]
    NoFibreTerm,
}
