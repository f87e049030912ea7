//! Sections, materials and fibre frames per cell.

use super::sets::Resolved;
use crate::deck::error::DeckErrorKind;
use crate::deck::fields::Item;
use crate::deck::raw::{Points, Raw, RawDistribution, RawOrientation, RawRow};
use crate::deck::source::{Fault, Located};
use nalgebra::{Matrix3, Rotation3, Unit, Vector3};
use std::collections::BTreeMap;

/// What the sections of a deck say of every cell.
pub(super) struct Sections {
    pub frames: Vec<Option<Matrix3<f64>>>,
    pub materials: Vec<Option<u32>>,
    pub material_names: Vec<String>,
}

impl Sections {
    pub fn resolve(raw: &Raw, elements: &Resolved, budget: &mut usize) -> Result<Self, Fault> {
        let cells = raw.elements.table.len();
        let mut sections = Self { frames: vec![None; cells], materials: vec![None; cells], material_names: Vec::new() };
        let mut taken = vec![false; cells];
        let mut names = BTreeMap::new();
        let mut axes = AxesCache { raw, elements, cells: BTreeMap::new(), budget };
        for section in &raw.sections {
            let set = raw.element_sets.find(&section.elements);
            let unknown = || DeckErrorKind::UnknownElementSet { name: section.elements.clone() };
            let members = elements.of(set.ok_or_else(unknown).at(section.at)?);
            if let Some(&cell) = members.iter().find(|&&cell| taken[cell as usize]) {
                let element = raw.elements.table.labels[cell as usize];
                return Err(Fault::new(section.at, DeckErrorKind::SecondSection { element }));
            }
            let material = section.material.as_ref().map(|name| {
                *names.entry(name.clone()).or_insert_with(|| {
                    sections.material_names.push(name.clone());
                    (sections.material_names.len() - 1) as u32
                })
            });
            for &cell in members {
                taken[cell as usize] = true;
                sections.materials[cell as usize] = material;
            }
            if let Some(name) = &section.orientation {
                let unknown = || DeckErrorKind::UnknownOrientation { name: name.clone() };
                let orientation = raw.orientations.get(name).ok_or_else(unknown).at(section.at)?;
                axes.fill(orientation, members, &mut sections.frames)?;
            }
        }
        Ok(sections)
    }
}

/// Rows of a distribution by cell, looked up once per distribution.
struct AxesCache<'a> {
    raw: &'a Raw,
    elements: &'a Resolved,
    cells: BTreeMap<&'a str, BTreeMap<u32, Matrix3<f64>>>,
    /// Rows that may still be given to cells.
    budget: &'a mut usize,
}

impl<'a> AxesCache<'a> {
    fn fill(
        &mut self,
        orientation: &'a RawOrientation,
        cells: &[u32],
        frames: &mut [Option<Matrix3<f64>>],
    ) -> Result<(), Fault> {
        let turn = additional_rotation(orientation.rotation);
        match &orientation.points {
            Points::Fixed(points) => {
                let frame = axes(points).at(orientation.at)? * turn;
                cells.iter().for_each(|&cell| frames[cell as usize] = Some(frame));
            }
            Points::Distribution(name) => {
                let unknown = || DeckErrorKind::UnknownDistribution { name: name.clone() };
                let distribution = self.raw.distributions.get(name).ok_or_else(unknown).at(orientation.at)?;
                if !self.cells.contains_key(name.as_str()) {
                    let rows = self.rows(name, distribution, orientation)?;
                    self.cells.insert(name, rows);
                }
                let default = default_axes(self.raw, distribution, name)?;
                for &cell in cells {
                    let own = self.cells.get(name.as_str()).and_then(|rows| rows.get(&cell).copied());
                    let missing = || DeckErrorKind::MissingAxes {
                        name: name.clone(),
                        element: self.raw.elements.table.labels[cell as usize],
                    };
                    frames[cell as usize] = Some(own.or(default).ok_or_else(missing).at(orientation.at)? * turn);
                }
            }
        }
        Ok(())
    }

    fn rows(
        &mut self,
        name: &str,
        distribution: &RawDistribution,
        orientation: &RawOrientation,
    ) -> Result<BTreeMap<u32, Matrix3<f64>>, Fault> {
        let expected = values_per_row(self.raw, distribution, name).at(orientation.at)?;
        let mut cells = BTreeMap::new();
        for row in &distribution.rows {
            let Some(item) = &row.item else { continue };
            let frame = row_axes(row, expected)?;
            let own = self.cells_of(item).at(row.at)?;
            super::sets::spend(self.budget, own.len()).at(row.at)?;
            for cell in own {
                cells.insert(cell, frame);
            }
        }
        Ok(cells)
    }

    fn cells_of(&self, item: &Item) -> Result<Vec<u32>, DeckErrorKind> {
        super::sets::cells_of(self.raw, self.elements, item)
    }
}

/// Axes of the row without a label; the last one counts.
fn default_axes(raw: &Raw, distribution: &RawDistribution, name: &str) -> Result<Option<Matrix3<f64>>, Fault> {
    let Some(row) = distribution.rows.iter().rfind(|row| row.item.is_none()) else { return Ok(None) };
    let expected = values_per_row(raw, distribution, name).at(row.at)?;
    row_axes(row, expected).map(Some)
}

/// Values of a row: two or three points, as the table says; two where no table is named.
fn values_per_row(raw: &Raw, distribution: &RawDistribution, name: &str) -> Result<usize, DeckErrorKind> {
    let points = match &distribution.table {
        Some(table) => raw.tables.get(table).copied().flatten().unwrap_or(0),
        None => 2,
    };
    match distribution.by_element && (2..=3).contains(&points) {
        true => Ok(3 * points),
        false => Err(DeckErrorKind::UnsupportedDistribution { name: name.to_owned() }),
    }
}

fn row_axes(row: &RawRow, expected: usize) -> Result<Matrix3<f64>, Fault> {
    if row.values.len() != expected {
        let got = row.values.len() + 1;
        return Err(Fault::new(row.at, DeckErrorKind::FieldCount { expected: expected + 1, got }));
    }
    let mut points = [Vector3::zeros(); 3];
    for (point, values) in points.iter_mut().zip(row.values.chunks_exact(3)) {
        point.copy_from_slice(values);
    }
    axes(&points).at(row.at)
}

/// Columns e1, e2, e3 from the points a, b and the origin c: e1 along a - c, e2 in the plane of a and b towards b.
fn axes(&[a, b, c]: &[Vector3<f64>; 3]) -> Result<Matrix3<f64>, DeckErrorKind> {
    let unit = |v: Vector3<f64>| {
        let scale = v.amax();
        if !(scale > 0.0 && scale.is_finite()) {
            return Err(DeckErrorKind::DegenerateAxes);
        }
        Ok((v / scale).normalize())
    };
    let (e1, b) = (unit(a - c)?, unit(b - c)?);
    let across = b - e1 * e1.dot(&b);
    // Decks carry about nine digits: less of an angle than this is their rounding.
    if across.norm() < 1e-8 {
        return Err(DeckErrorKind::DegenerateAxes);
    }
    let e2 = across.normalize();
    // Once more, so that nearly parallel points still give orthogonal axes.
    let e2 = (e2 - e1 * e1.dot(&e2)).normalize();
    Ok(Matrix3::from_columns(&[e1, e2, e1.cross(&e2)]))
}

fn additional_rotation(rotation: Option<(usize, f64)>) -> Matrix3<f64> {
    let Some((axis, angle)) = rotation else { return Matrix3::identity() };
    let axis = Unit::new_unchecked(Vector3::ith(axis, 1.0));
    Rotation3::from_axis_angle(&axis, angle).into_inner()
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn axes_are_orthonormal() {
        let frame = axes(&[Vector3::new(3.0, 4.0, 1.0), Vector3::new(1.0, 5.0, 1.0), Vector3::z()]).unwrap();
        assert_relative_eq!(frame.column(0).into_owned(), Vector3::new(0.6, 0.8, 0.0), epsilon = 1e-15);
        assert_relative_eq!(frame.column(1).into_owned(), Vector3::new(-0.8, 0.6, 0.0), epsilon = 1e-15);
        assert_relative_eq!(frame.column(2).into_owned(), Vector3::z(), epsilon = 1e-15);
    }

    #[test]
    fn huge_and_tiny_points_are_no_trouble() {
        for scale in [1e-300, 1e300] {
            let frame = axes(&[Vector3::x() * scale, Vector3::new(1.0, 1.0, 0.0) * scale, Vector3::zeros()]).unwrap();
            assert_relative_eq!(frame, Matrix3::identity(), epsilon = 1e-15);
        }
    }

    #[test]
    fn points_on_a_line_are_refused() {
        let x = Vector3::x();
        for points in [[x, x * 2.0, Vector3::zeros()], [x, Vector3::y(), x], [Vector3::zeros(), x, Vector3::zeros()]] {
            assert!(matches!(axes(&points), Err(DeckErrorKind::DegenerateAxes)));
        }
        let far = [x * 1e308, Vector3::y(), x * -1e308];
        assert!(matches!(axes(&far), Err(DeckErrorKind::DegenerateAxes)));
    }

    #[test]
    fn additional_rotation_turns_about_its_axis() {
        let turned = axes(&[Vector3::x(), Vector3::y(), Vector3::zeros()]).unwrap()
            * additional_rotation(Some((2, std::f64::consts::FRAC_PI_2)));
        assert_relative_eq!(turned.column(0).into_owned(), Vector3::y(), epsilon = 1e-15);
        assert_relative_eq!(turned.column(1).into_owned(), -Vector3::x(), epsilon = 1e-15);
    }
}
