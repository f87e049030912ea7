//! One layer of one strand, whose images under a screw are the whole rope.

use super::assembly::join;
use super::{Rope, RopeShape};
use crate::{GeometryError, Helix, Mesh, Strand, StrandAxis, StrandOrigin};

/// One layer of the first outer strand of a rope, from z = 0 up.
///
/// Every other layer of every other outer strand is its image by a turn of `j 2 pi/n + k angle` about the axis of the rope
/// and an advance of `k height` along it, and the fibres with it: mesh lines keep their place in the Frenet frame of the
/// axis of the strand, and so do the sections.
///
/// ```
/// use subrope_geometry::Rope;
/// let slice = Rope::default().slice()?;
/// assert_eq!((slice.mesh.cell_count(), slice.mesh.point_count()), (48, 2 * 57));
/// let (low, high) = (&slice.mesh.node_sets["END_A_1"], &slice.mesh.node_sets["END_B_1"]);
/// let (x, y) = (slice.mesh.points[low[0] as usize], slice.mesh.points[high[0] as usize]);
/// let turned = nalgebra::Rotation3::from_axis_angle(&nalgebra::Vector3::z_axis(), slice.angle) * x;
/// assert!((turned + nalgebra::Vector3::z() * slice.height - y).norm() < 1e-12);
/// # Ok::<(), subrope_geometry::GeometryError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct RopeSlice {
    /// The layer with the sets of a rope of one strand. The nodes of `END_B_1` follow those of `END_A_1` one by one.
    pub mesh: Mesh,
    /// The piece of strand.
    pub strand: Strand,
    /// Helix radius, lay and gaps of the rope.
    pub shape: RopeShape,
    /// Turn about the axis of the rope from one layer to the next \[rad\].
    pub angle: f64,
    /// Height of a layer \[mm\].
    pub height: f64,
}

impl Rope {
    /// One layer of the first outer strand; its axis starts on the reference direction of the axis of the rope.
    ///
    /// # Errors
    /// As [`Rope::mesh`].
    pub fn slice(&self) -> Result<RopeSlice, GeometryError> {
        let shape = self.shape()?;
        let height = self.length / self.layers as f64;
        let helix = Helix::new(self.axis, shape.helix_radius, shape.lay, 0.0)?;
        let layer = Self { layers: 1, origin: StrandOrigin::Bottom, ..*self };
        let strand = layer.strand(&self.outer, StrandAxis::Helix(helix), helix.arc_length(height))?;
        let (mesh, _) = join(&[strand], |strand| self.strand_mesh(strand, &shape))?;
        Ok(RopeSlice { mesh, strand, shape, angle: shape.lay.rate() * height, height })
    }
}
