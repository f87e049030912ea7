//! From elements to a sparse system in the free coordinates.

mod equations;
mod products;
mod scatter;
mod system;

pub use equations::Equations;
pub use system::{Assembled, Evaluation, Jump, System};
