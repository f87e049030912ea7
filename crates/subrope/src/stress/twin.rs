//! The same problem in other numbers.

use std::fmt;

use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::UnitError;
use super::units::in_other_units;
use crate::scene::Scene;

/// How the second run of a member differs: every length of the scene times `length`, every stress times `stress`, forces,
/// moments and energies as follows from both, and all coordinates moved by `shift`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Twin {
    /// Factor on lengths \[-\].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub length: f64,
    /// Factor on stresses and moduli \[-\].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub stress: f64,
    /// Where the origin goes \[mm\], after the change of lengths.
    pub shift: [f64; 3],
}

impl Default for Twin {
    fn default() -> Self {
        Self { length: 1000.0, stress: 1000.0, shift: [0.0; 3] }
    }
}

impl Twin {
    /// Nothing changed.
    pub const NONE: Self = Self { length: 1.0, stress: 1.0, shift: [0.0; 3] };

    /// Factor on forces \[-\].
    #[must_use]
    pub fn force(&self) -> f64 {
        self.stress * self.length * self.length
    }

    /// Factor on energies and moments \[-\].
    #[must_use]
    pub fn energy(&self) -> f64 {
        self.force() * self.length
    }

    /// The vector of the shift \[mm\].
    #[must_use]
    pub fn shift(&self) -> Vector3<f64> {
        Vector3::from(self.shift)
    }

    /// The scene in these units; points of ends and rigid bodies are moved with the mesh.
    ///
    /// # Errors
    /// [`UnitError`] when a number of the scene has no unit that is known.
    pub fn of(&self, scene: &Scene) -> Result<Scene, UnitError> {
        let mut scene = in_other_units(scene, self.length, self.stress)?;
        let ends = scene.end.iter_mut().filter_map(|end| end.point.as_mut());
        let points = ends.chain(scene.rigid.iter_mut().map(|rigid| &mut rigid.point));
        points.for_each(|point| point.iter_mut().zip(self.shift).for_each(|(x, by)| *x += by));
        Ok(scene)
    }
}

impl fmt::Display for Twin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut parts = Vec::new();
        if self.length != 1.0 {
            parts.push(format!("lengths x {:e}", self.length));
        }
        if self.stress != 1.0 {
            parts.push(format!("stresses x {:e}", self.stress));
        }
        if self.shift != [0.0; 3] {
            parts.push(format!("moved by {:e} mm", self.shift().norm()));
        }
        f.write_str(if parts.is_empty() { "unchanged".to_owned() } else { parts.join(", ") }.as_str())
    }
}
