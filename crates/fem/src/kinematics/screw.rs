//! Nodes that are images of others under a screw about the z axis.
//!
//! A rope in tension and torsion looks the same after every advance along its axis with the turn that belongs to it. One
//! layer of nodes then stands for all others: node i is the image of a free node m, its master, with
//! `theta_i = turn_i + k_i (phi + c twist)`,
//! `x_i = R_z(theta_i) x_m + k_i (h + c extension) e_z`.
//! `turn_i` leads to another strand, `k_i` to another layer; `phi` and `h` are turn and height of a layer at rest, and with
//! `c = h/L` the coordinates `extension` \[mm\] and `twist` \[rad\] are those of a rope of length L. Derivatives, with
//! `y = R_z x_m`: `dx/du_m = R_z`, `dx/dtwist = k c e_z x y`, `dx/dextension = k c e_z`,
//! `d2x/dtwist2 = -(k c)^2 (y - e_z e_z.y)`, `d2x/du_m dtwist = k c [e_z] R_z`.
//! Source: Frikha, Cartraud, Treyssede, Int. J. Solids Struct. 50 (2013) 1373, here for any motion.

use nalgebra::{Matrix3, Vector3};

use super::{Kinematics, NodeRule, ReferencePoint, Tie};
use crate::FemError;

/// A screw about the z axis and the nodes that follow others by it.
#[derive(Clone, Debug, PartialEq)]
pub struct Screw {
    /// Name of its reference point: displacement z is the extension, rotation z the twist; its other four coordinates move
    /// nothing and are to be prescribed.
    pub name: String,
    /// Turn `phi` of a layer at rest \[rad\].
    pub angle: f64,
    /// Height `h` of a layer at rest \[mm\].
    pub height: f64,
    /// Part `c` of extension and twist that falls on a layer \[-\].
    pub share: f64,
    /// The nodes.
    pub images: Vec<Image>,
}

/// A node that follows another one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Image {
    /// The node.
    pub node: u32,
    /// The free node that it is the image of.
    pub master: u32,
    /// Turn about the axis beside that of its layer \[rad\].
    pub turn: f64,
    /// Layers above the master.
    pub layer: i32,
}

impl Screw {
    /// Where the image of a point at rest lies \[mm\].
    #[must_use]
    pub fn place(&self, master: &Vector3<f64>, turn: f64, layer: i32) -> Vector3<f64> {
        let k = f64::from(layer);
        about_z(turn + k * self.angle) * master + Vector3::new(0.0, 0.0, k * self.height)
    }
}

/// Rotation about z.
fn about_z(angle: f64) -> Matrix3<f64> {
    let (s, c) = angle.sin_cos();
    Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0)
}

/// A screw in the numbering of a model.
#[derive(Clone, Debug)]
pub(super) struct PlacedScrew {
    pub(super) screw: Screw,
    /// Index of its reference point.
    pub(super) point: usize,
    /// Of every image the first coordinate of its master.
    masters: Vec<u32>,
    /// Of every image its turn at rest.
    rest: Vec<Matrix3<f64>>,
}

/// Part of the distance from the origin by which an image may miss its place.
const MISS: f64 = 1e-9;

impl PlacedScrew {
    /// Finds the masters.
    pub(super) fn new(
        screw: Screw,
        point: usize,
        positions: &[Vector3<f64>],
        rules: &[NodeRule],
    ) -> Result<Self, FemError> {
        let (mut masters, mut rest) = (Vec::with_capacity(screw.images.len()), Vec::with_capacity(screw.images.len()));
        for image in &screw.images {
            let (node, master) = (image.node as usize, image.master as usize);
            let Some(NodeRule::Free { first }) = rules.get(master) else {
                return Err(FemError::ImageOfTied { node, master });
            };
            let place = screw.place(&positions[master], image.turn, image.layer);
            let distance = (place - positions[node]).norm();
            if distance > MISS * place.norm().max(screw.height) {
                return Err(FemError::NotAnImage { node, master, distance });
            }
            masters.push(*first);
            rest.push(about_z(image.turn + f64::from(image.layer) * screw.angle));
        }
        Ok(Self { screw, point, masters, rest })
    }
}

/// What the coordinates say of a screw.
struct Turned<'a> {
    placed: &'a PlacedScrew,
    /// First coordinate of its reference point.
    first: u32,
    twist: f64,
    extension: f64,
}

/// One image at some coordinates.
struct At {
    /// Whole turn.
    rotation: Matrix3<f64>,
    /// Current position of the master, turned \[mm\].
    arm: Vector3<f64>,
    /// Derivative of the turn by the twist, and of the height by the extension.
    rate: f64,
}

impl<'a> Turned<'a> {
    fn new(placed: &'a PlacedScrew, points: &[ReferencePoint], q: &[f64]) -> Self {
        let first = points[placed.point].first;
        Self { placed, first, extension: q[first as usize + 2], twist: q[first as usize + 5] }
    }

    fn rate(&self, index: usize) -> f64 {
        f64::from(self.placed.screw.images[index].layer) * self.placed.screw.share
    }

    fn displacement_of_master(&self, index: usize, q: &[f64]) -> Vector3<f64> {
        let first = self.placed.masters[index] as usize;
        Vector3::from_column_slice(&q[first..first + 3])
    }

    fn at(&self, index: usize, positions: &[Vector3<f64>], q: &[f64]) -> At {
        let master = self.placed.screw.images[index].master as usize;
        let rate = self.rate(index);
        let rotation = self.placed.rest[index] * about_z(rate * self.twist);
        At { rotation, arm: rotation * (positions[master] + self.displacement_of_master(index, q)), rate }
    }

    /// `R_0 ((R - 1) X + R u) + k c extension e_z`: no digits of small displacements are lost.
    fn displacement(&self, index: usize, positions: &[Vector3<f64>], q: &[f64]) -> Vector3<f64> {
        let (rate, x) = (self.rate(index), &positions[self.placed.screw.images[index].master as usize]);
        let angle = rate * self.twist;
        let (sine, half) = (angle.sin(), (0.5 * angle).sin());
        let versine = 2.0 * half * half;
        let turned = Vector3::new(-versine * x.x - sine * x.y, sine * x.x - versine * x.y, 0.0);
        let own = turned + about_z(angle) * self.displacement_of_master(index, q);
        self.placed.rest[index] * own + Vector3::new(0.0, 0.0, rate * self.extension)
    }

    /// Coordinates of extension and twist with the columns that belong to them.
    fn columns(&self, at: &At) -> [(u32, Vector3<f64>); 2] {
        let along = Vector3::new(0.0, 0.0, at.rate);
        [(self.first + 2, along), (self.first + 5, along.cross(&at.arm))]
    }
}

impl Kinematics {
    /// The screw, if nodes follow one.
    #[must_use]
    pub fn screw(&self) -> Option<&Screw> {
        self.screw.as_ref().map(|placed| &placed.screw)
    }

    /// The present turn of an image against its master \[rad\]; [`None`] for other nodes.
    #[must_use]
    pub fn turn_of_image(&self, node: usize, q: &[f64]) -> Option<f64> {
        let (Some(placed), NodeRule::Image { image, .. }) = (&self.screw, &self.rules[node]) else { return None };
        let turned = Turned::new(placed, &self.points, q);
        let (index, screw) = (*image as usize, &placed.screw);
        let Image { turn, layer, .. } = screw.images[index];
        Some(turn + f64::from(layer) * screw.angle + turned.rate(index) * turned.twist)
    }

    /// The coordinates that move an image.
    pub(super) fn image_coordinates(&self, image: u32) -> Vec<u32> {
        let Some(placed) = &self.screw else { return Vec::new() };
        let (own, point) = (placed.masters[image as usize], self.points[placed.point].first);
        vec![own, own + 1, own + 2, point + 2, point + 5]
    }

    pub(super) fn displace_images(&self, q: &[f64], out: &mut [f64]) {
        let Some(placed) = &self.screw else { return };
        let turned = Turned::new(placed, &self.points, q);
        for (index, image) in placed.screw.images.iter().enumerate() {
            let u = turned.displacement(index, &self.positions, q);
            out[3 * image.node as usize..3 * image.node as usize + 3].copy_from_slice(u.as_slice());
        }
    }

    pub(super) fn tie_images(&self, q: &[f64], out: &mut [Tie]) {
        let Some(placed) = &self.screw else { return };
        let turned = Turned::new(placed, &self.points, q);
        for (index, image) in placed.screw.images.iter().enumerate() {
            if let NodeRule::Image { tie, .. } = &self.rules[image.node as usize] {
                let at = turned.at(index, &self.positions, q);
                out[*tie as usize] = Tie::of_image(placed.masters[index], &at.rotation, turned.columns(&at));
            }
        }
    }

    /// Second derivatives of the images, on their masters and the twist.
    pub(super) fn curve_images(&self, q: &[f64], nodal: &[f64], visit: &mut dyn FnMut(&[u32], &[f64])) {
        let Some(placed) = &self.screw else { return };
        let turned = Turned::new(placed, &self.points, q);
        let twist = turned.first + 5;
        for (index, image) in placed.screw.images.iter().enumerate() {
            let force = force(nodal, image.node);
            if force == Vector3::zeros() {
                continue;
            }
            let at = turned.at(index, &self.positions, q);
            let coupling = at.rotation.transpose() * force.cross(&Vector3::new(0.0, 0.0, at.rate));
            let mut block = super::slide_block(&coupling);
            block[15] = -at.rate * at.rate * at.arm.xy().dot(&force.xy());
            let own = placed.masters[index];
            visit(&[own, own + 1, own + 2, twist], &block);
        }
    }

    /// Force along and moment about z that belong to extension and twist.
    pub(super) fn screw_resultant(
        &self,
        placed: &PlacedScrew,
        q: &[f64],
        nodal: &[f64],
    ) -> (Vector3<f64>, Vector3<f64>) {
        let turned = Turned::new(placed, &self.points, q);
        let (mut along, mut about) = (0.0, 0.0);
        for (index, image) in placed.screw.images.iter().enumerate() {
            let force = force(nodal, image.node);
            let [(_, extension), (_, twist)] = turned.columns(&turned.at(index, &self.positions, q));
            along += extension.dot(&force);
            about += twist.dot(&force);
        }
        (Vector3::new(0.0, 0.0, along), Vector3::new(0.0, 0.0, about))
    }
}

fn force(nodal: &[f64], node: u32) -> Vector3<f64> {
    Vector3::from_column_slice(&nodal[3 * node as usize..3 * node as usize + 3])
}
