//! Names and values before anything is written.

use super::{FieldSpec, Location, Precision, Provenance, WriterOptions};
use crate::error::{IoError, ValueError};
use subrope_geometry::{GeometryError, Mesh};

/// The mesh, apart from nodes that no cell uses, which do no harm here.
pub(super) fn mesh(mesh: &Mesh) -> Result<(), IoError> {
    match mesh.validate() {
        Ok(()) | Err(GeometryError::UnusedPoints { .. }) => Ok(()),
        Err(error) => Err(error.into()),
    }
}

pub(super) fn options(options: WriterOptions) -> Result<(), ValueError> {
    match options.deflate {
        Some(level) if level > 9 => Err(ValueError::Deflate { level }),
        _ => Ok(()),
    }
}

/// Names and components of fields.
pub(super) fn specs<'a>(specs: impl IntoIterator<Item = &'a FieldSpec>) -> Result<(), ValueError> {
    let mut seen = std::collections::BTreeSet::new();
    for spec in specs {
        name(&spec.name)?;
        if !(1..=ValueError::MAX_COMPONENTS).contains(&spec.components) {
            return Err(ValueError::Components { name: spec.name.clone(), components: spec.components });
        }
        if !seen.insert((spec.location, spec.name.as_str())) {
            return Err(ValueError::DuplicateName { name: spec.name.clone() });
        }
    }
    Ok(())
}

pub(super) fn provenance(texts: &Provenance) -> Result<(), ValueError> {
    for (key, text) in texts {
        name(key)?;
        if text.contains('\0') {
            return Err(ValueError::Text { name: key.clone() });
        }
    }
    Ok(())
}

fn name(name: &str) -> Result<(), ValueError> {
    let wrong = name.trim().is_empty() || name.contains(['/', '.']) || name.contains(char::is_control);
    if wrong { Err(ValueError::Name { name: name.to_owned() }) } else { Ok(()) }
}

/// Points and cells of a mesh.
#[derive(Debug, Clone, Copy)]
pub(super) struct Counts {
    pub points: usize,
    pub cells: usize,
}

impl Counts {
    pub fn of(mesh: &Mesh) -> Self {
        Self { points: mesh.point_count(), cells: mesh.cell_count() }
    }

    pub fn tuples(self, location: Location) -> usize {
        match location {
            Location::Point => self.points,
            Location::Cell => self.cells,
        }
    }
}

/// Length of a field's values, and whether each can be written in the precision chosen.
pub(super) fn values(spec: &FieldSpec, values: &[f64], counts: Counts, precision: Precision) -> Result<(), ValueError> {
    let expected = counts.tuples(spec.location) * spec.components;
    if values.len() != expected {
        return Err(ValueError::Length { name: spec.name.clone(), expected, got: values.len() });
    }
    let writable = |x: f64| match precision {
        Precision::F32 => (x as f32).is_finite(),
        Precision::F64 => x.is_finite(),
    };
    match values.iter().position(|&x| !writable(x)) {
        Some(index) => Err(ValueError::NotFinite { name: spec.name.clone(), index, value: values[index] }),
        None => Ok(()),
    }
}
