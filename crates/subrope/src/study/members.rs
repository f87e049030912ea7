//! Members of a study: every series written out, every level with its scene.

use std::collections::BTreeMap;
use std::path::Path;

use super::file::{Series, Study};
use super::setting::{KeyPath, Setting};
use crate::document::{Document, InvalidDocument, Location, Problem, ProblemKind};
use crate::scene::{Scene, SceneError};

/// A scene to run.
#[derive(Clone, Debug)]
pub struct Member {
    /// Series and level, as tables show them.
    pub name: String,
    /// Index of its family.
    pub family: usize,
    /// Level in it, from 1 (coarse).
    pub level: usize,
    /// Keys of the scene and what they are set to, in the order in which they are put; a later one wins.
    pub settings: Vec<(String, Setting)>,
    /// Size of what is refined, where the series gives one.
    pub size: Option<f64>,
    /// Name of its folder under `members`.
    pub folder: String,
    /// The scene.
    pub text: String,
}

/// A series as written out: members from coarse to fine.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Family {
    /// Name of the series, with the values of `each`.
    pub name: String,
    /// Indices of its members.
    pub members: Vec<usize>,
}

/// All series written out.
pub(super) struct Expanded {
    pub families: Vec<Family>,
    pub members: Vec<Member>,
}

/// Writes out all series of a study; `base` is the text of its scene, which is valid.
pub(super) fn expand(
    study: &Study,
    document: &Document,
    base: &str,
    scene: &Path,
) -> Result<Expanded, InvalidDocument> {
    let maker = Maker { document, base: &toml::from_str(base).unwrap_or_default(), scene };
    let mut out = Expanded { families: Vec::new(), members: Vec::new() };
    let mut problems = Vec::new();
    for (index, series) in study.series.iter().enumerate() {
        let at = Location::root().at("series").at(index);
        for combination in combinations(&series.each) {
            let name = family_name(series, &combination);
            let family = out.families.len();
            let mut members = Vec::new();
            for level in 0..series.levels.values().next().map_or(1, Vec::len) {
                let mut settings = listed(&study.set);
                settings.extend(listed(&series.set));
                settings.extend(combination.iter().cloned());
                let own = series.levels.iter().map(|(key, list)| (key.clone(), list[level].clone()));
                settings.extend(own);
                let title =
                    if series.levels.is_empty() { name.clone() } else { format!("{name}, level {}", level + 1) };
                match maker.text(&title, &at, series, &settings) {
                    Ok(text) => {
                        members.push(out.members.len());
                        let folder = format!("{:02}_{}", out.members.len() + 1, slug(&title));
                        let size = series.sizes.as_ref().map(|h| h[level]);
                        out.members.push(Member {
                            name: title,
                            family,
                            level: level + 1,
                            settings,
                            size,
                            folder,
                            text,
                        });
                    }
                    Err(found) => problems.extend(found),
                }
            }
            out.families.push(Family { name, members });
        }
    }
    document.reject(problems)?;
    Ok(out)
}

/// Keys and values in the order in which they are put.
pub(crate) fn listed(settings: &BTreeMap<String, Setting>) -> Vec<(String, Setting)> {
    settings.iter().map(|(key, value)| (key.clone(), value.clone())).collect()
}

/// Every combination of the values of `each`; one without any when there are none.
pub(crate) fn combinations(each: &BTreeMap<String, Vec<Setting>>) -> Vec<Vec<(String, Setting)>> {
    let mut out = vec![Vec::new()];
    for (key, list) in each {
        let with = |before: &Vec<_>, value: &Setting| {
            let mut longer = before.clone();
            longer.push((key.clone(), value.clone()));
            longer
        };
        out = out.iter().flat_map(|before| list.iter().map(|value| with(before, value)).collect::<Vec<_>>()).collect();
    }
    out
}

fn family_name(series: &Series, combination: &[(String, Setting)]) -> String {
    combination.iter().fold(series.name.clone(), |name, (key, value)| {
        let last = key.rsplit('.').next().unwrap_or(key);
        format!("{name}, {last} {value}")
    })
}

/// A name fit for a folder.
fn slug(name: &str) -> String {
    let plain: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    let parts: Vec<_> = plain.split('_').filter(|p| !p.is_empty()).collect();
    parts.join("_").chars().take(60).collect()
}

/// Makes the scenes of members.
struct Maker<'a> {
    document: &'a Document,
    base: &'a toml::Table,
    scene: &'a Path,
}

impl Maker<'_> {
    /// The scene of a member, checked; problems are shown at what set it.
    fn text(
        &self,
        title: &str,
        at: &Location,
        series: &Series,
        settings: &[(String, Setting)],
    ) -> Result<String, Vec<Problem>> {
        let mut table = self.base.clone();
        for (key, value) in settings {
            let put = KeyPath::parse(key).and_then(|path| path.put(&mut table, &value.0));
            put.map_err(|fault| vec![self.problem(&place(at, series, key), fault.to_string())])?;
        }
        self.only_numbers(&mut table);
        let shown = if series.levels.is_empty() { at.at("name") } else { at.at("levels") };
        let text = toml::to_string(&table).map_err(|e| vec![self.problem(&shown, format!("{title}: {e}"))])?;
        match Scene::from_toml(title, &text) {
            Ok(_) => Ok(text),
            Err(SceneError::Invalid(scene)) => {
                Err(scene.problems().iter().map(|p| self.scene_problem(&shown, title, p)).collect())
            }
            Err(other) => Err(vec![self.problem(&shown, format!("{title}: {other}"))]),
        }
    }

    fn problem(&self, at: &Location, cause: String) -> Problem {
        self.document.problem(at, ProblemKind::Inconsistent { cause })
    }

    fn scene_problem(&self, at: &Location, title: &str, problem: &Problem) -> Problem {
        let shown = self.problem(at, format!("{title}: {problem}"));
        match miette::Diagnostic::help(problem) {
            Some(help) => shown.help(help.to_string()),
            None => shown,
        }
    }

    /// Members write no fields but the last displacement, into the folder they are told; a deck is found from anywhere.
    fn only_numbers(&self, table: &mut toml::Table) {
        let mut output = toml::Table::new();
        output.insert("fields".to_owned(), toml::Value::Array(vec!["displacement".into()]));
        output.insert("every".to_owned(), toml::Value::Integer(1_000_000));
        output.insert("compression".to_owned(), toml::Value::Integer(0));
        table.insert("output".to_owned(), toml::Value::Table(output));
        let folder = self.scene.parent().unwrap_or(Path::new(""));
        if let Some(toml::Value::Table(deck)) = table.get_mut("deck")
            && let Some(toml::Value::String(file)) = deck.get_mut("file")
            && let Ok(whole) = std::path::absolute(folder.join(&*file))
        {
            *file = whole.display().to_string();
        }
    }
}

/// Where a key was set: in the levels, in each, in the series, or for all.
fn place(at: &Location, series: &Series, key: &str) -> Location {
    let own = [
        ("levels", series.levels.contains_key(key)),
        ("each", series.each.contains_key(key)),
        ("set", series.set.contains_key(key)),
    ];
    match own.iter().find(|(_, has)| *has) {
        Some((table, _)) => at.at(*table).at(key),
        None => Location::root().at("set").at(key),
    }
}
