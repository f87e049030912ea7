//! Broad phase: boxes of patches in a tree that is refitted as they move. The only place that knows parry3d.

use nalgebra::Vector3;
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace};

use crate::foot::Posture;

/// Points of a patch whose box stands for it.
const SAMPLES: [f64; 3] = [-1.0, 0.0, 1.0];

/// A tree over the patches of a surface.
#[derive(Default)]
pub struct Tree {
    tree: Bvh,
    workspace: BvhWorkspace,
    patches: usize,
}

impl Tree {
    /// Fits the boxes to the current positions; built at the first call, refitted later.
    pub fn fit(&mut self, posture: &Posture<'_>) {
        let boxes: Vec<Aabb> = (0..posture.surface.patch_count()).map(|p| bounds(posture, p, 0.0)).collect();
        if self.patches == boxes.len() {
            for (index, b) in (0..).zip(&boxes) {
                self.tree.insert_or_update_partially(*b, index, 0.0);
            }
            self.tree.refit(&mut self.workspace);
        } else {
            self.tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes);
            self.patches = boxes.len();
        }
    }

    /// Patches whose boxes come within `reach` \[mm\] of the box of patch `patch` of another surface, in order.
    #[must_use]
    pub fn near(&self, other: &Posture<'_>, patch: usize, reach: f64) -> Vec<u32> {
        let query = bounds(other, patch, reach);
        let mut out: Vec<u32> = self.tree.intersect_aabb(&query).collect();
        out.sort_unstable();
        out
    }
}

/// Box of a patch, widened by `margin` and by the bulge of the surface between the sampled points.
fn bounds(posture: &Posture<'_>, patch: usize, margin: f64) -> Aabb {
    let nodal = posture.gather(patch);
    let mut low = Vector3::repeat(f64::INFINITY);
    let mut high = -low;
    for x in SAMPLES {
        for y in SAMPLES {
            let shape = posture.surface.shape(patch, [x, y]);
            let at = shape.combine(&shape.value, &nodal);
            (low, high) = (low.inf(&at), high.sup(&at));
        }
    }
    let grow = Vector3::repeat(margin + 0.05 * (high - low).norm());
    let (low, high) = (low - grow, high + grow);
    Aabb::new(Vector::new(low.x, low.y, low.z), Vector::new(high.x, high.y, high.z))
}
