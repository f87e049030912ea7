//! A strand generated from a few numbers.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Most cells in any direction, as in `subrope_geometry`.
const MAX_COUNT: usize = 1 << 20;

/// A straight twisted strand along z. Its node sets are `END_A` (lowest z), `END_B` (highest z), `SURFACE_NODES` (also
/// `LATERAL`), `AXIS` and `ALL`; its surface is `LATERAL`. Give either `surface_angle` or `pitch`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Strand {
    /// Radius of the section \[mm\].
    #[schemars(extend("minimum" = 1e-9, "maximum" = 1e9))]
    pub radius: f64,
    /// Length along z \[mm\].
    #[schemars(extend("minimum" = 1e-9, "maximum" = 1e9))]
    pub length: f64,
    /// Angle between the rope-yarns at the surface and the axis \[degrees\], from 0 (straight) to below 90.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 0, "exclusiveMaximum" = 90))]
    pub surface_angle: Option<f64>,
    /// Lay length: height of one turn of a rope-yarn \[mm\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 1e-9, "maximum" = 1e9))]
    pub pitch: Option<f64>,
    /// Sense of the helix: "right" (Z lay: rises counter-clockwise when seen from +z) or "left" (S lay).
    #[serde(default)]
    pub hand: Hand,
    /// Where z = 0 lies: in the "middle" of the strand or at its "bottom" (END_A).
    #[serde(default)]
    pub origin: Origin,
    /// Bending stiffness of the rope-yarns themselves, none when left out; needs mesh lines that follow them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub yarn_bending: Option<YarnBending>,
    /// Division into hexahedra.
    #[serde(default)]
    pub mesh: StrandMesh,
}

/// Bending stiffness of the rope-yarns of a strand: of every mesh line along them, `EI/2` times the integral of the square
/// of the change of its curvature from rest. The lines share `yarns` times `stiffness` by the volume around them. Rigid
/// ends hold the direction of the rope-yarns.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct YarnBending {
    /// Rope-yarns in the strand \[-\].
    #[schemars(range(min = 1, max = MAX_COUNT))]
    pub yarns: usize,
    /// Bending stiffness EI of one rope-yarn \[N mm^2\].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub stiffness: f64,
}

impl Strand {
    /// Whether the mesh has lines of nodes along the rope-yarns.
    #[must_use]
    pub fn has_lines_along_yarns(&self) -> bool {
        self.mesh.lines == MeshLines::Yarns || self.surface_tangent() == 0.0
    }

    /// Tangent of the angle between the rope-yarns at the surface and the axis, negative for a left-hand lay \[-\].
    #[must_use]
    pub fn surface_tangent(&self) -> f64 {
        let magnitude = match (self.surface_angle, self.pitch) {
            (Some(angle), _) => angle.to_radians().tan(),
            (None, Some(pitch)) => 2.0 * std::f64::consts::PI * self.radius / pitch,
            (None, None) => 0.0,
        };
        match self.hand {
            Hand::Right => magnitude,
            Hand::Left => -magnitude,
        }
    }
}

/// Sense of a helix.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Hand {
    /// Z lay.
    #[default]
    Right,
    /// S lay.
    Left,
}

/// Where the coordinate along the strand starts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Origin {
    /// z runs from -length/2 to +length/2.
    #[default]
    Middle,
    /// z runs from 0 to length.
    Bottom,
}

/// Division of a strand: a square core of `core` x `core` cells, `rings` rings of 4 `core` cells around it, and
/// `layers` layers: `(core^2 + 4 core rings) layers` hexahedra.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct StrandMesh {
    /// Cells along each side of the core \[-\], even, so that nodes lie on the axis; the outline has 4 times as many
    /// edges.
    #[schemars(extend("minimum" = 2, "maximum" = MAX_COUNT, "multipleOf" = 2))]
    pub core: usize,
    /// Rings of cells around the core \[-\].
    #[schemars(range(min = 1, max = MAX_COUNT))]
    pub rings: usize,
    /// Layers along the strand \[-\].
    #[schemars(range(min = 1, max = MAX_COUNT))]
    pub layers: usize,
    /// Half side of the core as a fraction of the radius \[-\], between 0 and 0.7071.
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = std::f64::consts::FRAC_1_SQRT_2))]
    pub core_fraction: f64,
    /// Outward displacement of the middle of a core side as a fraction of the half side \[-\], from 0 to below 1.
    #[schemars(extend("minimum" = 0, "exclusiveMaximum" = 1))]
    pub core_bulge: f64,
    /// Mesh lines run along the "axis" of the strand or turn with the "yarns".
    pub lines: MeshLines,
    /// The polygon that stands for the circle has the circle's "exact" area, or is "inscribed" (nodes on the circle).
    pub area: SectionArea,
}

impl StrandMesh {
    /// Number of hexahedra.
    #[must_use]
    pub fn cell_count(&self) -> usize {
        (self.core * self.core + 4 * self.core * self.rings) * self.layers
    }
}

impl Default for StrandMesh {
    fn default() -> Self {
        let (lines, area) = (MeshLines::Axis, SectionArea::Exact);
        Self { core: 4, rings: 2, layers: 50, core_fraction: 0.4, core_bulge: 0.15, lines, area }
    }
}

/// Direction of the mesh lines along the strand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum MeshLines {
    /// Parallel to the axis.
    Axis,
    /// Along the rope-yarns.
    Yarns,
}

/// Size of the polygon that stands for the circular section.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SectionArea {
    /// The area of the circle.
    Exact,
    /// Nodes on the circle, a smaller area.
    Inscribed,
}
