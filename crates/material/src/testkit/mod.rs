//! The battery every law passes, for laws of this crate and of others.
//!
//! [`check`] runs everything on a set of [`Path`]s; the checks are also public one by one. A failure names the worst
//! entry with the found and the expected number. Nothing is printed.

mod bundles;
mod derivatives;
mod edge;
mod failure;
mod invariance;
mod path;
mod random;
mod robustness;
mod stencil;
mod walk;

use crate::law::Law;

pub use bundles::bundles;
pub use derivatives::{mean_elongation_derivatives, mean_elongation_split, stress_is_gradient, tangent_is_derivative};
pub use edge::yield_edge;
pub use failure::{Entry, TestkitFailure};
pub use invariance::{objectivity, rotated_frame, transverse_isotropy};
pub use path::Path;
pub use random::Numbers;
pub use robustness::{dissipation, extremes, idempotence, rest, symmetry};

/// Runs the whole battery: at rest, extremes, and on every path gradient, tangent, symmetry, idempotence, dissipation,
/// objectivity, rotated frame and yield edge; with a fibre term also with mean elongation.
///
/// # Errors
/// The first [`TestkitFailure`].
pub fn check(law: &dyn Law, paths: &[Path]) -> Result<(), TestkitFailure> {
    rest(law)?;
    extremes(law)?;
    for path in paths {
        stress_is_gradient(law, path)?;
        tangent_is_derivative(law, path)?;
        symmetry(law, path)?;
        idempotence(law, path)?;
        dissipation(law, path)?;
        objectivity(law, path)?;
        rotated_frame(law, path)?;
        yield_edge(law, path)?;
        if law.has_fibre_term() {
            mean_elongation_split(law, path)?;
            mean_elongation_derivatives(law, path)?;
        }
    }
    Ok(())
}
