//! A scene in other units: every number by the unit that its key has in the schema.
//!
//! The documentation of a numeric key names its unit in brackets, a test sees to that. Lengths are multiplied by one
//! factor and stresses by another; forces, energies and everything else follow from both. Masses stay as they are.

use serde_json::Value as Json;

use crate::scene::Scene;

/// Why a scene cannot be written in other units.
#[derive(Debug, thiserror::Error)]
pub enum UnitError {
    /// A number whose key has no unit, or one that is not known.
    #[error("`{key}` has no unit in its description that is known")]
    NoUnit {
        /// The key.
        key: String,
    },
    /// The scene is none any more.
    #[error("in other units it is no scene: {0}")]
    Scene(#[from] serde_json::Error),
}

/// The scene with every length times `length` and every stress times `stress`.
///
/// # Errors
/// [`UnitError`].
pub fn in_other_units(scene: &Scene, length: f64, stress: f64) -> Result<Scene, UnitError> {
    let schema = Scene::schema();
    let mut value = serde_json::to_value(scene)?;
    let walk = Walk { root: &schema, length, stress };
    walk.value(&mut value, &schema, &Key { name: String::new(), factor: None })?;
    Ok(serde_json::from_value(value)?)
}

/// A key and the factor of its unit.
struct Key {
    name: String,
    factor: Option<f64>,
}

struct Walk<'a> {
    root: &'a Json,
    length: f64,
    stress: f64,
}

impl<'a> Walk<'a> {
    fn value(&self, value: &mut Json, schema: &'a Json, key: &Key) -> Result<(), UnitError> {
        let schema = self.fitting(value, schema);
        match value {
            Json::Number(number) if number.is_f64() => {
                let factor = key.factor.ok_or_else(|| UnitError::NoUnit { key: key.name.clone() })?;
                *value = Json::from(number.as_f64().unwrap_or_default() * factor);
                Ok(())
            }
            Json::Array(items) => self.list(items, schema, key),
            Json::Object(entries) => {
                let control = entries.get("of").and_then(Json::as_str).map(str::to_owned);
                for (name, entry) in entries.iter_mut() {
                    self.entry(entry, schema, name, control.as_deref())?;
                }
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn entry(&self, value: &mut Json, table: &'a Json, name: &str, control: Option<&str>) -> Result<(), UnitError> {
        let properties = table.get("properties").and_then(|p| p.get(name));
        let Some(own) = properties.or_else(|| table.get("additionalProperties")) else { return Ok(()) };
        let factor = match (name, control) {
            // Bounds of cycles are what their control says.
            ("low" | "high", Some("force")) => Some(self.stress * self.length * self.length),
            ("low" | "high", Some(_)) => Some(1.0),
            // The one entry of a tagged value is described where its tag is.
            _ => self.factor_of(own).or_else(|| self.factor_of(table)),
        };
        self.value(value, own, &Key { name: name.to_owned(), factor })
    }

    /// Of pairs (fraction of the step, value) only the second has the unit of the key.
    fn list(&self, items: &mut [Json], schema: &'a Json, key: &Key) -> Result<(), UnitError> {
        let inner = schema.get("items").unwrap_or(&Json::Null);
        let described = schema.get("description").and_then(Json::as_str).unwrap_or_default();
        if described.starts_with("Pairs [fraction") {
            let mut pairs = items.iter_mut().filter_map(|pair| pair.get_mut(1));
            return pairs.try_for_each(|second| self.value(second, &Json::Null, key));
        }
        items.iter_mut().try_for_each(|item| self.value(item, inner, key))
    }

    /// The schema itself, or that of its alternatives which fits the value.
    fn fitting(&self, value: &Json, schema: &'a Json) -> &'a Json {
        let target = schema.get("$ref").and_then(Json::as_str).and_then(|r| r.strip_prefix('#'));
        let schema = target.and_then(|pointer| self.root.pointer(pointer)).unwrap_or(schema);
        let listed = schema.get("oneOf").or_else(|| schema.get("anyOf")).and_then(Json::as_array);
        let Some(alternatives) = listed else { return schema };
        let mut resolved = alternatives.iter().map(|alternative| self.fitting(value, alternative));
        resolved.find(|alternative| fits(value, alternative)).unwrap_or(schema)
    }

    fn factor_of(&self, schema: &Json) -> Option<f64> {
        self.factor_in(schema.get("description")?.as_str()?)
    }

    /// Factor of the first unit in brackets that is known.
    fn factor_in(&self, text: &str) -> Option<f64> {
        let mut brackets = text.split('[').skip(1).filter_map(|rest| rest.split_once(']'));
        brackets.find_map(|(unit, _)| self.factor(unit.trim()))
    }

    /// Factor of a unit such as "N s/mm^4".
    fn factor(&self, unit: &str) -> Option<f64> {
        let mut sides = unit.split('/');
        let above = self.product(sides.next()?)?;
        let below = sides.next().map_or(Some(1.0), |side| self.product(side))?;
        sides.next().is_none().then_some(above / below)
    }

    fn product(&self, units: &str) -> Option<f64> {
        units.split_whitespace().try_fold(1.0, |product, word| {
            let (name, power) = match word.split_once('^') {
                Some((name, power)) => (name, power.parse().ok()?),
                None => (word, 1),
            };
            let factor: f64 = match name {
                "mm" | "m" => self.length,
                "MPa" => self.stress,
                "N" => self.stress * self.length * self.length,
                "mJ" => self.stress * self.length.powi(3),
                "tex" | "dtex" => 1.0 / self.length,
                "-" | "1" | "s" | "K" | "degrees" | "rad" | "kg" => 1.0,
                _ => return None,
            };
            Some(product * factor.powi(power))
        })
    }
}

/// Whether a value is of the type that a schema without alternatives describes.
fn fits(value: &Json, schema: &Json) -> bool {
    let has_type = |name: &str| match schema.get("type") {
        Some(Json::String(one)) => one == name,
        Some(Json::Array(several)) => several.iter().any(|s| s == name),
        _ => false,
    };
    match value {
        Json::Null => has_type("null"),
        Json::Bool(_) => has_type("boolean"),
        Json::Number(_) => has_type("number") || has_type("integer"),
        Json::String(_) => has_type("string"),
        Json::Array(_) => has_type("array"),
        Json::Object(entries) => {
            let property = |key: &String| schema.get("properties").and_then(|p| p.get(key));
            let agrees = |(key, entry): (&String, &Json)| {
                property(key).is_some_and(|own| own.get("const").is_none_or(|constant| constant == entry))
            };
            has_type("object") && entries.iter().all(agrees)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: &str = r#"
        title = "x"
        [strand]
        radius = 2.0
        length = 20.0
        pitch = 30.0
        mesh = { core = 2, rings = 1, layers = 4 }
        [law]
        kind = "bundle"
        K_e = 2000.0
        K_ec = 100.0
        w_e = 0.005
        nu = 0.5
        K_c = 60.0
        K_t = 15.0
        tau_t = 0.05
        K_l = 20.0
        tau_l = 1.0
        mu_l = 0.1
        [[end]]
        name = "END_A"
        [[end]]
        name = "END_B"
        point = [0.0, 0.0, 12.0]
        [[rigid]]
        name = "ROD"
        shape = "cylinder"
        point = [5.0, 0.0, 0.0]
        axis = [0.0, 1.0, 0.0]
        radius = 3.0
        [[contact]]
        name = "rod"
        primary = "ROD"
        secondary = "LATERAL"
        penalty = 50.0
        [[step]]
        name = "bend"
        bend = { angle = 20.0 }
        [[step]]
        name = "pull"
        duration = 2.0
        prescribe = [{ point = "END_B", ux = 3.0, uz = [[0.5, 1.0], [1.0, 2.0]], ry = 4.0, rz = "free" }]
        [[step]]
        name = "push"
        traction = [{ surface = "LATERAL", tx = 0.25 }]
        nodal_force = [{ set = "AXIS", fx = 7.0 }]
        [[step]]
        name = "cycles"
        prescribe = [{ point = "END_B", rz = "free" }]
        cycles = { count = 2, of = "force", low = 1.0, high = 10.0 }
        [solver]
        stabilisation = { viscosity = 1e-3 }
    "#;

    #[test]
    fn every_number_goes_by_its_unit() {
        let scene = Scene::from_toml("t", SCENE).unwrap();
        let twin = in_other_units(&scene, 10.0, 1e3).unwrap();
        let (a, b) = (serde_json::to_value(&scene).unwrap(), serde_json::to_value(&twin).unwrap());
        let ratio = |pointer: &str| {
            let number = |v: &Json| v.pointer(pointer).and_then(Json::as_f64).unwrap_or_else(|| panic!("{pointer}"));
            number(&b) / number(&a)
        };
        for (pointer, expected) in [
            ("/strand/radius", 10.0),
            ("/strand/pitch", 10.0),
            ("/strand/mesh/layers", 1.0),
            ("/strand/mesh/core_fraction", 1.0),
            ("/law/K_e", 1e3),
            ("/law/w_e", 1.0),
            ("/law/tau_l", 1e3),
            ("/law/mu_l", 1.0),
            ("/end/1/point/2", 10.0),
            ("/rigid/0/radius", 10.0),
            ("/rigid/0/point/0", 10.0),
            ("/rigid/0/axis/1", 1.0),
            ("/contact/0/penalty", 1e2),
            ("/step/0/bend/angle", 1.0),
            ("/step/1/duration", 1.0),
            ("/step/1/prescribe/0/ux", 10.0),
            ("/step/1/prescribe/0/uz/0/0", 1.0),
            ("/step/1/prescribe/0/uz/0/1", 10.0),
            ("/step/1/prescribe/0/ry", 1.0),
            ("/step/2/traction/0/tx", 1e3),
            ("/step/2/nodal_force/0/fx", 1e5),
            ("/step/3/cycles/high", 1e5),
            ("/solver/stabilisation/viscosity", 10.0),
            ("/solver/residual_tolerance", 1.0),
            ("/temperature", 1.0),
        ] {
            let found = ratio(pointer);
            assert!((found / expected - 1.0).abs() < 1e-14, "{pointer}: {found} instead of {expected}");
        }
    }

    /// Whatever a shipped scene holds has a unit.
    #[test]
    fn all_shipped_scenes_have_units() {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("templates");
        let mut count = 0;
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let text = std::fs::read_to_string(&path).unwrap();
            let scene = Scene::from_toml("t", &text).unwrap();
            let same = in_other_units(&scene, 1.0, 1.0).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
            assert_eq!(same, scene);
            count += 1;
        }
        assert!(count > 10);
    }
}
