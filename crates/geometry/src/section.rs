//! Section meshes: a square core inside rings of quadrilaterals.

mod lattice;
mod measure;

use crate::{CellKind, GeometryError, Parameter, check};
use lattice::Lattice;
use nalgebra::Vector2;
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// How the area of the mesh relates to the circle of the nominal radius R.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum SectionArea {
    /// The whole section is scaled about its centre until the meshed area is pi R^2; its outer nodes lie slightly
    /// outside the circle. A ring of 16 straight sides grows by the factor sqrt((pi/8)/sin(pi/8)) = 1.0130.
    #[default]
    Exact,
    /// The outer nodes lie on the circle; a ring of 16 straight sides loses 2.55 % of the area.
    Inscribed,
}

/// Parameters of a section mesh: n x n core cells and `rings` rings of 4 n cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Section {
    /// Cells n along a side of the core, even, so that a node lies on the axis.
    pub core_cells: usize,
    /// Rings around the core, at least one.
    pub rings: usize,
    /// Half side of the core over the radius, in (0, 1/sqrt(2)).
    pub core_fraction: f64,
    /// Outward displacement of the middle of a core side over the half side, in \[0, 1).
    pub core_bulge: f64,
    /// Area of the mesh.
    pub area: SectionArea,
}

impl Default for Section {
    /// 4 x 4 core cells and two rings of 16: 48 cells.
    fn default() -> Self {
        Self { core_cells: 4, rings: 2, core_fraction: 0.4, core_bulge: 0.15, area: SectionArea::Exact }
    }
}

/// A mesh of quadrilaterals in the plane, quad4 or quad9.
#[derive(Debug, Clone, PartialEq)]
pub struct SectionMesh {
    /// Nodes per cell, 4 or 9, in the order of [`crate::quadrilateral::Quadrilateral`].
    pub nodes_per_cell: usize,
    /// Coordinates \[mm\]; the centre of the section is the origin.
    pub points: Vec<Vector2<f64>>,
    /// Flat connectivity, counter-clockwise.
    pub cells: Vec<u32>,
    /// Nodes of the outer boundary, counter-clockwise.
    pub outer: Vec<u32>,
    /// Cells at the outer boundary, counter-clockwise; their second edge (nodes 1 and 2) lies on it.
    pub outer_cells: Vec<u32>,
    /// The node at the centre.
    pub centre: u32,
}

impl Section {
    /// Number of cells: n^2 + 4 n rings.
    pub fn cell_count(&self) -> usize {
        self.core_cells * (self.core_cells + 4 * self.rings)
    }

    /// Checks the parameters.
    ///
    /// # Errors
    /// The first parameter out of range.
    pub fn validate(&self) -> Result<(), GeometryError> {
        check::count(Parameter::CoreCells, self.core_cells, 2)?;
        if !self.core_cells.is_multiple_of(2) {
            return Err(GeometryError::OddCore { value: self.core_cells });
        }
        check::count(Parameter::Rings, self.rings, 1)?;
        check::positive(Parameter::CoreFraction, self.core_fraction)?;
        check::range(Parameter::CoreFraction, self.core_fraction, 0.0, FRAC_1_SQRT_2)?;
        check::range(Parameter::CoreBulge, self.core_bulge, 0.0, 1.0)?;
        Ok(())
    }

    /// The mesh of a section of radius `radius` \[mm\]: quad4 for [`CellKind::Hex8`], quad9 with curved outer edges
    /// (their middle nodes as far from the centre as their ends) for the quadratic bricks; those of 20 nodes do without the
    /// nodes in the middle of its cells.
    ///
    /// # Errors
    /// A parameter out of range, too many nodes, or a core so large that a cell folds.
    pub fn mesh(&self, radius: f64, kind: CellKind) -> Result<SectionMesh, GeometryError> {
        self.validate()?;
        check::positive(Parameter::Radius, radius)?;
        self.check_size(kind)?;
        let mut mesh = Lattice::new(self, kind).section(self, radius);
        mesh.check_orientation()?;
        if self.area == SectionArea::Exact {
            mesh.scale((PI * radius * radius / mesh.area()).sqrt());
        }
        Ok(mesh)
    }

    fn check_size(&self, kind: CellKind) -> Result<(), GeometryError> {
        let cells = self.cell_count() as u128;
        let points = cells * (kind.order() * kind.order()) as u128 + 4 * self.core_cells as u128 + 1;
        if points > u128::from(u32::MAX) { Err(GeometryError::TooLarge { points, cells }) } else { Ok(()) }
    }
}

impl SectionMesh {
    /// Number of cells.
    pub fn cell_count(&self) -> usize {
        self.cells.len() / self.nodes_per_cell
    }

    /// Multiplies all coordinates by a factor.
    pub fn scale(&mut self, factor: f64) {
        for x in &mut self.points {
            *x *= factor;
        }
    }

    /// Largest distance of a node from the centre \[mm\].
    pub fn outer_radius(&self) -> f64 {
        self.points.iter().map(|x| x.norm()).fold(0.0, f64::max)
    }
}
