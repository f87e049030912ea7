//! What a hierarchy determines, leaves open and contradicts.

use super::pair::solve_pair;
use super::{Hierarchy, Quantity, Relation};
use std::collections::BTreeMap;
use std::fmt;

/// Where a value comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Origin {
    /// The user.
    Given,
    /// A relation and the other quantities in it.
    Derived(Relation),
}

/// A known value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Known {
    /// The value, in the unit of its quantity.
    pub value: f64,
    /// Where it comes from.
    pub origin: Origin,
}

/// A redundant relation: all its quantities are known without it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Check {
    /// The relation.
    pub relation: Relation,
    /// The quantity told twice.
    pub quantity: Quantity,
    /// Its value.
    pub value: f64,
    /// The value that the other quantities of the relation imply; `None` when no value fulfils the relation.
    pub implied: Option<f64>,
    /// |value/implied - 1|, infinite when no value fulfils the relation.
    pub difference: f64,
}

/// A relation with several unknowns: all but one of them have to be given.
#[derive(Debug, Clone, PartialEq)]
pub struct Open {
    /// The relation.
    pub relation: Relation,
    /// Its unknown quantities.
    pub unknown: Vec<Quantity>,
}

/// What follows from a [`Hierarchy`].
#[derive(Debug, Clone, PartialEq)]
pub struct SizingReport {
    /// Given and derived values.
    pub known: BTreeMap<Quantity, Known>,
    /// Under-determined: relations that lack more than one quantity.
    pub open: Vec<Open>,
    /// Over-determined: relations that are redundant.
    pub checks: Vec<Check>,
    /// Relations in which no value of the one missing quantity fits the others.
    pub impossible: Vec<(Relation, Quantity)>,
    /// Values outside their sensible range, see [`Quantity::admissible`]: given ones are not used, derived ones are.
    pub inadmissible: Vec<(Quantity, f64)>,
    /// See [`Hierarchy::gap`].
    gap: f64,
}

impl SizingReport {
    pub(super) fn new(hierarchy: &Hierarchy) -> Self {
        let mut report = Self {
            known: BTreeMap::new(),
            open: Vec::new(),
            checks: Vec::new(),
            impossible: Vec::new(),
            inadmissible: Vec::new(),
            gap: hierarchy.gap.unwrap_or_default(),
        };
        for quantity in Quantity::ALL {
            if let Some(value) = hierarchy.given(quantity) {
                report.learn(quantity, value, Origin::Given);
            }
        }
        let touching = hierarchy.gap.is_some();
        let mut pending: Vec<_> = Relation::ALL.into_iter().filter(|r| touching || !r.needs_touching()).collect();
        report.check_redundant(&mut pending);
        while report.derive_one(&mut pending) || report.derive_two(&mut pending) {
            report.check_redundant(&mut pending);
        }
        let open = |relation| Open { relation, unknown: report.unknown(relation) };
        report.open = pending.into_iter().map(open).collect();
        report
    }

    /// The value of a quantity, given or derived.
    pub fn value(&self, quantity: Quantity) -> Option<f64> {
        self.known.get(&quantity).map(|known| known.value)
    }

    /// The redundant relations that differ by more than `tolerance`.
    pub fn contradictions(&self, tolerance: f64) -> impl Iterator<Item = &Check> {
        self.checks.iter().filter(move |check| check.difference > tolerance)
    }

    /// Quantities that are neither given nor follow.
    pub fn missing(&self) -> impl Iterator<Item = Quantity> + '_ {
        Quantity::ALL.into_iter().filter(|quantity| !self.known.contains_key(quantity))
    }

    /// The given quantities that a value comes from, each once; of a given one itself.
    pub fn sources(&self, quantity: Quantity) -> Vec<Quantity> {
        let (mut open, mut seen, mut given) = (vec![quantity], vec![quantity], Vec::new());
        while let Some(next) = open.pop() {
            match self.known.get(&next).map(|known| known.origin) {
                Some(Origin::Given) => given.push(next),
                Some(Origin::Derived(relation)) => {
                    let others = relation.quantities().iter().filter(|q| !seen.contains(q)).copied();
                    let others: Vec<_> = others.collect();
                    seen.extend(&others);
                    open.extend(others);
                }
                None => {}
            }
        }
        given.sort_unstable();
        given
    }

    fn learn(&mut self, quantity: Quantity, value: f64, origin: Origin) {
        let admissible = quantity.is_admissible(value);
        if !admissible {
            self.inadmissible.push((quantity, value));
        }
        if admissible || origin != Origin::Given {
            self.known.insert(quantity, Known { value, origin });
        }
    }

    fn unknown(&self, relation: Relation) -> Vec<Quantity> {
        relation.quantities().iter().copied().filter(|quantity| !self.known.contains_key(quantity)).collect()
    }

    /// Derives one value from the first relation that lacks one; false when there is no such relation.
    fn derive_one(&mut self, pending: &mut Vec<Relation>) -> bool {
        let lacking_one = pending.iter().position(|&relation| self.unknown(relation).len() == 1);
        let Some(relation) = lacking_one.map(|i| pending.remove(i)) else {
            return false;
        };
        // Straight strands have no lay length.
        if relation == Relation::Lay && self.value(Quantity::LayAngle) == Some(0.0) {
            return true;
        }
        for quantity in self.unknown(relation) {
            match self.solve(relation, quantity) {
                Some(value) => self.learn(quantity, value, Origin::Derived(relation)),
                None => self.impossible.push((relation, quantity)),
            }
        }
        true
    }

    /// Derives two values from the first two relations that lack the same two; false when that leads nowhere.
    fn derive_two(&mut self, pending: &mut Vec<Relation>) -> bool {
        for (i, &first) in pending.iter().enumerate() {
            let mut unknown = self.unknown(first);
            // The angle has the narrow range.
            unknown.sort_by_key(|q| *q != Quantity::LayAngle);
            let &[outer, inner] = unknown.as_slice() else { continue };
            for &second in &pending[i + 1..] {
                let lacks = self.unknown(second);
                if lacks.len() != 2 || !lacks.contains(&outer) || !lacks.contains(&inner) {
                    continue;
                }
                let known = |quantity| self.value(quantity).unwrap_or(f64::NAN);
                if let Some([x, y]) = solve_pair([first, second], [outer, inner], self.gap, known) {
                    self.learn(outer, x, Origin::Derived(second));
                    self.learn(inner, y, Origin::Derived(first));
                    pending.retain(|relation| ![first, second].contains(relation));
                    return true;
                }
            }
        }
        false
    }

    /// Compares both values of the first quantity of every relation that lacks nothing, and takes it off the list.
    fn check_redundant(&mut self, pending: &mut Vec<Relation>) {
        let (complete, rest) = pending.iter().partition(|&&relation| self.unknown(relation).is_empty());
        *pending = rest;
        let complete: Vec<Relation> = complete;
        for relation in complete {
            let quantity = relation.quantities()[0];
            let value = self.value(quantity).unwrap_or(f64::NAN);
            let implied = self.solve(relation, quantity);
            let difference = implied.map_or(f64::INFINITY, |implied| (value / implied - 1.0).abs());
            self.checks.push(Check { relation, quantity, value, implied, difference });
        }
    }

    fn solve(&self, relation: Relation, unknown: Quantity) -> Option<f64> {
        relation.solve(unknown, self.gap, |quantity| self.value(quantity).unwrap_or(f64::NAN))
    }
}

impl fmt::Display for SizingReport {
    /// One line per finding.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (quantity, known) in &self.known {
            match known.origin {
                Origin::Given => writeln!(f, "given: {quantity} {}", known.value)?,
                Origin::Derived(relation) => writeln!(f, "follows: {quantity} {} ({relation})", known.value)?,
            }
        }
        for Open { relation, unknown } in &self.open {
            let names: Vec<String> = unknown.iter().map(Quantity::to_string).collect();
            writeln!(f, "open: give all but one of {} ({relation})", names.join(", "))?;
        }
        for Check { relation, quantity, value, implied, difference } in &self.checks {
            match implied {
                Some(implied) => {
                    writeln!(f, "told twice: {quantity} {value} and {implied}, {difference:.2e} apart ({relation})")?;
                }
                None => writeln!(f, "contradiction: no {quantity} fits ({relation})")?,
            }
        }
        for (relation, quantity) in &self.impossible {
            writeln!(f, "contradiction: no {quantity} fits ({relation})")?;
        }
        for (quantity, value) in &self.inadmissible {
            let (least, greatest) = quantity.admissible();
            writeln!(f, "out of range: {quantity} {value} is not in {least} to {greatest}")?;
        }
        Ok(())
    }
}
