//! Checks of what steps move.

use std::collections::BTreeMap;

use super::{Checker, top};
use crate::document::{Location, ProblemKind};
use crate::scene::step::{Bend, BendEnds, CycleControl, Cycles, Prescribe, Step, Tension};
use crate::scene::{BendAxis, Component, EndKind, Prescription, Ramp};

/// Something moved in a step: its name, its component and the place that says so.
struct Moved<'a> {
    name: &'a str,
    component: Component,
    at: Location,
}

impl Checker<'_> {
    pub(super) fn motions(&mut self, at: &Location, step: &Step) {
        let mut moved = Vec::new();
        if let Some(bend) = &step.bend {
            self.bend(&at.at("bend"), bend, &mut moved);
        }
        if let Some(tension) = &step.tension {
            self.tension(&at.at("tension"), tension, &mut moved);
        }
        if let Some(cycles) = &step.cycles {
            self.cycles(&at.at("cycles"), cycles, step.tension.as_ref(), &mut moved);
        }
        for (index, entry) in step.prescribe.iter().enumerate() {
            self.prescribe(&at.at("prescribe").at(index), entry, &mut moved);
        }
        self.moved_twice(&moved);
    }

    fn moved_twice(&mut self, moved: &[Moved<'_>]) {
        let mut first: BTreeMap<(&str, Component), &Moved<'_>> = BTreeMap::new();
        for one in moved {
            let before = *first.entry((one.name, one.component)).or_insert(one);
            if !std::ptr::eq(before, one) {
                let key = one.component.key();
                let cause = format!("`{key}` of \"{}\" is prescribed twice in this step", one.name);
                self.inconsistent(&one.at, cause, &format!("also by {}", before.at));
            }
        }
    }

    /// The name of a reference point.
    pub(super) fn point(&mut self, at: &Location, name: &str) -> bool {
        let scene = self.scene;
        let names = scene.end.iter().map(|e| e.name.as_str()).chain(scene.rigid.iter().map(|r| r.name.as_str()));
        let help = "reference points are the [[end]] and [[rigid]] tables of the scene";
        self.known(at, "reference point", name, names, help)
    }

    fn bend<'a>(&mut self, at: &Location, bend: &'a Bend, moved: &mut Vec<Moved<'a>>) {
        self.ramp(&at.at("angle"), &bend.angle);
        self.angle(&at.at("angle"), &bend.angle, 180.0);
        for (key, name) in [("first", &bend.first), ("second", &bend.second)] {
            if self.point(&at.at(key), name) {
                self.rigid(&at.at(key), name);
            }
        }
        if bend.first == bend.second {
            self.inconsistent(&at.at("second"), "an end cannot be bent against itself", "name two reference points");
        }
        if bend.ends == BendEnds::Circle && bend.length.is_none() && self.scene.length().is_none() {
            self.missing(at, "length", "length of the ideal arc (mm); only a generated strand has one of its own");
        }
        let axis = if bend.axis == BendAxis::X { Component::Rx } else { Component::Ry };
        moved.push(Moved { name: &bend.first, component: axis, at: at.clone() });
        moved.push(Moved { name: &bend.second, component: axis, at: at.clone() });
        moved.push(Moved { name: &bend.second, component: Component::Uz, at: at.clone() });
    }

    fn rigid(&mut self, at: &Location, name: &str) {
        if self.scene.end.iter().any(|e| e.name == name && e.kind == EndKind::Radial) {
            self.inconsistent(at, format!("the end \"{name}\" is \"radial\" and cannot be bent"), "kind = \"rigid\"");
        }
    }

    fn angle(&mut self, at: &Location, angle: &Ramp, limit: f64) {
        for [_, value] in angle.knots().into_iter().filter(|[_, v]| v.abs() > limit) {
            self.out_of_range(at, "angle", value, &format!("between -{limit} and {limit} degrees"));
        }
    }

    fn tension<'a>(&mut self, at: &Location, tension: &'a Tension, moved: &mut Vec<Moved<'a>>) {
        self.point(&at.at("point"), &tension.point);
        let mut pull = || moved.push(Moved { name: &tension.point, component: Component::Uz, at: at.clone() });
        match (&tension.elongation, &tension.force) {
            (Some(_), Some(_)) => {
                let help = "give the elongation and find the force in the reactions, or the other way round";
                self.inconsistent(&at.at("force"), "`elongation` and `force` exclude each other", help);
            }
            (None, None) if tension.twist.is_none() => self.missing(at, "elongation", "or `force` (N), or `twist`"),
            (None, None) => {}
            _ => pull(),
        }
        if let Some(elongation) = &tension.elongation {
            self.elongation(at, elongation, tension.length);
        }
        if let Some(force) = &tension.force {
            self.ramp(&at.at("force"), force);
        }
        if let Some(twist) = &tension.twist {
            self.prescription(&at.at("twist"), Component::Rz, twist);
            moved.push(Moved { name: &tension.point, component: Component::Rz, at: at.at("twist") });
        }
    }

    fn cycles<'a>(&mut self, at: &Location, cycles: &'a Cycles, tension: Option<&Tension>, moved: &mut Vec<Moved<'a>>) {
        self.point(&at.at("point"), &cycles.point);
        moved.push(Moved { name: &cycles.point, component: Component::Uz, at: at.clone() });
        if tension.is_some_and(|t| t.point != cycles.point) {
            let help = "twist the end that goes to and fro, or another one in a step of its own";
            self.inconsistent(at, "`tension` and `cycles` of a step act on different points", help);
        }
        if cycles.low >= cycles.high {
            let cause = format!("reversed bounds: `low` = {} is not below `high` = {}", cycles.low, cycles.high);
            self.inconsistent(&at.at("low"), cause, "required: low < high");
        }
        match cycles.of {
            CycleControl::Peak if at == &top("step").at(0).at("cycles") => {
                let help = "pull in a step before, or give `of` = \"force\" or \"elongation\"";
                self.inconsistent(at, "cycles \"of\" the peak tension have no peak in the first step", help);
            }
            CycleControl::Peak | CycleControl::Force => {}
            CycleControl::Elongation => {
                for (key, value) in [("low", cycles.low), ("high", cycles.high)] {
                    if value <= -1.0 {
                        self.out_of_range(&at.at(key), key, value, "greater than -1 (a fraction of the length)");
                    }
                }
                if cycles.length.is_none() && self.scene.length().is_none() {
                    let help = "length that the elongation refers to (mm); only a generated strand or rope has its own";
                    self.missing(at, "length", help);
                }
            }
        }
    }

    fn elongation(&mut self, at: &Location, elongation: &Ramp, length: Option<f64>) {
        let own = at.at("elongation");
        self.ramp(&own, elongation);
        for [_, value] in elongation.knots().into_iter().filter(|[_, v]| *v <= -1.0) {
            self.out_of_range(&own, "elongation", value, "greater than -1 (a fraction of the length)");
        }
        if length.is_none() && self.scene.length().is_none() {
            self.missing(
                at,
                "length",
                "length that the elongation refers to (mm); only a generated strand has its own",
            );
        }
    }

    fn prescription(&mut self, at: &Location, component: Component, prescription: &Prescription) {
        match prescription {
            Prescription::Free(_) => {}
            Prescription::Ramp(ramp) => self.ramp(at, ramp),
            Prescription::Arc(_) if component.is_rotation() => {
                self.inconsistent(at, "an `arc` prescribes a displacement, not a rotation", "");
            }
            Prescription::Arc(table) => {
                let at = at.at("arc").at("angle");
                self.ramp(&at, &table.arc.angle);
                self.angle(&at, &table.arc.angle, 180.0);
            }
        }
    }

    fn prescribe<'a>(&mut self, at: &Location, entry: &'a Prescribe, moved: &mut Vec<Moved<'a>>) {
        if entry.components().iter().all(Option::is_none) {
            let help = "give at least one of ux, uy, uz (mm), rx, ry, rz (degrees)";
            self.inconsistent(at, "nothing is prescribed", help);
        }
        for (component, prescription) in Component::ALL.into_iter().zip(entry.components()) {
            if let Some(prescription) = prescription {
                self.prescription(&at.at(component.key()), component, prescription);
                let name = entry.point.as_ref().or(entry.constraint.as_ref());
                moved.extend(name.map(|name| Moved { name, component, at: at.at(component.key()) }));
            }
        }
        match (&entry.point, &entry.constraint) {
            (Some(point), None) => {
                self.point(&at.at("point"), point);
            }
            (None, Some(constraint)) => self.prescribed_constraint(at, constraint, entry),
            (Some(_), Some(_)) => {
                self.inconsistent(
                    &at.at("constraint"),
                    "`point` and `constraint` exclude each other",
                    "use two tables",
                );
            }
            (None, None) => self.missing(at, "point", "the name of an [[end]], or `constraint`"),
        }
    }

    fn prescribed_constraint(&mut self, at: &Location, name: &str, entry: &Prescribe) {
        let scene = self.scene;
        self.known(&at.at("constraint"), "constraint", name, scene.constraint.iter().map(|c| c.name.as_str()), "");
        let Some(own) = self.scene.constraint.iter().find(|c| c.name == name) else { return };
        let listed: Vec<_> = Component::ALL
            .into_iter()
            .zip(own.components.values())
            .filter(|(_, v)| v.is_some())
            .map(|(c, _)| c)
            .collect();
        for (component, prescription) in Component::ALL.into_iter().zip(entry.components()) {
            let Some(prescription) = prescription else { continue };
            let own = at.at(component.key());
            if !listed.contains(&component) {
                let allowed = listed.iter().map(|c| c.key().to_owned()).collect();
                let kind = ProblemKind::UnknownName {
                    what: "component of the constraint",
                    found: component.key().to_owned(),
                    allowed,
                };
                self.report(&own, kind, "");
            } else if prescription.is_free() {
                self.inconsistent(&own, "a component of a constraint cannot be freed", "give a value or a history");
            }
        }
    }
}
