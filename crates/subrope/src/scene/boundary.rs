//! Reference points tied to node sets, and constraints on node sets.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A reference point that carries a node set, usually an end section. Steps prescribe its motion
/// (`[[step.prescribe]] point = ..`) or load it (`[[step.force]] point = ..`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct End {
    /// Name of the reference point, used in steps.
    #[schemars(length(min = 1))]
    pub name: String,
    /// The node set it carries; the same name as the point when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub set: Option<String>,
    /// "rigid": the nodes move as one body. "radial": as one body, but each node is free along its radius. "sliding",
    /// for the ends of a rope: as one body, but each strand is free to move along the radius on which it lies, without
    /// force; the radius turns with the end, a core stays.
    #[serde(default)]
    pub kind: EndKind,
    /// Position of the reference point \[mm\]; the centroid of the set's nodes when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub point: Option<[f64; 3]>,
}

impl End {
    /// The node set it carries.
    #[must_use]
    pub fn set(&self) -> &str {
        self.set.as_deref().unwrap_or(&self.name)
    }
}

/// How nodes follow their reference point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum EndKind {
    /// As one body.
    #[default]
    Rigid,
    /// As one body, each node free along its radius.
    Radial,
    /// As one body, each strand of a rope free along the radius of its centre.
    Sliding,
}

/// Displacement components of a node set, prescribed throughout the run. A value other than 0 is reached linearly at
/// the end of the first step; a step may give another history (`[[step.prescribe]] constraint = ..`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Constraint {
    /// Name, used in steps and messages.
    #[schemars(length(min = 1))]
    pub name: String,
    /// The node set; its nodes must not be carried by a reference point.
    #[schemars(length(min = 1))]
    pub set: String,
    /// The components prescribed, at least one.
    pub components: ConstraintComponents,
}

/// Displacement components and their values.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ConstraintComponents {
    /// Displacement along x \[mm\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ux: Option<f64>,
    /// Displacement along y \[mm\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub uy: Option<f64>,
    /// Displacement along z \[mm\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub uz: Option<f64>,
}

impl ConstraintComponents {
    /// The three components in the order x, y, z.
    #[must_use]
    pub fn values(&self) -> [Option<f64>; 3] {
        [self.ux, self.uy, self.uz]
    }
}
