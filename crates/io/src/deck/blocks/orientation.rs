//! `*ORIENTATION`: points a and b (and an origin c), or the name of a distribution; then an additional rotation.

use crate::deck::error::DeckErrorKind;
use crate::deck::fields::{Fields, clean_name, number};
use crate::deck::keyword::Keyword;
use crate::deck::raw::{Points, Raw, RawOrientation};
use crate::deck::source::{At, Fault};
use nalgebra::Vector3;

pub(in crate::deck) struct OrientationBlock {
    name: String,
    at: At,
    points: Option<Points>,
    rotation: Option<(usize, f64)>,
    lines: usize,
}

impl OrientationBlock {
    pub fn begin(keyword: &Keyword, raw: &Raw, at: At) -> Result<Self, DeckErrorKind> {
        keyword.allow("SYSTEM", &["RECTANGULAR", "R"])?;
        keyword.allow("DEFINITION", &["COORDINATES"])?;
        let name = keyword.required("NAME")?.name();
        match raw.orientations.contains_key(&name) {
            true => Err(DeckErrorKind::DuplicateName { name }),
            false => Ok(Self { name, at, points: None, rotation: None, lines: 0 }),
        }
    }

    pub fn data(&mut self, fields: &Fields) -> Result<(), DeckErrorKind> {
        self.lines += 1;
        match self.lines {
            1 => self.points = Some(points(fields)?),
            2 => self.rotation = rotation(fields)?,
            _ => return Err(DeckErrorKind::FieldCount { expected: 0, got: fields.items.len() }),
        }
        Ok(())
    }

    pub fn end(self, raw: &mut Raw) -> Result<(), Fault> {
        let Some(points) = self.points else { return Err(Fault::new(self.at, DeckErrorKind::NoData)) };
        raw.orientations.insert(self.name, RawOrientation { at: self.at, points, rotation: self.rotation });
        Ok(())
    }
}

fn points(fields: &Fields) -> Result<Points, DeckErrorKind> {
    if let [name] = fields.items.as_slice()
        && name.starts_with(|c: char| c.is_alphabetic() || c == '"' || c == '_')
    {
        return Ok(Points::Distribution(clean_name(name)));
    }
    let values: Vec<f64> = fields.items.iter().map(|field| number(field)).collect::<Result<_, _>>()?;
    match values.as_slice() {
        &[a, b, c, d, e, f] => Ok(Points::Fixed([Vector3::new(a, b, c), Vector3::new(d, e, f), Vector3::zeros()])),
        &[a, b, c, d, e, f, x, y, z] => {
            Ok(Points::Fixed([Vector3::new(a, b, c), Vector3::new(d, e, f), Vector3::new(x, y, z)]))
        }
        other => Err(DeckErrorKind::FieldCount { expected: 6, got: other.len() }),
    }
}

/// Axis 1 to 3 and an angle in degrees; nothing for a blank line or a zero angle.
fn rotation(fields: &Fields) -> Result<Option<(usize, f64)>, DeckErrorKind> {
    let [axis, angle] = match fields.items.as_slice() {
        &[axis] => [axis, ""],
        &[axis, angle] => [axis, angle],
        other => return Err(DeckErrorKind::FieldCount { expected: 2, got: other.len() }),
    };
    let degrees = if angle.is_empty() { 0.0 } else { number(angle)? };
    let axis = match axis {
        "" | "1" => 0,
        "2" => 1,
        "3" => 2,
        _ => return Err(DeckErrorKind::UnsupportedParameter { parameter: "axis", value: axis.to_owned() }),
    };
    Ok((degrees != 0.0).then(|| (axis, degrees.to_radians())))
}
