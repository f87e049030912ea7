//! One integration point of the secondary surface: history and evaluation.

use nalgebra::{Vector2, Vector3};

use crate::ContactOptions;
use crate::foot::{Foot, Local, Place, Posture};
use crate::law::{self, Friction, Slip};
use crate::patch::PATCH_NODES;

/// Part of the reach below which an open point counts as about to close.
const CLOSING: f64 = 0.01;

/// What a point remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct History {
    /// Its foot.
    pub place: Option<Place>,
    /// Gap \[mm\], initial overlap taken off.
    pub gap: f64,
    /// Pressure \[MPa\].
    pub pressure: f64,
    /// Traction of friction on the secondary body \[MPa\].
    pub traction: Vector3<f64>,
    /// Elastic slip, contravariant.
    pub elastic: Vector2<f64>,
    /// Length of the elastic slip \[mm\]: kept when the surface is stretched, so that a traction at its limit stays there.
    pub elastic_length: f64,
    /// Length slipped so far \[mm\].
    pub slip: f64,
    /// Friction work so far \[mJ/mm^2\], end values.
    pub work: f64,
    /// The same, mid-point values as in the balance of energy.
    pub work_mid: f64,
}

/// An integration point.
#[derive(Clone, Debug)]
pub struct Point {
    /// Shape functions of the secondary patch at the point.
    pub own: [f64; PATCH_NODES],
    /// Reference area \[mm^2\].
    pub area: f64,
    /// Gap at the start where it was negative \[mm\], else zero.
    pub overlap: f64,
    /// Where to start the projection.
    pub hint: Option<Place>,
    /// Multiplier of the trial \[MPa\].
    pub multiplier: f64,
    /// Multiplier of the committed state \[MPa\].
    pub committed_multiplier: f64,
    /// Pressure that the limit of friction is taken from in the potential \[MPa\].
    pub frozen: f64,
    /// Magnitude of the trial traction at the last evaluation \[MPa\].
    pub pulling: f64,
    /// Committed state.
    pub old: History,
    /// Trial state.
    pub new: History,
}

/// What is known of a point at the committed state.
#[derive(Clone, Copy, Debug)]
pub struct PointRecord<'a> {
    /// Patch of the secondary surface.
    pub patch: usize,
    /// Reference area \[mm^2\].
    pub area: f64,
    /// Its state.
    pub state: &'a History,
}

/// Overlap that is still allowed at the end and at the start of the increment \[mm\].
#[derive(Clone, Copy, Debug)]
pub struct Ramp {
    /// At the end.
    pub new: f64,
    /// At the start.
    pub old: f64,
}

impl Ramp {
    /// Linear in time up to `duration`.
    pub fn new(duration: f64, time: f64, increment: f64) -> Self {
        let left = |t: f64| if duration > 0.0 { (1.0 - t / duration).clamp(0.0, 1.0) } else { 0.0 };
        Self { new: left(time), old: left(time - increment) }
    }
}

/// Energies of a point \[mJ/mm^2\].
#[derive(Clone, Copy, Debug, Default)]
pub struct PointEnergies {
    /// Incremental potential.
    pub potential: f64,
    /// Stored in the penalties.
    pub stored: f64,
    /// Dissipated by friction, mid-point value.
    pub friction: f64,
    /// Put in by the interference.
    pub interference: f64,
}

/// A point in contact.
pub struct Touch {
    /// Pressure and its slope by the gap.
    pub pressure: (f64, f64),
    /// Friction, if there is any.
    pub friction: Option<Friction>,
}

impl Point {
    /// Evaluates the point at a foot: sets the trial state, adds its energies, answers what touches.
    pub fn evaluate(
        &mut self,
        foot: &Foot,
        committed: &Posture<'_>,
        options: &ContactOptions,
        ramp: Ramp,
        predicting: bool,
    ) -> (Option<Touch>, PointEnergies) {
        let gap = foot.gap - self.overlap * ramp.new;
        let normal = options.normal();
        let mut pressure = normal.pressure(self.multiplier, gap);
        let (p, _) = pressure;
        self.hint = Some(foot.place);
        self.pulling = 0.0;
        self.new = History { place: Some(foot.place), gap, pressure: p, ..History::default() };
        (self.new.slip, self.new.work, self.new.work_mid) = (self.old.slip, self.old.work, self.old.work_mid);
        let mean = 0.5 * (self.old.pressure + p);
        let mut energies = PointEnergies {
            potential: normal.potential(self.multiplier, gap),
            interference: mean * self.overlap * (ramp.new - ramp.old),
            ..PointEnergies::default()
        };
        if p == 0.0 {
            // A point that is about to close keeps its gap in the linear first step of an increment: surfaces that just
            // touch would run deep into each other before any pressure shows.
            if predicting && gap < CLOSING * options.reach {
                pressure.1 = -options.penalty;
                return (Some(Touch { pressure, friction: None }), energies);
            }
            return (None, energies);
        }
        energies.stored = normal.energy(-gap);
        let friction = (options.friction > 0.0).then(|| self.slide(foot, committed, options, pressure));
        if let Some(f) = &friction {
            energies.stored += f.stored;
            self.pulling = f.magnitude + options.tangential_penalty * f.slipped;
            energies.potential += self.friction_potential(options);
            energies.friction = options.friction * mean * f.slipped;
            self.new.elastic = f.elastic;
            self.new.elastic_length = f.magnitude / options.tangential_penalty;
            self.new.slip += f.slipped;
            self.new.work += f.magnitude * f.slipped;
            self.new.work_mid += energies.friction;
            self.new.traction = -spatial(&foot.local, &f.traction);
        }
        (Some(Touch { pressure, friction }), energies)
    }

    fn slide(&self, foot: &Foot, committed: &Posture<'_>, options: &ContactOptions, pressure: (f64, f64)) -> Friction {
        let patch = foot.place.patch as usize;
        let local = Local::new(foot.local.shape.clone(), &committed.gather(patch));
        let mut slip = Slip { local: &local, way: Vector3::zeros(), elastic: Vector3::zeros(), share: (0.0, 0.0) };
        if let Some(place) = &self.old.place {
            let before = committed.surface.shape(place.patch as usize, place.xi);
            let before = Local::new(before, &committed.gather(place.patch as usize));
            slip.way = local.position - before.position;
            let elastic = before.tangents[0] * self.old.elastic[0] + before.tangents[1] * self.old.elastic[1];
            slip.elastic = elastic.try_normalize(0.0).unwrap_or_default() * self.old.elastic_length;
            slip.share = share(self.old.gap, self.old.pressure, self.new.gap);
        }
        law::friction(&slip, &foot.local.metric(), options.tangential_penalty, options.friction, pressure)
    }

    fn friction_potential(&self, options: &ContactOptions) -> f64 {
        law::friction_potential(self.pulling, options.friction * self.frozen, options.tangential_penalty)
    }

    /// Takes the limit of friction in the potential from the present pressure; answers by how much the potential changes
    /// \[mJ/mm^2\].
    pub fn freeze(&mut self, options: &ContactOptions) -> f64 {
        let before = self.friction_potential(options);
        self.frozen = self.new.pressure;
        self.friction_potential(options) - before
    }

    /// The trial becomes the committed state.
    pub fn commit(&mut self) {
        self.old = self.new;
        self.committed_multiplier = self.multiplier;
    }

    /// The committed state becomes the trial.
    pub fn revert(&mut self) {
        self.new = self.old;
        self.multiplier = self.committed_multiplier;
    }
}

/// Part of an increment's way that was gone in contact, with its derivative by the gap: all of it when the point touched
/// before, else the part after the gap closed.
fn share(old_gap: f64, old_pressure: f64, gap: f64) -> (f64, f64) {
    if old_pressure > 0.0 || old_gap <= 0.0 {
        return (1.0, 0.0);
    }
    if gap >= 0.0 {
        return (0.0, 0.0);
    }
    let closing = old_gap - gap;
    (-gap / closing, -old_gap / (closing * closing))
}

/// Spatial vector of covariant components.
fn spatial(local: &Local, covariant: &Vector2<f64>) -> Vector3<f64> {
    let raised = local.metric().try_inverse().map_or_else(Vector2::zeros, |m| m * covariant);
    local.tangents[0] * raised[0] + local.tangents[1] * raised[1]
}
