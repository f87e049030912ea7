//! Contact with the crate `subrope-contact`.

mod answers;
#[cfg(feature = "hdf5")]
mod field;
mod images;
mod pairs;
mod plan;

pub(crate) use answers::{is_any, loads, summaries};
#[cfg(feature = "hdf5")]
pub(crate) use field::{field, friction_work, friction_work_since};
pub(crate) use pairs::{contacts, slice_contact};
pub(crate) use plan::plan;
pub use subrope_contact::ContactError;
