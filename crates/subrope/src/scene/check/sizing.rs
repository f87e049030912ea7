//! Checks of what is known of a rope from its yarns up.

use subrope_geometry::Quantity;
use subrope_geometry::sizing::{Check, Origin, SizingReport};

use super::Checker;
use crate::document::Location;
use crate::scene::Rope;
use crate::sizing::{RopeSizing, digits, key, keys, other_sources, scaled, unit};

impl Checker<'_> {
    pub(super) fn sizing(&mut self, at: &Location, rope: &Rope) {
        if rope.core.is_some() && rope.is_sized() {
            let cause = "sizing knows ropes of equal strands, not a core";
            let help = "give `radius` and the lay, and leave out `linear_density` and [rope.sizing]";
            return self.inconsistent(&at.at("core"), cause, help);
        }
        let Some(sizing) = RopeSizing::of(self.scene) else { return };
        let report = &sizing.report;
        let before = self.problems.len();
        for check in report.contradictions(sizing.tolerance) {
            self.told_twice(at, report, check, sizing.tolerance);
        }
        for &(relation, quantity) in &report.impossible {
            let others = relation.quantities().iter().filter(|q| **q != quantity);
            let mut sources: Vec<Quantity> = others.flat_map(|q| report.sources(*q)).collect();
            sources.sort_unstable();
            sources.dedup();
            let cause = format!("no `{}` fits {} ({relation})", key(quantity), listed(&sources));
            self.inconsistent(&self.first(at, &sources), cause, "one of these values is wrong");
        }
        for (quantity, value) in sizing.impossible_values() {
            self.impossible_value(at, report, quantity, value);
        }
        if self.problems.len() == before {
            self.lacking(at, &sizing, rope);
        }
    }

    fn told_twice(&mut self, at: &Location, report: &SizingReport, check: &Check, tolerance: f64) {
        let (quantity, sources) = (check.quantity, other_sources(report, check));
        let value = |value: f64| format!("{} {}", digits(scaled(quantity, value)), unit(quantity));
        let told = match report.known.get(&quantity).map(|known| known.origin) {
            Some(Origin::Given) => format!("`{}` is {}", key(quantity), value(check.value)),
            _ => format!("`{}` is {} by {}", key(quantity), value(check.value), listed(&report.sources(quantity))),
        };
        let other = check.implied.map_or_else(|| "no value".to_owned(), value);
        let cause = format!(
            "{told}, but {other} by {} ({}): more than {} % apart",
            listed(&sources),
            check.relation,
            digits(100.0 * tolerance)
        );
        let own = report.sources(quantity);
        let help = "leave out what is less certain, or raise `tolerance` in [rope.sizing]";
        self.inconsistent(&self.first(at, &own), cause, help);
    }

    fn impossible_value(&mut self, at: &Location, report: &SizingReport, quantity: Quantity, value: f64) {
        let (least, greatest) = quantity.admissible();
        let range = [least, greatest].map(|limit| digits(scaled(quantity, limit)));
        let (found, unit) = (digits(scaled(quantity, value)), unit(quantity));
        let sources = report.sources(quantity);
        let told = if report.known.contains_key(&quantity) {
            format!("would be {found} {unit} by {}", listed(&sources))
        } else {
            format!("is {found} {unit}")
        };
        let cause = format!("`{}` {told}, which is not between {} and {}", key(quantity), range[0], range[1]);
        let sources = if sources.is_empty() { vec![quantity] } else { sources };
        self.inconsistent(&self.first(at, &sources), cause, "one of these values is wrong");
    }

    /// What the mesh needs and nothing gives.
    fn lacking(&mut self, at: &Location, sizing: &RopeSizing, rope: &Rope) {
        let lay = rope.lay_length.is_some() || sizing.lay_angle().is_some();
        let needed = [(Quantity::StrandRadius, sizing.radius().is_some()), (Quantity::LayAngle, lay)];
        for (quantity, _) in needed.iter().filter(|(_, there)| !there) {
            let open = sizing.report.open.iter().filter(|open| open.unknown.contains(quantity));
            let ways = open.map(|open| {
                let others: Vec<Quantity> = open.unknown.iter().copied().filter(|q| q != quantity).collect();
                format!("{} ({})", listed(&others), open.relation)
            });
            let ways: Vec<String> = ways.collect();
            let ways = if ways.is_empty() { String::new() } else { format!(", or {}", ways.join(", or ")) };
            let help = format!("it does not follow from what is given: give it{ways}");
            self.missing(at, key(*quantity), &help);
        }
    }

    /// The place of the first quantity that the scene gives.
    fn first(&self, at: &Location, quantities: &[Quantity]) -> Location {
        let places = quantities.iter().map(|quantity| match quantity {
            Quantity::StrandAngle => at.at("yarns"),
            Quantity::Strands
            | Quantity::LayAngle
            | Quantity::LayLength
            | Quantity::RopeTex
            | Quantity::StrandRadius
            | Quantity::OuterDiameter => at.at(key(*quantity)),
            other => at.at("sizing").at(key(*other)),
        });
        places.into_iter().find(|place| self.document.contains(place)).unwrap_or_else(|| at.clone())
    }
}

fn listed(quantities: &[Quantity]) -> String {
    let names: Vec<String> = keys(quantities).iter().map(|key| format!("`{key}`")).collect();
    names.join(", ")
}
