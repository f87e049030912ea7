//! A mesh read from an Abaqus deck.

use std::collections::BTreeMap;
use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::strand::Hand;

/// A mesh from an Abaqus input file (`*NODE`, `*ELEMENT`, `*NSET`, `*ELSET`, `*SURFACE`, orientations); the node set
/// `ALL` holds all nodes. Lengths are mm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Deck {
    /// The deck, relative to the scene file.
    #[schemars(with = "String", length(min = 1))]
    pub file: PathBuf,
    /// Where the fibre directions come from: "deck" (its orientations), { helix = {..} } or { parallel = [x, y, z] }.
    pub fibres: Fibres,
    /// Other names for node sets and surfaces of the deck: `END_A = "BOTTOM_NODES"` lets the scene say END_A. The
    /// deck's own names stay.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub sets: BTreeMap<String, String>,
}

/// Where the fibre directions come from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Fibres {
    /// The orientations of the deck.
    Deck,
    /// The same direction everywhere; need not be of unit length \[-\].
    Parallel([f64; 3]),
    /// Helices around an axis, all with the same pitch.
    Helix(HelixFibres),
}

/// Helices around an axis with one pitch. Give either `pitch`, or `angle` at `radius`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HelixFibres {
    /// A point of the axis \[mm\].
    #[serde(default)]
    pub point: [f64; 3],
    /// Direction of the axis; need not be of unit length \[-\].
    #[serde(default = "z_axis")]
    pub axis: [f64; 3],
    /// Lay length \[mm\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub pitch: Option<f64>,
    /// Angle between fibre and axis at the distance `radius` \[degrees\], from 0 to below 90.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 0, "exclusiveMaximum" = 90))]
    pub angle: Option<f64>,
    /// Where `angle` holds \[mm\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub radius: Option<f64>,
    /// Sense of the helix about the axis.
    #[serde(default)]
    pub hand: Hand,
}

fn z_axis() -> [f64; 3] {
    [0.0, 0.0, 1.0]
}

impl HelixFibres {
    /// Tangent of the fibre angle per distance from the axis, `2 pi / pitch` \[1/mm\], negative for a left-hand helix.
    #[must_use]
    pub fn tangent_per_radius(&self) -> f64 {
        let magnitude = match (self.pitch, self.angle, self.radius) {
            (Some(pitch), _, _) => 2.0 * std::f64::consts::PI / pitch,
            (None, Some(angle), Some(radius)) => angle.to_radians().tan() / radius,
            _ => 0.0,
        };
        match self.hand {
            Hand::Right => magnitude,
            Hand::Left => -magnitude,
        }
    }
}
