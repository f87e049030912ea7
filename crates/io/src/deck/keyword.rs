//! Keyword lines: `*KEYWORD, PARAMETER=VALUE, FLAG`.

use super::error::DeckErrorKind;
use super::fields::{clean_name, split};

/// The value of a parameter as written.
#[derive(Debug, Clone, Copy)]
pub(super) struct Value<'a>(&'a str);

impl<'a> Value<'a> {
    /// The text without blanks around it and without quotation marks, in the case it has.
    pub fn raw(self) -> &'a str {
        self.0.trim().trim_matches('"')
    }

    /// The text as a name: upper case, blanks removed unless quoted.
    pub fn name(self) -> String {
        clean_name(self.0)
    }
}

/// A keyword line.
#[derive(Debug)]
pub(super) struct Keyword {
    /// Upper case, all blanks removed: `SOLIDSECTION`.
    pub name: String,
    /// Upper case, single blanks: `SOLID SECTION`.
    pub display: String,
    parameters: Vec<(String, Option<String>)>,
}

impl Keyword {
    /// Parses a line that starts with `*`.
    pub fn parse(line: &str) -> Result<Self, DeckErrorKind> {
        let mut fields = split(line.trim_start_matches('*'))?.into_iter();
        let words: Vec<String> = fields.next().unwrap_or("").split_whitespace().map(str::to_uppercase).collect();
        let parameters = fields.filter(|field| !field.is_empty()).map(parameter).collect::<Result<_, _>>()?;
        Ok(Self { name: words.concat(), display: words.join(" "), parameters })
    }

    /// Whether a parameter is present, with or without a value.
    pub fn has(&self, name: &str) -> bool {
        self.parameters.iter().any(|(n, _)| n == name)
    }

    /// The value of a parameter, when it is present and not empty.
    pub fn value(&self, name: &str) -> Option<Value<'_>> {
        let (_, value) = self.parameters.iter().find(|(n, _)| n == name)?;
        value.as_deref().filter(|text| !text.trim().is_empty()).map(Value)
    }

    /// The value of a parameter that must be present.
    pub fn required(&self, name: &'static str) -> Result<Value<'_>, DeckErrorKind> {
        self.value(name).ok_or(DeckErrorKind::MissingParameter { parameter: name })
    }

    /// The value of a parameter as a name, when it is present and not empty.
    pub fn name_of(&self, name: &str) -> Option<String> {
        self.value(name).map(Value::name)
    }

    /// Refuses a parameter unless its value, as a name, is one of `allowed`.
    pub fn allow(&self, name: &'static str, allowed: &[&str]) -> Result<(), DeckErrorKind> {
        let value = self.name_of(name).unwrap_or_default();
        match !self.has(name) || allowed.contains(&value.as_str()) {
            true => Ok(()),
            false => Err(DeckErrorKind::UnsupportedParameter { parameter: name, value }),
        }
    }
}

fn parameter(field: &str) -> Result<(String, Option<String>), DeckErrorKind> {
    let (name, value) = match field.split_once('=') {
        Some((name, value)) => (name, Some(value.trim().to_owned())),
        None => (field, None),
    };
    let name: String = name.split_whitespace().flat_map(str::chars).flat_map(char::to_uppercase).collect();
    match name.starts_with(char::is_alphabetic) {
        true => Ok((name, value)),
        false => Err(DeckErrorKind::BadParameter { parameter: field.to_owned() }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn case_and_blanks_do_not_matter() {
        let keyword = Keyword::parse("* solid  Section , ElSet = a b , Material=\"Poly Amide\",composite,").unwrap();
        assert_eq!((keyword.name.as_str(), keyword.display.as_str()), ("SOLIDSECTION", "SOLID SECTION"));
        assert_eq!(keyword.name_of("ELSET").unwrap(), "AB");
        assert_eq!(keyword.name_of("MATERIAL").unwrap(), "POLY AMIDE");
        assert!(keyword.has("COMPOSITE") && keyword.value("COMPOSITE").is_none() && !keyword.has("ORIENTATION"));
    }

    #[test]
    fn paths_keep_their_case() {
        let keyword = Keyword::parse("*INCLUDE, input= Sub Folder/Nodes.inp ").unwrap();
        assert_eq!(keyword.required("INPUT").unwrap().raw(), "Sub Folder/Nodes.inp");
    }

    #[test]
    fn malformed_parameters_are_refused() {
        assert!(matches!(Keyword::parse("*NSET, NSET=A, 1, 2"), Err(DeckErrorKind::BadParameter { .. })));
        assert!(matches!(Keyword::parse("*NSET, NSET=\"A"), Err(DeckErrorKind::OpenQuote)));
        let keyword = Keyword::parse("*NSET, NSET=").unwrap();
        assert!(matches!(keyword.required("NSET"), Err(DeckErrorKind::MissingParameter { parameter: "NSET" })));
    }
}
