//! Nodes as functions of generalised coordinates.
//!
//! A free node owns three coordinates, its displacement. A reference point owns six, its displacement and its rotation
//! vector, and carries the nodes of its section: rigidly, or with one coordinate more per node, its motion along a
//! direction of the section (a radius), or with one coordinate more per part of the section that slides as a whole. The
//! reference point of a [`Screw`] carries images of free nodes. Every tie is the same mechanism: a position `x(q)`, its
//! first derivative (which moves forces and stiffness from nodes to coordinates) and its second (a term of the tangent).

mod map;
mod rotation;
mod screw;
mod sections;

pub use map::{ElementMap, Reduction, Tie};
pub use rotation::Rotation;
pub use screw::{Image, Screw};

use screw::PlacedScrew;
use sections::{check_extent, claim, free_parts, free_radii};

use nalgebra::{Matrix3, Vector3};

use crate::FemError;

/// How the nodes of a section follow their reference point.
#[derive(Clone, Debug, PartialEq)]
pub enum SectionKind {
    /// As a rigid body.
    Rigid,
    /// As a rigid body, but each node slides freely along its own radius.
    Radial,
    /// As a rigid body, but these parts of it slide freely, each as a whole along its own direction. Nodes that belong to
    /// no part do not slide.
    Sliding(Vec<Slide>),
}

/// Nodes of a section that slide together: `x = c + R (X - C + rho d)`, with one coordinate `rho` \[mm\] for all of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Slide {
    /// Direction `d` in the reference configuration, of any length but zero.
    pub direction: Vector3<f64>,
    /// The nodes.
    pub nodes: Vec<u32>,
}

/// A point whose six coordinates (displacement \[mm\], rotation vector \[rad\]) move a section.
#[derive(Clone, Debug)]
pub struct ReferencePoint {
    /// Name, as in the scene.
    pub name: String,
    /// Reference position \[mm\].
    pub position: Vector3<f64>,
    /// Nodes that follow it.
    pub nodes: Vec<u32>,
    /// Index of its first coordinate.
    pub first: u32,
    /// Coordinates of the parts that slide, in the order of [`SectionKind::Sliding`]; none otherwise.
    pub slides: Vec<u32>,
}

/// Which coordinates move a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NodeRule {
    /// Its own displacement, three coordinates from `first`.
    Free {
        /// First of three coordinates.
        first: u32,
    },
    /// Reference point `point`; with `slide`, also one coordinate along a direction that turns with the section.
    Tied {
        /// Index of the reference point.
        point: u32,
        /// Number of the tie among all ties.
        tie: u32,
        /// Coordinate and reference direction of the sliding motion.
        slide: Option<(u32, Vector3<f64>)>,
    },
    /// The image of a free node under the screw of the model.
    Image {
        /// Number of the tie among all ties.
        tie: u32,
        /// Index among the images of the screw.
        image: u32,
    },
}

/// All nodes and reference points of a model, and how the former follow from the coordinates `q`.
#[derive(Clone, Debug)]
pub struct Kinematics {
    positions: Vec<Vector3<f64>>,
    rules: Vec<NodeRule>,
    points: Vec<ReferencePoint>,
    screw: Option<PlacedScrew>,
    coordinates: usize,
}

/// A section to tie, given to [`Kinematics::new`].
#[derive(Clone, Debug)]
pub struct Section {
    /// Name of its reference point.
    pub name: String,
    /// Reference position of the point \[mm\].
    pub position: Vector3<f64>,
    /// Axis of the section (unit): radii are perpendicular to it. Not used by rigid sections.
    pub axis: Vector3<f64>,
    /// Nodes of the section.
    pub nodes: Vec<u32>,
    /// Rigid, free in radius or sliding in parts.
    pub kind: SectionKind,
}

impl ReferencePoint {
    /// Its six coordinates: displacement, then rotation vector.
    #[must_use]
    pub fn coordinates(&self) -> std::ops::Range<u32> {
        self.first..self.first + 6
    }
}

impl Section {
    /// A rigid section.
    #[must_use]
    pub fn rigid(name: &str, position: Vector3<f64>, nodes: &[u32]) -> Self {
        let (axis, kind) = (Vector3::z(), SectionKind::Rigid);
        Self { name: name.into(), position, axis, nodes: nodes.to_vec(), kind }
    }
}

impl Kinematics {
    /// Numbers the coordinates: free nodes in node order, then per section the point and its sliding nodes.
    ///
    /// # Errors
    /// [`FemError::NodeTiedTwice`], [`FemError::UnknownNode`], [`FemError::EmptySection`],
    /// [`FemError::DegenerateSection`]; [`FemError::BadSlide`] for a part without nodes or direction, and for one with a
    /// node that is not of its section or slides already.
    pub fn new(positions: Vec<Vector3<f64>>, sections: Vec<Section>) -> Result<Self, FemError> {
        Self::numbered(positions, sections, None)
    }

    /// As [`Kinematics::new`], with nodes that follow others by a screw; its reference point comes last.
    ///
    /// # Errors
    /// As there; [`FemError::ImageOfTied`] when a master is not free, [`FemError::NotAnImage`] when a node does not lie
    /// where the screw puts it.
    pub fn with_screw(positions: Vec<Vector3<f64>>, sections: Vec<Section>, screw: Screw) -> Result<Self, FemError> {
        Self::numbered(positions, sections, Some(screw))
    }

    fn numbered(positions: Vec<Vector3<f64>>, sections: Vec<Section>, screw: Option<Screw>) -> Result<Self, FemError> {
        let mut owner: Vec<Option<Owner>> = vec![None; positions.len()];
        for (index, section) in sections.iter().enumerate() {
            if section.nodes.is_empty() {
                return Err(FemError::EmptySection { name: section.name.clone() });
            }
            section
                .nodes
                .iter()
                .try_for_each(|&n| claim(&mut owner, Owner::Section(index as u32), n, &section.name))?;
            check_extent(section, &positions)?;
        }
        for (screw, (index, image)) in screw.iter().flat_map(|s| (0..).zip(&s.images).map(move |i| (s, i))) {
            claim(&mut owner, Owner::Screw(index), image.node, &screw.name)?;
        }
        let (mut rules, mut next) = number(&owner);
        let mut points = Vec::with_capacity(sections.len() + 1);
        for section in sections {
            let first = next;
            next += 6;
            let mut slides = Vec::new();
            match &section.kind {
                SectionKind::Rigid => {}
                SectionKind::Radial => free_radii(&section, &positions, &mut rules, &mut next),
                SectionKind::Sliding(parts) => {
                    slides = (next..).take(parts.len()).collect();
                    free_parts(&section.name, points.len() as u32, parts, &slides, &mut rules)?;
                    next += parts.len() as u32;
                }
            }
            let Section { name, position, nodes, .. } = section;
            points.push(ReferencePoint { name, position, nodes, first, slides });
        }
        let screw = screw.map(|s| PlacedScrew::new(s, points.len(), &positions, &rules)).transpose()?;
        if let Some(placed) = &screw {
            let (name, position) = (placed.screw.name.clone(), Vector3::zeros());
            points.push(ReferencePoint { name, position, nodes: Vec::new(), first: next, slides: Vec::new() });
            next += 6;
        }
        Ok(Self { positions, rules, points, screw, coordinates: next as usize })
    }

    /// Number of coordinates.
    #[must_use]
    pub fn coordinate_count(&self) -> usize {
        self.coordinates
    }

    /// Number of nodes.
    #[must_use]
    pub fn node_count(&self) -> usize {
        self.positions.len()
    }

    /// Reference positions of the nodes \[mm\].
    #[must_use]
    pub fn positions(&self) -> &[Vector3<f64>] {
        &self.positions
    }

    /// How each node follows from the coordinates.
    #[must_use]
    pub fn rules(&self) -> &[NodeRule] {
        &self.rules
    }

    /// The reference points.
    #[must_use]
    pub fn points(&self) -> &[ReferencePoint] {
        &self.points
    }

    /// Index of a reference point by name.
    #[must_use]
    pub fn point_index(&self, name: &str) -> Option<usize> {
        self.points.iter().position(|p| p.name == name)
    }

    /// Displacement and rotation vector of a reference point.
    #[must_use]
    pub fn point_motion(&self, point: usize, q: &[f64]) -> (Vector3<f64>, Vector3<f64>) {
        let first = self.points[point].first as usize;
        (Vector3::from_column_slice(&q[first..first + 3]), Vector3::from_column_slice(&q[first + 3..first + 6]))
    }

    /// Whether a coordinate is an angle \[rad\] rather than a length.
    #[must_use]
    pub fn is_rotation(&self, coordinate: usize) -> bool {
        self.points.iter().any(|p| (p.first as usize + 3..p.first as usize + 6).contains(&coordinate))
    }

    /// Displacements of all nodes \[mm\], three per node.
    pub fn displacements(&self, q: &[f64], out: &mut [f64]) {
        for (target, rule) in out.chunks_exact_mut(3).zip(&self.rules) {
            if let NodeRule::Free { first } = rule {
                target.copy_from_slice(&q[*first as usize..*first as usize + 3]);
            }
        }
        for (index, point) in self.points.iter().enumerate() {
            let (shift, turn) = self.point_motion(index, q);
            let rotation = Rotation::new(turn);
            for &node in &point.nodes {
                let node = node as usize;
                let slid = self.slid(node, q);
                let u = shift + rotation.displacement(&(self.positions[node] - point.position + slid)) + slid;
                out[3 * node..3 * node + 3].copy_from_slice(u.as_slice());
            }
        }
        self.displace_images(q, out);
    }

    /// What a tied node has slid along its direction, before the section turns.
    fn slid(&self, node: usize, q: &[f64]) -> Vector3<f64> {
        match &self.rules[node] {
            NodeRule::Tied { slide: Some((rho, direction)), .. } => direction * q[*rho as usize],
            _ => Vector3::zeros(),
        }
    }

    /// Derivatives of all tied nodes at `q`, in the order of their ties; free nodes need none.
    pub fn ties(&self, q: &[f64], out: &mut Vec<Tie>) {
        let images = self.screw().map_or(0, |s| s.images.len());
        out.resize_with(images + self.points.iter().map(|p| p.nodes.len()).sum::<usize>(), Tie::default);
        for (index, point) in self.points.iter().enumerate() {
            let rotation = Rotation::new(self.point_motion(index, q).1);
            for &node in &point.nodes {
                if let NodeRule::Tied { tie, slide, .. } = &self.rules[node as usize] {
                    let arm = self.positions[node as usize] - point.position;
                    let slide = slide.map(|(c, d)| (c, d, q[c as usize]));
                    out[*tie as usize] = Tie::of_section(point.first, &rotation, &arm, slide);
                }
            }
        }
        self.tie_images(q, out);
    }

    /// Generalised forces `J^T f` from nodal forces.
    pub fn reduce(&self, ties: &[Tie], nodal: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        for (rule, f) in self.rules.iter().zip(nodal.chunks_exact(3)) {
            match rule {
                NodeRule::Free { first } => {
                    for (o, v) in out[*first as usize..*first as usize + 3].iter_mut().zip(f) {
                        *o += v;
                    }
                }
                NodeRule::Tied { tie, .. } | NodeRule::Image { tie, .. } => {
                    ties[*tie as usize].reduce(&Vector3::from_column_slice(f), out);
                }
            }
        }
    }

    /// Second-derivative term of the tangent, `sum_i f_i . d2x_i/dq2`, as dense symmetric blocks on lists of coordinates.
    pub fn curvature_blocks(&self, q: &[f64], nodal: &[f64], visit: &mut dyn FnMut(&[u32], &[f64])) {
        for (index, point) in self.points.iter().enumerate() {
            let rotation = Rotation::new(self.point_motion(index, q).1);
            self.curvature_of_point(point, &rotation, q, nodal, visit);
        }
        self.curve_images(q, nodal, visit);
    }

    fn curvature_of_point(
        &self,
        point: &ReferencePoint,
        rotation: &Rotation,
        q: &[f64],
        nodal: &[f64],
        visit: &mut dyn FnMut(&[u32], &[f64]),
    ) {
        let omega = [point.first + 3, point.first + 4, point.first + 5];
        let (mut moment, mut dyad) = (Vector3::zeros(), Matrix3::zeros());
        for &node in &point.nodes {
            let node = node as usize;
            let force = Vector3::from_column_slice(&nodal[3 * node..3 * node + 3]);
            let mut arm = self.positions[node] - point.position;
            if let NodeRule::Tied { slide: Some((rho, direction)), .. } = &self.rules[node] {
                arm += direction * q[*rho as usize];
                let coupling = rotation.tangent().transpose() * rotation.rotate(direction).cross(&force);
                visit(&[omega[0], omega[1], omega[2], *rho], &slide_block(&coupling));
            }
            let lever = rotation.rotate(&arm);
            moment += lever.cross(&force);
            dyad += lever * force.transpose();
        }
        visit(&omega, rotation.second_derivative(&moment, &dyad).as_slice());
    }

    /// Force \[N\] and spatial moment about the current position of the point \[N mm\] of its nodes' forces; of a screw the
    /// tension and the torque.
    #[must_use]
    pub fn section_resultant(&self, point: usize, q: &[f64], nodal: &[f64]) -> (Vector3<f64>, Vector3<f64>) {
        if let Some(placed) = self.screw.as_ref().filter(|placed| placed.point == point) {
            return self.screw_resultant(placed, q, nodal);
        }
        let rotation = Rotation::new(self.point_motion(point, q).1);
        let p = &self.points[point];
        let (mut force, mut moment) = (Vector3::zeros(), Vector3::zeros());
        for &node in &p.nodes {
            let node = node as usize;
            let f = Vector3::from_column_slice(&nodal[3 * node..3 * node + 3]);
            let lever = rotation.rotate(&(self.positions[node] - p.position + self.slid(node, q)));
            force += f;
            moment += lever.cross(&f);
        }
        (force, moment)
    }
}

/// What moves a node that is not free.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Owner {
    /// Index of its section.
    Section(u32),
    /// Index among the images.
    Screw(u32),
}

/// Rules of all nodes, and the number of coordinates that free nodes take.
fn number(owner: &[Option<Owner>]) -> (Vec<NodeRule>, u32) {
    let (mut next, mut ties) = (0_u32, 0_u32);
    let rules = owner.iter().map(|owner| {
        let Some(owner) = owner else {
            next += 3;
            return NodeRule::Free { first: next - 3 };
        };
        ties += 1;
        match owner {
            Owner::Section(point) => NodeRule::Tied { point: *point, tie: ties - 1, slide: None },
            Owner::Screw(image) => NodeRule::Image { tie: ties - 1, image: *image },
        }
    });
    (rules.collect(), next)
}

/// 4x4 block that couples a rotation vector and a sliding coordinate.
fn slide_block(c: &Vector3<f64>) -> [f64; 16] {
    [0.0, 0.0, 0.0, c.x, 0.0, 0.0, 0.0, c.y, 0.0, 0.0, 0.0, c.z, c.x, c.y, c.z, 0.0]
}
