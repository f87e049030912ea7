//! Ropes: equal strands laid about an axis, with or without a core, as one mesh.

mod assembly;
mod compaction;
mod contour;
mod fibres;
mod layout;
mod search;
mod shape;
mod slice;

pub use assembly::{RopeMesh, join_strands};
pub use compaction::Compaction;
pub use fibres::RopeFibres;
pub use layout::{HelixRadius, LayBy, RopeLay, Sense, YarnLay, YarnLayBy};
pub use shape::RopeShape;
pub use slice::RopeSlice;

use shape::GREATEST_DEGREE;

use crate::{
    Axis, CellKind, GeometryError, Handedness, Helix, Parameter, Section, Strand, StrandAxis, StrandEnds, StrandOrigin,
    check,
};
use std::f64::consts::{PI, TAU};

/// Names of the sets of a rope mesh beside those of [`crate::strand::sets`].
///
/// Sets of one strand carry its number: `STRAND_1`, `END_A_1`, `END_B_1`, `LATERAL_1`, `SURFACE_NODES_1`, `AXIS_1`. The
/// outer strands are 1 to n, a core is n + 1. `END_A` and `END_B` hold the ends of all strands.
pub mod sets {
    /// Node set and element set: everything.
    pub const ALL: &str = "ALL";

    /// The name of a set of the strand of index `strand`, counted from 0.
    pub fn of_strand(name: &str, strand: usize) -> String {
        format!("{name}_{}", strand + 1)
    }
}

/// One strand of a rope, or several equal ones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RopeStrand {
    /// Radius r \[mm\].
    pub radius: f64,
    /// Winding of its yarns.
    pub yarns: YarnLay,
    /// Divisions of its section.
    pub section: Section,
}

/// A rope: `strands` equal strands on helices about an axis, and a straight core where one is given.
///
/// The ends are plane and normal to the axis of the rope. Mesh lines keep their place in the Frenet frame of the axis
/// of their strand. The axis of strand i lies at the angle 2 pi i/n from the reference direction of the axis of the
/// rope where the rope starts counting (in its middle or at its bottom).
///
/// ```
/// use subrope_geometry::{HelixRadius, Rope};
/// let rope = Rope { helix_radius: HelixRadius::Touching { gap: 0.05 }, layers: 10, ..Rope::default() };
/// let meshed = rope.mesh()?;
/// assert_eq!(meshed.mesh.cell_count(), 3 * 48 * 10);
/// assert!((meshed.shape.gap - 0.05).abs() < 1e-9);
/// let frames = meshed.frames()?;
/// assert_eq!(frames.len(), 8 * meshed.mesh.cell_count());
/// # Ok::<(), subrope_geometry::GeometryError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rope {
    /// Axis of the rope.
    pub axis: Axis,
    /// Number n of outer strands, at least two.
    pub strands: usize,
    /// The outer strands.
    pub outer: RopeStrand,
    /// The core.
    pub core: Option<RopeStrand>,
    /// Lay of the outer strands.
    pub lay: RopeLay,
    /// Radius of their helices.
    pub helix_radius: HelixRadius,
    /// Flattening of the outer strands against each other.
    pub compaction: Compaction,
    /// Length along the axis of the rope \[mm\].
    pub length: f64,
    /// Where the axis starts.
    pub origin: StrandOrigin,
    /// Layers of cells along the rope.
    pub layers: usize,
    /// Kind of the cells.
    pub kind: CellKind,
}

impl Default for RopeStrand {
    /// Radius 2.785 mm, yarns at 30 deg at the surface against the lay of the rope, 48 cells.
    fn default() -> Self {
        let yarns = YarnLay { by: YarnLayBy::SurfaceAngle(PI / 6.0), sense: Sense::Opposite };
        Self { radius: 2.785, yarns, section: Section::default() }
    }
}

impl Default for Rope {
    /// Three touching strands, right-handed at 20 deg, 60 mm long about the origin along z, 50 layers: 7200 eight-node
    /// bricks.
    fn default() -> Self {
        Self {
            axis: Axis::default(),
            strands: 3,
            outer: RopeStrand::default(),
            core: None,
            lay: RopeLay { by: LayBy::Angle(PI / 9.0), handedness: Handedness::Right },
            helix_radius: HelixRadius::default(),
            compaction: Compaction::None,
            length: 60.0,
            origin: StrandOrigin::Middle,
            layers: 50,
            kind: CellKind::Hex8,
        }
    }
}

impl Rope {
    /// Checks the parameters that need no computation.
    ///
    /// # Errors
    /// The first parameter out of range; [`GeometryError::NoSmoothSurface`] for 20-node bricks;
    /// [`GeometryError::CompactionOnCore`]; [`GeometryError::Undetermined`] when an
    /// outer diameter is to give the lay or the compaction of strands that do not touch each other, or both.
    pub fn validate(&self) -> Result<(), GeometryError> {
        if self.kind.is_serendipity() {
            return Err(GeometryError::NoSmoothSurface { nodes: self.kind.nodes() });
        }
        check::count(Parameter::Strands, self.strands, 2)?;
        check::positive(Parameter::Length, self.length)?;
        check::count(Parameter::Layers, self.layers, 1)?;
        for strand in std::iter::once(&self.outer).chain(&self.core) {
            check::positive(Parameter::Radius, strand.radius)?;
            strand.section.validate()?;
        }
        match self.helix_radius {
            HelixRadius::Given(radius) => check::positive(Parameter::HelixRadius, radius)?,
            HelixRadius::Touching { gap } => check::range(Parameter::Gap, gap, (-1.0_f64).next_up(), f64::INFINITY)?,
        };
        self.validate_compaction()
    }

    /// Checks that compaction makes sense and that an outer diameter determines one thing only.
    fn validate_compaction(&self) -> Result<(), GeometryError> {
        if self.compaction != Compaction::None && self.core.is_some() {
            return Err(GeometryError::CompactionOnCore);
        }
        let touching = matches!(self.helix_radius, HelixRadius::Touching { .. }) && self.core.is_none();
        let undetermined = |outer_diameter: f64| Err(GeometryError::Undetermined { outer_diameter });
        match (self.lay.by, self.compaction) {
            (LayBy::OuterDiameter(diameter), compaction) if !touching || compaction != Compaction::None => {
                undetermined(diameter)
            }
            (_, Compaction::OuterDiameter(diameter)) if !touching => undetermined(diameter),
            (_, Compaction::Degree(degree)) => {
                check::range(Parameter::Compaction, degree, 0.0, GREATEST_DEGREE.next_up()).map(|_| ())
            }
            _ => Ok(()),
        }
    }

    /// Number of strands with the core.
    pub fn strand_count(&self) -> usize {
        self.strands + usize::from(self.core.is_some())
    }

    /// Number of cells.
    pub fn cell_count(&self) -> usize {
        let core = self.core.map_or(0, |core| core.section.cell_count());
        (self.strands * self.outer.section.cell_count() + core) * self.layers
    }

    /// The strands as they are meshed: outer strands first, then the core.
    ///
    /// # Errors
    /// As [`Rope::shape`].
    pub fn strand_list(&self) -> Result<Vec<Strand>, GeometryError> {
        self.strands_of(&self.shape()?)
    }

    fn strands_of(&self, shape: &RopeShape) -> Result<Vec<Strand>, GeometryError> {
        let mut strands = Vec::with_capacity(self.strand_count());
        for i in 0..self.strands {
            let phase = TAU * i as f64 / self.strands as f64;
            let helix = Helix::new(self.axis, shape.helix_radius, shape.lay, phase)?;
            strands.push(self.strand(&self.outer, StrandAxis::Helix(helix), helix.arc_length(self.length))?);
        }
        if let Some(core) = &self.core {
            strands.push(self.strand(core, StrandAxis::Straight(self.axis), self.length)?);
        }
        Ok(strands)
    }

    fn strand(&self, strand: &RopeStrand, axis: StrandAxis, length: f64) -> Result<Strand, GeometryError> {
        Ok(Strand {
            radius: strand.radius,
            length,
            layers: self.layers,
            kind: self.kind,
            section: strand.section,
            axis,
            origin: self.origin,
            lay: strand.yarns.lay(strand.radius, self.lay.handedness)?,
            ends: StrandEnds::Flat,
            ..Strand::default()
        })
    }
}
