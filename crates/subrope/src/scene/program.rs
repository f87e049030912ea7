//! A scene's steps resolved: the motion of every component and the history of every load.

use std::collections::BTreeMap;

use super::Scene;
use super::cycles::{HalfCycle, parts};
use super::expand::expand;
use super::prescription::{Component, Prescription, Ramp};
use super::step::{Distribution, Incrementation, Step};

/// All steps of a scene in full. Lengths in mm, forces in N, moments in N mm, tractions in MPa, times in s, rotations
/// in **radians**.
#[derive(Clone, Debug, PartialEq)]
pub struct Program {
    /// The steps in order.
    pub steps: Vec<ProgramStep>,
}

/// One step in full.
#[derive(Clone, Debug, PartialEq)]
pub struct ProgramStep {
    /// Which step of the scene it comes from.
    pub source: usize,
    /// The half cycle that it is.
    pub half_cycle: Option<HalfCycle>,
    /// Name.
    pub name: String,
    /// Length of the step \[s\].
    pub duration: f64,
    /// How it is divided.
    pub increments: Incrementation,
    /// All six components of every reference point, and the listed components of every constraint.
    pub motions: Vec<Motion>,
    /// Every load that acts or ever acted.
    pub loads: Vec<Load>,
}

/// What a motion moves.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum MotionTarget {
    /// A reference point, by name.
    Point(String),
    /// A constraint, by name.
    Constraint(String),
}

/// One component of a reference point or of a constraint during a step.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// What moves.
    pub target: MotionTarget,
    /// In which component.
    pub component: Component,
    /// How.
    pub path: MotionPath,
}

/// What a component does during a step.
#[derive(Clone, Debug, PartialEq)]
pub enum MotionPath {
    /// Not prescribed.
    Free,
    /// Prescribed \[mm or rad\].
    Linear(Path),
    /// Prescribed: `length (sin(theta)/theta - 1)` \[mm\] with the path of `theta` \[rad\].
    Arc {
        /// Length of the arc \[mm\].
        length: f64,
        /// Half the angle of the arc \[rad\].
        angle: Path,
    },
}

impl MotionPath {
    /// The value at a fraction of the step, `None` when free; `reached` is the value at the start of the step, used
    /// where the component was free before.
    #[must_use]
    pub fn value(&self, fraction: f64, reached: f64) -> Option<f64> {
        match self {
            Self::Free => None,
            Self::Linear(path) => Some(path.value(fraction, reached)),
            // Where u_z was free before, theta starts from the angle known, and u_z jumps onto the arc over the step.
            Self::Arc { length, angle } => {
                let on_arc = |f: f64| length * approach(angle.value(f, 0.0));
                let offset = if angle.start.is_some() { 0.0 } else { reached - on_arc(0.0) };
                Some(on_arc(fraction) + offset * (1.0 - fraction))
            }
        }
    }
}

/// `sin(theta)/theta - 1` \[-\], by its series for small angles.
fn approach(theta: f64) -> f64 {
    let square = theta * theta;
    if square < 1e-4 {
        -square / 6.0 * (1.0 - square / 20.0 * (1.0 - square / 42.0))
    } else {
        theta.sin() / theta - 1.0
    }
}

/// A piecewise linear history over a step.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// Value at the start of the step; `None`: whatever was reached, since the component was free.
    pub start: Option<f64>,
    /// Pairs (fraction of the step, value), fractions rising in ]0, 1]; constant after the last.
    pub knots: Vec<[f64; 2]>,
}

impl Path {
    /// The value at a fraction of the step, below 0 and above 1 as the line there goes on; `reached` takes the place of an unknown start.
    #[must_use]
    pub fn value(&self, fraction: f64, reached: f64) -> f64 {
        let mut last = [0.0, self.start.unwrap_or(reached)];
        for knot in &self.knots {
            // An equilibrium path may go beyond both ends of the step.
            let beyond = fraction > 1.0 && knot[0] == 1.0;
            if fraction < knot[0] || beyond {
                return last[1] + (fraction - last[0]) / (knot[0] - last[0]) * (knot[1] - last[1]);
            }
            last = *knot;
        }
        last[1]
    }

    /// The value at the end of the step, if it is known.
    #[must_use]
    pub fn end(&self) -> Option<f64> {
        self.knots.last().map(|k| k[1]).or(self.start)
    }

    fn held(value: Option<f64>) -> Self {
        Self { start: value, knots: Vec::new() }
    }
}

/// What a load acts on.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum LoadTarget {
    /// A reference point: force \[N\] or moment \[N mm\].
    Point(String),
    /// A node set: total force \[N\], shared equally.
    NodesTotal(String),
    /// A node set: force on each node \[N\].
    NodesEach(String),
    /// A surface: force per reference area \[MPa\].
    Surface(String),
}

/// One component of a load during a step.
#[derive(Clone, Debug, PartialEq)]
pub struct Load {
    /// What it acts on.
    pub target: LoadTarget,
    /// The component of motion it works on (`Rx` to `Rz`: moments).
    pub component: Component,
    /// History; without a start it begins with what acts.
    pub path: Path,
    /// Whether its values are fractions of the largest force so far.
    pub of_peak: bool,
}

/// How a component stands between two steps.
#[derive(Clone, Debug, Default)]
struct Standing {
    free: bool,
    /// Value \[mm or rad\], unless it was free or an arc with an unknown start.
    value: Option<f64>,
    /// Angle reached on an arc \[rad\].
    arc: Option<f64>,
}

impl Program {
    /// Resolves all steps of a checked scene.
    #[must_use]
    pub fn new(scene: &Scene) -> Self {
        Self::with_cycles(scene, usize::MAX)
    }

    /// The same with one cycle of each step that has any.
    #[must_use]
    pub fn outline(scene: &Scene) -> Self {
        Self::with_cycles(scene, 1)
    }

    fn with_cycles(scene: &Scene, most: usize) -> Self {
        let length = scene.length();
        let mut standing = initial_standing(scene);
        let mut loads = BTreeMap::new();
        let mut steps: Vec<ProgramStep> = Vec::with_capacity(scene.step.len());
        let parts =
            scene.step.iter().enumerate().flat_map(|(i, s)| parts(s, most).into_iter().map(move |part| (i, part)));
        for (source, part) in parts {
            let step = expand(&part.step, length);
            let mut motions = standing_motions(&standing);
            if steps.is_empty() {
                first_constraints(scene, &mut motions);
            }
            prescribe(&step, &mut motions, &standing);
            settle(&motions, &mut standing);
            steps.push(ProgramStep {
                source,
                half_cycle: part.half,
                name: step.name.clone(),
                duration: step.duration,
                increments: step.increments.resolve(),
                loads: load_step(&step, part.of_peak, &mut loads),
                motions: motions
                    .into_iter()
                    .map(|((target, component), path)| Motion { target, component, path })
                    .collect(),
            });
        }
        Self { steps }
    }
}

type Key = (MotionTarget, Component);
type Motions = BTreeMap<Key, MotionPath>;

fn initial_standing(scene: &Scene) -> BTreeMap<Key, Standing> {
    let held = || Standing { free: false, value: Some(0.0), arc: Some(0.0) };
    let points = scene
        .point_names()
        .flat_map(|name| Component::ALL.into_iter().map(|c| (MotionTarget::Point(name.to_owned()), c)));
    let constraints = scene.constraint.iter().flat_map(|constraint| {
        let listed = Component::ALL.into_iter().zip(constraint.components.values()).filter(|(_, v)| v.is_some());
        listed.map(|(c, _)| (MotionTarget::Constraint(constraint.name.clone()), c))
    });
    points.chain(constraints).map(|key| (key, held())).collect()
}

/// Everything stays as it is.
fn standing_motions(standing: &BTreeMap<Key, Standing>) -> Motions {
    let path = |s: &Standing| if s.free { MotionPath::Free } else { MotionPath::Linear(Path::held(s.value)) };
    standing.iter().map(|(key, s)| (key.clone(), path(s))).collect()
}

/// Values of constraints are reached in the first step.
fn first_constraints(scene: &Scene, motions: &mut Motions) {
    for constraint in &scene.constraint {
        for (component, value) in Component::ALL.into_iter().zip(constraint.components.values()) {
            if let Some(value) = value {
                let path = Path { start: Some(0.0), knots: vec![[1.0, value]] };
                motions
                    .insert((MotionTarget::Constraint(constraint.name.clone()), component), MotionPath::Linear(path));
            }
        }
    }
}

fn prescribe(step: &Step, motions: &mut Motions, standing: &BTreeMap<Key, Standing>) {
    for entry in &step.prescribe {
        let target = match (&entry.point, &entry.constraint) {
            (Some(point), _) => MotionTarget::Point(point.clone()),
            (None, Some(constraint)) => MotionTarget::Constraint(constraint.clone()),
            (None, None) => continue,
        };
        for (component, prescription) in Component::ALL.into_iter().zip(entry.components()) {
            let key = (target.clone(), component);
            if let (Some(prescription), Some(before)) = (prescription, standing.get(&key)) {
                motions.insert(key, motion_path(prescription, component, before));
            }
        }
    }
}

fn motion_path(prescription: &Prescription, component: Component, before: &Standing) -> MotionPath {
    let unit = if component.is_rotation() { 1_f64.to_radians() } else { 1.0 };
    match prescription {
        Prescription::Free(_) => MotionPath::Free,
        Prescription::Ramp(ramp) => MotionPath::Linear(path(ramp, unit, before.value)),
        Prescription::Arc(table) => {
            let angle = path(&table.arc.angle, 1_f64.to_radians(), before.arc);
            MotionPath::Arc { length: table.arc.length, angle }
        }
    }
}

fn path(ramp: &Ramp, unit: f64, start: Option<f64>) -> Path {
    Path { start, knots: ramp.knots().into_iter().map(|[f, v]| [f, unit * v]).collect() }
}

/// Notes where every component stands at the end of the step.
fn settle(motions: &Motions, standing: &mut BTreeMap<Key, Standing>) {
    for (key, path) in motions {
        let now = match path {
            MotionPath::Free => Standing { free: true, value: None, arc: None },
            MotionPath::Linear(path) => {
                Standing { free: false, value: path.end(), arc: held_arc(path, standing.get(key)) }
            }
            MotionPath::Arc { length, angle } => {
                let arc = angle.end();
                Standing { free: false, value: arc.map(|a| length * approach(a)), arc }
            }
        };
        standing.insert(key.clone(), now);
    }
}

/// A component that is only held keeps its place on the arc; one at 0 is on it.
fn held_arc(path: &Path, before: Option<&Standing>) -> Option<f64> {
    match path.end() {
        Some(0.0) => Some(0.0),
        _ if path.knots.is_empty() => before.and_then(|s| s.arc),
        _ => None,
    }
}

type LoadKey = (LoadTarget, Component);

/// The loads of a step: those it gives, and those that stay.
fn load_step(step: &Step, of_peak: Option<(String, Ramp)>, standing: &mut BTreeMap<LoadKey, Option<f64>>) -> Vec<Load> {
    let mut paths: BTreeMap<LoadKey, Path> =
        standing.iter().map(|(key, value)| (key.clone(), Path::held(*value))).collect();
    for (key, ramp) in given_loads(step) {
        let start = standing.get(&key).copied().unwrap_or(Some(0.0));
        paths.insert(key, path(ramp, 1.0, start));
    }
    for (key, path) in &paths {
        standing.insert(key.clone(), path.end());
    }
    let peak_key = of_peak.map(|(point, ramp)| {
        let key = (LoadTarget::Point(point), Component::Uz);
        // In newtons it is known when it has been reached.
        standing.insert(key.clone(), None);
        paths.insert(key.clone(), path(&ramp, 1.0, None));
        key
    });
    let whole = |((target, component), path)| {
        let key = (target, component);
        let of_peak = peak_key.as_ref() == Some(&key);
        Load { target: key.0, component, path, of_peak }
    };
    paths.into_iter().map(whole).collect()
}

/// All loads that a step gives, with what they act on.
pub(super) fn given_loads(step: &Step) -> Vec<(LoadKey, &Ramp)> {
    let mut given = Vec::new();
    for force in &step.force {
        collect(&mut given, &LoadTarget::Point(force.point.clone()), &force.components());
    }
    for force in &step.nodal_force {
        let target = match force.distribution {
            Distribution::Total => LoadTarget::NodesTotal(force.set.clone()),
            Distribution::PerNode => LoadTarget::NodesEach(force.set.clone()),
        };
        collect(&mut given, &target, &force.components());
    }
    for traction in &step.traction {
        collect(&mut given, &LoadTarget::Surface(traction.surface.clone()), &traction.components());
    }
    given
}

fn collect<'a>(given: &mut Vec<(LoadKey, &'a Ramp)>, target: &LoadTarget, components: &[Option<&'a Ramp>]) {
    for (component, ramp) in Component::ALL.into_iter().zip(components) {
        if let Some(ramp) = ramp {
            given.push(((target.clone(), component), ramp));
        }
    }
}
