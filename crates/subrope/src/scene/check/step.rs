//! Checks of steps: increments, histories, loads.

use std::collections::BTreeSet;

use super::{Checker, top};
use crate::document::Location;
use crate::scene::program::{Program, given_loads};
use crate::scene::step::{Increments, Step};
use crate::scene::{Component, LoadTarget, MotionPath, MotionTarget, PathControl, ProgramStep, Ramp, TrustRegion};

/// Most entries of a program as written, each of some hundred bytes.
const MOST_ENTRIES: usize = 2_000_000;

impl Checker<'_> {
    pub(super) fn steps(&mut self) {
        let scene = self.scene;
        self.unique("step", &scene.step.iter().map(|s| s.name.as_str()).collect::<Vec<_>>());
        for (index, step) in scene.step.iter().enumerate() {
            let at = top("step").at(index);
            self.increments(&at.at("increments"), &step.increments, index == 0);
            self.motions(&at, step);
            self.loads(&at, step);
        }
        // Only a scene without other faults has a program worth looking at.
        if self.problems.is_empty() && self.fits() {
            // All half cycles of a step are alike: the first speaks for them.
            let program = Program::outline(scene);
            let first = |s: &&ProgramStep| s.half_cycle.is_none_or(|half| half.cycle == 1 && !half.rising);
            for resolved in program.steps.iter().filter(first) {
                let index = resolved.source;
                self.loaded_components(&top("step").at(index), &scene.step[index], resolved);
            }
        }
    }

    /// Every step tells the motion of every component and every load that acts, also where nothing changes.
    fn fits(&mut self) -> bool {
        let scene = self.scene;
        let components = 6 * scene.point_names().count() + 3 * scene.constraint.len();
        let given = scene.step.iter().flat_map(given_loads).map(|(key, _)| key);
        let loads = given.collect::<BTreeSet<_>>().len();
        let entries = scene.step.len() * (components + loads);
        if entries > MOST_ENTRIES {
            let cause = format!(
                "{} steps of {components} components and {loads} loads make {entries} entries, more than {MOST_ENTRIES}",
                scene.step.len()
            );
            self.inconsistent(&top("step"), cause, "fewer steps, ends, constraints or loads");
        }
        entries <= MOST_ENTRIES
    }

    fn increments(&mut self, at: &Location, increments: &Increments, first: bool) {
        let Increments { fixed, initial, minimum, maximum, max_count, control } = increments;
        let lengths = [initial.is_some(), minimum.is_some(), maximum.is_some()];
        let others = [lengths.contains(&true), max_count.is_some(), control.is_some()];
        if fixed.is_some() && others.contains(&true) {
            let help = "give { fixed = N }, or initial, minimum, maximum, max_count and control";
            self.inconsistent(&at.at("fixed"), "`fixed` excludes the keys of automatic increments", help);
            return;
        }
        if *control == Some(PathControl::ArcLength) {
            self.arcs(&at.at("control"), first);
        }
        let ordered = [("minimum", minimum), ("initial", initial), ("maximum", maximum)];
        for (low, high) in [(0, 1), (1, 2), (0, 2)] {
            let ((low_key, low), (high_key, high)) = (ordered[low], ordered[high]);
            if let (Some(low), Some(high)) = (low, high)
                && low > high
            {
                let cause = format!("reversed bounds: `{low_key}` = {low} is larger than `{high_key}` = {high}");
                self.inconsistent(&at.at(low_key), cause, "required: minimum <= initial <= maximum");
                return;
            }
        }
    }

    /// What an equilibrium path cannot be followed with: forces that hang on time, states that are minima.
    fn arcs(&mut self, at: &Location, first: bool) {
        let (scene, solver) = (self.scene, &self.scene.solver);
        if solver.stabilisation.is_some() {
            let cause =
                "`control` = \"arc_length\" follows equilibria, which `solver.stabilisation` disturbs".to_owned();
            self.inconsistent(at, cause, "leave out one of them");
        }
        let ramp = scene.contact.iter().any(|c| c.ramp.is_some()) || scene.rope.as_ref().is_some_and(|r| r.gap < 0.0);
        if ramp && first {
            let cause = "surfaces that overlap at the start are pressed apart over the time of the first step, which with \
                         `control` = \"arc_length\" is the length of a path";
            self.inconsistent(at, cause, "press them apart in a short step of its own before");
        }
        if solver.trust_region == TrustRegion::Always {
            let cause = "`control` = \"arc_length\" follows unstable states too, `solver.trust_region` = \"always\" finds none of \
                         them"
                .to_owned();
            self.inconsistent(at, cause, "leave out one of them");
        }
    }

    /// Fractions rise in ]0, 1].
    pub(super) fn ramp(&mut self, at: &Location, ramp: &Ramp) {
        let Ramp::Path(knots) = ramp else { return };
        if knots.is_empty() {
            self.inconsistent(
                at,
                "the history is empty",
                "pairs [fraction of the step, value], for example [[0.5, 1.0], [1.0, 0.0]]",
            );
        }
        let mut last = 0.0;
        for (index, [fraction, _]) in knots.iter().enumerate() {
            if !(*fraction > last && *fraction <= 1.0) {
                let requirement = format!("greater than {last} and at most 1: fractions of a step rise from 0 to 1");
                self.out_of_range(&at.at(index).at(0), "fraction", *fraction, &requirement);
            }
            last = *fraction;
        }
    }

    fn loads(&mut self, at: &Location, step: &Step) {
        for (index, force) in step.force.iter().enumerate() {
            let at = at.at("force").at(index);
            self.point(&at.at("point"), &force.point);
            self.load_components(&at, &force.components(), ["fx", "fy", "fz", "mx", "my", "mz"]);
            self.moments(&at, &force.components());
        }
        for (index, force) in step.nodal_force.iter().enumerate() {
            let at = at.at("nodal_force").at(index);
            self.node_set(&at.at("set"), &force.set);
            self.load_components(&at, &force.components(), ["fx", "fy", "fz"]);
        }
        for (index, traction) in step.traction.iter().enumerate() {
            let at = at.at("traction").at(index);
            self.surface(&at.at("surface"), &traction.surface);
            self.load_components(&at, &traction.components(), ["tx", "ty", "tz"]);
        }
    }

    /// A dead moment has no potential and is not available.
    fn moments(&mut self, at: &Location, components: &[Option<&Ramp>; 6]) {
        for (component, ramp) in Component::ALL.into_iter().zip(components) {
            if component.is_rotation() && ramp.is_some() {
                let cause = "a moment is not available as a load on a reference point";
                let help = format!("prescribe `{}` and read the moment in history.csv", component.key());
                self.inconsistent(&at.at(component.force_key()), cause, &help);
            }
        }
    }

    fn load_components<const N: usize>(&mut self, at: &Location, components: &[Option<&Ramp>; N], keys: [&str; N]) {
        if components.iter().all(Option::is_none) {
            self.inconsistent(at, "the load has no component", &format!("give at least one of {}", keys.join(", ")));
        }
        for (ramp, key) in components.iter().zip(keys) {
            if let Some(ramp) = ramp {
                self.ramp(&at.at(key), ramp);
            }
        }
    }

    /// A force on a component that is held does nothing.
    fn loaded_components(&mut self, at: &Location, step: &Step, resolved: &ProgramStep) {
        let free = |target: &MotionTarget, component: Component| {
            let own = resolved.motions.iter().find(|m| m.target == *target && m.component == component);
            own.is_none_or(|m| m.path == MotionPath::Free)
        };
        for (index, force) in step.force.iter().enumerate() {
            let target = MotionTarget::Point(force.point.clone());
            for (component, ramp) in Component::ALL.into_iter().zip(force.components()) {
                if ramp.is_some() && !free(&target, component) {
                    let (load, motion) = (component.force_key(), component.key());
                    let cause = format!("`{load}` on \"{}\" does nothing: `{motion}` is prescribed", force.point);
                    let help =
                        format!("add [[step.prescribe]] with point = \"{}\" and {motion} = \"free\"", force.point);
                    self.inconsistent(&at.at("force").at(index).at(load), cause, &help);
                }
            }
        }
        self.standing_loads(at, step, resolved, &free);
    }

    /// A force of an earlier step on a component that this step prescribes.
    fn standing_loads(
        &mut self,
        at: &Location,
        step: &Step,
        resolved: &ProgramStep,
        free: &dyn Fn(&MotionTarget, Component) -> bool,
    ) {
        for load in &resolved.loads {
            let LoadTarget::Point(point) = &load.target else { continue };
            let given =
                step.force.iter().any(|f| f.point == *point && f.components()[load.component.index()].is_some());
            // What cycles of the peak tension left acting is not known here, but it acts.
            let acts = load.path.start != Some(0.0) || load.path.end() != Some(0.0);
            if !given && acts && !free(&MotionTarget::Point(point.clone()), load.component) {
                let (force, motion) = (load.component.force_key(), load.component.key());
                let cause =
                    format!("the step prescribes `{motion}` of \"{point}\" while `{force}` of an earlier step acts");
                let help =
                    format!("end the force in the step before: [[step.force]] point = \"{point}\", {force} = 0.0");
                self.inconsistent(at, cause, &help);
            }
        }
    }
}
