//! Strands pressed flat against their neighbours.

use crate::{GeometryError, Helix, SectionMesh, Strand, StrandAxis, StrandEnds};
use nalgebra::Vector2;
use std::f64::consts::{PI, TAU};

/// How far the sections of the strands of a rope are flattened where they meet.
///
/// The section of a strand by a plane normal to the rope is the set of all x, counted from the axis of the strand, with
///
/// (|x|/(lambda T))^p + sum over both neighbours of (c max(0, m.x)/(lambda r))^p <= 1, p = 8.
///
/// T is the radius of the section of the round strand in the direction of x, m the normal of the plane between the
/// neighbours, c the degree of compaction. The set is convex and smooth: round for c = 0, cut by planes at the distance
/// lambda r/c from the axis of the strand when c is large, with rounded edges. lambda keeps the area, so that the
/// strand keeps its volume per length. Fibre fields of compacted strands are those of the round ones.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Compaction {
    /// Round strands.
    #[default]
    None,
    /// The degree c, from 0 (round) to 2.
    Degree(f64),
    /// The degree that gives the rope this outer diameter 2 (a + lambda r) \[mm\].
    OuterDiameter(f64),
}

/// Exponent p: the larger, the sharper the edges beside the flats.
const EXPONENT: i32 = 8;

/// Samples around an outline for its area.
const SAMPLES: usize = 1024;

/// A strand section and its growth lambda across the flats.
pub(super) struct Flattened {
    pub(super) section: SectionMesh,
    pub(super) growth: f64,
}

/// The section of `strand` on `helix` (about the z axis, phase 0), flattened to the degree `degree` against the
/// neighbours in a rope of `strands`.
pub(super) fn flatten(strand: &Strand, helix: &Helix, strands: usize, degree: f64) -> Result<Flattened, GeometryError> {
    let mut section = strand.section.mesh(strand.radius, strand.kind)?;
    if degree == 0.0 {
        return Ok(Flattened { section, growth: 1.0 });
    }
    let cut = Cut { axis: StrandAxis::Helix(*helix), helix, radius: strand.radius, strands, degree };
    let growth = cut.growth();
    for x in &mut section.points {
        *x = cut.image(x, growth)?;
    }
    Ok(Flattened { section, growth })
}

struct Cut<'a> {
    axis: StrandAxis,
    helix: &'a Helix,
    radius: f64,
    strands: usize,
    degree: f64,
}

impl Cut<'_> {
    /// The point (u, v) of the normal section where its mesh line meets the plane z = 0, from the axis of the strand.
    fn transverse(&self, local: &Vector2<f64>) -> Vector2<f64> {
        let x = self.axis.place(0.0, local, 0.0, StrandEnds::Flat);
        Vector2::new(x.x - self.helix.radius(), x.y)
    }

    /// Factor on a transverse point whose mesh line lies at the distance `radius` from the axis of the strand.
    fn factor(&self, x: &Vector2<f64>, radius: f64) -> f64 {
        let (sin, cos) = (PI / self.strands as f64).sin_cos();
        let term = |y: f64| (self.degree * (y * cos - x.x * sin).max(0.0) / radius).powi(EXPONENT);
        (1.0 + term(x.y) + term(-x.y)).powf(-1.0 / f64::from(EXPONENT))
    }

    /// lambda: the area of the round outline over that of the cut one, square root.
    fn growth(&self) -> f64 {
        let outline = (0..=SAMPLES).map(|i| {
            let (sin, cos) = (TAU * i as f64 / SAMPLES as f64).sin_cos();
            let x = self.transverse(&(Vector2::new(cos, sin) * self.radius));
            (x, x * self.factor(&x, self.radius))
        });
        let outline: Vec<_> = outline.collect();
        let (mut round, mut cut) = (0.0, 0.0);
        for pair in outline.windows(2) {
            round += pair[0].0.perp(&pair[1].0);
            cut += pair[0].1.perp(&pair[1].1);
        }
        (round / cut).sqrt()
    }

    /// The place of a section point after flattening, back in the normal section.
    fn image(&self, local: &Vector2<f64>, growth: f64) -> Result<Vector2<f64>, GeometryError> {
        let radius = local.norm();
        if radius == 0.0 {
            return Ok(*local);
        }
        let x = self.transverse(local);
        let x = x * (growth * self.factor(&x, radius));
        let x = nalgebra::Vector3::new(x.x + self.helix.radius(), x.y, 0.0);
        let frame = self.helix.frenet(self.helix.nearest(&x)?);
        let offset = x - frame.position;
        Ok(Vector2::new(offset.dot(&frame.normal), offset.dot(&frame.binormal)))
    }
}
