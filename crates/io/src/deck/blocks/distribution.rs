//! `*DISTRIBUTION` and `*DISTRIBUTION TABLE`: values per element, the first row being the default.

use crate::deck::error::DeckErrorKind;
use crate::deck::fields::{Fields, Item, clean_name, number};
use crate::deck::keyword::Keyword;
use crate::deck::raw::{Raw, RawDistribution, RawRow};
use crate::deck::source::{At, Fault};

pub(in crate::deck) struct DistributionBlock {
    name: String,
    pending: Option<RawRow>,
}

impl DistributionBlock {
    pub fn begin(keyword: &Keyword, raw: &mut Raw) -> Result<Self, DeckErrorKind> {
        keyword.allow("INPUT", &[])?;
        let name = keyword.required("NAME")?.name();
        if raw.distributions.contains_key(&name) {
            return Err(DeckErrorKind::DuplicateName { name });
        }
        let by_element = keyword.name_of("LOCATION").is_none_or(|location| location == "ELEMENT");
        let table = keyword.name_of("TABLE");
        raw.distributions.insert(name.clone(), RawDistribution { by_element, table, rows: Vec::new() });
        Ok(Self { name, pending: None })
    }

    pub fn data(&mut self, raw: &mut Raw, at: At, fields: &Fields) -> Result<(), DeckErrorKind> {
        let Some(distribution) = raw.distributions.get_mut(&self.name) else { return Ok(()) };
        // Values of another meaning (per node, per model) are of no use here.
        if !distribution.by_element {
            return Ok(());
        }
        let (mut row, values) = match self.pending.take() {
            Some(row) => (row, fields.items.as_slice()),
            None => begin_row(at, fields)?,
        };
        for field in values {
            row.values.push(number(field)?);
        }
        match fields.continued {
            true => self.pending = Some(row),
            false => distribution.rows.push(row),
        }
        Ok(())
    }

    /// A row that ends with a comma is complete when nothing follows.
    pub fn end(self, raw: &mut Raw) -> Result<(), Fault> {
        if let (Some(row), Some(distribution)) = (self.pending, raw.distributions.get_mut(&self.name)) {
            distribution.rows.push(row);
        }
        Ok(())
    }
}

fn begin_row<'f, 'a>(at: At, fields: &'f Fields<'a>) -> Result<(RawRow, &'f [&'a str]), DeckErrorKind> {
    let Some((first, values)) = fields.items.split_first() else { return Err(DeckErrorKind::NoData) };
    let item = if first.is_empty() { None } else { Some(Item::parse(first)?) };
    Ok((RawRow { at, item, values: Vec::with_capacity(values.len()) }, values))
}

pub(in crate::deck) struct TableBlock {
    name: String,
}

impl TableBlock {
    pub fn begin(keyword: &Keyword, raw: &mut Raw) -> Result<Self, DeckErrorKind> {
        let name = keyword.required("NAME")?.name();
        match raw.tables.insert(name.clone(), Some(0)) {
            Some(_) => Err(DeckErrorKind::DuplicateName { name }),
            None => Ok(Self { name }),
        }
    }

    pub fn data(&mut self, raw: &mut Raw, fields: &Fields) -> Result<(), DeckErrorKind> {
        let Some(points) = raw.tables.get_mut(&self.name) else { return Ok(()) };
        for field in fields.items.iter().filter(|field| !field.is_empty()) {
            *points = match (*points, clean_name(field).as_str()) {
                (Some(count), "COORD3D") => Some(count + 1),
                _ => None,
            };
        }
        Ok(())
    }
}
