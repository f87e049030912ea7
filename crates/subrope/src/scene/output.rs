//! What a run writes.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What a run writes. Every key has a default.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Output {
    /// Folder of the results, relative to the scene file; `out/NAME` for a scene NAME.toml when left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<String>")]
    pub folder: Option<PathBuf>,
    /// Fields of the result file; all when left out.
    #[schemars(length(min = 1))]
    pub fields: Vec<Field>,
    /// Write every n-th increment \[-\]; the last of a step is always written.
    #[schemars(range(min = 1))]
    pub every: usize,
    /// Write a checkpoint every n-th increment \[-\], for `--restart`; 0: none. When left out 10, and 100 for meshes of less
    /// than 1000 elements, whose increments cost little.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub checkpoint_every: Option<usize>,
    /// Digits of the fields: "f32" or "f64".
    pub precision: Precision,
    /// Compression of the fields, from 0 (none) to 9 \[-\].
    #[schemars(range(max = 9))]
    pub compression: u8,
}

impl Default for Output {
    fn default() -> Self {
        Self {
            folder: None,
            fields: Field::ALL.to_vec(),
            every: 1,
            checkpoint_every: None,
            precision: Precision::F32,
            compression: 4,
        }
    }
}

/// A field of the result file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Field {
    /// Displacement of the nodes \[mm\].
    Displacement,
    /// Cauchy stress, element means \[MPa\].
    Stress,
    /// Elongation, compaction, distortion and longitudinal shear, element means \[-\].
    StrainModes,
    /// Plastic parts of distortion and longitudinal shear, element means \[-\].
    PlasticStrains,
    /// Energy dissipated per reference volume by each sliding mode, element means \[mJ/mm^3\].
    Dissipation,
    /// Fibre direction in the current configuration, element means \[-\].
    Fibre,
    /// Reaction forces of the nodes \[N\].
    Reactions,
    /// Gap \[mm\], pressure \[MPa\], traction of friction \[MPa\], friction work per area \[mJ/mm^2\] and slip \[mm\] of
    /// contacts, on the elements that touch.
    Contact,
    /// In scenes with cycles, what the cycle has lost: energy dissipated per reference volume by each sliding mode
    /// \[mJ/mm^3\] and friction work of contacts per area \[mJ/mm^2\], mid-point values.
    Cycle,
    /// Number of the strand of a rope.
    Strand,
}

impl Field {
    /// All fields.
    pub const ALL: [Self; 10] = [
        Self::Displacement,
        Self::Stress,
        Self::StrainModes,
        Self::PlasticStrains,
        Self::Dissipation,
        Self::Fibre,
        Self::Reactions,
        Self::Contact,
        Self::Cycle,
        Self::Strand,
    ];
}

/// Digits of a written field.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Precision {
    /// Single precision.
    F32,
    /// Double precision.
    F64,
}
