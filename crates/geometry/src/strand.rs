//! Strand meshes: a section swept along a straight or helical axis.

mod axis;
mod fibres;
mod sweep;

pub use axis::{StrandAxis, StrandEnds};
pub use fibres::StrandFibres;

use crate::{CellKind, GeometryError, Helix, Lay, Mesh, Parameter, Section, SectionArea, check};
use std::f64::consts::PI;

/// Names of the sets that a strand mesh carries.
pub mod sets {
    /// Node set: the low end.
    pub const END_A: &str = "END_A";
    /// Node set: the high end.
    pub const END_B: &str = "END_B";
    /// Node set: the outer surface.
    pub const SURFACE_NODES: &str = "SURFACE_NODES";
    /// Node set: the axis.
    pub const AXIS: &str = "AXIS";
    /// Element set: all cells.
    pub const STRAND: &str = "STRAND";
    /// Surface: the outer faces.
    pub const LATERAL: &str = "LATERAL";
}

/// Where the axis starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum StrandOrigin {
    /// The origin of the axis is in the middle: s from -length/2 to length/2.
    #[default]
    Middle,
    /// The origin of the axis is the low end: s from 0 to length.
    Bottom,
}

/// Which lines the mesh follows along the strand.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum MeshLines {
    /// Along the axis: sections of a straight strand are not turned, those of a helical one keep their place in the
    /// Frenet frame of the axis.
    #[default]
    Axis,
    /// Along the yarns: the sections turn by 2 pi s/pitch, nothing at s = 0.
    Yarns,
}

/// A strand of circular section, meshed with hexahedra.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Strand {
    /// Radius R \[mm\].
    pub radius: f64,
    /// Arc length of the axis \[mm\].
    pub length: f64,
    /// Layers of cells along the axis.
    pub layers: usize,
    /// Kind of the cells.
    pub kind: CellKind,
    /// The section. With [`SectionArea::Exact`] the volume of the mesh is pi R^2 length: where lines follow the yarns
    /// or the axis is a helix, straight edges between layers cut corners, and the sections are scaled to make up for
    /// it.
    pub section: Section,
    /// The axis.
    pub axis: StrandAxis,
    /// Where the axis starts.
    pub origin: StrandOrigin,
    /// Winding of the yarns about the axis, along its arc length.
    pub lay: Lay,
    /// Which lines the mesh follows.
    pub lines: MeshLines,
    /// Position of the sections of a helical strand.
    pub ends: StrandEnds,
}

impl Default for Strand {
    /// Radius 2.785 mm, length 60 mm about the origin along z, right-handed yarns at 30 deg at the surface, 2400
    /// eight-node bricks (48 in each of 50 layers), lines along the axis.
    fn default() -> Self {
        let radius = 2.785;
        Self {
            radius,
            length: 60.0,
            layers: 50,
            kind: CellKind::Hex8,
            section: Section::default(),
            axis: StrandAxis::default(),
            origin: StrandOrigin::Middle,
            lay: Lay::from_finite_rate((PI / 6.0).tan() / radius),
            lines: MeshLines::Axis,
            ends: StrandEnds::Normal,
        }
    }
}

impl Strand {
    /// The default strand on a helix, as in a rope: `length` \[mm\] is that of the rope, both ends are plane and normal
    /// to its axis.
    pub fn on_helix(helix: Helix, length: f64) -> Self {
        let length = helix.arc_length(length);
        Self { length, axis: StrandAxis::Helix(helix), ends: StrandEnds::Flat, ..Self::default() }
    }

    /// Checks the parameters.
    ///
    /// # Errors
    /// The first parameter out of range, a mesh too large, or a strand too thick for its axis.
    pub fn validate(&self) -> Result<(), GeometryError> {
        check::positive(Parameter::Radius, self.radius)?;
        check::positive(Parameter::Length, self.length)?;
        check::count(Parameter::Layers, self.layers, 1)?;
        self.section.validate()?;
        self.check_size()?;
        self.axis.check_radius(self.radius, self.line_rate(), self.ends)
    }

    /// Number of cells.
    pub fn cell_count(&self) -> usize {
        self.section.cell_count() * self.layers
    }

    /// Exact volume pi R^2 length \[mm^3\] of the smooth strand, whatever its axis (theorem of Pappus) and its ends.
    pub fn volume(&self) -> f64 {
        PI * self.radius * self.radius * self.length
    }

    /// Arc length of the axis at the low and the high end \[mm\].
    pub fn span(&self) -> (f64, f64) {
        match self.origin {
            StrandOrigin::Middle => (-0.5 * self.length, 0.5 * self.length),
            StrandOrigin::Bottom => (0.0, self.length),
        }
    }

    /// The field of its yarns.
    pub fn fibres(&self) -> StrandFibres {
        StrandFibres::new(&self.axis, self.lay)
    }

    /// The mesh with node sets, element set and surface named in [`sets`].
    ///
    /// # Errors
    /// As [`Strand::validate`]; [`GeometryError::SectionFolds`], [`GeometryError::InvertedCells`] when cells fold.
    pub fn mesh(&self) -> Result<Mesh, GeometryError> {
        self.mesh_of(self.section.mesh(self.radius, self.kind)?)
    }

    /// As [`Strand::mesh`], with the nodes of the section moved to those of `section`.
    pub(crate) fn mesh_of(&self, mut section: crate::SectionMesh) -> Result<Mesh, GeometryError> {
        self.validate()?;
        self.axis.check_radius(section.outer_radius(), self.line_rate(), self.ends)?;
        let (mut mesh, kept) = sweep::sweep(self, &section);
        let prismatic = matches!(self.axis, StrandAxis::Straight(_)) && self.line_rate() == 0.0;
        if self.section.area == SectionArea::Exact && !prismatic {
            self.match_volume(&mut section, &mut mesh, &kept)?;
        }
        crate::quality::check_orientation(&mesh)?;
        Ok(mesh)
    }

    /// Scales the sections until the volume of the mesh is that of the strand.
    fn match_volume(
        &self,
        section: &mut crate::SectionMesh,
        mesh: &mut Mesh,
        kept: &[u32],
    ) -> Result<(), GeometryError> {
        // The volume is close to quadratic in the scale: each pass gains several digits.
        for _ in 0..20 {
            let factor = (self.volume() / crate::quality::volume(mesh)?).sqrt();
            if !factor.is_finite() || (factor - 1.0).abs() < 1e-14 {
                break;
            }
            section.scale(factor);
            self.axis.check_radius(section.outer_radius(), self.line_rate(), self.ends)?;
            let all = sweep::points(self, section);
            mesh.points = kept.iter().map(|&node| all[node as usize]).collect();
        }
        Ok(())
    }

    /// Turning of the mesh lines about the axis \[rad/mm\].
    fn line_rate(&self) -> f64 {
        match self.lines {
            MeshLines::Axis => 0.0,
            MeshLines::Yarns => self.lay.rate(),
        }
    }

    fn check_size(&self) -> Result<(), GeometryError> {
        let order = self.kind.order() as u128;
        let (n, m) = (self.section.core_cells as u128 * order, self.section.rings as u128 * order);
        let per_level = (n + 1) * (n + 1) + 4 * n * m;
        let points = per_level * (self.layers as u128 * order + 1);
        let cells = (n / order) * (n / order + 4 * m / order) * self.layers as u128;
        if points > u128::from(u32::MAX) { Err(GeometryError::TooLarge { points, cells }) } else { Ok(()) }
    }
}
