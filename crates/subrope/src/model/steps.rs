//! The steps of a program as prescribed coordinates and dead loads.

use std::sync::Arc;

use subrope_fem::analysis::{Increments, LoadBefore, PathControl, Prescription, Step, StepLoad};
use subrope_fem::kinematics::{Kinematics, NodeRule};

use super::{MeshModel, ModelError, loads};
use crate::estimate;
use crate::scene::{self, Incrementation, Motion, MotionPath, MotionTarget, Program, ProgramStep, Scene};

/// Memory of a prescribed coordinate or a load in one step \[bytes\].
const PRESCRIPTION: f64 = 100.0;

/// Steps that the kernel runs.
pub(super) fn steps(
    scene: &Scene,
    program: &Program,
    mesh: &MeshModel,
    kinematics: &Kinematics,
) -> Result<Vec<Step>, ModelError> {
    let (limit, mut bytes) = (estimate::limit(), 0.0);
    let mut steps = Vec::with_capacity(program.steps.len());
    for step in &program.steps {
        let step = one(scene, step, mesh, kinematics)?;
        // Constraints prescribe every node of their sets, in every half cycle.
        bytes += PRESCRIPTION * (step.prescriptions.len() + step.loads.len()) as f64;
        estimate::refuse_beyond(|| format!("{} steps", program.steps.len()), bytes, limit)?;
        steps.push(step);
    }
    Ok(steps)
}

fn one(scene: &Scene, step: &ProgramStep, mesh: &MeshModel, kinematics: &Kinematics) -> Result<Step, ModelError> {
    let mut prescriptions: Vec<Prescription> = Vec::new();
    for motion in &step.motions {
        for coordinate in coordinates(scene, motion, mesh, kinematics)? {
            if let Some(path) = path(&motion.path) {
                prescriptions.push(Prescription { coordinate, path });
            }
        }
    }
    prescriptions.extend(held_motions(mesh, kinematics));
    reject_twice(&step.name, &mut prescriptions, mesh, kinematics)?;
    let mut loads = Vec::new();
    for load in &step.loads {
        let path = load.path.clone();
        loads.push(StepLoad {
            load: loads::unit_load(&step.name, &load.target, load.component, mesh, kinematics)?,
            path: if load.of_peak {
                Arc::new(move |fraction, before: LoadBefore| {
                    let start = if before.peak == 0.0 { 0.0 } else { before.load / before.peak };
                    path.value(fraction, start) * before.peak
                })
            } else {
                Arc::new(move |fraction, before: LoadBefore| path.value(fraction, before.load))
            },
        });
    }
    let increments = match step.increments {
        Incrementation::Fixed { count } => Increments::Fixed(count),
        Incrementation::Automatic { initial, minimum, maximum, max_count, control } => {
            let control = match control {
                scene::PathControl::Load => PathControl::Load,
                scene::PathControl::ArcLength => PathControl::ArcLength,
            };
            Increments::Automatic { initial, minimum, maximum, max_count, control }
        }
    };
    let knots = knots(step);
    if increments.are_arcs()
        && let Some(knot) = knots.first()
    {
        return Err(ModelError::KnotOnArc { step: step.name.clone(), knot: *knot });
    }
    if let Increments::Fixed(count) = increments
        && let Some(knot) = knots.iter().find(|k| ((**k * count as f64).round() - **k * count as f64).abs() > 1e-9)
    {
        return Err(ModelError::MissedKnot { step: step.name.clone(), knot: *knot, count });
    }
    Ok(Step { name: step.name.clone(), duration: step.duration, prescriptions, loads, increments, knots })
}

/// The motions of a slice along and about z, which nothing resists: held at a node on the x axis.
fn held_motions(mesh: &MeshModel, kinematics: &Kinematics) -> Vec<Prescription> {
    let rule = mesh.slice.map(|slice| kinematics.rules()[slice.held as usize]);
    let Some(NodeRule::Free { first }) = rule else { return Vec::new() };
    vec![Prescription::ramp(first + 1, 0.0), Prescription::ramp(first + 2, 0.0)]
}

/// Fractions of the step at which a history has a corner.
fn knots(step: &ProgramStep) -> Vec<f64> {
    let motions = step.motions.iter().filter_map(|m| match &m.path {
        MotionPath::Free => None,
        MotionPath::Linear(path) | MotionPath::Arc { angle: path, .. } => Some(path),
    });
    let paths = motions.chain(step.loads.iter().map(|l| &l.path));
    let mut knots: Vec<f64> = paths.flat_map(|p| p.knots.iter().map(|k| k[0])).filter(|f| *f < 1.0).collect();
    knots.sort_by(f64::total_cmp);
    knots.dedup_by(|a, b| (*a - *b).abs() < 1e-12);
    knots
}

/// The value of a motion over the step; `None` when it is free.
fn path(motion: &MotionPath) -> Option<subrope_fem::analysis::Path> {
    match motion {
        MotionPath::Free => None,
        other => {
            let other = other.clone();
            Some(Arc::new(move |fraction, reached| other.value(fraction, reached).unwrap_or(reached)))
        }
    }
}

/// Index of a reference point.
pub(super) fn point(kinematics: &Kinematics, name: &str) -> Result<usize, ModelError> {
    kinematics.point_index(name).ok_or_else(|| ModelError::UnknownSet {
        kind: "reference point",
        name: name.into(),
        available: kinematics.points().iter().map(|p| p.name.clone()).collect(),
    })
}

fn coordinates(
    scene: &Scene,
    motion: &Motion,
    mesh: &MeshModel,
    kinematics: &Kinematics,
) -> Result<Vec<u32>, ModelError> {
    let component = motion.component.index() as u32;
    match &motion.target {
        // The other end of a slice stays, and has no reference point.
        MotionTarget::Point(name) if mesh.slice.is_some() && kinematics.point_index(name).is_none() => Ok(Vec::new()),
        MotionTarget::Point(name) => Ok(vec![kinematics.points()[point(kinematics, name)?].first + component]),
        MotionTarget::Constraint(name) => {
            let Some(constraint) = scene.constraint.iter().find(|c| &c.name == name) else { return Ok(Vec::new()) };
            mesh.node_set(&constraint.set)?
                .iter()
                .map(|&node| match kinematics.rules()[node as usize] {
                    NodeRule::Free { first } => Ok(first + component),
                    NodeRule::Tied { .. } | NodeRule::Image { .. } => Err(ModelError::ConstrainedSectionNode {
                        constraint: name.clone(),
                        node: mesh.mesh.point_label(node as usize),
                    }),
                })
                .collect()
        }
    }
}

fn reject_twice(
    step: &str,
    prescriptions: &mut [Prescription],
    mesh: &MeshModel,
    kinematics: &Kinematics,
) -> Result<(), ModelError> {
    prescriptions.sort_by_key(|p| p.coordinate);
    let Some(pair) = prescriptions.windows(2).find(|w| w[0].coordinate == w[1].coordinate) else { return Ok(()) };
    let twice = pair[0].coordinate;
    let owner = kinematics
        .rules()
        .iter()
        .position(|r| matches!(r, NodeRule::Free { first } if (*first..*first + 3).contains(&twice)));
    let node = owner.map_or(0, |n| mesh.mesh.point_label(n));
    let component = ["ux", "uy", "uz"][owner.map_or(0, |n| match kinematics.rules()[n] {
        NodeRule::Free { first } => (twice - first) as usize,
        NodeRule::Tied { .. } | NodeRule::Image { .. } => 0,
    })];
    Err(ModelError::PrescribedTwice { step: step.into(), component, node })
}
