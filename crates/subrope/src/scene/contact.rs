//! Contact between surfaces, and rigid bodies.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Contact of a pair of surfaces, or of all neighbouring strands of a rope when no surface is named.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Contact {
    /// Name, used in results and messages.
    #[schemars(length(min = 1))]
    pub name: String,
    /// A surface or a rigid body that the other is projected on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub primary: Option<String>,
    /// The surface that carries the integration points: the softer or finer one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub secondary: Option<String>,
    /// Coulomb's coefficient of friction \[-\].
    #[serde(default)]
    #[schemars(extend("minimum" = 0))]
    pub friction: f64,
    /// "penalty", or "augmented": a multiplier takes over until the penetration falls below `penetration`.
    #[serde(default)]
    pub method: ContactMethod,
    /// Normal penalty \[MPa/mm\]; 300 times the transverse stiffness at rest over the radius when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub penalty: Option<f64>,
    /// Depth over which the normal penalty sets in, over the radius \[-\]. Strands that just touch start more easily with
    /// 5e-4; they come closer by half of it.
    #[serde(default)]
    #[schemars(extend("minimum" = 0))]
    pub toe: f64,
    /// Tangential over normal penalty \[-\].
    #[serde(default = "tenth")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub tangential_ratio: f64,
    /// Largest penetration over the radius that "augmented" leaves \[-\].
    #[serde(default = "thousandth")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub penetration: f64,
    /// "spline": smooth surfaces through the nodes; "none": facets as meshed.
    #[serde(default)]
    pub smoothing: ContactSmoothing,
    /// Integration points of a face \[-\], around and along a strand.
    #[serde(default = "six_by_three")]
    pub points: [usize; 2],
    /// Tangent of friction: "exact" (unsymmetric) or its "symmetric" part (more and cheaper iterations).
    #[serde(default)]
    pub tangent: ContactTangent,
    /// Time over which an overlap at the start is pressed apart \[s\]; the first step when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 0))]
    pub ramp: Option<f64>,
}

fn tenth() -> f64 {
    0.1
}

fn thousandth() -> f64 {
    1e-3
}

fn six_by_three() -> [usize; 2] {
    [6, 3]
}

/// How surfaces are kept apart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ContactMethod {
    /// Pressure in proportion to the penetration.
    #[default]
    Penalty,
    /// Augmented Lagrangian.
    Augmented,
}

/// Surfaces in contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ContactSmoothing {
    /// Bicubic B-splines whose control points are the nodes.
    #[default]
    Spline,
    /// Facets.
    None,
}

/// Tangent of friction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ContactTangent {
    /// Unsymmetric.
    #[default]
    Exact,
    /// Its symmetric part.
    Symmetric,
}

/// A rigid body with a reference point of its name at `point`; steps prescribe its motion, 0 when they say nothing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Rigid {
    /// Name of the body and of its reference point.
    #[schemars(length(min = 1))]
    pub name: String,
    /// "cylinder" (about `axis`, of `radius`) or "plane" (solid on the side that `axis` comes from).
    pub shape: RigidShape,
    /// A point of the cylinder's axis, or of the plane \[mm\].
    pub point: [f64; 3],
    /// Axis of the cylinder, or outward normal of the plane; need not be of unit length \[-\].
    pub axis: [f64; 3],
    /// Radius of the cylinder \[mm\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub radius: Option<f64>,
}

/// Shape of a rigid body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum RigidShape {
    /// Without ends.
    Cylinder,
    /// Without edges.
    Plane,
}
