//! Histories of one number over a step.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Component of the motion of a reference point or node set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Component {
    /// Displacement along x \[mm\].
    Ux,
    /// Displacement along y \[mm\].
    Uy,
    /// Displacement along z \[mm\].
    Uz,
    /// Rotation vector, component x.
    Rx,
    /// Rotation vector, component y.
    Ry,
    /// Rotation vector, component z.
    Rz,
}

impl Component {
    /// Displacements, then rotations.
    pub const ALL: [Self; 6] = [Self::Ux, Self::Uy, Self::Uz, Self::Rx, Self::Ry, Self::Rz];

    /// Position in [`Component::ALL`].
    #[must_use]
    pub fn index(self) -> usize {
        self as usize
    }

    /// Whether it is a rotation.
    #[must_use]
    pub fn is_rotation(self) -> bool {
        self.index() >= 3
    }

    /// The key in a scene file.
    #[must_use]
    pub fn key(self) -> &'static str {
        ["ux", "uy", "uz", "rx", "ry", "rz"][self.index()]
    }

    /// The key of the force or moment that works on it.
    #[must_use]
    pub fn force_key(self) -> &'static str {
        ["fx", "fy", "fz", "mx", "my", "mz"][self.index()]
    }
}

/// A number over a step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Ramp {
    /// Reached linearly at the end of the step.
    To(f64),
    /// Pairs [fraction of the step \[-\], value]: linear in between, fractions rising from above 0 to at most 1.
    Path(Vec<[f64; 2]>),
}

impl Ramp {
    /// Pairs [fraction of the step, value].
    #[must_use]
    pub fn knots(&self) -> Vec<[f64; 2]> {
        match self {
            Self::To(value) => vec![[1.0, *value]],
            Self::Path(knots) => knots.clone(),
        }
    }

    /// The same history times a factor.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        match self {
            Self::To(value) => Self::To(factor * value),
            Self::Path(knots) => Self::Path(knots.iter().map(|[f, v]| [*f, factor * v]).collect()),
        }
    }
}

/// What a component of a reference point does in a step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Prescription {
    /// Not prescribed.
    Free(Free),
    /// Prescribed as the end of an arc.
    Arc(ArcTable),
    /// Prescribed.
    Ramp(Ramp),
}

/// The word "free".
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Free {
    /// Not prescribed.
    Free,
}

/// Carries an [`Arc`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ArcTable {
    /// Approach of the ends of an arc.
    pub arc: Arc,
}

/// Approach of the ends of a beam bent to an arc of constant length: `u = L (sin(theta)/theta - 1)`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Arc {
    /// Length of the arc `L` \[mm\].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub length: f64,
    /// Half the angle of the arc `theta` \[degrees\]: the rotation of each end.
    pub angle: Ramp,
}

impl Prescription {
    /// The history of a value.
    #[must_use]
    pub fn to(value: f64) -> Self {
        Self::Ramp(Ramp::To(value))
    }

    /// Not prescribed.
    #[must_use]
    pub fn free() -> Self {
        Self::Free(Free::Free)
    }

    /// Whether it is "free".
    #[must_use]
    pub fn is_free(&self) -> bool {
        matches!(self, Self::Free(_))
    }
}
