//! The TOML form: a law, a fibre direction and targets.

use nalgebra::{Matrix3, Rotation3, Vector3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use subrope_material::StrainModes;

use super::record::{PathFile, PathRecord, StepRecord, Tensor, text};
use super::{Params, Place, PointError, displacement_gradient_of, parameters};
use crate::document::{self, Document, Location, Problem, ProblemKind};
use crate::scene::{Law, check_law};
use crate::{estimate, law};

/// A path of one material point, for people.
///
/// ```toml
/// title = "Shear loop"
/// cycles = 3
/// fibre = [0.0, 0.0, 1.0]
/// [law]
/// kind = "bundle"
/// # ...
/// [[path]]
/// modes = [0.0, 0.0, 0.0, 0.0, 0.5, 0.0]
/// steps = 20
/// [[path]]
/// modes = [0.0, 0.0, 0.0, 0.0, -0.5, 0.0]
/// steps = 40
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PathScene {
    /// What the path shows, in one line.
    #[schemars(length(min = 1))]
    pub title: String,
    /// Sources, assumptions, remarks.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub notes: Option<String>,
    /// The law of the material, as in a scene.
    pub law: Law,
    /// Fibre direction \[-\], along x when left out; need not be of unit length.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fibre: Option<[f64; 3]>,
    /// Fibre frame in place of `fibre`: a rotation with the columns e1 (the fibre), e2, e3, given by rows \[-\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frame: Option<Tensor>,
    /// How often the targets are gone through \[-\].
    #[serde(default = "once")]
    #[schemars(range(min = 1))]
    pub cycles: usize,
    /// The targets, reached one after the other from rest; at least one.
    #[schemars(length(min = 1))]
    pub path: Vec<Target>,
}

fn once() -> usize {
    1
}

/// A deformation to be reached in equal steps: one of `H`, `F`, `modes`. Between two targets given by `modes` the modes
/// are interpolated linearly, otherwise the displacement gradient.
#[allow(non_snake_case)] // the symbols of the formulas
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Target {
    /// Displacement gradient `F - 1` by rows, global frame \[-\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub H: Option<Tensor>,
    /// Deformation gradient by rows, global frame \[-\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub F: Option<Tensor>,
    /// Strain modes (elongation, compaction, D1, D2, g2, g3), fibre frame \[-\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub modes: Option<[f64; 6]>,
    /// Number of equal steps to the target \[-\].
    #[serde(default = "once")]
    #[schemars(range(min = 1))]
    pub steps: usize,
}

/// Memory of a step with everything computed, and of its line of text \[bytes\].
const STEP_BYTES: f64 = (size_of::<StepRecord>() + 2000) as f64;

/// Where a path stands: modes as long as targets are given by modes.
#[derive(Clone, Copy, Debug)]
enum Standing {
    Modes([f64; 6]),
    Gradient(Matrix3<f64>),
}

impl PathScene {
    /// The JSON schema (draft 2020-12) of the TOML form.
    #[must_use]
    pub fn schema() -> serde_json::Value {
        document::schema_of::<Self>()
    }

    /// Reads and checks the text of a path; `name` is what errors call it.
    ///
    /// # Errors
    /// [`PointError::Invalid`] with all problems found.
    pub fn from_toml(name: &str, text: &str) -> Result<Self, PointError> {
        let (scene, document) = document::read::<Self>(name, text)?;
        document.reject(scene.check(&document))?;
        Ok(scene)
    }

    fn check(&self, document: &Document) -> Vec<Problem> {
        let mut problems = check_law(&self.law, document);
        let mut report = |at: Location, cause: &str, help: &str| {
            let kind = ProblemKind::Inconsistent { cause: cause.to_owned() };
            problems.push(document.problem(&at, kind).help(help));
        };
        let top = Location::root();
        if self.fibre == Some([0.0; 3]) {
            report(top.at("fibre"), "`fibre` is a direction and cannot be zero", "for example [0.0, 0.0, 1.0]");
        }
        if self.fibre.is_some() && self.frame.is_some() {
            report(top.at("frame"), "`fibre` and `frame` exclude each other", "give one of the two");
        }
        let (steps, most) = (self.steps(), estimate::limit() / STEP_BYTES);
        if steps > most {
            let cause = format!(
                "{steps} steps take {:.3e} GB, and {:.1} GB of memory are left",
                steps * STEP_BYTES / 1e9,
                most * STEP_BYTES / 1e9
            );
            report(top.at("cycles"), &cause, "fewer `cycles`, or fewer `steps` to the targets");
        }
        for (index, target) in self.path.iter().enumerate() {
            let given = [target.H.is_some(), target.F.is_some(), target.modes.is_some()];
            if given.iter().filter(|g| **g).count() != 1 {
                report(top.at("path").at(index), "a target has exactly one of `H`, `F`, `modes`", "");
            }
        }
        problems
    }

    /// Number of single steps, as a real number: the product may be beyond what integers hold.
    #[must_use]
    pub fn steps(&self) -> f64 {
        self.cycles as f64 * self.path.iter().map(|target| target.steps as f64).sum::<f64>()
    }

    /// The same as single steps.
    ///
    /// # Errors
    /// [`PointError::Law`] when a deformation that turns matter inside out is to be interpolated in modes.
    pub fn path_file(&self, name: &str) -> Result<PathFile, PointError> {
        let frame = self.rotation();
        let mut steps = Vec::new();
        let mut standing = Standing::Modes([0.0; 6]);
        for target in std::iter::repeat_n(&self.path, self.cycles).flatten() {
            standing = target.approach(standing, &frame, &mut steps).map_err(|source| {
                let (file, step) = (name.to_owned(), Some(steps.len()));
                PointError::Law {
                    place: Box::new(Place { file, path: Some(0), name: self.title.clone(), step }),
                    source,
                }
            })?;
        }
        let record = PathRecord {
            name: self.title.clone(),
            params: self.params(),
            frame: std::array::from_fn(|i| std::array::from_fn(|j| frame[(i, j)])),
            state0: vec![0.0; 8],
            steps,
            other: serde_json::Map::new(),
            law: Some(self.law.clone()),
        };
        Ok(PathFile {
            units: text::units(),
            voigt: text::voigt(),
            state: text::state(),
            frame: text::frame(),
            precision: text::precision(),
            conventions: text::conventions(),
            paths: vec![record],
            other: serde_json::Map::new(),
        })
    }

    /// The law's parameters in the keys of the JSON form; other laws in those of a scene.
    fn params(&self) -> Params {
        match &self.law {
            Law::Bundle(bundle) => parameters::write(&law::bundle_parameters(bundle)),
            other => match serde_json::to_value(other) {
                Ok(serde_json::Value::Object(map)) => map.into_iter().collect(),
                _ => Params::default(),
            },
        }
    }

    /// Columns e1, e2, e3; from a direction, the shortest rotation of x onto it.
    fn rotation(&self) -> Matrix3<f64> {
        if let Some(rows) = &self.frame {
            return Matrix3::from_fn(|i, j| rows[i][j]);
        }
        let along = Vector3::from(self.fibre.unwrap_or([1.0, 0.0, 0.0]));
        let rotation = Rotation3::rotation_between(&Vector3::x(), &along);
        // Only the opposite of x has no shortest rotation.
        rotation.unwrap_or_else(|| Rotation3::from_axis_angle(&Vector3::z_axis(), std::f64::consts::PI)).into_inner()
    }
}

impl Target {
    /// Appends the steps from where the path stands to the target.
    fn approach(
        &self,
        from: Standing,
        frame: &Matrix3<f64>,
        steps: &mut Vec<StepRecord>,
    ) -> Result<Standing, subrope_material::LawError> {
        let fraction = |index: usize| (index + 1) as f64 / self.steps as f64;
        if let Some(to) = self.modes {
            let from = from.modes(frame)?;
            steps.extend((0..self.steps).map(|index| {
                let t = fraction(index);
                let modes = std::array::from_fn(|i| if t < 1.0 { from[i] + t * (to[i] - from[i]) } else { to[i] });
                StepRecord { modes: Some(modes), ..StepRecord::default() }
            }));
            return Ok(Standing::Modes(to));
        }
        let from = from.gradient(frame);
        let to = self.gradient();
        steps.extend((0..self.steps).map(|index| {
            let t = fraction(index);
            let h = if t < 1.0 { from + t * (to - from) } else { to };
            let rows = std::array::from_fn(|i| std::array::from_fn(|j| h[(i, j)]));
            StepRecord { H: Some(rows), ..StepRecord::default() }
        }));
        Ok(Standing::Gradient(to))
    }

    fn gradient(&self) -> Matrix3<f64> {
        match (&self.H, &self.F) {
            (Some(h), _) => Matrix3::from_fn(|i, j| h[i][j]),
            (None, Some(f)) => Matrix3::from_fn(|i, j| f[i][j]) - Matrix3::identity(),
            (None, None) => Matrix3::zeros(),
        }
    }
}

impl Standing {
    fn modes(&self, frame: &Matrix3<f64>) -> Result<[f64; 6], subrope_material::LawError> {
        match self {
            Self::Modes(modes) => Ok(*modes),
            Self::Gradient(gradient) => {
                let modes = StrainModes::from_displacement_gradient(&(frame.tr_mul(gradient) * frame))?;
                let ([d1, d2], [g2, g3]) = (modes.distortion, modes.longitudinal_shear);
                Ok([modes.elongation, modes.compaction, d1, d2, g2, g3])
            }
        }
    }

    fn gradient(&self, frame: &Matrix3<f64>) -> Matrix3<f64> {
        match self {
            Self::Modes(modes) => frame * displacement_gradient_of(modes) * frame.transpose(),
            Self::Gradient(gradient) => *gradient,
        }
    }
}
