//! A rope of several strands generated from a few numbers.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::sizing::Sizing;
use super::strand::{Hand, Origin, StrandMesh};

/// Most strands of a rope.
const MOST_STRANDS: usize = 1000;

/// Equal strands laid together about z, with or without a straight core, ends plane and normal to z. Its node sets are
/// `END_A` (lowest z), `END_B`, `ALL`, and for every strand `END_A_1`, `END_B_1`, `SURFACE_NODES_1`, `AXIS_1`; its
/// surfaces are `LATERAL_1` and so on; a core is the last strand. Give `radius` and one of `lay_angle`, `lay_length` and
/// `outer_diameter`; or leave out the radius, the lay or both where they follow from `linear_density`, `outer_diameter`
/// and `[rope.sizing]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Rope {
    /// Number of strands without the core \[-\].
    #[serde(default = "three")]
    #[schemars(range(min = 2, max = MOST_STRANDS))]
    pub strands: usize,
    /// Radius of a strand \[mm\]; when left out it follows from `outer_diameter`, or from `linear_density` with `density`
    /// and `packing` in `[rope.sizing]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub radius: Option<f64>,
    /// Length along z \[mm\].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub length: f64,
    /// Angle between the axis of a strand and z \[degrees\], from 0 to below 90.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 0, "exclusiveMaximum" = 90))]
    pub lay_angle: Option<f64>,
    /// Length of rope per turn of a strand \[mm\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub lay_length: Option<f64>,
    /// Mass of the rope by its length \[tex\] (g/km).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub linear_density: Option<f64>,
    /// Diameter over the strands \[mm\], which gives the lay of touching round strands, or their radius when that is left
    /// out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub outer_diameter: Option<f64>,
    /// Sense of the lay.
    #[serde(default)]
    pub hand: Hand,
    /// Winding of the rope-yarns in a strand.
    pub yarns: Yarns,
    /// A straight strand in the middle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub core: Option<Core>,
    /// Gap between the smooth surfaces at the start as a fraction of the radius \[-\]; negative: they overlap.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = -1))]
    pub gap: f64,
    /// Radius of the helices of the strands' axes \[mm\]; from the gap when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub helix_radius: Option<f64>,
    /// Flattening of the strands against each other \[-\], from 0 (round) to 2.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 2.0))]
    pub compaction: f64,
    /// Where z = 0 lies: in the "middle" of the rope or at its "bottom" (END_A).
    #[serde(default)]
    pub origin: Origin,
    /// "none": all strands over the whole length. "helical": one layer of one strand, whose images are all others; for
    /// tension and twist of END_B, without a core. There are no ends then: the rope is that far from them.
    #[serde(default)]
    pub symmetry: Symmetry,
    /// Division of every strand into hexahedra; `lines` is "axis".
    #[serde(default)]
    pub mesh: StrandMesh,
    /// What is known of its yarns.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sizing: Option<Sizing>,
}

/// What of a rope is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Symmetry {
    /// All of it.
    #[default]
    None,
    /// One layer of one strand: everything else is its image under a screw.
    Helical,
}

/// Winding of rope-yarns about the axis of their strand. Give either `surface_angle` or `pitch`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Yarns {
    /// Angle at the surface of the strand between rope-yarns and its axis \[degrees\], from 0 (straight) to below 90.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 0, "exclusiveMaximum" = 90))]
    pub surface_angle: Option<f64>,
    /// Length of the strand's axis per turn against its Frenet normal \[mm\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub pitch: Option<f64>,
    /// Whether rope-yarns turn "opposite" to the strands or in the "same" sense.
    #[serde(default)]
    pub sense: YarnSense,
}

/// Sense of the rope-yarns against that of the strands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum YarnSense {
    /// Ordinary lay: torques balance in part.
    #[default]
    Opposite,
    /// Lang lay.
    Same,
}

/// A straight strand in the middle of a rope.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Core {
    /// Radius \[mm\].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub radius: f64,
    /// Winding of its rope-yarns; its sense counts against that of the strands.
    pub yarns: Yarns,
}

fn three() -> usize {
    3
}

impl Rope {
    /// Whether something beside radius and lay has to agree, or has to give them.
    #[must_use]
    pub fn is_sized(&self) -> bool {
        self.radius.is_none() || self.linear_density.is_some() || self.sizing.is_some()
    }

    /// Whether one layer of one strand stands for all.
    #[must_use]
    pub fn is_slice(&self) -> bool {
        self.symmetry == Symmetry::Helical
    }

    /// Number of strands with the core.
    #[must_use]
    pub fn strand_count(&self) -> usize {
        self.strands + usize::from(self.core.is_some())
    }

    /// Pairs of strands that are neighbours, from 1.
    #[must_use]
    pub fn neighbours(&self) -> Vec<(usize, usize)> {
        let n = self.strands;
        let ring = (1..=n).map(|i| (i, i % n + 1)).take(if n == 2 { 1 } else { n });
        let core = self.core.iter().flat_map(|_| (1..=n).map(|i| (n + 1, i)));
        ring.chain(core).collect()
    }

    /// Names of its node sets.
    #[must_use]
    pub fn set_names(&self) -> Vec<String> {
        let own = ["END_A", "END_B", "SURFACE_NODES", "AXIS"];
        let numbered = (1..=self.strand_count()).flat_map(|i| own.iter().map(move |name| format!("{name}_{i}")));
        ["END_A", "END_B", "ALL"].map(str::to_owned).into_iter().chain(numbered).collect()
    }

    /// Names of the sets of its ends: of all strands, then of each outer one.
    #[must_use]
    pub fn end_sets(&self) -> Vec<String> {
        let all = ["END_A", "END_B"].map(str::to_owned);
        all.iter()
            .cloned()
            .chain((1..=self.strands).flat_map(|i| all.clone().map(|end| format!("{end}_{i}"))))
            .collect()
    }

    /// Names of its surfaces.
    #[must_use]
    pub fn surface_names(&self) -> Vec<String> {
        (1..=self.strand_count()).map(|i| format!("LATERAL_{i}")).collect()
    }
}
