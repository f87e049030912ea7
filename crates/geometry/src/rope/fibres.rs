//! The fibre field of a rope: each strand has its own.

use crate::{FibreField, GeometryError, Strand, StrandFibres};
use nalgebra::{Matrix3, Vector3};

/// Fibre field of the mesh of a rope; the cell tells the strand.
#[derive(Debug, Clone, PartialEq)]
pub struct RopeFibres {
    fields: Vec<StrandFibres>,
    /// One past the last cell of every strand.
    ends: Vec<usize>,
}

impl RopeFibres {
    /// The fields of strands whose cells follow each other.
    pub fn new(strands: &[Strand]) -> Self {
        let mut end = 0;
        let ends = strands.iter().map(|strand| {
            end += strand.cell_count();
            end
        });
        Self { ends: ends.collect(), fields: strands.iter().map(Strand::fibres).collect() }
    }

    /// Zero-based index of the strand that a cell belongs to; the number of strands for a cell beyond the last.
    #[inline]
    pub fn strand(&self, cell: usize) -> usize {
        self.ends.partition_point(|&end| end <= cell)
    }

    /// The field of each strand.
    pub fn fields(&self) -> &[StrandFibres] {
        &self.fields
    }
}

impl FibreField for RopeFibres {
    fn frame(&self, x: &Vector3<f64>, cell: usize) -> Result<Matrix3<f64>, GeometryError> {
        let frames = self.ends.last().copied().unwrap_or(0);
        let field = self.fields.get(self.strand(cell)).ok_or(GeometryError::FrameIndex { cell, frames })?;
        field.frame(x, cell)
    }
}
