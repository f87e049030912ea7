//! The finite element.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The finite element.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Element {
    /// How the hexahedra are formulated.
    #[serde(default)]
    pub formulation: Formulation,
}

/// How the hexahedra are formulated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Formulation {
    /// Eight nodes, 2x2x2 points, nothing averaged. Locks when fibres are stiff.
    Hex8,
    /// Eight nodes, the volume ratio averaged over the element (Abaqus C3D8).
    Hex8MeanVolume,
    /// Eight nodes, the fibre elongation averaged over the element: free of fibre locking. Needs a law with fibres.
    #[default]
    Hex8MeanElongation,
    /// 20 nodes, 3x3x3 points (C3D20). No contact, no ropes.
    Hex20,
    /// 20 nodes, 2x2x2 points (C3D20R): the cheapest of all until sliding localises, too soft then. No contact, no ropes.
    #[serde(rename = "hex20r")]
    Hex20R,
    /// 27 nodes, 3x3x3 points.
    Hex27,
}

impl Formulation {
    /// The word in a scene file.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Hex8 => "hex8",
            Self::Hex8MeanVolume => "hex8_mean_volume",
            Self::Hex8MeanElongation => "hex8_mean_elongation",
            Self::Hex20 => "hex20",
            Self::Hex20R => "hex20r",
            Self::Hex27 => "hex27",
        }
    }

    /// Whether faces have a node in the middle, or need none: what touches others is made of such.
    #[must_use]
    pub fn can_touch(self) -> bool {
        !matches!(self, Self::Hex20 | Self::Hex20R)
    }
}
