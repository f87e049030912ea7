//! What follows from the parameters of a rope: helix radius, lay, compaction, gaps.

use super::compaction::flatten;
use super::search::Search;
use super::{Compaction, HelixRadius, Rope};
use crate::{Axis, GeometryError, Helix, Lay, SectionMesh, Strand};

/// What follows from the parameters of a [`Rope`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RopeShape {
    /// Radius a of the helices of the outer strands \[mm\].
    pub helix_radius: f64,
    /// Their lay about the axis of the rope.
    pub lay: Lay,
    /// Angle between their axes and that of the rope \[rad\].
    pub lay_angle: f64,
    /// Outer diameter 2 (a + lambda r) \[mm\], r the nominal radius of an outer strand, lambda = 1 where it is round.
    pub outer_diameter: f64,
    /// Degree of compaction of the outer strands, 0 where they are round, see [`Compaction`].
    pub compaction: f64,
    /// Mean radius of the smooth contact surface of a round outer strand in its section, see
    /// [`crate::SectionMesh::smooth_radius`] \[mm\].
    pub smooth_radius: f64,
    /// The same of the core \[mm\].
    pub core_smooth_radius: Option<f64>,
    /// Distance of the smooth surfaces of neighbouring outer strands over their radius, negative when they overlap:
    /// strands of radius r (1 + gap/2) on the same helices would touch.
    pub gap: f64,
    /// Distance of the smooth surfaces of core and outer strands over the radius of an outer strand.
    pub core_gap: Option<f64>,
}

/// Largest degree of compaction.
pub(super) const GREATEST_DEGREE: f64 = 2.0;

impl Rope {
    /// Helix radius, lay, compaction and gaps.
    ///
    /// # Errors
    /// As [`Rope::validate`]; [`GeometryError::StrandsDoNotFit`] when strands touch at no helix radius;
    /// [`GeometryError::OuterDiameter`] when no lay, or no compaction, meets the outer diameter;
    /// [`GeometryError::OuterStrandsOverlap`] when strands that touch the core overlap each other; the errors of
    /// [`crate::Strand::mesh`].
    pub fn shape(&self) -> Result<RopeShape, GeometryError> {
        self.validate()?;
        let degree = match self.compaction {
            Compaction::None => 0.0,
            Compaction::Degree(degree) => degree,
            Compaction::OuterDiameter(diameter) => self.degree_of_diameter(diameter)?,
        };
        let shape = Search { rope: self, degree }.shape()?;
        let overlap = matches!(self.helix_radius, HelixRadius::Touching { .. }) && self.core.is_some();
        if overlap && shape.gap < -1e-9 {
            let helix_radius = shape.helix_radius;
            return Err(GeometryError::OuterStrandsOverlap { strands: self.strands, helix_radius, gap: shape.gap });
        }
        Ok(shape)
    }

    /// The degree of compaction at which the rope has the given outer diameter: it falls as the degree grows.
    fn degree_of_diameter(&self, outer_diameter: f64) -> Result<f64, GeometryError> {
        let diameter = |degree: f64| Search { rope: self, degree }.outer_diameter();
        let (least, greatest) = (diameter(GREATEST_DEGREE)?, diameter(0.0)?);
        if !(least..=greatest * (1.0 + 1e-12)).contains(&outer_diameter) {
            return Err(GeometryError::OuterDiameter { outer_diameter, least, greatest });
        }
        let (mut low, mut high) = (0.0, GREATEST_DEGREE);
        for _ in 0..45 {
            let middle = 0.5 * (low + high);
            if diameter(middle)? > outer_diameter { low = middle } else { high = middle }
        }
        Ok(0.5 * (low + high))
    }

    /// The section of the outer strands on helices of radius `a`, flattened to the degree `degree`.
    pub(super) fn flattened(
        &self,
        strand: &Strand,
        a: f64,
        lay: Lay,
        degree: f64,
    ) -> Result<SectionMesh, GeometryError> {
        Ok(flatten(strand, &Helix::new(Axis::default(), a, lay, 0.0)?, self.strands, degree)?.section)
    }
}
