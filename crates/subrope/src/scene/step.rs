//! Steps: what is moved and loaded, and in how many increments.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::MOST_PARTS;
use super::prescription::{Component, Prescription, Ramp};

/// A step. What it does not mention stays as the step before left it; before the first step every component of every
/// reference point is held at 0.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Step {
    /// Name, used in messages and results.
    #[schemars(length(min = 1))]
    pub name: String,
    /// Length of the step in time \[s\].
    #[serde(default = "one_second")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub duration: f64,
    /// Increments: { fixed = 20 } or { initial = .., minimum = .., maximum = .., max_count = ..,
    /// control = .. }.
    #[serde(default)]
    pub increments: Increments,
    /// Bending: both ends turned against each other.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bend: Option<Bend>,
    /// Tension and twist of one end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tension: Option<Tension>,
    /// Tension of one end going to and fro.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cycles: Option<Cycles>,
    /// Motions of reference points and of constraints.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = MOST_PARTS))]
    pub prescribe: Vec<Prescribe>,
    /// Dead forces and moments on reference points.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = MOST_PARTS))]
    pub force: Vec<PointForce>,
    /// Dead forces on node sets.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = MOST_PARTS))]
    pub nodal_force: Vec<NodalForce>,
    /// Dead tractions on surfaces.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = MOST_PARTS))]
    pub traction: Vec<Traction>,
}

fn one_second() -> f64 {
    1.0
}

/// How a step is divided. Either `fixed`, or the others: the program then chooses between their bounds.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Increments {
    /// Number of equal increments \[-\]; never cut.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 1_000_000))]
    pub fixed: Option<usize>,
    /// First increment as a fraction of the step \[-\]; 0.05 when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 1e-12, "maximum" = 1))]
    pub initial: Option<f64>,
    /// Smallest increment as a fraction of the step \[-\]; 1e-6 when left out. Below it the run gives up.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 1e-12, "maximum" = 1))]
    pub minimum: Option<f64>,
    /// Largest increment as a fraction of the step \[-\]; 0.1 (or `initial`, if larger) when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 1e-12, "maximum" = 1))]
    pub maximum: Option<f64>,
    /// Largest number of increments \[-\]; 1000 when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 1_000_000))]
    pub max_count: Option<usize>,
    /// "load": loads and motions grow with the fraction of the step; "load" when left out. "arc_length": the fraction
    /// is an unknown that may go back, past limit points and snap-back; `minimum` and `maximum` are then lengths of
    /// an arc in motions and dissipation, which is the fraction as long as the structure is as stiff as at first;
    /// `initial` is still the fraction of the first increment. Loads and motions must grow linearly from the start of
    /// the step to its end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub control: Option<PathControl>,
}

/// What an increment goes on by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PathControl {
    /// The fraction of the step.
    #[default]
    Load,
    /// The length of an arc of the equilibrium path.
    ArcLength,
}

/// How a step is divided, with defaults filled in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Incrementation {
    /// Equal increments, never cut.
    Fixed {
        /// Their number.
        count: usize,
    },
    /// Chosen by the program; fractions of the step.
    Automatic {
        /// First increment.
        initial: f64,
        /// Smallest increment.
        minimum: f64,
        /// Largest increment.
        maximum: f64,
        /// Largest number of increments.
        max_count: usize,
        /// What they go on by.
        control: PathControl,
    },
}

impl Increments {
    /// With defaults filled in.
    #[must_use]
    pub fn resolve(&self) -> Incrementation {
        if let Some(count) = self.fixed {
            return Incrementation::Fixed { count };
        }
        let largest = self.maximum.unwrap_or(1.0);
        let initial = self.initial.unwrap_or(0.05_f64.max(self.minimum.unwrap_or(0.0)).min(largest));
        Incrementation::Automatic {
            initial,
            minimum: self.minimum.unwrap_or(1e-6_f64.min(initial)),
            maximum: self.maximum.unwrap_or(0.1_f64.max(initial)),
            max_count: self.max_count.unwrap_or(1000),
            control: self.control.unwrap_or_default(),
        }
    }
}

/// Bending: the end `first` turns by +angle about the axis with its centre fixed, the end `second` by -angle. Axis x
/// bends towards -y, axis y towards +x.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Bend {
    /// Rotation of each end at the end of the step \[degrees\], between -180 and 180; or pairs [fraction of the step,
    /// degrees].
    pub angle: Ramp,
    /// Axis of rotation: "x" or "y".
    #[serde(default)]
    pub axis: BendAxis,
    /// Centre of the second end: "free" along z, or moved as on the ideal "circle",
    /// `u_z = L (sin(theta)/theta - 1)`.
    #[serde(default)]
    pub ends: BendEnds,
    /// Length `L` of the ideal arc \[mm\]; the strand's when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub length: Option<f64>,
    /// Reference point of the end that keeps its place.
    #[serde(default = "end_a")]
    pub first: String,
    /// Reference point of the other end.
    #[serde(default = "end_b")]
    pub second: String,
}

pub(super) fn end_a() -> String {
    "END_A".to_owned()
}

pub(super) fn end_b() -> String {
    "END_B".to_owned()
}

/// Axis of bending.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum BendAxis {
    /// The x axis.
    #[default]
    X,
    /// The y axis.
    Y,
}

/// What the centre of the second end does in bending.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum BendEnds {
    /// Free along z.
    #[default]
    Free,
    /// Moved as on the ideal circle.
    Circle,
}

/// Tension and twist: the end `point` moves along z and turns about z, its other components stay. Give either
/// `elongation` or `force`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Tension {
    /// Elongation at the end of the step as a fraction of the length \[-\]; or pairs [fraction of the step,
    /// elongation].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub elongation: Option<Ramp>,
    /// Dead force along z at the end of the step \[N\]; or pairs [fraction of the step, N].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub force: Option<Ramp>,
    /// Rotation about z \[degrees\] at the end of the step, "free", or pairs [fraction of the step, degrees]; stays as
    /// it is when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub twist: Option<Prescription>,
    /// Length that the elongation refers to \[mm\]; the strand's when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub length: Option<f64>,
    /// Reference point of the end that moves.
    #[serde(default = "end_b")]
    pub point: String,
}

/// Cycles of tension: the end `point` goes to `low` and back to `high`, `count` times; its other components stay.
/// Every half cycle is a step of its own, named after this one: `duration` covers them all, `increments` and whatever
/// else this step asks for hold for each.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Cycles {
    /// Number of cycles \[-\].
    #[schemars(range(min = 1, max = 100_000))]
    pub count: usize,
    /// What `low` and `high` are: fractions of the largest tension so far ("peak"), a "force" \[N\], or an "elongation"
    /// as a fraction of the length.
    #[serde(default)]
    pub of: CycleControl,
    /// Lower end of the cycle \[-, N or -, as `of` says\].
    pub low: f64,
    /// Upper end of the cycle \[-, N or -\].
    pub high: f64,
    /// Course of a half cycle: "triangle" (straight) or "sine".
    #[serde(default)]
    pub waveform: Waveform,
    /// Fields are written at both ends of every n-th cycle and of the last \[-\].
    #[serde(default = "one")]
    #[schemars(range(min = 1))]
    pub every: usize,
    /// Length that an elongation refers to \[mm\]; the strand's or the rope's when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub length: Option<f64>,
    /// Reference point of the end that moves.
    #[serde(default = "end_b")]
    pub point: String,
}

fn one() -> usize {
    1
}

/// What a cycle goes between.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CycleControl {
    /// Fractions of the largest tension so far.
    #[default]
    Peak,
    /// Forces \[N\].
    Force,
    /// Elongations, fractions of the length.
    Elongation,
}

/// Course of a half cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Waveform {
    /// Straight.
    #[default]
    Triangle,
    /// Half a cosine in eight straight pieces.
    Sine,
}

/// Motion of one reference point (`point`) or of one constraint (`constraint`): each component a value at the end of
/// the step (reached linearly from where the step before left it), "free", or pairs [fraction of the step, value].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Prescribe {
    /// Name of a reference point.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub point: Option<String>,
    /// Name of a constraint; only the components it lists, and none "free".
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub constraint: Option<String>,
    /// Displacement along x \[mm\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ux: Option<Prescription>,
    /// Displacement along y \[mm\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub uy: Option<Prescription>,
    /// Displacement along z \[mm\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub uz: Option<Prescription>,
    /// Rotation vector, component x \[degrees\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rx: Option<Prescription>,
    /// Rotation vector, component y \[degrees\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ry: Option<Prescription>,
    /// Rotation vector, component z \[degrees\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rz: Option<Prescription>,
}

impl Prescribe {
    /// The components in the order of [`Component::ALL`].
    #[must_use]
    pub fn components(&self) -> [Option<&Prescription>; 6] {
        [&self.ux, &self.uy, &self.uz, &self.rx, &self.ry, &self.rz].map(Option::as_ref)
    }

    /// The entry of a component.
    pub(super) fn component_mut(&mut self, component: Component) -> &mut Option<Prescription> {
        match component {
            Component::Ux => &mut self.ux,
            Component::Uy => &mut self.uy,
            Component::Uz => &mut self.uz,
            Component::Rx => &mut self.rx,
            Component::Ry => &mut self.ry,
            Component::Rz => &mut self.rz,
        }
    }
}

/// Dead force and moment on a reference point: each component a value at the end of the step, or pairs [fraction of the
/// step, value]. A loaded component must be "free".
///
/// A load starts from its value at the end of the step before, 0 if there was none. A component that was prescribed
/// until now is let go at once: its reaction does not carry over into the load.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PointForce {
    /// Name of a reference point.
    pub point: String,
    /// Force along x \[N\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fx: Option<Ramp>,
    /// Force along y \[N\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fy: Option<Ramp>,
    /// Force along z \[N\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fz: Option<Ramp>,
    /// Moment about x \[N mm\], spatial, about the current position of the point.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mx: Option<Ramp>,
    /// Moment about y \[N mm\], spatial, about the current position of the point.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub my: Option<Ramp>,
    /// Moment about z \[N mm\], spatial, about the current position of the point.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mz: Option<Ramp>,
}

impl PointForce {
    /// Forces and moments in the order of [`Component::ALL`].
    #[must_use]
    pub fn components(&self) -> [Option<&Ramp>; 6] {
        [&self.fx, &self.fy, &self.fz, &self.mx, &self.my, &self.mz].map(Option::as_ref)
    }
}

/// Dead force on the nodes of a set: each component a value at the end of the step, or pairs [fraction of the step, N].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NodalForce {
    /// The node set.
    pub set: String,
    /// Whether the force is the "total" of the set, shared equally by its nodes, or acts on each node ("per_node").
    #[serde(default)]
    pub distribution: Distribution,
    /// Force along x \[N\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fx: Option<Ramp>,
    /// Force along y \[N\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fy: Option<Ramp>,
    /// Force along z \[N\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fz: Option<Ramp>,
}

impl NodalForce {
    /// Forces in the order x, y, z.
    #[must_use]
    pub fn components(&self) -> [Option<&Ramp>; 3] {
        [&self.fx, &self.fy, &self.fz].map(Option::as_ref)
    }
}

/// How a force is shared by the nodes of a set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Distribution {
    /// The value is the sum over the nodes.
    #[default]
    Total,
    /// The value acts on each node.
    PerNode,
}

/// Dead traction on a surface, force per reference area: each component a value at the end of the step, or pairs
/// [fraction of the step, MPa].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Traction {
    /// The surface: LATERAL of a generated strand, or a surface of the deck.
    pub surface: String,
    /// Traction along x \[MPa\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tx: Option<Ramp>,
    /// Traction along y \[MPa\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ty: Option<Ramp>,
    /// Traction along z \[MPa\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tz: Option<Ramp>,
}

impl Traction {
    /// Tractions in the order x, y, z.
    #[must_use]
    pub fn components(&self) -> [Option<&Ramp>; 3] {
        [&self.tx, &self.ty, &self.tz].map(Option::as_ref)
    }
}
