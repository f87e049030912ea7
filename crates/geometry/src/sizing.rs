//! Sizing of a rope from its hierarchy: filament, yarn, rope-yarn, strand, rope.
//!
//! What a maker tells of a rope is partly redundant and partly incomplete. [`Hierarchy`] takes what is known;
//! [`Hierarchy::report`] says what follows from it, what stays open and what contradicts.

mod pair;
mod quantity;
mod relation;
mod report;

pub use quantity::Quantity;
pub use relation::{Relation, strand_contraction};
pub use report::{Check, Known, Open, Origin, SizingReport};

/// What is known of a rope; everything but the number of strands may be left open.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hierarchy {
    /// Linear density of a filament \[dtex = 0.1 g/km\].
    pub filament_dtex: Option<f64>,
    /// Diameter of a filament \[mm\].
    pub filament_diameter: Option<f64>,
    /// Filaments in a yarn.
    pub filaments_per_yarn: Option<u32>,
    /// Linear density of a yarn \[tex = g/km\].
    pub yarn_tex: Option<f64>,
    /// Yarns in a rope-yarn.
    pub yarns_per_rope_yarn: Option<u32>,
    /// Rope-yarns in a strand.
    pub rope_yarns_per_strand: Option<u32>,
    /// Strands in the rope.
    pub strands: u32,
    /// Density of the solid \[kg/m^3\].
    pub density: Option<f64>,
    /// Mass of coating over mass of fibre \[-\].
    pub coating: Option<f64>,
    /// Angle at the surface of a strand between its rope-yarns and its axis \[rad\].
    pub strand_angle: Option<f64>,
    /// Angle between the axis of a strand and that of the rope \[rad\].
    pub lay_angle: Option<f64>,
    /// Length of rope per turn of a strand \[mm\], strands circular and touching.
    pub lay_length: Option<f64>,
    /// Linear density of the rope \[tex = g/km\].
    pub rope_tex: Option<f64>,
    /// Solid area over area of the section of a strand \[-\].
    pub packing: Option<f64>,
    /// Radius of a strand of circular section \[mm\].
    pub strand_radius: Option<f64>,
    /// Diameter of the circle around the rope \[mm\], strands circular and touching.
    pub outer_diameter: Option<f64>,
    /// Distance between neighbouring strands over their radius \[-\]: touching ones have 0. `None` when the helix radius
    /// has another reason (a core, flattened strands), so that neither diameter nor lay length tell of the angle.
    pub gap: Option<f64>,
}

impl Default for Hierarchy {
    /// Three touching strands, nothing else known.
    fn default() -> Self {
        Self {
            filament_dtex: None,
            filament_diameter: None,
            filaments_per_yarn: None,
            yarn_tex: None,
            yarns_per_rope_yarn: None,
            rope_yarns_per_strand: None,
            strands: 3,
            density: None,
            coating: None,
            strand_angle: None,
            lay_angle: None,
            lay_length: None,
            rope_tex: None,
            packing: None,
            strand_radius: None,
            outer_diameter: None,
            gap: Some(0.0),
        }
    }
}

impl Hierarchy {
    /// The value given for a quantity.
    pub fn given(&self, quantity: Quantity) -> Option<f64> {
        match quantity {
            Quantity::FilamentDtex => self.filament_dtex,
            Quantity::FilamentDiameter => self.filament_diameter,
            Quantity::FilamentsPerYarn => self.filaments_per_yarn.map(f64::from),
            Quantity::YarnTex => self.yarn_tex,
            Quantity::YarnsPerRopeYarn => self.yarns_per_rope_yarn.map(f64::from),
            Quantity::RopeYarnsPerStrand => self.rope_yarns_per_strand.map(f64::from),
            Quantity::Strands => Some(f64::from(self.strands)),
            Quantity::FibreTex => None,
            Quantity::Density => self.density,
            Quantity::Coating => self.coating,
            Quantity::StrandAngle => self.strand_angle,
            Quantity::LayAngle => self.lay_angle,
            Quantity::LayLength => self.lay_length,
            Quantity::RopeTex => self.rope_tex,
            Quantity::Packing => self.packing,
            Quantity::StrandRadius => self.strand_radius,
            Quantity::OuterDiameter => self.outer_diameter,
        }
    }

    /// What follows, what is open, what contradicts.
    pub fn report(&self) -> SizingReport {
        SizingReport::new(self)
    }
}
