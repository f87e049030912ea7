//! Quantities: which number of a run is looked at.

use serde_json::Value as Json;
use subrope_io::History;

use super::file::{At, Quantity};

/// A quantity with a name.
#[derive(Clone, Copy, Debug)]
pub struct Known {
    /// The name.
    pub name: &'static str,
    /// Unit.
    pub unit: &'static str,
    kind: Kind,
}

#[derive(Clone, Copy, Debug)]
enum Kind {
    Point(&'static str, Part),
    Summary(&'static str),
    Contacts(&'static str, Over),
}

/// What of a vector.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Its magnitude.
    Magnitude,
    /// Its component along z.
    Axial,
}

/// What of all contacts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Over {
    /// The sum.
    Sum,
    /// The largest.
    Largest,
}

const fn known_as(name: &'static str, unit: &'static str, kind: Kind) -> Known {
    Known { name, unit, kind }
}

const KNOWN: [Known; 21] = [
    known_as("force", "N", Kind::Point("force_n", Part::Magnitude)),
    known_as("tension", "N", Kind::Point("force_n", Part::Axial)),
    known_as("moment", "N mm", Kind::Point("moment_n_mm", Part::Magnitude)),
    known_as("torque", "N mm", Kind::Point("moment_n_mm", Part::Axial)),
    known_as("work", "mJ", Kind::Summary("/energies/external_work_mj")),
    known_as("stored", "mJ", Kind::Summary("/energies/stored_mj")),
    known_as("dissipation_transverse", "mJ", Kind::Summary("/energies/dissipated_transverse_midpoint_mj")),
    known_as("dissipation_longitudinal", "mJ", Kind::Summary("/energies/dissipated_longitudinal_midpoint_mj")),
    known_as("dissipation_contact", "mJ", Kind::Summary("/energies/contact_friction_mj")),
    known_as("peak_density_transverse", "mJ/mm^3", Kind::Summary("/peak_densities/transverse_mj_per_mm3")),
    known_as("peak_density_longitudinal", "mJ/mm^3", Kind::Summary("/peak_densities/longitudinal_mj_per_mm3")),
    known_as("contact_force", "N", Kind::Contacts("normal_force_n", Over::Sum)),
    known_as("contact_friction_force", "N", Kind::Contacts("friction_force_n", Over::Sum)),
    known_as("contact_area", "mm^2", Kind::Contacts("area_mm2", Over::Sum)),
    known_as("contact_pressure", "MPa", Kind::Contacts("largest_pressure_mpa", Over::Largest)),
    known_as("penetration", "mm", Kind::Contacts("largest_penetration_mm", Over::Largest)),
    known_as("curvature_peak", "1/mm", Kind::Summary("/findings/largest_curvature_per_mm")),
    known_as("curvature_peak_length", "mm", Kind::Summary("/findings/curvature_peak_length_mm")),
    known_as("ovality", "-", Kind::Summary("/findings/largest_ovality")),
    known_as("out_of_plane", "mm", Kind::Summary("/findings/out_of_plane_mm")),
    known_as("approach", "mm", Kind::Summary("/findings/approach_mm")),
];

/// Names of all known quantities.
pub fn names() -> impl Iterator<Item = &'static str> {
    KNOWN.iter().map(|k| k.name)
}

/// The known quantity of a name.
#[must_use]
pub fn known(name: &str) -> Option<&'static Known> {
    KNOWN.iter().find(|k| k.name == name)
}

impl Known {
    /// Where it comes from; `point` is the reference point, where it has one.
    #[must_use]
    pub fn source(&self, point: Option<&str>) -> Source {
        match self.kind {
            Kind::Point(vector, part) => Source::Point { point: point.map(str::to_owned), vector, part },
            Kind::Summary(pointer) => Source::Summary { pointer: pointer.to_owned() },
            Kind::Contacts(key, over) => Source::Contacts { key, over },
        }
    }
}

/// Where a number comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// A vector of a reference point at the end.
    Point {
        /// The point; the last by name when left out.
        point: Option<String>,
        /// Key of the vector.
        vector: &'static str,
        /// What of it.
        part: Part,
    },
    /// A number of the summary.
    Summary {
        /// JSON pointer (RFC 6901).
        pointer: String,
    },
    /// Over all contacts.
    Contacts {
        /// Key of the number.
        key: &'static str,
        /// How they are taken together.
        over: Over,
    },
    /// A column of the history.
    History {
        /// Its name without unit.
        column: String,
        /// The row; the last when left out.
        at: Option<At>,
    },
}

/// Why a run does not give a quantity.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Missing {
    /// The summary has no such number.
    #[error("the summary has no {0}")]
    Summary(String),
    /// There is no such reference point.
    #[error("there is no reference point {0}")]
    Point(String),
    /// The history has no such column.
    #[error("the history has no column {0}")]
    Column(String),
    /// The column never gets there.
    #[error("{0} does not pass the value of `at`")]
    Passed(String),
}

impl Source {
    /// Where the quantity comes from; `None` when it says nothing that can be read.
    #[must_use]
    pub fn of(quantity: &Quantity) -> Option<Self> {
        match &quantity.from {
            Some(from) => Self::parse(from, quantity.at.as_ref()),
            None => known(&quantity.name).map(|k| k.source(quantity.point.as_deref())),
        }
    }

    /// Reads `history:COLUMN` or `summary:/pointer`.
    #[must_use]
    pub fn parse(from: &str, at: Option<&At>) -> Option<Self> {
        let (file, rest) = from.split_once(':')?;
        match file {
            "history" if !rest.is_empty() => Some(Self::History { column: rest.to_owned(), at: at.cloned() }),
            "summary" if rest.starts_with('/') => Some(Self::Summary { pointer: rest.to_owned() }),
            _ => None,
        }
    }

    /// The number that a run gives.
    ///
    /// # Errors
    /// [`Missing`] when it gives none.
    pub fn value(&self, summary: &Json, history: &History) -> Result<f64, Missing> {
        match self {
            Self::Point { point, vector, part } => of_point(summary, point.as_deref(), vector, *part),
            Self::Summary { pointer } => {
                finite(summary.pointer(pointer)).ok_or_else(|| Missing::Summary(pointer.clone()))
            }
            Self::Contacts { key, over } => of_contacts(summary, key, *over),
            Self::History { column, at: None } => {
                let values = history.column(column).ok_or_else(|| Missing::Column(column.clone()))?;
                values.last().copied().ok_or_else(|| Missing::Passed(column.clone()))
            }
            Self::History { column, at: Some(at) } => passing(history, column, at),
        }
    }
}

fn finite(value: Option<&Json>) -> Option<f64> {
    value.and_then(Json::as_f64).filter(|v| v.is_finite())
}

fn of_point(summary: &Json, point: Option<&str>, vector: &str, part: Part) -> Result<f64, Missing> {
    let points = summary.get("reference_points").and_then(Json::as_object);
    let unknown = || Missing::Point(point.unwrap_or("at all").to_owned());
    let points = points.ok_or_else(unknown)?;
    let found = match point {
        Some(name) => points.get(name),
        None => points.iter().max_by(|a, b| a.0.cmp(b.0)).map(|(_, p)| p),
    };
    let entries = found.and_then(|p| p.get(vector)).and_then(Json::as_array).ok_or_else(unknown)?;
    let entries: Vec<f64> = entries.iter().filter_map(|e| finite(Some(e))).collect();
    match (part, entries.as_slice()) {
        (Part::Magnitude, [x, y, z]) => Ok(x.hypot(*y).hypot(*z)),
        (Part::Axial, [_, _, z]) => Ok(*z),
        _ => Err(Missing::Summary(vector.to_owned())),
    }
}

fn of_contacts(summary: &Json, key: &str, over: Over) -> Result<f64, Missing> {
    let missing = || Missing::Summary(format!("contacts with {key}"));
    let contacts = summary.get("contacts").and_then(Json::as_array).ok_or_else(missing)?;
    let values = contacts.iter().map(|c| finite(c.get(key)).ok_or_else(missing)).collect::<Result<Vec<_>, _>>()?;
    Ok(match over {
        Over::Sum => values.iter().sum(),
        Over::Largest => values.iter().copied().fold(0.0, f64::max),
    })
}

/// Linear between the rows at which the column of `at` first passes its value.
fn passing(history: &History, column: &str, at: &At) -> Result<f64, Missing> {
    let get = |name: &str| history.column(name).ok_or_else(|| Missing::Column(name.to_owned()));
    let (x, y) = (get(&at.column)?, get(column)?);
    let slack = 1e-9 * at.value.abs();
    for i in 0..x.len() {
        if (x[i] - at.value).abs() <= slack {
            return Ok(y[i]);
        }
        if i > 0 && (x[i - 1] - at.value) * (x[i] - at.value) < 0.0 {
            let t = (at.value - x[i - 1]) / (x[i] - x[i - 1]);
            return Ok(y[i - 1] + t * (y[i] - y[i - 1]));
        }
    }
    Err(Missing::Passed(at.column.clone()))
}

#[cfg(test)]
mod tests {
    use subrope_io::Column;

    use super::*;

    fn history() -> History {
        let columns = vec![Column::new("angle", "rad"), Column::new("moment", "N mm")];
        History { columns, rows: vec![vec![0.1, 1.0], vec![0.3, 5.0], vec![0.2, 9.0]], truncated: false }
    }

    #[test]
    fn rows_are_interpolated_where_a_column_first_passes() {
        let get = |value| {
            let at = At { column: "angle".into(), value };
            Source::parse("history:moment", Some(&at)).unwrap().value(&Json::Null, &history())
        };
        assert_eq!(get(0.1), Ok(1.0));
        assert!((get(0.2).unwrap() - 3.0).abs() < 1e-12);
        assert_eq!(get(0.5), Err(Missing::Passed("angle".into())));
        assert_eq!(Source::parse("history:moment", None).unwrap().value(&Json::Null, &history()), Ok(9.0));
        assert!(Source::parse("moment", None).is_none() && Source::parse("summary:x", None).is_none());
    }

    #[test]
    fn numbers_of_the_summary() {
        let summary = serde_json::json!({
            "reference_points": {
                "A": { "force_n": [3.0, 4.0, 0.0] },
                "B": { "force_n": [0.0, 3.0, -4.0] }
            },
            "energies": { "stored_mj": 2.5 },
            "contacts": [{ "normal_force_n": 1.0 }, { "normal_force_n": 2.0 }],
            "findings": null
        });
        let get = |name: &str, point| known(name).unwrap().source(point).value(&summary, &history());
        assert_eq!(get("force", Some("A")), Ok(5.0));
        assert_eq!(get("tension", None), Ok(-4.0));
        assert_eq!(get("stored", None), Ok(2.5));
        assert_eq!(get("contact_force", None), Ok(3.0));
        assert!(get("force", Some("C")).is_err());
        assert!(get("curvature_peak", None).is_err());
    }
}
