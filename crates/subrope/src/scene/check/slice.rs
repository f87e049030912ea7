//! What a helical slice cannot do: everything that does not look the same from every layer of every strand.

use super::{Checker, top};
use crate::document::Location;
use crate::scene::step::{Prescribe, Step};
use crate::scene::{Component, Prescription, Ramp, Rope};

/// What to try instead.
const WHOLE: &str = "leave out `symmetry` in [rope]: the whole rope can do that";

impl Checker<'_> {
    pub(super) fn slice(&mut self) {
        let scene = self.scene;
        let Some(rope) = scene.rope.as_ref().filter(|rope| rope.is_slice()) else { return };
        self.slice_rope(rope);
        self.slice_ends();
        for index in 0..scene.constraint.len() {
            let cause = "nodes held in a helical slice would be held in every layer of every strand";
            self.inconsistent(&top("constraint").at(index), cause, WHOLE);
        }
        for index in 0..scene.rigid.len() {
            let cause = "a rigid body beside a rope breaks the symmetry of a helical slice";
            self.inconsistent(&top("rigid").at(index), cause, WHOLE);
        }
        for (index, contact) in scene.contact.iter().enumerate() {
            let at = top("contact").at(index);
            if contact.primary.is_some() || contact.secondary.is_some() {
                let cause = "in a helical slice a strand touches the image of itself: there are no surfaces to name";
                self.inconsistent(&at, cause, "leave out `primary` and `secondary`");
            } else if index > 0 {
                let cause = "a helical slice has one contact: all pairs of neighbouring strands are images of it";
                self.inconsistent(&at, cause, "keep one [[contact]]");
            }
        }
        if scene.solver.stabilisation.is_some() {
            let at = top("solver").at("stabilisation");
            let cause = "dashpots on the nodes of a helical slice would brake its free motion along and about z";
            self.inconsistent(&at, cause, "leave it out; shorter increments help where a slice does not converge");
        }
        for (index, step) in scene.step.iter().enumerate() {
            self.slice_step(&top("step").at(index), step);
        }
    }

    fn slice_rope(&mut self, rope: &Rope) {
        if rope.core.is_some() {
            let cause = "a helical slice has no core: it is one layer of one of equal strands";
            self.inconsistent(&top("rope").at("core"), cause, "leave out `core`, or `symmetry`");
        }
        if rope.lay_angle == Some(0.0) {
            let cause = "strands without lay have no screw: a layer is the image of another without a turn";
            self.inconsistent(&top("rope").at("lay_angle"), cause, "a lay angle above 0, or leave out `symmetry`");
        }
    }

    fn slice_ends(&mut self) {
        let scene = self.scene;
        for (index, end) in scene.end.iter().enumerate() {
            let at = top("end").at(index);
            let key = if end.set.is_some() { "set" } else { "name" };
            if !["END_A", "END_B"].iter().any(|set| set.eq_ignore_ascii_case(end.set())) {
                let cause = format!("the end \"{}\" is not one of the whole rope, as a helical slice needs", end.name);
                self.inconsistent(&at.at(key), cause, "END_A stays, END_B moves; leave out the others");
            }
            if end.point.is_some_and(|point| point[0] != 0.0 || point[1] != 0.0) {
                let cause = "the reference point of a helical slice lies on the axis of the rope, z";
                self.inconsistent(&at.at("point"), cause, "leave it out");
            }
        }
        if scene.slice_end().is_none() {
            let cause = "a helical slice is moved by the end END_B, which the scene has not";
            self.inconsistent(&top("rope").at("symmetry"), cause, "add [[end]] with name = \"END_B\"");
        }
    }

    fn slice_step(&mut self, at: &Location, step: &Step) {
        if step.bend.is_some() {
            self.inconsistent(&at.at("bend"), "a helical slice is straight: bending breaks its symmetry", WHOLE);
        }
        let points =
            [("tension", step.tension.as_ref().map(|t| &t.point)), ("cycles", step.cycles.as_ref().map(|c| &c.point))];
        for (key, point) in points {
            if let Some(point) = point {
                self.slice_point(&at.at(key), point);
            }
        }
        for (index, entry) in step.prescribe.iter().enumerate() {
            self.slice_motion(&at.at("prescribe").at(index), entry);
        }
        for (index, force) in step.force.iter().enumerate() {
            let at = at.at("force").at(index);
            self.slice_point(&at, &force.point);
            for (component, ramp) in Component::ALL.into_iter().zip(force.components()) {
                if ramp.is_some() && component != Component::Uz {
                    let key = component.force_key();
                    let cause = format!("`{key}` breaks the symmetry of a helical slice, which takes `fz`");
                    self.inconsistent(&at.at(key), cause, WHOLE);
                }
            }
        }
        let cause = "a force on some nodes breaks the symmetry of a helical slice";
        (0..step.nodal_force.len()).for_each(|i| self.inconsistent(&at.at("nodal_force").at(i), cause, WHOLE));
        let cause = "a traction on a surface breaks the symmetry of a helical slice";
        (0..step.traction.len()).for_each(|i| self.inconsistent(&at.at("traction").at(i), cause, WHOLE));
    }

    /// Only END_B moves.
    fn slice_point(&mut self, at: &Location, name: &str) {
        if let Some(end) = self.scene.slice_end().filter(|end| end.name != name) {
            let cause = format!("a helical slice is moved by \"{}\", not by \"{name}\"", end.name);
            let help = format!("point = \"{}\"; what counts is the motion of one end against the other", end.name);
            self.inconsistent(at, cause, &help);
        }
    }

    /// END_B moves along and turns about z; everything else stays.
    fn slice_motion(&mut self, at: &Location, entry: &Prescribe) {
        let Some(end) = self.scene.slice_end() else { return };
        let moves = entry.point.as_ref() == Some(&end.name);
        for (component, prescription) in Component::ALL.into_iter().zip(entry.components()) {
            let screws = moves && matches!(component, Component::Uz | Component::Rz);
            if prescription.is_some_and(|p| !screws && !is_still(p)) {
                let key = component.key();
                let cause = format!("`{key}` breaks the symmetry of a helical slice");
                let help = format!("`uz` and `rz` of \"{}\" move a slice; or {WHOLE}", end.name);
                self.inconsistent(&at.at(key), cause, &help);
            }
        }
    }
}

/// Whether nothing moves.
fn is_still(prescription: &Prescription) -> bool {
    matches!(prescription, Prescription::Ramp(ramp) if Ramp::knots(ramp).iter().all(|[_, value]| *value == 0.0))
}
