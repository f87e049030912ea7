//! `*SURFACE, NAME=, TYPE=ELEMENT`: element or element set, face S1 to S6.

use crate::deck::error::DeckErrorKind;
use crate::deck::fields::{Fields, Item, clean_name};
use crate::deck::keyword::Keyword;
use crate::deck::raw::{Raw, RawSurface};
use crate::deck::source::At;

pub(in crate::deck) struct SurfaceBlock {
    name: String,
}

impl SurfaceBlock {
    /// `None` for surfaces that are not made of element faces.
    pub fn begin(keyword: &Keyword, raw: &mut Raw) -> Result<Option<Self>, DeckErrorKind> {
        if keyword.name_of("TYPE").is_some_and(|kind| kind != "ELEMENT") {
            return Ok(None);
        }
        keyword.allow("COMBINE", &[])?;
        keyword.allow("CROP", &[])?;
        let name = keyword.required("NAME")?.name();
        if raw.surfaces.contains_key(&name) {
            return Err(DeckErrorKind::DuplicateName { name });
        }
        raw.surfaces.insert(name.clone(), RawSurface { internal: keyword.has("INTERNAL"), rows: Vec::new() });
        Ok(Some(Self { name }))
    }

    pub fn data(&mut self, raw: &mut Raw, at: At, fields: &Fields) -> Result<(), DeckErrorKind> {
        let [item, face] = fields.exactly()?;
        let (item, face) = (Item::parse(item)?, parse_face(face)?);
        if let Some(surface) = raw.surfaces.get_mut(&self.name) {
            surface.rows.push((at, item, face));
        }
        Ok(())
    }
}

fn parse_face(field: &str) -> Result<u8, DeckErrorKind> {
    match clean_name(field).as_bytes() {
        [b'S', digit @ b'1'..=b'6'] => Ok(digit - b'1'),
        _ => Err(DeckErrorKind::BadFace { field: field.to_owned() }),
    }
}
