//! Steps, increments and Newton iterations.

mod balance;
mod division;
mod driver;
mod factors;
mod line_search;
mod newton;
mod record;
mod rigid;
mod state;
mod step;
mod trust_region;
mod viscous;
mod workspace;

pub use driver::{Analysis, LastTrial, Model};
pub use record::{Control, IncrementRecord, Observer, Phase, Phases, Silent, Totals};
pub use rigid::rigid_motions;
pub use step::{
    Increments, Load, LoadBefore, LoadPath, NewtonOptions, Path, Prescription, Step, StepLoad, TrustRegion,
};
pub use viscous::Viscous;
