//! What is known of a rope from its filaments up.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What is known of the yarns of a `[rope]`, from filaments up; every key may be left out. With `strands`, `radius`,
/// `lay_angle`, `lay_length`, `outer_diameter`, `linear_density` and `yarns` of the rope itself it gives what was left
/// out there, and what is told twice is compared. `subrope check` prints what follows, what contradicts and what stays
/// open.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Sizing {
    /// Linear density of a filament \[dtex\] (0.1 g/km).
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub filament_dtex: Option<f64>,
    /// Diameter of a filament \[mm\].
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub filament_diameter: Option<f64>,
    /// Filaments in a yarn \[-\].
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1))]
    pub filaments_per_yarn: Option<u32>,
    /// Linear density of a yarn \[tex\] (g/km).
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub yarn_tex: Option<f64>,
    /// Yarns in a rope-yarn \[-\].
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1))]
    pub yarns_per_rope_yarn: Option<u32>,
    /// Rope-yarns in a strand \[-\].
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1))]
    pub rope_yarns_per_strand: Option<u32>,
    /// Density of fibre and coating \[kg/m^3\].
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub density: Option<f64>,
    /// Mass of coating over mass of fibre \[-\].
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub coating: Option<f64>,
    /// Solid area over area of the section of a strand \[-\].
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1))]
    pub packing: Option<f64>,
    /// Largest relative difference of what is told twice \[-\].
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 1))]
    pub tolerance: f64,
}

impl Default for Sizing {
    fn default() -> Self {
        Self {
            filament_dtex: None,
            filament_diameter: None,
            filaments_per_yarn: None,
            yarn_tex: None,
            yarns_per_rope_yarn: None,
            rope_yarns_per_strand: None,
            density: None,
            coating: None,
            packing: None,
            tolerance: 0.02,
        }
    }
}
