//! Helix radius and lay of a rope from the touching of its smooth surfaces.

use super::contour::{Contour, secant};
use super::{HelixRadius, LayBy, Rope};
use crate::{Axis, CellKind, GeometryError, Helix, Lay, StrandAxis, StrandOrigin, touching_radius_at_angle};

/// What follows from the parameters of a [`Rope`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RopeShape {
    /// Radius a of the helices of the outer strands \[mm\].
    pub helix_radius: f64,
    /// Their lay about the axis of the rope.
    pub lay: Lay,
    /// Angle between their axes and that of the rope \[rad\].
    pub lay_angle: f64,
    /// Outer diameter 2 (a + r) \[mm\], r the nominal radius of an outer strand.
    pub outer_diameter: f64,
    /// Mean radius of the smooth contact surface of an outer strand in its section, see
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

impl Rope {
    /// Helix radius, lay and gaps.
    ///
    /// # Errors
    /// As [`Rope::validate`]; [`GeometryError::StrandsDoNotFit`] when strands touch at no helix radius;
    /// [`GeometryError::OuterDiameter`] when no lay meets the outer diameter; [`GeometryError::OuterStrandsOverlap`] when
    /// strands that touch the core overlap each other; the errors of [`crate::Strand::mesh`].
    pub fn shape(&self) -> Result<RopeShape, GeometryError> {
        self.validate()?;
        let (a, lay) = match (self.helix_radius, self.lay.by) {
            (HelixRadius::Given(a), _) => (a, self.lay_at(a)?),
            (HelixRadius::Touching { gap }, LayBy::OuterDiameter(d)) => self.lay_of_diameter(d, gap)?,
            (HelixRadius::Touching { gap }, _) => {
                let a = self.touching(gap)?;
                (a, self.lay_at(a)?)
            }
        };
        let shape = self.described(a, lay)?;
        let overlap = matches!(self.helix_radius, HelixRadius::Touching { .. }) && self.core.is_some();
        if overlap && shape.gap < -1e-9 {
            return Err(GeometryError::OuterStrandsOverlap { strands: self.strands, helix_radius: a, gap: shape.gap });
        }
        Ok(shape)
    }

    fn described(&self, a: f64, lay: Lay) -> Result<RopeShape, GeometryError> {
        let core = self.core_smooth_radius()?;
        let core_gap = match core {
            Some(radius) => Some((self.contour(a, lay, 1.0)?.inner_radius() - radius) / self.outer.radius),
            None => None,
        };
        Ok(RopeShape {
            helix_radius: a,
            lay,
            lay_angle: lay.angle(a),
            outer_diameter: 2.0 * (a + self.outer.radius),
            smooth_radius: self.outer.section.mesh(self.outer.radius, self.kind)?.smooth_radius(),
            core_smooth_radius: core,
            gap: self.gap(a, lay)?,
            core_gap,
        })
    }

    /// The lay of strands on helices of radius `a`.
    fn lay_at(&self, a: f64) -> Result<Lay, GeometryError> {
        match self.lay.by {
            LayBy::Length(length) => Lay::from_lay_length(length, self.lay.handedness),
            LayBy::Angle(angle) => Lay::from_angle(a, angle, self.lay.handedness),
            LayBy::OuterDiameter(outer_diameter) => Err(GeometryError::LayUndetermined { outer_diameter }),
        }
    }

    /// Helix radius at which smooth surfaces are `gap` radii apart.
    fn touching(&self, gap: f64) -> Result<f64, GeometryError> {
        let start = self.first_guess(gap)?;
        let step = -1e-3 * start;
        let root = match self.core_smooth_radius()? {
            Some(core) => {
                let least = core + gap * self.outer.radius;
                secant(start, step, |a| Ok(least - self.contour(a, self.lay_at(a)?, 1.0)?.inner_radius()))?
            }
            None => secant(start, step, |a| self.excess(a, self.lay_at(a)?, 1.0 + 0.5 * gap))?,
        };
        root.filter(|a| *a > 0.0).ok_or_else(|| self.do_not_fit(self.lay_at(start)))
    }

    /// The helix radius of round tubes.
    fn first_guess(&self, gap: f64) -> Result<f64, GeometryError> {
        let radius = self.outer.radius;
        if let Some(core) = &self.core {
            return Ok(core.radius + radius * (1.0 + gap));
        }
        match self.lay.by {
            LayBy::Angle(angle) => touching_radius_at_angle(self.strands, radius * (1.0 + 0.5 * gap), angle),
            _ => crate::touching_radius(self.strands, radius * (1.0 + 0.5 * gap), self.lay_at(radius)?),
        }
    }

    fn lay_of_diameter(&self, outer_diameter: f64, gap: f64) -> Result<(f64, Lay), GeometryError> {
        let a = 0.5 * outer_diameter - self.outer.radius;
        let swelling = 1.0 + 0.5 * gap;
        let straight = |a: f64| self.excess(a, Lay::PARALLEL, swelling);
        let failure = |least: f64| GeometryError::OuterDiameter { outer_diameter, least };
        let start = touching_radius_at_angle(self.strands, self.outer.radius * swelling, 0.0)?;
        let least_radius = secant(start, -1e-3 * start, straight)?.unwrap_or(start);
        let least = 2.0 * (least_radius + self.outer.radius);
        if outer_diameter.is_nan() || outer_diameter < least * (1.0 - 1e-12) {
            return Err(failure(least));
        }
        if outer_diameter <= least * (1.0 + 1e-12) {
            return Ok((a, Lay::PARALLEL));
        }
        // The excess is close to linear in the square of the tangent of the lay angle.
        let lay = |q: f64| Lay::from_rate(self.lay.handedness.sign() * q.max(0.0).sqrt() / a);
        let q = secant(0.0, 0.05, |q| self.excess(a, lay(q)?, swelling))?;
        let q = q.filter(|q| *q < 3.0).ok_or_else(|| failure(least))?;
        Ok((a, lay(q)?))
    }

    /// Gap between neighbours over their radius.
    fn gap(&self, a: f64, lay: Lay) -> Result<f64, GeometryError> {
        let root = secant(1.0, 1e-3, |swelling| self.excess(a, lay, swelling))?;
        root.map(|swelling| 2.0 * (swelling - 1.0)).ok_or_else(|| self.do_not_fit(Ok(lay)))
    }

    /// How far neighbours whose radius is `swelling` times theirs reach beyond the plane between them \[mm\].
    fn excess(&self, a: f64, lay: Lay, swelling: f64) -> Result<f64, GeometryError> {
        Ok(self.contour(a, lay, swelling)?.excess(self.strands))
    }

    fn contour(&self, a: f64, lay: Lay, swelling: f64) -> Result<Contour, GeometryError> {
        let (helix, height) = (Helix::new(Axis::default(), a, lay, 0.0)?, self.length / self.layers as f64);
        let outer = super::RopeStrand { radius: self.outer.radius * swelling, ..self.outer };
        let mut layer = self.strand(&outer, StrandAxis::Helix(helix), helix.arc_length(height))?;
        (layer.layers, layer.origin) = (1, StrandOrigin::Bottom);
        let order = if self.kind == CellKind::Hex27 { 2.0 } else { 1.0 };
        Ok(Contour::new(&layer, &layer.mesh()?, height / order))
    }

    fn core_smooth_radius(&self) -> Result<Option<f64>, GeometryError> {
        let radius = |core: &super::RopeStrand| Ok(core.section.mesh(core.radius, self.kind)?.smooth_radius());
        self.core.as_ref().map(radius).transpose()
    }

    fn do_not_fit(&self, lay: Result<Lay, GeometryError>) -> GeometryError {
        let lay_length = lay.map_or(f64::NAN, |lay| lay.lay_length());
        GeometryError::StrandsDoNotFit { strands: self.strands, radius: self.outer.radius, lay_length }
    }
}
