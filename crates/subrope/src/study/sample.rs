//! What one run of a member gave.

use std::path::Path;

use serde_json::Value as Json;
use subrope_io::{History, read_history};

/// Numbers of one run.
#[derive(Clone, Debug)]
pub(super) struct Sample {
    /// The summary.
    pub summary: Json,
    /// The history.
    pub history: History,
}

impl Sample {
    /// Reads the folder of a run that has ended well.
    pub fn read(folder: &Path) -> Result<Self, String> {
        let path = folder.join("summary.json");
        let text = std::fs::read_to_string(&path).map_err(|e| format!("cannot read {}: {e}", path.display()))?;
        let summary: Json = serde_json::from_str(&text).map_err(|e| format!("{}: {e}", path.display()))?;
        let state = summary.pointer("/status/state").and_then(Json::as_str).unwrap_or_default();
        if state != "done" {
            let cause = summary.pointer("/status/cause").and_then(Json::as_str).unwrap_or(state);
            return Err(cause.to_owned());
        }
        let history = read_history(&folder.join("history.csv")).map_err(|e| e.to_string())?;
        Ok(Self { summary, history })
    }

    /// Reads an earlier run, if it is one of this scene by this version of the program.
    pub fn read_again(folder: &Path, scene_hash: &str) -> Option<Self> {
        let sample = Self::read(folder).ok()?;
        let says = |key: &str| sample.summary.get(key).and_then(Json::as_str);
        let same = says("scene_hash") == Some(scene_hash) && says("version") == Some(env!("CARGO_PKG_VERSION"));
        same.then_some(sample)
    }

    fn number(&self, pointer: &str) -> Option<f64> {
        self.summary.pointer(pointer).and_then(Json::as_f64)
    }

    /// CPU time of the solution \[s\], where the system tells it.
    pub fn cpu(&self) -> Option<f64> {
        self.number("/seconds/solving_cpu")
    }

    /// Wall-clock time of the solution \[s\].
    pub fn wall(&self) -> Option<f64> {
        self.number("/seconds/solving")
    }

    /// Largest resident memory \[MB\].
    pub fn memory(&self) -> Option<f64> {
        self.number("/peak_memory_mb")
    }

    /// A count of the summary.
    pub fn count(&self, pointer: &str) -> u64 {
        self.summary.pointer(pointer).and_then(Json::as_u64).unwrap_or_default()
    }
}
