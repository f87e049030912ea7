//! Study files: what is varied, what is looked at, and what it is compared with.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use subrope_io::input;

use super::members::{Family, Member};
use super::setting::Setting;
use super::{StudyError, check, members};
use crate::Error;
use crate::document::{self, InvalidDocument, Location, ProblemKind};
use crate::scene::{SceneError, SceneFile};

/// A study: a scene run with varied settings, and how far its results are from a reference at what cost.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Study {
    /// What the study shows, in one line.
    #[schemars(length(min = 1))]
    pub title: String,
    /// Sources, assumptions, remarks.
    #[serde(default)]
    pub notes: Option<String>,
    /// The scene that is varied, relative to the study file.
    #[schemars(with = "String", length(min = 1))]
    pub scene: PathBuf,
    /// How often every member runs \[-\]: all once, then all again. The reference runs once.
    #[serde(default = "three")]
    #[schemars(range(min = 1, max = 1000))]
    pub repeats: usize,
    /// Members whose first run takes longer run once \[s\]: what disturbs is small beside it. None when left out.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub repeat_below: Option<f64>,
    /// Time after which a member is stopped and counts as failed \[s\]; none when left out.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub time_limit: Option<f64>,
    /// Threads of every member \[-\].
    #[serde(default = "one")]
    #[schemars(range(min = 1))]
    pub threads: usize,
    /// Which time is compared: "cpu" of the process, or "wall".
    #[serde(default)]
    pub clock: Clock,
    /// Relative error to be reached \[-\].
    #[serde(default = "one_percent")]
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 1))]
    pub target: f64,
    /// Settings of all members: keys of the scene such as "step\[0\].bend.angle", and their values.
    #[serde(default)]
    pub set: BTreeMap<String, Setting>,
    /// What results are compared with, where a quantity has no value of its own.
    #[serde(default)]
    pub reference: Option<Reference>,
    /// What is looked at.
    #[schemars(length(min = 1, max = 1000))]
    pub quantity: Vec<Quantity>,
    /// Series of members, from coarse to fine.
    #[schemars(length(min = 1, max = 1000))]
    pub series: Vec<Series>,
}

fn three() -> usize {
    3
}

fn one() -> usize {
    1
}

fn one_percent() -> f64 {
    0.01
}

/// Which time is compared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Clock {
    /// Time the process had a processor, over all its threads: little disturbed by what else runs on the machine.
    #[default]
    Cpu,
    /// Time that passed.
    Wall,
}

impl Clock {
    /// In words.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Cpu => "CPU time",
            Self::Wall => "wall-clock time",
        }
    }
}

/// What results are compared with.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Reference {
    /// "finest": the last level of a series. "extrapolated": Richardson's extrapolation of its last three levels.
    /// "value": every quantity has a value of its own.
    pub kind: ReferenceKind,
    /// The series; may be left out where there is one.
    #[serde(default)]
    pub series: Option<String>,
}

/// Kind of a reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ReferenceKind {
    /// The last level of a series.
    Finest,
    /// Richardson's extrapolation of the last three levels of a series.
    Extrapolated,
    /// A closed form, given with the quantity.
    Value,
}

/// A number that a run gives.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Quantity {
    /// One of the known names (docs/studies.md), or any name where `from` is given.
    #[schemars(length(min = 1))]
    pub name: String,
    /// "history:COLUMN" (the last row, or `at`) or "summary:/json/pointer".
    #[serde(default)]
    pub from: Option<String>,
    /// Where in the history: linear between the rows at which a column first passes a value.
    #[serde(default)]
    pub at: Option<At>,
    /// Reference point of `force`, `moment`, `tension` and `torque`; the last one by name when left out.
    #[serde(default)]
    pub point: Option<String>,
    /// Unit, for tables and plots of quantities with `from`.
    #[serde(default)]
    pub unit: Option<String>,
    /// What it should be, from a closed form \[unit of the quantity\].
    #[serde(default)]
    pub value: Option<f64>,
}

/// A place in the history.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct At {
    /// The column, without its unit.
    #[schemars(length(min = 1))]
    pub column: String,
    /// The value it passes \[unit of the column\].
    pub value: f64,
}

/// Members that differ in how fine they are. Without `levels` a single member.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Series {
    /// Its name in tables and plots.
    #[schemars(length(min = 1))]
    pub name: String,
    /// Settings of all its members.
    #[serde(default)]
    pub set: BTreeMap<String, Setting>,
    /// Lists of values: the series is repeated for every combination of them.
    #[serde(default)]
    pub each: BTreeMap<String, Vec<Setting>>,
    /// Lists of equal length, from coarse to fine: the i-th level takes the i-th value of every list.
    #[serde(default)]
    pub levels: BTreeMap<String, Vec<Setting>>,
    /// Size of what is refined (length of a brick, of an increment), one per level, falling \[any unit\]; unknowns^(-1/3)
    /// when left out. Observed orders and extrapolation refer to it.
    #[serde(default)]
    pub sizes: Option<Vec<f64>>,
}

impl Study {
    /// The JSON schema (draft 2020-12) of study files.
    #[must_use]
    pub fn schema() -> serde_json::Value {
        document::schema_of::<Self>()
    }
}

/// A checked study file with its members.
#[derive(Clone, Debug)]
pub struct StudyFile {
    /// The study.
    pub study: Study,
    /// The file.
    pub path: PathBuf,
    /// The scene that is varied, relative to the working folder.
    pub scene: PathBuf,
    /// Series, those with `each` written out.
    pub families: Vec<Family>,
    /// All members, series by series and from coarse to fine.
    pub members: Vec<Member>,
}

impl StudyFile {
    /// Reads a study file and the scene it varies, and checks every member's scene. A deck is opened only by the run.
    ///
    /// # Errors
    /// [`Error::Study`] with the place of every problem, [`Error::Scene`] when the scene itself is wrong.
    pub fn load(path: &Path) -> Result<Self, Error> {
        let text = input::read_text(path, input::MAX_TEXT);
        let text = text.map_err(|source| StudyError::Read { path: path.to_owned(), source })?;
        Self::of_text(path, &text, |scene| input::read_bytes(scene, input::MAX_TEXT), SceneFile::load)
    }

    /// The same from a text; `read` gives the bytes of the scene, `load` checks it.
    ///
    /// # Errors
    /// As [`StudyFile::load`].
    pub fn of_text(
        path: &Path,
        text: &str,
        read: impl FnOnce(&Path) -> std::io::Result<Vec<u8>>,
        load: impl FnOnce(&Path) -> Result<SceneFile, SceneError>,
    ) -> Result<Self, Error> {
        let name = path.display().to_string();
        let (study, document) = document::read::<Study>(&name, text).map_err(invalid)?;
        let scene = path.parent().unwrap_or(Path::new("")).join(&study.scene);
        let base = read(&scene).map_err(|error| {
            let cause = format!("cannot read the scene {}: {error}", scene.display());
            let at = Location::root().at("scene");
            let problem = document.problem(&at, ProblemKind::UnusableFile { cause });
            invalid(document.invalid(vec![problem.help("the path is relative to the study file")]))
        })?;
        document.reject(check::check(&study, &document)).map_err(invalid)?;
        load(&scene)?;
        // Scenes are UTF-8 text, or they would not have been loaded.
        let base = String::from_utf8_lossy(&base);
        let expanded = members::expand(&study, &document, &base, &scene).map_err(invalid)?;
        document.reject(check::check_reference(&study, &document, &expanded.families)).map_err(invalid)?;
        Ok(Self { study, path: path.to_owned(), scene, families: expanded.families, members: expanded.members })
    }

    /// The folder for results: `out/NAME` beside the study NAME.toml.
    #[must_use]
    pub fn output_folder(&self) -> PathBuf {
        let stem = self.path.file_stem().unwrap_or_default();
        self.path.parent().unwrap_or(Path::new("")).join("out").join(stem)
    }
}

fn invalid(document: InvalidDocument) -> StudyError {
    StudyError::Invalid(Box::new(document))
}
