//! Shorthands of a step in general form.

use super::prescription::{Arc, ArcTable, Component, Prescription, Ramp};
use super::step::{Bend, BendAxis, BendEnds, PointForce, Prescribe, Step, Tension};

/// The same step without shorthands. `length` is the length of the strand \[mm\], used where a shorthand gives none.
///
/// `bend` with the angle `theta` becomes
/// - on the first end: rotation `+theta` about the axis (its displacements stay as they are, held from the start);
/// - on the second end: rotation `-theta` about the axis, and u_z "free" (`ends = "free"`) or
///   `u_z = L (sin(theta)/theta - 1)` (`ends = "circle"`).
///
/// `tension` becomes, on its point, `u_z = elongation L`, or u_z "free" and a dead force f_z; and the rotation r_z, if
/// a twist is given.
#[must_use]
pub fn expand(step: &Step, length: Option<f64>) -> Step {
    let mut general = Step { bend: None, tension: None, ..step.clone() };
    if let Some(bend) = &step.bend {
        general.prescribe.extend(expand_bend(bend, length));
    }
    if let Some(tension) = &step.tension {
        let (motion, force) = expand_tension(tension, length);
        general.prescribe.push(motion);
        general.force.extend(force);
    }
    general
}

fn expand_bend(bend: &Bend, length: Option<f64>) -> [Prescribe; 2] {
    let axis = match bend.axis {
        BendAxis::X => Component::Rx,
        BendAxis::Y => Component::Ry,
    };
    let mut first = Prescribe { point: Some(bend.first.clone()), ..Prescribe::default() };
    *first.component_mut(axis) = Some(Prescription::Ramp(bend.angle.clone()));
    let mut second = Prescribe { point: Some(bend.second.clone()), ..Prescribe::default() };
    *second.component_mut(axis) = Some(Prescription::Ramp(bend.angle.scaled(-1.0)));
    second.uz = Some(match bend.ends {
        BendEnds::Free => Prescription::free(),
        BendEnds::Circle => {
            let length = bend.length.or(length).unwrap_or_default();
            Prescription::Arc(ArcTable { arc: Arc { length, angle: bend.angle.clone() } })
        }
    });
    [first, second]
}

fn expand_tension(tension: &Tension, length: Option<f64>) -> (Prescribe, Option<PointForce>) {
    let length = tension.length.or(length).unwrap_or_default();
    let elongation = tension.elongation.as_ref().map(|e| Prescription::Ramp(e.scaled(length)));
    let force = tension.force.as_ref().map(|force| PointForce {
        point: tension.point.clone(),
        fz: Some(force.clone()),
        ..PointForce::default()
    });
    let motion = Prescribe {
        point: Some(tension.point.clone()),
        uz: elongation.or_else(|| tension.force.as_ref().map(|_: &Ramp| Prescription::free())),
        rz: tension.twist.clone(),
        ..Prescribe::default()
    };
    (motion, force)
}
