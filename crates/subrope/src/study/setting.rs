//! Settings: keys of a scene by their path, and the values a study gives them.

use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;

use crate::document::{Location, Segment};

/// Any value of a scene.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(transparent)]
pub struct Setting(pub toml::Value);

impl JsonSchema for Setting {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Setting".into()
    }

    /// The scene's own schema decides.
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "description": "Any value that the scene takes there" })
    }
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.0 {
            toml::Value::String(text) => f.write_str(text),
            other => other.fmt(f),
        }
    }
}

/// Most keys and indices of a path: no scene is nested as deeply.
const DEEPEST: usize = 32;

/// Why a setting cannot be put into a scene.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SettingFault {
    /// The path cannot be read.
    #[error("\"{path}\" is no path of keys")]
    Path {
        /// As written.
        path: String,
    },
    /// A key is asked of what has none.
    #[error("`{place}` of the scene is no table: it has no key `{key}`")]
    NoTable {
        /// What stands there.
        place: String,
        /// The key.
        key: String,
    },
    /// An entry is asked of what is no list.
    #[error("`{place}` of the scene is no list")]
    NoList {
        /// What stands there.
        place: String,
    },
    /// The list is shorter.
    #[error("`{place}` of the scene has {count} entries, counted from 0: there is no [{index}]")]
    NoEntry {
        /// The list.
        place: String,
        /// The index asked for.
        index: usize,
        /// How many there are.
        count: usize,
    },
}

/// Keys and indices from the top of a scene, written `step[0].bend.angle`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KeyPath(Vec<Segment>);

impl KeyPath {
    /// Reads a path.
    ///
    /// # Errors
    /// [`SettingFault::Path`] for an empty key, a missing bracket or an index that is no number.
    pub fn parse(text: &str) -> Result<Self, SettingFault> {
        let wrong = || SettingFault::Path { path: text.to_owned() };
        let mut segments = Vec::new();
        for part in text.split('.') {
            let (key, indices) = part.split_once('[').map_or((part, None), |(key, rest)| (key, Some(rest)));
            if key.is_empty() || key.contains(|c: char| !(c.is_alphanumeric() || "_-".contains(c))) {
                return Err(wrong());
            }
            segments.push(Segment::from(key));
            for index in indices.iter().flat_map(|rest| rest.split('[')) {
                let index = index.strip_suffix(']').and_then(|i| i.parse::<usize>().ok()).ok_or_else(wrong)?;
                segments.push(Segment::from(index));
            }
        }
        if segments.len() > DEEPEST { Err(wrong()) } else { Ok(Self(segments)) }
    }

    /// Puts a value there; tables on the way are made where the scene has none.
    ///
    /// # Errors
    /// [`SettingFault`] where the scene has no such list, entry or table.
    pub fn put(&self, scene: &mut toml::Table, value: &toml::Value) -> Result<(), SettingFault> {
        let mut root = toml::Value::Table(std::mem::take(scene));
        let result = put(&mut root, &self.0, 0, value);
        if let toml::Value::Table(table) = root {
            *scene = table;
        }
        result
    }
}

fn put(place: &mut toml::Value, path: &[Segment], depth: usize, value: &toml::Value) -> Result<(), SettingFault> {
    let name = || path[..depth].iter().fold(Location::root(), |l, s| l.at(s.clone())).to_string();
    match (path.get(depth), place) {
        (None, place) => {
            *place = value.clone();
            Ok(())
        }
        (Some(Segment::Key(key)), toml::Value::Table(table)) => {
            let entry = table.entry(key.clone()).or_insert_with(|| toml::Value::Table(toml::Table::new()));
            put(entry, path, depth + 1, value)
        }
        (Some(Segment::Index(index)), toml::Value::Array(list)) => {
            let count = list.len();
            match list.get_mut(*index) {
                Some(entry) => put(entry, path, depth + 1, value),
                None => Err(SettingFault::NoEntry { place: name(), index: *index, count }),
            }
        }
        (Some(Segment::Key(key)), _) => Err(SettingFault::NoTable { place: name(), key: key.clone() }),
        (Some(Segment::Index(_)), _) => Err(SettingFault::NoList { place: name() }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene() -> toml::Table {
        toml::from_str("title = \"x\"\n[[step]]\nname = \"a\"\nangles = [[1.0, 2.0]]\n").unwrap()
    }

    #[test]
    fn values_are_put_where_the_path_says() {
        let mut scene = scene();
        let put = |scene: &mut toml::Table, path: &str, value: f64| {
            KeyPath::parse(path).and_then(|p| p.put(scene, &toml::Value::Float(value)))
        };
        put(&mut scene, "step[0].angles[0][1]", 7.0).unwrap();
        put(&mut scene, "solver.growth", 2.0).unwrap();
        assert_eq!(scene["step"][0]["angles"][0][1].as_float(), Some(7.0));
        assert_eq!(scene["solver"]["growth"].as_float(), Some(2.0));
        let fault = put(&mut scene, "step.angles", 1.0).unwrap_err();
        assert_eq!(fault, SettingFault::NoTable { place: "step".into(), key: "angles".into() });
        let fault = put(&mut scene, "step[1].angles", 1.0).unwrap_err();
        assert_eq!(fault, SettingFault::NoEntry { place: "step".into(), index: 1, count: 1 });
        assert_eq!(put(&mut scene, "title[0]", 1.0), Err(SettingFault::NoList { place: "title".into() }));
        assert_eq!(scene["title"].as_str(), Some("x"), "a refused setting changes nothing");
    }

    #[test]
    fn what_is_no_path_is_refused() {
        assert!(KeyPath::parse(&["a"; 33].join(".")).is_err());
        for path in ["", "a..b", "[0]", "a[x]", "a[0", "a]0[", "a b"] {
            assert_eq!(KeyPath::parse(path), Err(SettingFault::Path { path: path.into() }));
        }
    }
}
