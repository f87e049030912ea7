//! Members of families: every combination of settings, written out.

use super::{StressError, StressFamily, StressList, Twin};
use crate::study::{KeyPath, Setting, combinations, listed};

/// A scene to run twice.
#[derive(Clone, Debug, PartialEq)]
pub struct StressMember {
    /// Its name in the family.
    pub name: String,
    /// The scene as text; whether it is a valid one the run finds out.
    pub text: String,
    /// Units of the second run.
    pub twin: Twin,
}

/// Refuses names of families that are not there.
pub(super) fn check_names(lists: &[StressList], only: &[String]) -> Result<(), StressError> {
    let families = || lists.iter().flat_map(|list| &list.family);
    match only.iter().find(|name| !families().any(|f| f.is_named(name))) {
        None => Ok(()),
        Some(name) => Err(StressError::UnknownFamily {
            name: name.clone(),
            allowed: families().map(|f| f.name.clone()).collect(),
        }),
    }
}

/// The members of a family.
pub(super) fn expand(list: &StressList, family: &StressFamily) -> Result<Vec<StressMember>, StressError> {
    let Some(Setting(toml::Value::Table(base))) = list.scene.get(&family.scene) else {
        return Err(StressError::UnknownScene {
            family: family.name.clone(),
            scene: family.scene.clone(),
            allowed: list.scene.keys().cloned().collect(),
        });
    };
    let count = count(family)?;
    let mut out = Vec::new();
    for combination in combinations(&family.each) {
        for level in 0..count {
            let own: Vec<(String, Setting)> =
                family.levels.iter().map(|(key, values)| (key.clone(), values[level].clone())).collect();
            let name = name(family, &combination, &own, level);
            let settings = listed(&family.set).into_iter().chain(combination.iter().cloned()).chain(own);
            let twin = family.twins.get(level).copied().unwrap_or(family.twin);
            out.push(StressMember { name, text: text(family, base, settings)?, twin });
        }
    }
    check_limits(family, &out)?;
    Ok(out)
}

/// How many members every combination of `each` has.
fn count(family: &StressFamily) -> Result<usize, StressError> {
    let lengths = family.levels.values().map(Vec::len).chain([family.twins.len(), family.members.len()]);
    let mut lengths = lengths.filter(|n| *n > 0);
    let Some(expected) = lengths.next() else { return Ok(1) };
    match lengths.find(|n| *n != expected) {
        Some(found) => Err(StressError::Lengths { family: family.name.clone(), found, expected }),
        None => Ok(expected),
    }
}

fn name(family: &StressFamily, each: &[(String, Setting)], own: &[(String, Setting)], level: usize) -> String {
    let short =
        |(key, value): &(String, Setting)| format!("{} {}", key.rsplit('.').next().unwrap_or(key), number(value));
    let mut parts: Vec<String> = each.iter().map(short).collect();
    match (family.members.get(level), family.twins.get(level)) {
        (Some(name), _) => parts.push(name.clone()),
        (None, Some(twin)) => parts.push(twin.to_string()),
        _ => parts.extend(own.iter().map(short)),
    }
    if parts.is_empty() { family.name.clone() } else { parts.join(", ") }
}

/// A value, powers of ten as such.
fn number(value: &Setting) -> String {
    match value.0.as_float() {
        Some(x) if x != 0.0 && !(1e-3..1e5).contains(&x.abs()) => format!("{x:e}"),
        _ => value.to_string(),
    }
}

fn text(
    family: &StressFamily,
    base: &toml::Table,
    settings: impl Iterator<Item = (String, Setting)>,
) -> Result<String, StressError> {
    let mut table = base.clone();
    for (key, value) in settings {
        let put = KeyPath::parse(&key).and_then(|path| path.put(&mut table, &value.0));
        put.map_err(|fault| StressError::Setting { family: family.name.clone(), key, fault: Box::new(fault) })?;
    }
    Ok(table.to_string())
}

fn check_limits(family: &StressFamily, members: &[StressMember]) -> Result<(), StressError> {
    let known = |name: &String| name == "*" || members.iter().any(|m| m.name == *name);
    match family.limits.keys().find(|name| !known(name)) {
        None => Ok(()),
        Some(member) => Err(StressError::UnknownMember {
            family: family.name.clone(),
            member: member.clone(),
            allowed: members.iter().map(|m| m.name.clone()).collect(),
        }),
    }
}
