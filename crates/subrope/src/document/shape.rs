//! Comparison of a document with a JSON schema: unknown and missing keys, types, words, bounds, lengths.
//!
//! Understands what `schemars` derives for plain data: `$ref`, `type`, `properties`, `required`,
//! `additionalProperties`, `items`, `prefixItems`, `enum`, `const`, numeric bounds, list lengths, and alternatives
//! (`oneOf`, `anyOf`) told apart by the type of the value, by a tag or by their key.

use std::ops::Range;

use serde_json::Value as Json;

use super::keywords::{
    describe, is_null, join_or, length, number, property_names, tag_of, tag_value, type_fits, words,
};
use super::{Document, Location, MOST_PROBLEMS, Node, Problem, ProblemKind, Segment, Value};

/// All problems of a document under a schema.
pub(super) fn check(document: &Document, schema: &Json) -> Vec<Problem> {
    let mut shape = Shape { document, schema, problems: Vec::new() };
    shape.value(&Place { node: document.root(), key_span: 0..0, at: Location::root() }, schema, "");
    shape.problems
}

struct Shape<'a> {
    document: &'a Document,
    schema: &'a Json,
    problems: Vec<Problem>,
}

/// A value under examination, and where it stands.
struct Place<'a> {
    node: &'a Node,
    key_span: Range<usize>,
    at: Location,
}

impl Place<'_> {
    /// The key that holds the value; an entry of a list has the list's key.
    fn key(&self) -> String {
        let segments = self.at.segments();
        let start = segments.iter().rposition(|s| matches!(s, Segment::Key(_))).unwrap_or(0);
        segments[start..].iter().fold(Location::root(), |l, s| l.at(s.clone())).to_string()
    }

    /// Tables are shown by their header.
    fn span(&self) -> Range<usize> {
        match self.node.value {
            Value::Table(_) => self.key_span.clone(),
            _ => self.node.span.clone(),
        }
    }
}

impl<'a> Shape<'a> {
    fn report(&mut self, span: Range<usize>, kind: ProblemKind, about: &str) {
        if self.problems.len() >= MOST_PROBLEMS {
            return;
        }
        let problem = self.document.problem_at(span, kind);
        // Documentation is wrapped, advice is one line.
        let about = about.replace('\n', " ");
        self.problems.push(if about.is_empty() { problem } else { problem.help(about) });
    }

    fn resolve(&self, schema: &'a Json) -> &'a Json {
        let target = schema.get("$ref").and_then(Json::as_str).and_then(|r| r.strip_prefix('#'));
        target.and_then(|pointer| self.schema.pointer(pointer)).unwrap_or(schema)
    }

    /// The alternatives of a schema without `null`; a plain schema is its own only alternative.
    fn alternatives(&self, schema: &'a Json) -> Vec<&'a Json> {
        let schema = self.resolve(schema);
        let listed = schema.get("oneOf").or_else(|| schema.get("anyOf")).and_then(Json::as_array);
        match listed {
            None => vec![schema],
            Some(list) => list.iter().filter(|s| !is_null(s)).flat_map(|s| self.alternatives(s)).collect(),
        }
    }

    /// Checks one value. `about` is the documentation of its key.
    fn value(&mut self, place: &Place<'a>, schema: &'a Json, about: &str) {
        if self.non_finite(place, about) {
            return;
        }
        let alternatives = self.alternatives(schema);
        let fitting: Vec<_> = alternatives.iter().copied().filter(|s| type_fits(place.node, s)).collect();
        match (fitting.as_slice(), &place.node.value) {
            ([], _) => self.wrong_type(place, &alternatives, about),
            (_, Value::String(word)) => self.word(place, word, &fitting, about),
            ([one], _) => self.single(place, one, about),
            (several, Value::Table(_)) => self.choose_table(place, several, about),
            (several, _) => self.single(place, several[0], about),
        }
    }

    fn non_finite(&mut self, place: &Place<'a>, about: &str) -> bool {
        match place.node.value {
            Value::Float(found) if !found.is_finite() => {
                let requirement = "a finite number".to_owned();
                self.report(place.span(), ProblemKind::OutOfRange { key: place.key(), found, requirement }, about);
                true
            }
            _ => false,
        }
    }

    fn wrong_type(&mut self, place: &Place<'a>, alternatives: &[&'a Json], about: &str) {
        let expected = join_or(alternatives.iter().map(|s| describe(s)).collect());
        let found = match &place.node.value {
            Value::Float(f) if f.fract() == 0.0 => format!("a number with a decimal point ({f:?})"),
            _ => place.node.kind().to_owned(),
        };
        let key = if place.at.segments().is_empty() { "the file".to_owned() } else { place.key() };
        self.report(place.span(), ProblemKind::WrongType { key, expected, found }, about);
    }

    fn word(&mut self, place: &Place<'a>, word: &str, alternatives: &[&'a Json], about: &str) {
        let allowed: Vec<String> = alternatives.iter().flat_map(|s| words(s)).collect();
        if allowed.is_empty() {
            if let [one] = alternatives
                && one.get("minLength").is_some()
                && word.trim().is_empty()
            {
                let kind = ProblemKind::Inconsistent { cause: format!("`{}` must not be empty", place.key()) };
                self.report(place.span(), kind, about);
            }
        } else if !allowed.iter().any(|a| a == word) {
            let kind = ProblemKind::UnknownWord { key: place.key(), found: word.to_owned(), allowed };
            self.report(place.span(), kind, about);
        }
    }

    fn single(&mut self, place: &Place<'a>, schema: &'a Json, about: &str) {
        match &place.node.value {
            Value::Integer(i) => self.bounds(place, *i as f64, schema, about),
            Value::Float(f) => self.bounds(place, *f, schema, about),
            Value::Array(items) => self.list(place, items, schema, about),
            Value::Table(entries) => self.table(place, entries, schema),
            _ => {}
        }
    }

    fn bounds(&mut self, place: &Place<'a>, found: f64, schema: &Json, about: &str) {
        let limits = [
            ("exclusiveMinimum", "greater than", (|v, l| v > l) as fn(f64, f64) -> bool),
            ("minimum", "at least", |v, l| v >= l),
            ("exclusiveMaximum", "less than", |v, l| v < l),
            ("maximum", "at most", |v, l| v <= l),
            ("multipleOf", "a multiple of", |v, l| v % l == 0.0),
        ];
        let given: Vec<_> =
            limits.iter().filter_map(|(key, text, ok)| Some((schema.get(key)?.as_f64()?, text, ok))).collect();
        if given.iter().all(|(limit, _, ok)| ok(found, *limit)) {
            return;
        }
        let requirement = given.iter().map(|(limit, text, _)| format!("{text} {}", number(*limit))).collect::<Vec<_>>();
        let requirement = requirement.join(" and ");
        self.report(place.span(), ProblemKind::OutOfRange { key: place.key(), found, requirement }, about);
    }

    fn list(&mut self, place: &Place<'a>, items: &'a [Node], schema: &'a Json, about: &str) {
        let limit = |key: &str| schema.get(key).and_then(Json::as_u64).map(|n| n as usize);
        let (low, high) = (limit("minItems"), limit("maxItems"));
        if low.is_some_and(|n| items.len() < n) || high.is_some_and(|n| items.len() > n) {
            let kind =
                ProblemKind::WrongLength { key: place.key(), found: items.len(), requirement: length(low, high) };
            self.report(place.node.span.clone(), kind, about);
            return;
        }
        let prefix = schema.get("prefixItems").and_then(Json::as_array);
        for (index, item) in items.iter().enumerate() {
            let own = prefix.and_then(|p| p.get(index)).or_else(|| schema.get("items"));
            if let Some(own) = own {
                let inner = Place { node: item, key_span: item.span.clone(), at: place.at.at(index) };
                self.value(&inner, own, about);
            }
        }
    }

    fn table(&mut self, place: &Place<'a>, entries: &'a [(String, Range<usize>, Node)], schema: &'a Json) {
        let properties = schema.get("properties").and_then(Json::as_object);
        let open = schema.get("additionalProperties").filter(|s| s.is_object());
        for (key, key_span, node) in entries {
            match properties.and_then(|p| p.get(key)).or(open) {
                Some(own) => {
                    let about = self.about(own);
                    let inner = Place { node, key_span: key_span.clone(), at: place.at.at(key.as_str()) };
                    self.value(&inner, own, about);
                }
                None if schema.get("additionalProperties") == Some(&Json::Bool(false)) => {
                    self.unknown_key(place, key, key_span, schema);
                }
                None => {}
            }
        }
        self.missing_keys(place, schema);
    }

    fn unknown_key(&mut self, place: &Place<'a>, key: &str, span: &Range<usize>, schema: &'a Json) {
        let allowed: Vec<String> = property_names(schema).map(str::to_owned).collect();
        let elsewhere =
            self.child_with(schema, key).map(|child| format!("`{key}` belongs to {}", place.at.at(child).table_name()));
        let table = place.at.table_name();
        self.report(
            span.clone(),
            ProblemKind::UnknownKey { key: key.to_owned(), table, allowed },
            &elsewhere.unwrap_or_default(),
        );
    }

    /// The sub-table that does have the key.
    fn child_with(&self, schema: &'a Json, key: &str) -> Option<&'a str> {
        let properties = schema.get("properties").and_then(Json::as_object)?;
        let has = |s: &&Json| s.get("properties").is_some_and(|p| p.get(key).is_some());
        properties.iter().find(|(_, s)| self.alternatives(s).iter().any(has)).map(|(name, _)| name.as_str())
    }

    fn missing_keys(&mut self, place: &Place<'a>, schema: &'a Json) {
        let required = schema.get("required").and_then(Json::as_array).into_iter().flatten().filter_map(Json::as_str);
        for key in required.filter(|k| place.node.get(k).is_none()) {
            let own = schema.get("properties").and_then(|p| p.get(key));
            let about = own.map_or("", |s| self.about(s));
            let kind = ProblemKind::MissingKey { key: key.to_owned(), table: place.at.table_name() };
            self.report(place.span(), kind, about);
        }
    }

    /// Several tables are possible: a tag or the keys present tell which is meant.
    fn choose_table(&mut self, place: &Place<'a>, several: &[&'a Json], about: &str) {
        let Value::Table(entries) = &place.node.value else { return };
        if let Some(tag) = tag_of(several) {
            return self.tagged(place, entries, several, tag, about);
        }
        let known = |schema: &&&Json| entries.iter().filter(|(k, _, _)| property_names(schema).any(|p| p == k)).count();
        match several.iter().max_by_key(known).filter(|s| known(s) > 0 || entries.is_empty()) {
            Some(schema) => self.table(place, entries, schema),
            None => {
                let allowed: Vec<String> = several.iter().flat_map(|s| property_names(s)).map(str::to_owned).collect();
                for (key, span, _) in entries {
                    let kind = ProblemKind::UnknownKey {
                        key: key.clone(),
                        table: place.at.table_name(),
                        allowed: allowed.clone(),
                    };
                    self.report(span.clone(), kind, about);
                }
            }
        }
    }

    fn tagged(
        &mut self,
        place: &Place<'a>,
        entries: &'a [(String, Range<usize>, Node)],
        several: &[&'a Json],
        tag: &str,
        about: &str,
    ) {
        let allowed: Vec<String> = several.iter().filter_map(|s| tag_value(s, tag)).map(str::to_owned).collect();
        match place.node.get(tag) {
            None => {
                let kind = ProblemKind::MissingKey { key: tag.to_owned(), table: place.at.table_name() };
                self.report(place.span(), kind, &format!("allowed values: {}", allowed.join(", ")));
            }
            Some((_, node)) => match &node.value {
                Value::String(found) => match several.iter().find(|s| tag_value(s, tag) == Some(found)) {
                    Some(schema) => self.table(place, entries, schema),
                    None => {
                        let kind = ProblemKind::UnknownWord { key: tag.to_owned(), found: found.clone(), allowed };
                        self.report(node.span.clone(), kind, about);
                    }
                },
                _ => {
                    let expected = format!("one of {}", allowed.join(", "));
                    let found = node.kind().to_owned();
                    let kind = ProblemKind::WrongType { key: tag.to_owned(), expected, found };
                    self.report(node.span.clone(), kind, about);
                }
            },
        }
    }

    /// The documentation of a key: its own, or that of its type.
    fn about(&self, schema: &'a Json) -> &'a str {
        let own = |s: &'a Json| s.get("description").and_then(Json::as_str);
        own(schema).or_else(|| own(self.resolve(schema))).unwrap_or_default()
    }
}
