//! A point at which a run failed, as a file: `failed_point.toml`, written by a run and asked again by `subrope point`.

use nalgebra::Matrix3;
use serde::{Deserialize, Serialize};
use subrope_fem::solid::FailedPoint;
use subrope_material::LawError;

use super::PointError;
use super::record::Tensor;
use crate::document::{Document, ProblemKind};
use crate::law;
use crate::scene::Law;

/// A point of a run at which the law gave no answer, with everything it was asked. Numbers are the shortest decimals that
/// give the same double back.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FailedPointFile {
    /// Title of the scene.
    pub title: String,
    /// Where and when.
    pub failure: Failure,
    /// What the law was asked.
    pub asked: Asked,
    /// The law, as in the scene.
    pub law: Law,
}

/// Where and when a law gave no answer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Failure {
    /// What the run said of it.
    pub message: String,
    /// Label of the element.
    pub element: u64,
    /// Integration point, from 0.
    pub point: usize,
    /// Strand of a rope, from 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub strand: Option<u32>,
    /// Number of the step, from 1; every half cycle is one.
    pub step: usize,
    /// Number of the increment in the run, from 1.
    pub increment: usize,
    /// Time at the committed state \[s\].
    pub time: f64,
}

/// What the law was asked. Tensors stand by rows in the fibre frame.
#[allow(non_snake_case)] // the symbols of the formulas
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Asked {
    /// Displacement gradient `F - 1` of the trial, as the element gave it to the law: what it averages included \[-\].
    pub H: Tensor,
    /// Displacement gradient `F - 1` of the point at the committed state \[-\].
    pub H_committed: Tensor,
    /// Mean elongation in place of the point's own \[-\], where the element averages it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mean_elongation: Option<f64>,
    /// Fibre frame: the columns e1 (the fibre), e2, e3 by rows \[-\].
    pub frame: Tensor,
    /// Committed state of the law.
    pub state: Vec<f64>,
    /// Length of the time increment \[s\].
    pub time_increment: f64,
    /// Temperature \[K\].
    pub temperature: f64,
}

impl Asked {
    /// From what the kernel tells.
    #[must_use]
    pub fn of(point: &FailedPoint) -> Self {
        Self {
            H: rows(&point.gradient),
            H_committed: rows(&point.committed_gradient),
            mean_elongation: point.mean_elongation,
            frame: rows(&point.frame),
            state: point.state.clone(),
            time_increment: point.time_increment,
            temperature: point.temperature,
        }
    }

    fn point(&self) -> FailedPoint {
        FailedPoint {
            gradient: matrix(&self.H),
            mean_elongation: self.mean_elongation,
            committed_gradient: matrix(&self.H_committed),
            frame: matrix(&self.frame),
            state: self.state.clone(),
            time_increment: self.time_increment,
            temperature: self.temperature,
        }
    }
}

impl FailedPointFile {
    /// Reads the text of such a file; `None` when it is a file of paths. `name` is what errors call it.
    ///
    /// # Errors
    /// [`PointError::Invalid`] with the place of what is wrong.
    pub fn from_toml(name: &str, text: &str) -> Result<Option<Self>, PointError> {
        let document = Document::parse(name, text)?;
        if document.root().get("failure").is_none() {
            return Ok(None);
        }
        let invalid = |error: toml::de::Error| {
            let kind = ProblemKind::Syntax { message: error.message().to_owned() };
            let span = error.span().unwrap_or(0..0);
            let problem = document.problem_at(span, kind).help("failed points are written by `subrope run`");
            PointError::from(document.invalid(vec![problem]))
        };
        Ok(Some(toml::from_str(text).map_err(invalid)?))
    }

    /// As text.
    ///
    /// # Errors
    /// What the writer of TOML says.
    pub fn to_toml(&self) -> Result<String, toml::ser::Error> {
        let note = "# A point at which the law gave no answer. `subrope point` asks it the same again.\n";
        Ok(note.to_owned() + &toml::to_string(self)?)
    }

    /// Asks the law the same again, and tells what it answers: on the same processor the same bits.
    ///
    /// # Errors
    /// [`PointError::Failed`] when it has no answer again.
    pub fn replay(&self) -> Result<String, PointError> {
        let Failure { element, point, .. } = self.failure;
        self.ask().map_err(|source| PointError::Failed { element, point, source })?;
        Ok(format!(
            "element {element}, integration point {point}: the law has an answer here; the run said: {}\n",
            self.failure.message
        ))
    }

    /// With the type of law that an element has: the same instructions.
    fn ask(&self) -> Result<(), LawError> {
        let point = self.asked.point();
        match &self.law {
            Law::Bundle(parameters) => point.ask(&law::bundle(parameters)?),
            Law::Orthotropic(parameters) => point.ask(&law::orthotropic(parameters)?),
            other => point.ask(&law::build(other)?),
        }
    }
}

fn rows(matrix: &Matrix3<f64>) -> Tensor {
    std::array::from_fn(|i| std::array::from_fn(|j| matrix[(i, j)]))
}

fn matrix(rows: &Tensor) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| rows[i][j])
}
