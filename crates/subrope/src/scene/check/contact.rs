//! Checks of ropes, contacts and rigid bodies.

use super::{Checker, top};
use crate::contact;
use crate::document::Location;
use crate::scene::{Contact, MeshLines, RigidShape, Rope, Yarns};

impl Checker<'_> {
    pub(super) fn rope(&mut self, rope: &Rope) {
        let at = top("rope");
        self.lay(&at, rope);
        self.sizing(&at, rope);
        if rope.mesh.lines == MeshLines::Yarns {
            let cause = "the mesh lines of a rope's strands run along their axes";
            self.inconsistent(&at.at("mesh").at("lines"), cause, "lines = \"axis\"");
        }
        if rope.compaction > 0.0 && rope.core.is_some() {
            let cause = "strands about a core are not flattened against each other";
            self.inconsistent(&at.at("compaction"), cause, "leave out `compaction` or `core`");
        }
        self.yarns(&at.at("yarns"), &rope.yarns);
        if let Some(core) = &rope.core {
            self.yarns(&at.at("core").at("yarns"), &core.yarns);
        }
    }

    /// One key gives the lay, unless sizing has the diameter give the radius or compares it.
    fn lay(&mut self, at: &Location, rope: &Rope) {
        let lays = [
            ("lay_angle", rope.lay_angle.is_some()),
            ("lay_length", rope.lay_length.is_some()),
            ("outer_diameter", rope.outer_diameter.is_some() && !rope.is_sized()),
        ];
        let mut given = lays.iter().filter(|(_, g)| *g);
        match (given.next(), given.next()) {
            (None, _) if !rope.is_sized() => {
                self.missing(at, "lay_angle", "or `lay_length` (mm) or `outer_diameter` (mm)");
            }
            (Some((first, _)), Some((second, _))) => {
                let cause = format!("`{first}` and `{second}` exclude each other");
                self.inconsistent(&at.at(*second), cause, "one of them gives the lay");
            }
            _ => {}
        }
    }

    fn yarns(&mut self, at: &Location, yarns: &Yarns) {
        match (yarns.surface_angle, yarns.pitch) {
            (Some(_), Some(_)) => {
                let help = "tan(surface_angle) = 2 pi radius / pitch: give one of the two";
                self.inconsistent(&at.at("pitch"), "`surface_angle` and `pitch` exclude each other", help);
            }
            (None, None) => self.missing(at, "surface_angle", "or `pitch` (mm); surface_angle = 0 means straight"),
            _ => {}
        }
    }

    pub(super) fn contacts(&mut self) {
        let scene = self.scene;
        self.unique("contact", &scene.contact.iter().map(|c| c.name.as_str()).collect::<Vec<_>>());
        self.unique("rigid", &scene.rigid.iter().map(|r| r.name.as_str()).collect::<Vec<_>>());
        for (index, rigid) in scene.rigid.iter().enumerate() {
            let at = top("rigid").at(index);
            self.heading(&at.at("name"), &rigid.name, "letters, digits, _, -, + and blanks within");
            if rigid.axis.iter().all(|c| *c == 0.0) {
                self.inconsistent(&at.at("axis"), "`axis` is a direction and cannot be zero", "");
            }
            match (rigid.shape, rigid.radius) {
                (RigidShape::Cylinder, None) => self.missing(&at, "radius", "the radius of the cylinder (mm)"),
                (RigidShape::Plane, Some(_)) => {
                    self.inconsistent(&at.at("radius"), "a plane has no radius", "leave it out");
                }
                _ => {}
            }
            if scene.end.iter().any(|e| e.name == rigid.name) {
                let cause = format!("the name \"{}\" is that of an end", rigid.name);
                self.inconsistent(&at.at("name"), cause, "reference points need names of their own");
            }
        }
        if !cfg!(feature = "contact") && !scene.contact.is_empty() {
            self.inconsistent(&top("contact").at(0), contact::LEFT_OUT, contact::HOW_TO_GET);
        }
        for (index, contact) in scene.contact.iter().enumerate() {
            self.contact(&top("contact").at(index), contact);
        }
    }

    fn contact(&mut self, at: &Location, contact: &Contact) {
        self.heading(&at.at("name"), &contact.name, "letters, digits, _, -, + and blanks within");
        match (&contact.primary, &contact.secondary) {
            (Some(primary), Some(secondary)) => {
                if !self.scene.rigid.iter().any(|r| r.name == *primary) {
                    self.surface(&at.at("primary"), primary);
                }
                self.surface(&at.at("secondary"), secondary);
                if primary.eq_ignore_ascii_case(secondary) {
                    self.inconsistent(&at.at("secondary"), "a surface cannot touch itself", "name two surfaces");
                }
            }
            (None, None) if self.scene.rope.is_none() => {
                self.missing(at, "primary", "only a [rope] has neighbouring strands that need not be named");
            }
            (None, None) => {}
            (Some(_), None) => self.missing(at, "secondary", "the surface that touches `primary`"),
            (None, Some(_)) => self.missing(at, "primary", "the surface or rigid body that `secondary` touches"),
        }
        if let Some(n) = contact.points.iter().find(|n| !(1..=32).contains(*n)) {
            self.out_of_range(&at.at("points"), "points", *n as f64, "between 1 and 32");
        }
    }
}
