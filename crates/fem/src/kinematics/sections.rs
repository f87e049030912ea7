//! What sections make of the nodes that they carry: owners, radii, parts that slide.

use nalgebra::Vector3;

use super::{Kinematics, NodeRule, Owner, Section, Slide};
use crate::FemError;

impl Kinematics {
    /// Largest distance \[mm\] of a tied node from its reference point, of an image from its axis; one when nothing is tied.
    #[must_use]
    pub fn lever(&self) -> f64 {
        let (x, points) = (self.positions(), self.points());
        let arms = points.iter().flat_map(|p| p.nodes.iter().map(|&n| (x[n as usize] - p.position).norm()));
        let images = self.screw().into_iter().flat_map(|s| &s.images).map(|i| x[i.node as usize].xy().norm());
        let largest = arms.chain(images).fold(0.0, f64::max);
        if largest > 0.0 { largest } else { 1.0 }
    }
}

/// Notes who moves a node.
pub(super) fn claim(owner: &mut [Option<Owner>], by: Owner, node: u32, name: &str) -> Result<(), FemError> {
    let node = node as usize;
    let slot = owner.get_mut(node).ok_or_else(|| FemError::UnknownNode { node, name: name.into() })?;
    match slot {
        Some(_) => Err(FemError::NodeTiedTwice { node, name: name.into() }),
        None => {
            *slot = Some(by);
            Ok(())
        }
    }
}

/// Every rotation of a section must move a node of it.
pub(super) fn check_extent(section: &Section, positions: &[Vector3<f64>]) -> Result<(), FemError> {
    let first = positions[section.nodes[0] as usize];
    let arms = || section.nodes.iter().map(|&n| positions[n as usize] - first);
    let along = arms().max_by(|a, b| a.norm().total_cmp(&b.norm())).unwrap_or_else(Vector3::zeros);
    let size = along.norm();
    let off_line = arms().map(|arm| arm.cross(&along).norm()).fold(0.0, f64::max);
    if off_line > 1e-9 * size * size { Ok(()) } else { Err(FemError::DegenerateSection { name: section.name.clone() }) }
}

/// Gives a sliding coordinate to each node of a section that has a radius (a node on the axis has none).
pub(super) fn free_radii(section: &Section, positions: &[Vector3<f64>], rules: &mut [NodeRule], next: &mut u32) {
    let radius = |node: u32| {
        let arm = positions[node as usize] - section.position;
        arm - section.axis * section.axis.dot(&arm)
    };
    let largest = section.nodes.iter().map(|&n| radius(n).norm()).fold(0.0, f64::max);
    for &node in &section.nodes {
        let r = radius(node);
        if r.norm() > 1e-9 * largest
            && let NodeRule::Tied { slide, .. } = &mut rules[node as usize]
        {
            *slide = Some((*next, r.normalize()));
            *next += 1;
        }
    }
}

/// Gives each part of section `index` its sliding coordinate.
pub(super) fn free_parts(
    name: &str,
    index: u32,
    parts: &[Slide],
    coordinates: &[u32],
    rules: &mut [NodeRule],
) -> Result<(), FemError> {
    for (number, (part, &coordinate)) in parts.iter().zip(coordinates).enumerate() {
        let refuse = || FemError::BadSlide { name: name.into(), part: number + 1 };
        let direction = part.direction.try_normalize(0.0).filter(|d| d.iter().all(|c| c.is_finite()));
        let direction = direction.filter(|_| !part.nodes.is_empty()).ok_or_else(refuse)?;
        for &node in &part.nodes {
            match rules.get_mut(node as usize) {
                Some(NodeRule::Tied { point, slide: slide @ None, .. }) if *point == index => {
                    *slide = Some((coordinate, direction));
                }
                _ => return Err(refuse()),
            }
        }
    }
    Ok(())
}
