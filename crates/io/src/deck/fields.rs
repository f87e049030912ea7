//! Entries of a line: splitting at commas, numbers, labels, names.

use super::error::DeckErrorKind;

/// Splits a line at the commas outside quotation marks; blanks around the entries are removed.
pub(super) fn split(line: &str) -> Result<Vec<&str>, DeckErrorKind> {
    let mut fields = Vec::new();
    let (mut start, mut inside) = (0, false);
    for (i, byte) in line.bytes().enumerate() {
        match byte {
            b'"' => inside = !inside,
            b',' if !inside => {
                fields.push(line[start..i].trim());
                start = i + 1;
            }
            _ => {}
        }
    }
    fields.push(line[start..].trim());
    if inside { Err(DeckErrorKind::OpenQuote) } else { Ok(fields) }
}

/// The entries of a data line.
#[derive(Debug)]
pub(super) struct Fields<'a> {
    /// Entries without the empty one after a trailing comma.
    pub items: Vec<&'a str>,
    /// Whether the line ends with a comma.
    pub continued: bool,
}

impl<'a> Fields<'a> {
    /// Splits a data line.
    pub fn parse(line: &'a str) -> Result<Self, DeckErrorKind> {
        let mut items = split(line)?;
        let continued = items.len() > 1 && items.last().is_some_and(|last| last.is_empty());
        if continued {
            items.pop();
        }
        Ok(Self { items, continued })
    }

    /// The entries, when there are exactly `N`.
    pub fn exactly<const N: usize>(&self) -> Result<[&'a str; N], DeckErrorKind> {
        let got = self.items.len();
        self.items.as_slice().try_into().map_err(|_| DeckErrorKind::FieldCount { expected: N, got })
    }
}

/// A finite number; the exponent may be marked by E or D.
pub(super) fn number(field: &str) -> Result<f64, DeckErrorKind> {
    let parsed = match field.contains(['d', 'D']) {
        true => field.replace(['d', 'D'], "e").parse::<f64>(),
        false => field.parse::<f64>(),
    };
    match parsed {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err(DeckErrorKind::NotFinite { field: field.to_owned() }),
        Err(_) => Err(DeckErrorKind::BadNumber { field: field.to_owned() }),
    }
}

/// A positive integer.
pub(super) fn label(field: &str) -> Result<u64, DeckErrorKind> {
    match field.parse::<u64>() {
        Ok(label) if label > 0 => Ok(label),
        _ => Err(DeckErrorKind::BadLabel { field: field.to_owned() }),
    }
}

/// A name: upper case; blanks removed unless in quotation marks.
pub(super) fn clean_name(text: &str) -> String {
    let text = text.trim();
    match text.strip_prefix('"').and_then(|rest| rest.strip_suffix('"')) {
        Some(inner) => inner.to_uppercase(),
        None => text.chars().filter(|c| !c.is_whitespace() && *c != '"').flat_map(char::to_uppercase).collect(),
    }
}

/// A label, or the name of a set.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Item {
    Label(u64),
    Set(String),
}

impl Item {
    /// An entry made of digits (with a sign) is a label, any other one a name.
    pub fn parse(field: &str) -> Result<Self, DeckErrorKind> {
        let numeric = field.trim_start_matches(['+', '-']).starts_with(|c: char| c.is_ascii_digit());
        if field.is_empty() || numeric {
            return label(field).map(Self::Label);
        }
        Ok(Self::Set(clean_name(field)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn entries_of_a_line() {
        let fields = Fields::parse(" 1 , \"a, b\" ,, 3,").unwrap();
        assert_eq!(fields.items, ["1", "\"a, b\"", "", "3"]);
        assert!(fields.continued);
        assert!(matches!(Fields::parse("1,2").unwrap().exactly::<3>(), Err(DeckErrorKind::FieldCount { .. })));
    }

    #[test]
    fn numbers_of_fortran() {
        for (text, value) in [("1.5d-3", 1.5e-3), ("-.5D+2", -50.0), ("1.", 1.0), ("+2E0", 2.0)] {
            assert_eq!(number(text).unwrap(), value);
        }
        for text in ["nan", "inf", "1e999"] {
            assert!(matches!(number(text), Err(DeckErrorKind::NotFinite { .. })), "{text}");
        }
        for text in ["", "1 2", "0x3", "one"] {
            assert!(matches!(number(text), Err(DeckErrorKind::BadNumber { .. })), "{text}");
        }
    }

    #[test]
    fn labels_and_names() {
        assert_eq!(Item::parse("12").unwrap(), Item::Label(12));
        assert_eq!(Item::parse("end_a").unwrap(), Item::Set("END_A".into()));
        for field in ["", "0", "-3", "1.5", "99999999999999999999999"] {
            assert!(matches!(Item::parse(field), Err(DeckErrorKind::BadLabel { .. })), "{field}");
        }
    }

    proptest! {
        #[test]
        fn no_text_is_too_strange(text in "\\PC{0,80}") {
            let _ = Fields::parse(&text);
            let _ = number(&text);
            let _ = Item::parse(&text);
            let _ = clean_name(&text);
        }

        #[test]
        fn numbers_survive(value in prop::num::f64::NORMAL) {
            prop_assert_eq!(number(&format!("{value:e}")).unwrap(), value);
            prop_assert_eq!(number(&format!("{value:e}").replace('e', "D")).unwrap(), value);
        }
    }
}
