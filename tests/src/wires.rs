//! The theory of ropes of thin elastic wires, and what a computed rope does in its middle.

use std::f64::consts::PI;

use nalgebra::Vector3;
use subrope_contact::Contact;
use subrope_geometry::{Lay, touching_radius};

use crate::rope::Run;

/// Equal wires on helices about an axis, held apart by each other or by a straight core.
///
/// Every wire is a rod that stretches, bends and twists; its section shrinks by Poisson's ratio and stays round, so that the
/// helix radius follows from the stretch. Force and moment are the derivatives of the energy per length of rope
/// `n ds/dz (EA xi^2 + EI (kappa - kappa_0)^2 + GJ (lambda tau - tau_0)^2)/2`, `lambda = 1 + xi`, with curvature and
/// tortuosity of the axis: twist counts per length at rest, since stretching a rod that cannot turn does not twist it.
/// Costello's theory takes `tau - tau_0` there and leaves out what the pressure between wires does to their length; its moment
/// per elongation is then not its force per twist, as it is of anything elastic.
#[derive(Clone, Copy, Debug)]
pub struct Wires {
    /// Their number.
    pub count: usize,
    /// Radius \[mm\].
    pub radius: f64,
    /// Radius of the core \[mm\].
    pub core: Option<f64>,
    /// Young's modulus \[MPa\].
    pub young: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// Angle about the axis per length of rope \[rad/mm\].
    pub rate: f64,
}

/// A wire of a stretched rope.
#[derive(Clone, Copy, Debug)]
pub struct WireState {
    /// Helix radius \[mm\].
    pub helix_radius: f64,
    /// Its strain.
    pub strain: f64,
    /// Change of curvature \[1/mm\].
    pub bending: f64,
    /// Change of twist per length at rest \[1/mm\].
    pub twisting: f64,
}

impl Wires {
    /// Length of wire per length of rope.
    fn winding(&self) -> f64 {
        (self.rest_radius() * self.rate).hypot(1.0)
    }

    /// Helix radius at rest \[mm\].
    #[must_use]
    pub fn rest_radius(&self) -> f64 {
        self.helix_radius(self.radius, self.rate, self.core.unwrap_or_default())
    }

    fn helix_radius(&self, radius: f64, rate: f64, core: f64) -> f64 {
        match self.core {
            Some(_) => core + radius,
            None => touching_radius(self.count, radius, Lay::from_rate(rate).unwrap()).unwrap(),
        }
    }

    /// A wire of a rope stretched by `elongation` (a fraction) and twisted by `twist` \[rad/mm\].
    #[must_use]
    pub fn state(&self, elongation: f64, twist: f64) -> WireState {
        let (height, rate) = (1.0 + elongation, self.rate + twist);
        let strain = |a: f64| (a * rate).hypot(height) / self.winding() - 1.0;
        let core = self.core.unwrap_or_default() * (1.0 - self.poisson * elongation);
        let mut a = self.rest_radius();
        for _ in 0..40 {
            a = self.helix_radius(self.radius * (1.0 - self.poisson * strain(a)), rate / height, core);
        }
        let ([bent, turned], [rest_bent, rest_turned]) =
            (shape(a, rate / height), shape(self.rest_radius(), self.rate));
        let strain = strain(a);
        WireState {
            helix_radius: a,
            strain,
            bending: bent - rest_bent,
            twisting: (1.0 + strain) * turned - rest_turned,
        }
    }

    /// Stiffness of a wire against stretch \[N\], bending and twist \[N mm^2\].
    #[must_use]
    pub fn stiffness(&self) -> [f64; 3] {
        self.stiffness_of(self.radius)
    }

    fn stiffness_of(&self, radius: f64) -> [f64; 3] {
        let area = PI * radius * radius;
        let bending = self.young * area * radius * radius / 4.0;
        [self.young * area, bending, bending / (1.0 + self.poisson)]
    }

    /// Energy per length of rope \[mJ/mm\].
    fn energy(&self, elongation: f64, twist: f64) -> f64 {
        let [stretch, bend, turn] = self.stiffness();
        let at = self.state(elongation, twist);
        let wire = stretch * at.strain.powi(2) + bend * at.bending.powi(2) + turn * at.twisting.powi(2);
        let core = self.core.map_or(0.0, |radius| {
            let [stretch, _, turn] = self.stiffness_of(radius);
            stretch * elongation.powi(2) + turn * twist * twist
        });
        0.5 * (self.count as f64 * self.winding() * wire + core)
    }

    /// Force \[N\] and moment \[N mm\].
    #[must_use]
    pub fn load(&self, elongation: f64, twist: f64) -> [f64; 2] {
        let (d, t) = (1e-5, 1e-5 * self.rate);
        let force = self.energy(elongation + d, twist) - self.energy(elongation - d, twist);
        let moment = self.energy(elongation, twist + t) - self.energy(elongation, twist - t);
        [force / (2.0 * d), moment / (2.0 * t)]
    }

    /// Shear force of a wire towards the binormal \[N\], which its moments of bending and twist need; the force of the rope is
    /// `n (T cos beta + V sin beta)`, what presses a wire inwards `T kappa - V tau` per length of its axis.
    #[must_use]
    pub fn shear(&self, elongation: f64, twist: f64) -> f64 {
        let [_, bend, turn] = self.stiffness();
        let at = self.state(elongation, twist);
        let [curvature, tortuosity] = shape(at.helix_radius, (self.rate + twist) / (1.0 + elongation));
        turn * at.twisting * curvature - bend * at.bending * tortuosity
    }
}

/// Curvature and tortuosity of a helix \[1/mm\] that turns by `rate` \[rad/mm\] per height.
fn shape(radius: f64, rate: f64) -> [f64; 2] {
    [radius * rate * rate, rate].map(|v| v / (1.0 + (radius * rate).powi(2)))
}

/// The middle of a rope, between two sections: what it does, not what its ends are told to do.
#[derive(Clone, Copy, Debug)]
pub struct Middle {
    /// Layers between the sections, the first and one past the last.
    pub layers: [usize; 2],
    /// Elongation.
    pub elongation: f64,
    /// Twist per length at rest \[rad/mm\].
    pub twist: f64,
    /// Helix radius of the deformed axis of the first strand \[mm\].
    pub helix_radius: f64,
    /// Angle between that axis and the rope \[rad\].
    pub lay_angle: f64,
    /// Length of that deformed axis between the sections \[mm\].
    pub axis_length: f64,
    /// Angle by which the section in the middle has turned about the axis of the rope \[rad\].
    pub turn: f64,
}

impl Middle {
    /// Of a generated rope of `layers` layers of eight-node bricks, `margin` layers away from its ends.
    #[must_use]
    pub fn of(run: &Run, layers: usize, margin: usize) -> Self {
        let mesh = &run.model.mesh.mesh;
        let mut axis: Vec<[Vector3<f64>; 2]> = mesh.node_sets["AXIS_1"]
            .iter()
            .map(|&n| {
                let moved = Vector3::from_column_slice(&run.model.analysis.displacement()[3 * n as usize..][..3]);
                let rest = mesh.points[n as usize];
                [rest, rest + moved]
            })
            .collect();
        axis.sort_by(|a, b| a[0].z.total_cmp(&b[0].z));
        assert_eq!(axis.len(), layers + 1);
        let (first, last) = (axis[margin], axis[layers - margin]);
        let turned = |x: &[Vector3<f64>; 2]| {
            let turn = x[1].y.atan2(x[1].x) - x[0].y.atan2(x[0].x);
            (turn + PI).rem_euclid(2.0 * PI) - PI
        };
        let [rest, now] = [0, 1].map(|k| last[k].z - first[k].z);
        let inner = &axis[margin..=layers - margin];
        let radius = inner.iter().map(|x| x[1].xy().norm()).sum::<f64>() / inner.len() as f64;
        let angle: f64 = inner
            .windows(2)
            .map(|w| {
                let turn = w[1][1].y.atan2(w[1][1].x) - w[0][1].y.atan2(w[0][1].x);
                (turn + PI).rem_euclid(2.0 * PI) - PI
            })
            .sum();
        let tangent = radius * angle / now;
        Self {
            layers: [margin, layers - margin],
            elongation: now / rest - 1.0,
            twist: (turned(&last) - turned(&first)) / rest,
            helix_radius: radius,
            lay_angle: tangent.atan(),
            axis_length: now * tangent.hypot(1.0),
            turn: turned(&axis[layers / 2]),
        }
    }

    /// Force between two strands per length of the axis of one of them, within the middle \[N/mm\]; `around` are the faces
    /// around a strand.
    #[must_use]
    pub fn line_load(&self, contact: &Contact, around: usize) -> f64 {
        let layer = |patch: usize| contact.secondary().face(patch) / around;
        let inside = contact.points().filter(|p| (self.layers[0]..self.layers[1]).contains(&layer(p.patch)));
        inside.map(|p| p.area * p.state.pressure).sum::<f64>() / self.axis_length
    }
}
