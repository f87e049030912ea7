//! The search for helix radius and lay at which smooth surfaces touch.

use super::compaction::{Flattened, flatten};
use super::contour::{Contour, secant};
use super::{HelixRadius, LayBy, Rope, RopeLay, RopeShape, RopeStrand};
use crate::{
    Axis, GeometryError, Helix, Lay, Mesh, Strand, StrandAxis, StrandOrigin, touching_radius, touching_radius_at_angle,
};
use std::f64::consts::PI;

/// The search for the shape of a rope of known compaction.
pub(super) struct Search<'a> {
    pub(super) rope: &'a Rope,
    pub(super) degree: f64,
}

impl Search<'_> {
    pub(super) fn shape(&self) -> Result<RopeShape, GeometryError> {
        let rope = self.rope;
        let (a, lay) = self.helix()?;
        let core = self.core_smooth_radius()?;
        let core_gap = match core {
            Some(radius) => Some((self.contour(a, lay, 1.0)?.inner_radius() - radius) / rope.outer.radius),
            None => None,
        };
        Ok(RopeShape {
            helix_radius: a,
            lay,
            lay_angle: lay.angle(a),
            outer_diameter: self.diameter_at(a, lay)?,
            compaction: self.degree,
            smooth_radius: rope.outer.section.mesh(rope.outer.radius, rope.kind)?.smooth_radius(),
            core_smooth_radius: core,
            gap: self.gap(a, lay)?,
            core_gap,
        })
    }

    pub(super) fn outer_diameter(&self) -> Result<f64, GeometryError> {
        let (a, lay) = self.helix()?;
        self.diameter_at(a, lay)
    }

    fn diameter_at(&self, a: f64, lay: Lay) -> Result<f64, GeometryError> {
        let (_, flattened) = self.layer(a, lay, 1.0)?;
        Ok(2.0 * (a + flattened.growth * self.rope.outer.radius))
    }

    /// Helix radius and lay.
    fn helix(&self) -> Result<(f64, Lay), GeometryError> {
        match (self.rope.helix_radius, self.rope.lay.by) {
            (HelixRadius::Given(a), _) => Ok((a, self.lay_at(a)?)),
            (HelixRadius::Touching { gap }, LayBy::OuterDiameter(d)) => self.lay_of_diameter(d, gap),
            (HelixRadius::Touching { gap }, _) => {
                let a = self.touching(gap)?;
                Ok((a, self.lay_at(a)?))
            }
        }
    }

    /// The lay of strands on helices of radius `a`.
    fn lay_at(&self, a: f64) -> Result<Lay, GeometryError> {
        let RopeLay { by, handedness } = self.rope.lay;
        match by {
            LayBy::Length(length) => Lay::from_lay_length(length, handedness),
            LayBy::Angle(angle) => Lay::from_angle(a, angle, handedness),
            LayBy::OuterDiameter(outer_diameter) => Err(GeometryError::Undetermined { outer_diameter }),
        }
    }

    /// Helix radius at which smooth surfaces are `gap` radii apart.
    fn touching(&self, gap: f64) -> Result<f64, GeometryError> {
        let start = self.first_guess(gap)?;
        let step = -1e-3 * start;
        let root = match self.core_smooth_radius()? {
            Some(core) => {
                let least = core + gap * self.rope.outer.radius;
                secant(start, step, |a| Ok(least - self.contour(a, self.lay_at(a)?, 1.0)?.inner_radius()))?
            }
            None => secant(start, step, |a| self.excess(a, self.lay_at(a)?, 1.0 + 0.5 * gap))?,
        };
        root.filter(|a| *a > 0.0).ok_or_else(|| self.do_not_fit(self.lay_at(start)))
    }

    /// The helix radius of round tubes.
    fn first_guess(&self, gap: f64) -> Result<f64, GeometryError> {
        let radius = self.rope.outer.radius;
        if let Some(core) = &self.rope.core {
            return Ok(core.radius + radius * (1.0 + gap));
        }
        match self.rope.lay.by {
            LayBy::Angle(angle) => touching_radius_at_angle(self.rope.strands, radius * (1.0 + 0.5 * gap), angle),
            _ => touching_radius(self.rope.strands, radius * (1.0 + 0.5 * gap), self.lay_at(radius)?),
        }
    }

    fn lay_of_diameter(&self, outer_diameter: f64, gap: f64) -> Result<(f64, Lay), GeometryError> {
        let a = 0.5 * outer_diameter - self.rope.outer.radius;
        let swelling = 1.0 + 0.5 * gap;
        let straight = |a: f64| self.excess(a, Lay::PARALLEL, swelling);
        let tubes = |angle| touching_radius_at_angle(self.rope.strands, self.rope.outer.radius * swelling, angle);
        let greatest = 2.0 * (tubes(PI / 3.0)? + self.rope.outer.radius);
        let failure = |least: f64| GeometryError::OuterDiameter { outer_diameter, least, greatest };
        let start = tubes(0.0)?;
        let least_radius = secant(start, -1e-3 * start, straight)?.unwrap_or(start);
        let least = 2.0 * (least_radius + self.rope.outer.radius);
        if outer_diameter.is_nan() || outer_diameter < least * (1.0 - 1e-12) {
            return Err(failure(least));
        }
        if outer_diameter <= least * (1.0 + 1e-12) {
            return Ok((a, Lay::PARALLEL));
        }
        // The excess is close to linear in the square of the tangent of the lay angle.
        let lay = |q: f64| Lay::from_rate(self.rope.lay.handedness.sign() * q.max(0.0).sqrt() / a);
        let q = secant(0.0, 0.05, |q| self.excess(a, lay(q)?, swelling))?;
        let q = q.filter(|q| *q < 3.0).ok_or_else(|| failure(least))?;
        Ok((a, lay(q)?))
    }

    /// Gap between neighbours over their radius.
    fn gap(&self, a: f64, lay: Lay) -> Result<f64, GeometryError> {
        let excess = |swelling: f64| self.excess(a, lay, swelling);
        let swelling = match secant(1.0, -1e-3, excess) {
            Ok(Some(swelling)) => swelling,
            // Strands so far apart that none on these helices is thick enough to touch: told to first order.
            _ => {
                let (here, thinner) = (excess(1.0)?, excess(0.999)?);
                1.0 - 1e-3 * here / (here - thinner)
            }
        };
        Ok(2.0 * (swelling - 1.0))
    }

    /// How far neighbours whose radius is `swelling` times theirs reach beyond the plane between them \[mm\].
    fn excess(&self, a: f64, lay: Lay, swelling: f64) -> Result<f64, GeometryError> {
        Ok(self.contour(a, lay, swelling)?.excess(self.rope.strands))
    }

    fn contour(&self, a: f64, lay: Lay, swelling: f64) -> Result<Contour, GeometryError> {
        let (layer, flattened) = self.layer(a, lay, swelling)?;
        let order = layer.kind.order() as f64;
        let mesh: Mesh = layer.mesh_of(flattened.section)?;
        Ok(Contour::new(&layer, &mesh, self.rope.length / (order * self.rope.layers as f64)))
    }

    /// One layer of an outer strand about the z axis, its radius `swelling` times the nominal one, and its section.
    fn layer(&self, a: f64, lay: Lay, swelling: f64) -> Result<(Strand, Flattened), GeometryError> {
        let (rope, helix) = (self.rope, Helix::new(Axis::default(), a, lay, 0.0)?);
        let outer = RopeStrand { radius: rope.outer.radius * swelling, ..rope.outer };
        let height = helix.arc_length(rope.length / rope.layers as f64);
        let strand = rope.strand(&outer, StrandAxis::Helix(helix), height)?;
        let layer = Strand { layers: 1, origin: StrandOrigin::Bottom, ..strand };
        Ok((layer, flatten(&layer, &helix, rope.strands, self.degree)?))
    }

    fn core_smooth_radius(&self) -> Result<Option<f64>, GeometryError> {
        let radius = |core: &RopeStrand| Ok(core.section.mesh(core.radius, self.rope.kind)?.smooth_radius());
        self.rope.core.as_ref().map(radius).transpose()
    }

    fn do_not_fit(&self, lay: Result<Lay, GeometryError>) -> GeometryError {
        let lay_length = lay.map_or(f64::NAN, |lay| lay.lay_length());
        GeometryError::StrandsDoNotFit { strands: self.rope.strands, radius: self.rope.outer.radius, lay_length }
    }
}
