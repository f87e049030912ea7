//! Checks of a study that need more than one value.

use std::collections::BTreeMap;

use super::file::{Quantity, ReferenceKind, Series, Study};
use super::members::Family;
use super::quantity::{self, Source};
use super::setting::{KeyPath, Setting};
use crate::document::{Document, Location, Problem, ProblemKind};

/// Most members of a study, each a process of its own.
const MOST_MEMBERS: f64 = 1000.0;

/// Problems of a study without a look at its scene.
pub(super) fn check(study: &Study, document: &Document) -> Vec<Problem> {
    let mut checker = Checker { document, problems: Vec::new() };
    checker.paths(&Location::root().at("set"), study.set.keys());
    study.series.iter().enumerate().for_each(|(index, series)| checker.series(index, series));
    checker.members(study);
    checker.unique("series", &study.series.iter().map(|s| s.name.as_str()).collect::<Vec<_>>());
    study.quantity.iter().enumerate().for_each(|(index, quantity)| checker.quantity(index, quantity));
    checker.unique("quantity", &study.quantity.iter().map(|q| q.name.as_str()).collect::<Vec<_>>());
    checker.problems
}

/// Problems of the reference, which names a series as written out.
pub(super) fn check_reference(study: &Study, document: &Document, families: &[Family]) -> Vec<Problem> {
    let mut checker = Checker { document, problems: Vec::new() };
    checker.reference(study, families);
    checker.problems
}

struct Checker<'a> {
    document: &'a Document,
    problems: Vec<Problem>,
}

impl Checker<'_> {
    fn report(&mut self, at: &Location, kind: ProblemKind, help: &str) {
        let problem = self.document.problem(at, kind);
        self.problems.push(if help.is_empty() { problem } else { problem.help(help) });
    }

    fn inconsistent(&mut self, at: &Location, cause: impl Into<String>, help: &str) {
        self.report(at, ProblemKind::Inconsistent { cause: cause.into() }, help);
    }

    fn unique(&mut self, table: &str, names: &[&str]) {
        for (index, name) in names.iter().enumerate() {
            if names[..index].contains(name) {
                let at = Location::root().at(table).at(index).at("name");
                self.inconsistent(&at, format!("the name \"{name}\" is used twice in [[{table}]]"), "");
            }
        }
    }

    fn paths<'k>(&mut self, at: &Location, keys: impl Iterator<Item = &'k String>) {
        for key in keys {
            if let Err(fault) = KeyPath::parse(key) {
                self.inconsistent(&at.at(key.as_str()), fault.to_string(), "for example \"step[0].bend.angle\"");
            }
        }
    }

    fn series(&mut self, index: usize, series: &Series) {
        let at = Location::root().at("series").at(index);
        self.paths(&at.at("set"), series.set.keys());
        for (table, lists) in [("each", &series.each), ("levels", &series.levels)] {
            self.paths(&at.at(table), lists.keys());
            for key in lists.iter().filter(|(_, list)| list.is_empty()).map(|(key, _)| key) {
                self.wrong_length(&at.at(table).at(key.as_str()), key, 0, "at least one entry");
            }
        }
        self.levels(&at, &series.levels);
        let levels = series.levels.values().next().map_or(1, Vec::len);
        if let Some(sizes) = &series.sizes {
            let at = at.at("sizes");
            if sizes.len() != levels {
                self.wrong_length(&at, "sizes", sizes.len(), &format!("{levels} entries, one per level"));
            } else if sizes.iter().any(|h| *h <= 0.0) || sizes.windows(2).any(|h| h[1] >= h[0]) {
                self.inconsistent(&at, "`sizes` must be positive and fall from level to level", "coarse comes first");
            }
        }
    }

    /// Lists in `each` multiply.
    fn members(&mut self, study: &Study) {
        let mut sum = 0.0;
        for (index, series) in study.series.iter().enumerate() {
            let levels = series.levels.values().next().map_or(1, Vec::len) as f64;
            sum += series.each.values().fold(levels, |product, list| product * list.len() as f64);
            if sum > MOST_MEMBERS {
                let cause = format!("the study has {sum} members up to here, more than {MOST_MEMBERS}");
                let at = Location::root().at("series").at(index).at("name");
                return self.inconsistent(&at, cause, "shorter lists in `each` and `levels`, or several studies");
            }
        }
    }

    fn levels(&mut self, at: &Location, levels: &BTreeMap<String, Vec<Setting>>) {
        let Some((first, list)) = levels.iter().next() else { return };
        for (key, other) in levels.iter().filter(|(_, other)| other.len() != list.len()) {
            let requirement = format!("{} entries, as many as `{first}`", list.len());
            self.wrong_length(&at.at("levels").at(key.as_str()), key, other.len(), &requirement);
        }
    }

    fn wrong_length(&mut self, at: &Location, key: &str, found: usize, requirement: &str) {
        let kind = ProblemKind::WrongLength { key: key.to_owned(), found, requirement: requirement.to_owned() };
        self.report(at, kind, "");
    }

    fn quantity(&mut self, index: usize, quantity: &Quantity) {
        let at = Location::root().at("quantity").at(index);
        if quantity.name.contains(|c: char| !(c.is_ascii_alphanumeric() || "_-".contains(c))) {
            let cause = format!("the name \"{}\" cannot be the name of a file", quantity.name);
            return self.inconsistent(&at.at("name"), cause, "letters, digits, _ and -");
        }
        let source = match (&quantity.from, quantity::known(&quantity.name)) {
            (Some(from), _) => match Source::parse(from, quantity.at.as_ref()) {
                Some(source) => source,
                None => {
                    let help = "\"history:END_B_fz\" or \"summary:/energies/stored_mj\"";
                    let cause = format!("`from` cannot be \"{from}\"");
                    return self.inconsistent(&at.at("from"), cause, help);
                }
            },
            (None, Some(known)) => known.source(quantity.point.as_deref()),
            (None, None) => {
                let allowed = quantity::names().map(str::to_owned).collect();
                let kind = ProblemKind::UnknownName { what: "quantity", found: quantity.name.clone(), allowed };
                return self.report(&at.at("name"), kind, "or say where it comes `from`");
            }
        };
        if quantity.at.is_some() && !matches!(source, Source::History { .. }) {
            self.inconsistent(
                &at.at("at"),
                "only a quantity from the history has an `at`",
                "from = \"history:COLUMN\"",
            );
        }
        if quantity.point.is_some() && !matches!(source, Source::Point { .. }) {
            self.inconsistent(&at.at("point"), "only force, moment, tension and torque have a `point`", "");
        }
        if quantity.value == Some(0.0) {
            self.inconsistent(&at.at("value"), "a relative error needs a `value` other than 0", "");
        }
    }

    fn reference(&mut self, study: &Study, families: &[Family]) {
        let lacking = study.quantity.iter().position(|q| q.value.is_none());
        let reference = match (&study.reference, lacking) {
            (None, None) => return,
            (None, Some(index)) => {
                let at = Location::root().at("quantity").at(index).at("name");
                let cause = format!("there is nothing to compare \"{}\" with", study.quantity[index].name);
                return self.inconsistent(&at, cause, "give it a `value`, or a [reference] for all");
            }
            (Some(reference), lacking) if reference.kind == ReferenceKind::Value => {
                if let Some(index) = lacking {
                    let at = Location::root().at("quantity").at(index).at("name");
                    let cause = format!("the reference is \"value\", and \"{}\" has none", study.quantity[index].name);
                    self.inconsistent(&at, cause, "");
                }
                return;
            }
            (Some(reference), _) => reference,
        };
        let at = Location::root().at("reference");
        let family = match &reference.series {
            None if families.len() == 1 => &families[0],
            None => {
                let kind = ProblemKind::MissingKey { key: "series".to_owned(), table: at.table_name() };
                return self.report(&at, kind, "there is more than one series");
            }
            Some(name) => match families.iter().find(|f| f.name == *name) {
                Some(family) => family,
                None => {
                    let allowed = families.iter().map(|f| f.name.clone()).collect();
                    let kind = ProblemKind::UnknownName { what: "series", found: name.clone(), allowed };
                    return self.report(&at.at("series"), kind, "");
                }
            },
        };
        if reference.kind == ReferenceKind::Extrapolated && family.members.len() < 3 {
            let cause = format!("extrapolation needs three levels, \"{}\" has {}", family.name, family.members.len());
            self.inconsistent(&at.at("kind"), cause, "");
        }
    }
}
