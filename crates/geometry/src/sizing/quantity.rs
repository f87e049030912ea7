//! The quantities of a rope's hierarchy and their ranges.

use std::f64::consts::{FRAC_PI_2, PI};
use std::fmt;

/// A quantity of the hierarchy of a rope, see [`super::Hierarchy`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Quantity {
    /// Linear density of a filament \[dtex\].
    FilamentDtex,
    /// Diameter of a filament \[mm\].
    FilamentDiameter,
    /// Filaments in a yarn.
    FilamentsPerYarn,
    /// Linear density of a yarn \[tex\].
    YarnTex,
    /// Yarns in a rope-yarn.
    YarnsPerRopeYarn,
    /// Rope-yarns in a strand.
    RopeYarnsPerStrand,
    /// Strands in the rope.
    Strands,
    /// Linear densities of all yarns of the rope added up, straight and uncoated \[tex\].
    FibreTex,
    /// Density of the solid \[kg/m^3\].
    Density,
    /// Mass of coating over mass of fibre \[-\].
    Coating,
    /// Surface angle of the rope-yarns in a strand \[rad\].
    StrandAngle,
    /// Angle of the strands in the rope \[rad\].
    LayAngle,
    /// Length of rope per turn of a strand \[mm\].
    LayLength,
    /// Linear density of the rope \[tex\].
    RopeTex,
    /// Solid area over area of the section of a strand \[-\].
    Packing,
    /// Radius of a strand \[mm\].
    StrandRadius,
    /// Diameter of the circle around the rope \[mm\].
    OuterDiameter,
}

impl Quantity {
    /// All of them.
    pub const ALL: [Self; 17] = [
        Self::FilamentDtex,
        Self::FilamentDiameter,
        Self::FilamentsPerYarn,
        Self::YarnTex,
        Self::YarnsPerRopeYarn,
        Self::RopeYarnsPerStrand,
        Self::Strands,
        Self::FibreTex,
        Self::Density,
        Self::Coating,
        Self::StrandAngle,
        Self::LayAngle,
        Self::LayLength,
        Self::RopeTex,
        Self::Packing,
        Self::StrandRadius,
        Self::OuterDiameter,
    ];

    /// Least and greatest sensible value.
    pub fn admissible(self) -> (f64, f64) {
        match self {
            Self::FilamentsPerYarn | Self::YarnsPerRopeYarn | Self::RopeYarnsPerStrand => (1.0, f64::from(u32::MAX)),
            Self::Strands => (2.0, 1e3),
            Self::Coating => (0.0, 1.0),
            Self::StrandAngle | Self::LayAngle => (0.0, PI / 3.0),
            Self::Packing => (f64::MIN_POSITIVE, 1.0),
            _ => (f64::MIN_POSITIVE, 1e12),
        }
    }

    pub(super) fn is_admissible(self, value: f64) -> bool {
        let (least, greatest) = self.admissible();
        (least..=greatest).contains(&value)
    }

    /// The value at `t` in \[0, 1\] of the range in which a solution is looked for: wider than the admissible one, so
    /// that a report can tell how far a solution lies outside.
    pub(super) fn at(self, t: f64) -> f64 {
        match self {
            Self::Coating => -0.99 + 100.99 * t,
            Self::StrandAngle | Self::LayAngle => t * (FRAC_PI_2 - 0.1),
            _ => (27.0 * (2.0 * t - 1.0)).exp(),
        }
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::FilamentDtex => "linear density of a filament [dtex]",
            Self::FilamentDiameter => "diameter of a filament [mm]",
            Self::FilamentsPerYarn => "filaments per yarn",
            Self::YarnTex => "linear density of a yarn [tex]",
            Self::YarnsPerRopeYarn => "yarns per rope-yarn",
            Self::RopeYarnsPerStrand => "rope-yarns per strand",
            Self::Strands => "strands",
            Self::FibreTex => "linear density of all yarns [tex]",
            Self::Density => "density [kg/m^3]",
            Self::Coating => "mass of coating over mass of fibre",
            Self::StrandAngle => "surface angle of the strand [rad]",
            Self::LayAngle => "lay angle [rad]",
            Self::LayLength => "lay length [mm]",
            Self::RopeTex => "linear density of the rope [tex]",
            Self::Packing => "packing of the strand",
            Self::StrandRadius => "radius of a strand [mm]",
            Self::OuterDiameter => "outer diameter [mm]",
        })
    }
}
