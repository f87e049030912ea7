//! The JSON form: paths of single steps, with what was computed.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::error::PointError;
use super::list;
use super::parameters::Params;
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
    #[serde(deserialize_with = "list::paths")]
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
    pub params: Params,
    /// Columns e1, e2, e3, given by rows; the global frame when left out.
    #[serde(default = "identity")]
    pub frame: Tensor,
    /// State before the first step; zeros when left out.
    #[serde(default = "virgin")]
    pub state0: Vec<f64>,
    /// The steps.
    #[serde(deserialize_with = "list::steps")]
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

/// Reads the JSON form; `file` is what errors call it.
///
/// # Errors
/// [`PointError::Json`] with the path and the step, line and column.
pub fn parse(file: &str, text: &str) -> Result<PathFile, PointError> {
    serde_json::from_str(text).map_err(|source| PointError::Json { file: file.to_owned(), source })
}
