//! Questions to one JSON schema.

use serde_json::Value as Json;

use super::{Node, Value};

pub(super) fn is_null(schema: &Json) -> bool {
    schema.get("type").and_then(Json::as_str) == Some("null")
}

/// The types a schema allows, without `null`.
fn types(schema: &Json) -> Vec<&str> {
    match schema.get("type") {
        Some(Json::String(one)) => vec![one],
        Some(Json::Array(many)) => many.iter().filter_map(Json::as_str).filter(|t| *t != "null").collect(),
        _ => Vec::new(),
    }
}

/// Whether the value has a type that the schema allows; a schema without a type allows all.
pub(super) fn type_fits(node: &Node, schema: &Json) -> bool {
    let own: &[&str] = match node.value {
        Value::String(_) => &["string"],
        Value::Integer(_) => &["integer", "number"],
        Value::Float(_) => &["number"],
        Value::Boolean(_) => &["boolean"],
        Value::Datetime => &[],
        Value::Array(_) => &["array"],
        Value::Table(_) => &["object"],
    };
    let allowed = types(schema);
    allowed.is_empty() || allowed.iter().any(|t| own.contains(t))
}

/// The words a schema allows: of an `enum` or a `const`.
pub(super) fn words(schema: &Json) -> Vec<String> {
    let listed = schema.get("enum").and_then(Json::as_array).into_iter().flatten();
    listed.chain(schema.get("const")).filter_map(Json::as_str).map(str::to_owned).collect()
}

pub(super) fn property_names(schema: &Json) -> impl Iterator<Item = &str> {
    schema.get("properties").and_then(Json::as_object).into_iter().flat_map(|p| p.keys().map(String::as_str))
}

/// The key that is a constant in every alternative.
pub(super) fn tag_of<'a>(several: &[&'a Json]) -> Option<&'a str> {
    let first = several.first()?;
    property_names(first).find(|key| several.iter().all(|s| tag_value(s, key).is_some()))
}

pub(super) fn tag_value<'a>(schema: &'a Json, tag: &str) -> Option<&'a str> {
    schema.get("properties")?.get(tag)?.get("const")?.as_str()
}

/// What a schema asks for, in words.
pub(super) fn describe(schema: &Json) -> String {
    let words = words(schema);
    if !words.is_empty() {
        return join_or(words.iter().map(|w| format!("\"{w}\"")).collect());
    }
    let named = types(schema).into_iter().map(|t| match t {
        "string" => "a string".to_owned(),
        "integer" => "an integer".to_owned(),
        "number" => "a number".to_owned(),
        "boolean" => "true or false".to_owned(),
        "array" => describe_list(schema),
        _ => describe_table(schema),
    });
    join_or(named.collect())
}

fn describe_list(schema: &Json) -> String {
    let limit = |key: &str| schema.get(key).and_then(Json::as_u64);
    match (limit("minItems"), limit("maxItems")) {
        (Some(low), Some(high)) if low == high => format!("a list of {low} entries"),
        _ => match schema.get("items").filter(|s| s.get("prefixItems").is_some()) {
            Some(_) => "a list of pairs".to_owned(),
            None => "a list".to_owned(),
        },
    }
}

fn describe_table(schema: &Json) -> String {
    let keys: Vec<_> = property_names(schema).collect();
    if keys.is_empty() || keys.len() > 4 { "a table".to_owned() } else { format!("a table {{{}}}", keys.join(", ")) }
}

/// `a, b or c`.
pub(super) fn join_or(mut parts: Vec<String>) -> String {
    parts.dedup();
    match parts.pop() {
        Some(last) if parts.is_empty() => last,
        Some(last) => format!("{} or {last}", parts.join(", ")),
        None => String::new(),
    }
}

/// How many entries a list must have, in words.
pub(super) fn length(low: Option<usize>, high: Option<usize>) -> String {
    match (low, high) {
        (Some(a), Some(b)) if a == b => format!("{a} entries"),
        (Some(a), Some(b)) => format!("{a} to {b} entries"),
        (Some(1), None) => "at least one entry".to_owned(),
        (Some(a), None) => format!("at least {a} entries"),
        (None, Some(b)) => format!("at most {b} entries"),
        (None, None) => "any number of entries".to_owned(),
    }
}

/// A number as a person would write it: huge and tiny ones with an exponent.
pub(super) fn number(value: f64) -> String {
    let plain = value == 0.0 || !value.is_finite() || (1e-6..1e12).contains(&value.abs());
    if plain { value.to_string() } else { format!("{value:e}") }
}
