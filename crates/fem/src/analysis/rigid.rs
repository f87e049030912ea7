//! Rigid motions that nothing holds, found from the geometry before anything is solved.

use nalgebra::{Matrix6, SymmetricEigen, Vector3, Vector6};

use crate::contribution::Contribution;
use crate::kinematics::{Kinematics, NodeRule};

/// Names every rigid motion of every body that the prescribed coordinates leave free, such as
/// `translation along z` or `rotation about x`. Bodies are the connected parts of elements and sections. What slides in
/// its sections and is held by nothing else is told too: its directions of sliding must not all be parallel.
#[must_use]
pub fn rigid_motions(
    kinematics: &Kinematics,
    contributions: &[Box<dyn Contribution>],
    prescribed: &[bool],
) -> Vec<String> {
    let bodies = bodies(kinematics, contributions, true);
    let mut constraints: Vec<Body> = bodies.iter().map(|nodes| Body::new(kinematics, nodes)).collect();
    let mut owner = vec![None; kinematics.node_count()];
    for (b, nodes) in bodies.iter().enumerate() {
        nodes.iter().for_each(|&n| owner[n as usize] = Some(b));
    }
    for (node, rule) in kinematics.rules().iter().enumerate() {
        if let (NodeRule::Free { first }, Some(b)) = (rule, owner[node]) {
            for k in 0..3 {
                if prescribed[*first as usize + k] {
                    constraints[b].hold_translation(&kinematics.positions()[node], k);
                }
            }
        }
    }
    for point in kinematics.points() {
        let Some(b) = point.nodes.first().and_then(|&n| owner[n as usize]) else { continue };
        for k in 0..3 {
            if prescribed[point.first as usize + k] {
                constraints[b].hold_translation(&point.position, k);
            }
            if prescribed[point.first as usize + 3 + k] {
                constraints[b].hold_rotation(k);
            }
        }
    }
    hold_by_images(kinematics, &owner, &mut constraints);
    let several = constraints.len() > 1;
    let mut names = Vec::new();
    for (b, body) in constraints.iter().enumerate() {
        for motion in body.free_motions() {
            names.push(if several { format!("body {}: {motion}", b + 1) } else { motion });
        }
    }
    names.extend(sliding_motions(kinematics, contributions, prescribed));
    names
}

/// Sine of half a turn below which an image counts as not turned.
const TURNED: f64 = 1e-6;

/// A body that is its own image under a screw can only move along and about z: a tilt does not stay with the screw, and
/// neither does a motion across the axis unless the screw does not turn.
fn hold_by_images(kinematics: &Kinematics, owner: &[Option<usize>], constraints: &mut [Body]) {
    let Some(screw) = kinematics.screw() else { return };
    for image in &screw.images {
        let Some(b) = owner[image.node as usize] else { continue };
        let turned = (0.5 * (image.turn + f64::from(image.layer) * screw.angle)).sin().abs() > TURNED;
        (0..2).filter(|_| turned || image.layer != 0).for_each(|k| constraints[b].hold_rotation(k));
        if turned {
            let centre = constraints[b].centre;
            (0..2).for_each(|k| constraints[b].hold_translation(&centre, k));
        }
    }
}

/// Translations of bodies of elements along the one direction in which they slide in all their sections.
fn sliding_motions(
    kinematics: &Kinematics,
    contributions: &[Box<dyn Contribution>],
    prescribed: &[bool],
) -> Vec<String> {
    if kinematics.points().iter().all(|point| point.slides.is_empty()) {
        return Vec::new();
    }
    let motion = |nodes: Vec<u32>| {
        let (mut along, mut name) = (None::<Vector3<f64>>, String::new());
        for &node in &nodes {
            let direction = match &kinematics.rules()[node as usize] {
                NodeRule::Free { first } => {
                    let held = (0..3).filter(|k| prescribed[*first as usize + k]);
                    let held: Vec<Vector3<f64>> = held.map(|k| Vector3::ith(k, 1.0)).collect();
                    if along.is_some_and(|d| held.iter().any(|axis| axis.dot(&d).abs() > PARALLEL)) {
                        return None;
                    }
                    continue;
                }
                NodeRule::Tied { point, slide: Some((rho, direction)), .. } => {
                    let point = &kinematics.points()[*point as usize];
                    let part = point.slides.iter().position(|c| c == rho).filter(|_| !prescribed[*rho as usize])?;
                    name = format!("part {} of section {}", part + 1, point.name);
                    *direction
                }
                NodeRule::Tied { slide: None, .. } | NodeRule::Image { .. } => return None,
            };
            if along.get_or_insert(direction).cross(&direction).norm() > PARALLEL {
                return None;
            }
        }
        along.map(|direction| format!("{name}: sliding along {}", name_direction(&direction)))
    };
    let mut bodies = bodies(kinematics, contributions, false);
    // Tied nodes first: they give the direction that free nodes may hold.
    for nodes in &mut bodies {
        nodes.sort_by_key(|&node| matches!(kinematics.rules()[node as usize], NodeRule::Free { .. }));
    }
    bodies.into_iter().filter_map(motion).collect()
}

/// Sine of the angle below which directions count as parallel.
const PARALLEL: f64 = 1e-6;

/// Constraints on the six rigid motions of one body: `sum rows^T rows`.
struct Body {
    centre: Vector3<f64>,
    size: f64,
    held: Matrix6<f64>,
}

impl Body {
    fn new(kinematics: &Kinematics, nodes: &[u32]) -> Self {
        let x = kinematics.positions();
        let centre = nodes.iter().map(|&n| x[n as usize]).sum::<Vector3<f64>>() / nodes.len() as f64;
        let size = nodes.iter().map(|&n| (x[n as usize] - centre).norm()).fold(0.0, f64::max).max(f64::MIN_POSITIVE);
        Self { centre, size, held: Matrix6::zeros() }
    }

    /// Row of `e_k . (t + w x (x - centre))`, lengths over the size of the body.
    fn hold_translation(&mut self, x: &Vector3<f64>, k: usize) {
        let arm = (x - self.centre) / self.size;
        let turn = arm.cross(&Vector3::ith(k, 1.0));
        let mut row = Vector6::zeros();
        row[k] = 1.0;
        row.fixed_rows_mut::<3>(3).copy_from(&turn);
        self.held += row * row.transpose();
    }

    fn hold_rotation(&mut self, k: usize) {
        self.held[(3 + k, 3 + k)] += 1.0;
    }

    fn free_motions(&self) -> Vec<String> {
        let eigen = SymmetricEigen::new(self.held);
        let largest = eigen.eigenvalues.max().max(1.0);
        (0..6)
            .filter(|&i| eigen.eigenvalues[i] < 1e-10 * largest)
            .map(|i| name_motion(&eigen.eigenvectors.column(i).into_owned()))
            .collect()
    }
}

fn name_motion(v: &Vector6<f64>) -> String {
    let (t, w) = (v.fixed_rows::<3>(0).into_owned(), v.fixed_rows::<3>(3).into_owned());
    if w.norm() > 0.3 {
        format!("rotation about {}", name_direction(&w))
    } else {
        format!("translation along {}", name_direction(&t))
    }
}

fn name_direction(v: &Vector3<f64>) -> String {
    let unit = v.normalize();
    for (k, name) in ["x", "y", "z"].iter().enumerate() {
        if unit[k].abs() > 0.999 {
            return (*name).to_string();
        }
    }
    format!("({:.2}, {:.2}, {:.2})", unit.x, unit.y, unit.z)
}

/// Nodes of every connected body, in the order of their first nodes; sections connect or do not.
fn bodies(kinematics: &Kinematics, contributions: &[Box<dyn Contribution>], by_sections: bool) -> Vec<Vec<u32>> {
    let mut parent: Vec<u32> = (0..kinematics.node_count() as u32).collect();
    for c in contributions {
        for e in 0..c.element_count() {
            unite(&mut parent, c.element_nodes(e));
        }
    }
    for point in kinematics.points().iter().filter(|_| by_sections) {
        unite(&mut parent, &point.nodes);
    }
    for image in kinematics.screw().into_iter().flat_map(|screw| &screw.images) {
        unite(&mut parent, &[image.master, image.node]);
    }
    let mut index = vec![usize::MAX; parent.len()];
    let mut bodies: Vec<Vec<u32>> = Vec::new();
    for node in 0..parent.len() as u32 {
        let root = find(&mut parent, node) as usize;
        if index[root] == usize::MAX {
            index[root] = bodies.len();
            bodies.push(Vec::new());
        }
        bodies[index[root]].push(node);
    }
    bodies
}

fn unite(parent: &mut [u32], nodes: &[u32]) {
    let Some((&first, rest)) = nodes.split_first() else { return };
    for &node in rest {
        let (a, b) = (find(parent, first), find(parent, node));
        parent[a.max(b) as usize] = a.min(b);
    }
}

fn find(parent: &mut [u32], node: u32) -> u32 {
    let mut at = node;
    while parent[at as usize] != at {
        parent[at as usize] = parent[parent[at as usize] as usize];
        at = parent[at as usize];
    }
    at
}
