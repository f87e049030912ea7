//! Steps, increments and Newton iterations.

mod arc_length;
mod balance;
mod branch;
mod division;
mod driver;
mod factors;
mod line_search;
mod mode;
mod newton;
mod record;
mod rigid;
mod smoothing;
mod state;
mod step;
mod trust_region;
mod viscous;
mod workspace;

pub use driver::{Analysis, LastTrial, Model};
pub use record::{Control, IncrementRecord, Observer, Phase, Phases, Silent, Totals};
pub use rigid::rigid_motions;
pub use step::{
    BranchChoice, Increments, Load, LoadBefore, LoadPath, NewtonOptions, Path, PathControl, Prescription, Step,
    StepLoad, TrustRegion,
};
pub use viscous::Viscous;
