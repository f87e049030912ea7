//! Scene files: what a user writes, as plain data.
//!
//! A scene is read by [`SceneFile::load`]; every error in it carries file, line, column, cause and allowed values. The
//! shorthands of a step (`bend`, `tension`) are expanded by [`expand`], and [`Program`] resolves all steps into the
//! motion of every component and the history of every load, so that whoever runs a scene knows only these.
//!
//! Units: mm, N, MPa, mJ, s, K; angles in degrees in scenes and in radians in a [`Program`].

mod boundary;
mod check;
mod contact;
mod cycles;
mod deck;
mod element;
mod error;
mod expand;
mod file;
mod law;
mod output;
mod prescription;
mod program;
mod rope;
mod sets;
mod sizing;
mod solver;
mod step;
mod strand;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::sizing::RopeSizing;

pub(crate) use check::check_law;

pub use boundary::{Constraint, ConstraintComponents, End, EndKind};
pub use contact::{Contact, ContactMethod, ContactSmoothing, ContactTangent, Rigid, RigidShape};
pub use cycles::HalfCycle;
pub use deck::{Deck, Fibres, HelixFibres};
pub use element::{Element, Formulation};
pub use error::SceneError;
pub use expand::expand;
pub use file::SceneFile;
pub use law::{
    BundleLaw, CharmetantLaw, Compaction, FibreReinforcedLaw, IsotropicLaw, Law, NeoHookeIsochoricLaw, NeoHookeLaw,
    OrthotropicLaw,
};
pub use output::{Field, Output, Precision};
pub use prescription::{Arc, ArcTable, Component, Free, Prescription, Ramp};
pub use program::{Load, LoadTarget, Motion, MotionPath, MotionTarget, Path, Program, ProgramStep};
pub use rope::{Core, Rope, Symmetry, YarnSense, Yarns};
pub use sizing::Sizing;
pub use solver::{BranchChoice, LineSearch, Smoothing, Solver, Stabilisation, TrustRegion};
pub use step::{
    Bend, BendAxis, BendEnds, CycleControl, Cycles, Distribution, Incrementation, Increments, NodalForce, PathControl,
    PointForce, Prescribe, Step, Tension, Traction, Waveform,
};
pub use strand::{Hand, MeshLines, Origin, SectionArea, Strand, StrandMesh, YarnBending};

/// The node sets of a generated strand.
pub const STRAND_SETS: [&str; 6] = ["END_A", "END_B", "LATERAL", "SURFACE_NODES", "AXIS", "ALL"];

/// Most ends, contacts, rigid bodies, constraints; most entries of one kind in a step.
pub(crate) const MOST_PARTS: usize = 1000;

/// Most steps as written; half cycles are not counted.
const MOST_STEPS: usize = 10_000;

/// The surfaces of a generated strand.
pub const STRAND_SURFACES: [&str; 1] = ["LATERAL"];

/// A scene: mesh, law, boundary, steps, solver and output. Exactly one of `strand`, `rope` and `deck` is
/// given.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// What the scene shows, in one line.
    #[schemars(length(min = 1))]
    pub title: String,
    /// Sources, assumptions, remarks.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub notes: Option<String>,
    /// Temperature \[K\].
    #[serde(default = "room_temperature")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub temperature: f64,
    /// A strand generated from a few numbers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub strand: Option<Strand>,
    /// A rope of several strands generated from a few numbers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rope: Option<Rope>,
    /// A mesh read from an Abaqus deck.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub deck: Option<Deck>,
    /// The finite element.
    #[serde(default)]
    pub element: Element,
    /// The law of the material.
    pub law: Law,
    /// Reference points that carry node sets.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = MOST_PARTS))]
    pub end: Vec<End>,
    /// Surfaces that touch.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = MOST_PARTS))]
    pub contact: Vec<Contact>,
    /// Rigid bodies.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = MOST_PARTS))]
    pub rigid: Vec<Rigid>,
    /// Prescribed displacements of node sets.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = MOST_PARTS))]
    pub constraint: Vec<Constraint>,
    /// What happens, step by step; at least one.
    #[schemars(length(min = 1, max = MOST_STEPS))]
    pub step: Vec<Step>,
    /// Newton's method and the choice of increments.
    #[serde(default)]
    pub solver: Solver,
    /// What a run writes.
    #[serde(default)]
    pub output: Output,
}

fn room_temperature() -> f64 {
    293.15
}

impl Scene {
    /// The JSON schema (draft 2020-12) of scene files; descriptions hold the units.
    #[must_use]
    pub fn schema() -> serde_json::Value {
        crate::document::schema_of::<Self>()
    }

    /// Length of the generated strand or rope \[mm\].
    #[must_use]
    pub fn length(&self) -> Option<f64> {
        self.strand.as_ref().map(|s| s.length).or(self.rope.as_ref().map(|r| r.length))
    }

    /// Whether one layer of one strand of a rope stands for all of it.
    #[must_use]
    pub fn is_slice(&self) -> bool {
        self.rope.as_ref().is_some_and(Rope::is_slice)
    }

    /// The end whose reference point moves a slice.
    #[must_use]
    pub fn slice_end(&self) -> Option<&End> {
        self.end.iter().find(|end| self.is_slice() && end.set().eq_ignore_ascii_case("END_B"))
    }

    /// Radius of a strand of the generated strand or rope \[mm\], given or by its sizing.
    #[must_use]
    pub fn strand_radius(&self) -> Option<f64> {
        let sized = || RopeSizing::of(self).and_then(|sizing| sizing.radius());
        let rope = self.rope.as_ref().and_then(|rope| rope.radius.or_else(sized));
        self.strand.as_ref().map(|strand| strand.radius).or(rope)
    }

    /// Names of all reference points: ends, then rigid bodies.
    pub fn point_names(&self) -> impl Iterator<Item = &str> {
        self.end.iter().map(|e| e.name.as_str()).chain(self.rigid.iter().map(|r| r.name.as_str()))
    }

    /// Reads and checks scene text; `name` is what errors call it. A deck is not opened, so the names of its sets are
    /// not checked: [`SceneFile::load`] does.
    ///
    /// # Errors
    /// [`SceneError::Invalid`] with all problems found.
    pub fn from_toml(name: &str, text: &str) -> Result<Self, SceneError> {
        let (scene, document) = crate::document::read::<Self>(name, text)?;
        document.reject(check::check(&scene, &document, None))?;
        Ok(scene)
    }
}
