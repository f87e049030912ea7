//! The JSON form: paths of single steps, with what was computed.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::error::{EntryFault, Place, PointError};
use crate::scene::Law;

/// A second-order tensor by rows \[-\].
pub type Tensor = [[f64; 3]; 3];

/// A file of paths. Keys not listed here are kept.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PathFile {
    /// Units of everything.
    #[serde(default = "text::units")]
    pub units: String,
    /// Order of vectors of six.
    #[serde(default = "text::voigt")]
    pub voigt: String,
    /// Order of the state.
    #[serde(default = "text::state")]
    pub state: String,
    /// Meaning of the frame.
    #[serde(default = "text::frame")]
    pub frame: String,
    /// How the numbers were computed.
    #[serde(default = "text::precision")]
    pub precision: String,
    /// Conventions of the law.
    #[serde(default = "text::conventions")]
    pub conventions: String,
    /// The paths.
    pub paths: Vec<PathRecord>,
    /// Other keys.
    #[serde(flatten)]
    pub other: Map<String, Value>,
}

/// Explanations that a written file carries.
pub(super) mod text {
    pub fn units() -> String {
        "MPa, mm, mJ/mm^3".to_owned()
    }
    pub fn voigt() -> String {
        "11,22,33,12,13,23; D=dS/dE with engineering shear".to_owned()
    }
    pub fn state() -> String {
        "DP1 DP2 gP2 gP3 kappa_t kappa_l d_t d_l".to_owned()
    }
    pub fn frame() -> String {
        "columns e1,e2,e3; C_fibre=(F R)^T(F R)".to_owned()
    }
    pub fn precision() -> String {
        format!("computed in double precision by subrope {}", env!("CARGO_PKG_VERSION"))
    }
    pub fn conventions() -> String {
        "comp_type 0 quadratic, 1 power, 2 lock-up; friction 0 = elastic only; W = elastic potential after the step"
            .to_owned()
    }
}

/// One path from one state. Keys not listed here are kept.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PathRecord {
    /// Name.
    #[serde(default)]
    pub name: String,
    /// Parameters of the law: `K_e K_ec w_e K_c nu comp_type K_p p_exp z_lock`, and per mode
    /// `K_t tau_t0 H_t mu_t` (`_l` likewise), `friction`; optional `X_t`, `H_inf_t`, `kappa_s_t` (`_l` likewise).
    #[serde(default)]
    pub params: Map<String, Value>,
    /// Columns e1, e2, e3, given by rows; the global frame when left out.
    #[serde(default = "identity")]
    pub frame: Tensor,
    /// State before the first step; zeros when left out.
    #[serde(default = "virgin")]
    pub state0: Vec<f64>,
    /// The steps.
    pub steps: Vec<StepRecord>,
    /// Other keys.
    #[serde(flatten)]
    pub other: Map<String, Value>,
    /// The law, when it does not come from `params`.
    #[serde(skip)]
    pub law: Option<Law>,
}

fn identity() -> Tensor {
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
}

fn virgin() -> Vec<f64> {
    vec![0.0; 8]
}

/// One step: a deformation (`F`; or `H`, or `modes`) and what was computed. Keys not listed here are kept.
#[allow(non_snake_case)] // the keys of the file
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct StepRecord {
    /// Deformation gradient, global frame \[-\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub F: Option<Tensor>,
    /// Displacement gradient `F - 1`, global frame \[-\]; it keeps the digits of a small strain and goes before `F`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub H: Option<Tensor>,
    /// Strain modes to be reached (elongation, compaction, D1, D2, g2, g3) \[-\], where neither `F` nor `H` is given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub modes: Option<[f64; 6]>,
    /// Right Cauchy-Green tensor, fibre frame \[-\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub C_fibre: Option<[f64; 6]>,
    /// Strain modes (elongation, compaction, D1, D2, g2, g3) \[-\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub I: Option<[f64; 6]>,
    /// Forces conjugate to the strain modes \[MPa\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub q: Option<[f64; 6]>,
    /// Compaction pressure \[MPa\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub p: Option<f64>,
    /// Stored energy after the step: elastic potential and back-stress energy \[mJ/mm^3\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub W: Option<f64>,
    /// Second Piola-Kirchhoff stress, fibre frame \[MPa\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub S_fibre: Option<[f64; 6]>,
    /// Second Piola-Kirchhoff stress, global frame \[MPa\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub S_global: Option<[f64; 6]>,
    /// Tangent dS/dE with engineering shear, fibre frame \[MPa\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub D_fibre: Option<[[f64; 6]; 6]>,
    /// The same by difference quotients \[MPa\], when asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub D_difference: Option<[[f64; 6]; 6]>,
    /// State after the step.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub state: Option<Vec<f64>>,
    /// Energy dissipated in the step by transverse and longitudinal sliding, end value \[mJ/mm^3\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dW_dissip: Option<[f64; 2]>,
    /// Whether the transverse and the longitudinal mode slid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slip: Option<[bool; 2]>,
    /// Other keys.
    #[serde(flatten)]
    pub other: Map<String, Value>,
}

/// Reads the JSON form. Errors name the path and the step.
pub(super) fn parse(file: &str, text: &str) -> Result<PathFile, PointError> {
    let json = |place: Place| move |source| PointError::Json { file: file.to_owned(), place: place.clone(), source };
    let mut whole: Map<String, Value> = serde_json::from_str(text).map_err(json(Place::default()))?;
    let listed = match whole.insert("paths".to_owned(), Value::Array(Vec::new())) {
        Some(Value::Array(listed)) => listed,
        Some(other) => return Err(json(Place::default())(serde::de::Error::custom(format!("`paths` is {}", kind(&other))))),
        None => return Err(json(Place::default())(serde::de::Error::missing_field("paths"))),
    };
    let mut paths: PathFile = serde_json::from_value(Value::Object(whole)).map_err(json(Place::default()))?;
    for (index, value) in listed.into_iter().enumerate() {
        paths.paths.push(parse_path(file, index, value)?);
    }
    Ok(paths)
}

fn parse_path(file: &str, index: usize, mut value: Value) -> Result<PathRecord, PointError> {
    let name = value.get("name").and_then(Value::as_str).unwrap_or_default().to_owned();
    let place = |step| Place { path: Some(index), name: name.clone(), step };
    let fault = |step: Option<usize>| {
        let place = place(step);
        move |source| PointError::Json { file: file.to_owned(), place, source }
    };
    let steps = match value.get_mut("steps").map(Value::take) {
        Some(Value::Array(steps)) => steps,
        _ => return Err(fault(None)(serde::de::Error::custom("the path needs a list `steps`"))),
    };
    if let Some(entry) = value.get_mut("steps") {
        *entry = Value::Array(Vec::new());
    }
    let mut path: PathRecord = serde_json::from_value(value).map_err(fault(None))?;
    for (step, value) in steps.into_iter().enumerate() {
        path.steps.push(serde_json::from_value(value).map_err(fault(Some(step)))?);
    }
    if path.state0.len() != 8 {
        let fault = EntryFault::State { found: path.state0.len() };
        return Err(PointError::Entry { file: file.to_owned(), place: place(None), fault });
    }
    Ok(path)
}

fn kind(value: &Value) -> &'static str {
    match value {
        Value::Null => "null, not a list",
        Value::Bool(_) => "true or false, not a list",
        Value::Number(_) => "a number, not a list",
        Value::String(_) => "a string, not a list",
        Value::Array(_) => "a list",
        Value::Object(_) => "an object, not a list",
    }
}
