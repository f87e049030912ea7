//! Lists of extreme scenes: what is varied, how far the twin may differ, which limits are explained.

use std::collections::BTreeMap;
use std::path::Path;

use schemars::JsonSchema;
use serde::Deserialize;

use super::{StressError, Twin};
use crate::document;
use crate::study::Setting;

/// A list of families of extreme scenes.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StressList {
    /// What the list is about, in one line.
    #[schemars(length(min = 1))]
    pub title: String,
    /// Scenes that families vary, by name; written as in a scene file.
    pub scene: BTreeMap<String, Setting>,
    /// Families.
    #[schemars(length(min = 1))]
    pub family: Vec<StressFamily>,
}

/// Scenes that differ in a few settings. `levels` and `each` are those of a study.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StressFamily {
    /// Its name.
    #[schemars(length(min = 1))]
    pub name: String,
    /// What it asks and what is to be seen.
    #[schemars(length(min = 1))]
    pub question: String,
    /// Name of the scene that is varied.
    pub scene: String,
    /// Settings of all members.
    #[serde(default)]
    pub set: BTreeMap<String, Setting>,
    /// Lists of values: every combination of them is a member.
    #[serde(default)]
    pub each: BTreeMap<String, Vec<Setting>>,
    /// Lists of equal length: the i-th member takes the i-th value of every list.
    #[serde(default)]
    pub levels: BTreeMap<String, Vec<Setting>>,
    /// Names of the members of `levels` or `twins`; made of the values when left out.
    #[serde(default)]
    pub members: Vec<String>,
    /// The units of the second run of every member; lengths and stiffnesses times 1000 when left out.
    #[serde(default)]
    pub twin: Twin,
    /// One member for each of these second runs, of the same scene.
    #[serde(default)]
    pub twins: Vec<Twin>,
    /// Largest relative difference of the dimensionless results of the two runs \[-\].
    #[serde(default = "millionth")]
    #[schemars(extend("minimum" = 0))]
    pub within: f64,
    /// Largest part of the external work that the balance may leave open beside the snaps that were reported \[-\].
    #[serde(default = "hundredth")]
    #[schemars(extend("minimum" = 0))]
    pub energy: f64,
    /// Time after which a run is stopped \[s\].
    #[serde(default = "two_minutes")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub time_limit: f64,
    /// Members that may stop or be refused, and why: their name, or "*" for all of them.
    #[serde(default)]
    pub limits: BTreeMap<String, String>,
    /// What the results say, for the table.
    #[serde(default)]
    pub remark: Option<String>,
}

fn millionth() -> f64 {
    1e-6
}

fn hundredth() -> f64 {
    1e-2
}

fn two_minutes() -> f64 {
    120.0
}

impl StressList {
    /// The JSON schema (draft 2020-12) of lists.
    #[must_use]
    pub fn schema() -> serde_json::Value {
        document::schema_of::<Self>()
    }

    /// Reads and checks a list; `name` is what errors call it.
    ///
    /// # Errors
    /// [`StressError::Invalid`] with the place of every problem.
    pub fn from_toml(name: &str, text: &str) -> Result<Self, StressError> {
        let read = document::read::<Self>(name, text).map_err(|e| StressError::Invalid(Box::new(e)))?;
        Ok(read.0)
    }

    /// Reads and checks a file.
    ///
    /// # Errors
    /// [`StressError::Read`], [`StressError::Invalid`].
    pub fn load(path: &Path) -> Result<Self, StressError> {
        let text =
            std::fs::read_to_string(path).map_err(|source| StressError::Read { path: path.to_owned(), source })?;
        Self::from_toml(&path.display().to_string(), &text)
    }
}

impl StressFamily {
    /// Why a member may stop.
    #[must_use]
    pub fn limit(&self, member: &str) -> Option<&str> {
        self.limits.get(member).or_else(|| self.limits.get("*")).map(String::as_str)
    }

    /// Whether it is one of those asked for.
    pub(super) fn is_wanted(&self, only: &[String]) -> bool {
        only.is_empty() || only.iter().any(|part| self.is_named(part))
    }

    pub(super) fn is_named(&self, part: &str) -> bool {
        self.name.to_lowercase().contains(&part.to_lowercase())
    }
}
