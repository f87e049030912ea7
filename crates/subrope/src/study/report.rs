//! What a study tells: everything that `study.json` holds.

use std::collections::BTreeMap;

use serde::Serialize;
use serde_json::Value as Json;

use super::file::{Clock, ReferenceKind};
use super::front::{CostAt, Ratio};
use super::machine::Machine;

/// All results of a study.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Title of the study.
    pub title: String,
    /// The scene.
    pub scene: String,
    /// Version of the program.
    pub version: &'static str,
    /// Whether every member ran as often as it should.
    pub complete: bool,
    /// How often a member runs; the reference once.
    pub repeats: usize,
    /// Threads of a member.
    pub threads: usize,
    /// Which time is compared.
    pub clock: Clock,
    /// What is timed.
    pub timed: &'static str,
    /// Relative error to be reached.
    pub target: f64,
    /// The machine.
    pub machine: Machine,
    /// Spread of the times of repeated members, (largest - smallest)/smallest: median and largest over all members.
    pub noise: Option<Noise>,
    /// All members.
    pub members: Vec<MemberReport>,
    /// All series.
    pub series: Vec<SeriesReport>,
    /// All quantities.
    pub quantities: Vec<QuantityReport>,
    /// The cheapest member that reaches the target in all quantities, and its time \[s\].
    pub cheapest_for_all: Option<Cheapest>,
}

/// What is timed, in words.
pub(super) const TIMED: &str = "all steps of a run: pattern, ordering, search for contacts, assembly, factorisation, solution; without reading the \
     scene, making the mesh and writing the summary";

/// Spread of repeated times.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Noise {
    /// Median over the members.
    pub median: f64,
    /// Largest.
    pub largest: f64,
}

/// How a member ended.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case", tag = "state", content = "reason")]
pub enum MemberStatus {
    /// All its runs gave results.
    Done,
    /// A run gave none, for this reason.
    Failed(String),
    /// It did not run: the study was stopped.
    NotRun,
}

impl MemberStatus {
    /// One word.
    #[must_use]
    pub fn word(&self) -> &'static str {
        match self {
            Self::Done => "done",
            Self::Failed(_) => "failed",
            Self::NotRun => "not run",
        }
    }

    /// Why it failed.
    #[must_use]
    pub fn reason(&self) -> &str {
        match self {
            Self::Failed(reason) => reason,
            _ => "",
        }
    }
}

/// Times of repeated runs \[s\].
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Times {
    /// Smallest: the figure that counts.
    pub min: f64,
    /// Median.
    pub median: f64,
    /// Largest.
    pub max: f64,
    /// One per run.
    pub all: Vec<f64>,
}

impl Times {
    /// `None` without a run.
    pub(super) fn of(all: Vec<f64>) -> Option<Self> {
        let mut sorted = all.clone();
        sorted.sort_by(f64::total_cmp);
        let (min, max) = (*sorted.first()?, *sorted.last()?);
        let middle = sorted.len() / 2;
        let median = if sorted.len() % 2 == 1 { sorted[middle] } else { 0.5 * (sorted[middle - 1] + sorted[middle]) };
        Some(Self { min, median, max, all })
    }
}

/// Sizes and counts of a member.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Counts {
    /// Elements.
    pub elements: u64,
    /// Nodes.
    pub nodes: u64,
    /// Unknowns.
    pub unknowns: u64,
    /// Converged increments.
    pub increments: u64,
    /// Newton iterations.
    pub iterations: u64,
    /// Failed attempts.
    pub cutbacks: u64,
    /// Converged increments whose tangent has negative pivots: members may then follow different branches.
    pub unstable_increments: u64,
}

/// A member.
#[derive(Clone, Debug, Serialize)]
pub struct MemberReport {
    /// Series and level.
    pub name: String,
    /// Its series.
    pub series: String,
    /// Level, from 1 (coarse).
    pub level: usize,
    /// What it sets in the scene.
    pub settings: BTreeMap<String, Json>,
    /// Size of what is refined, if the series gives one.
    pub size: Option<f64>,
    /// Folder of its runs.
    pub folder: String,
    /// How it ended.
    pub status: MemberStatus,
    /// Sizes and counts.
    pub counts: Option<Counts>,
    /// Times that are compared.
    pub time: Option<Times>,
    /// Wall-clock times.
    pub wall: Option<Times>,
    /// Largest resident memory of its process, the largest over its runs \[MB\].
    pub memory_mb: Option<f64>,
    /// One per quantity.
    pub values: Vec<ValueReport>,
}

/// What a member gives for a quantity.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ValueReport {
    /// The number.
    pub value: Option<f64>,
    /// |value - reference|/|reference|; none for the reference itself.
    pub error: Option<f64>,
    /// Whether no other member is both faster and better.
    pub on_front: bool,
    /// Whether the others are compared with this one.
    pub is_reference: bool,
    /// Why there is no number.
    pub missing: Option<String>,
}

/// A series.
#[derive(Clone, Debug, Serialize)]
pub struct SeriesReport {
    /// Its name.
    pub name: String,
    /// Indices of its members, from coarse to fine.
    pub members: Vec<usize>,
    /// Whether sizes are "given" or "unknowns^(-1/3)".
    pub sizes_from: &'static str,
    /// Sizes of its levels; none of a level that failed.
    pub sizes: Vec<Option<f64>>,
}

/// A quantity.
#[derive(Clone, Debug, Serialize)]
pub struct QuantityReport {
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// What members are compared with.
    pub reference: Option<ReferenceReport>,
    /// Orders between levels, per series.
    pub orders: Vec<Vec<Option<f64>>>,
    /// The Pareto front over time and error: indices of members by rising time.
    pub front: Vec<usize>,
    /// Time from which a series stays at or below the target, per series \[s\].
    pub time_at_target: Vec<Option<CostAt>>,
    /// Times of pairs of series at equal error.
    pub pairs: Vec<Pair>,
    /// The cheapest member at or below the target.
    pub cheapest: Option<Cheapest>,
    /// The smallest error there is, and whose.
    pub best: Option<Best>,
}

/// What members are compared with.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReferenceReport {
    /// Its kind, as it came to be.
    pub kind: ReferenceKind,
    /// The number.
    pub value: f64,
    /// The member it is.
    pub member: Option<usize>,
    /// Order of the extrapolation.
    pub order: Option<f64>,
    /// What is to be known of it.
    pub note: Option<String>,
}

/// Two series at equal error: what the first needs over what the second needs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Pair {
    /// Index of the series that costs more.
    pub slower: usize,
    /// Index of the other.
    pub faster: usize,
    /// Time of the first over that of the second at the smallest error that the finest levels of both reach.
    pub common: Ratio,
    /// That error.
    pub common_error: f64,
    /// The same at the target, where something can be said of it.
    pub at_target: Option<Ratio>,
}

/// The cheapest member that reaches the target.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Cheapest {
    /// Index of the member.
    pub member: usize,
    /// Its time \[s\].
    pub time: f64,
    /// Its error, the largest of all quantities where several are meant.
    pub error: f64,
    /// Whether a finer level of its series misses the target again: it may be good by chance.
    pub by_chance: bool,
}

/// The smallest error.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Best {
    /// Index of the member.
    pub member: usize,
    /// Its error.
    pub error: f64,
}
