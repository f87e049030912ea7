//! JSON schemas of the types that documents become.

use std::any::TypeId;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use schemars::JsonSchema;
use serde_json::Value;

/// The JSON schema (draft 2020-12) of a type; descriptions are the documentation of its fields, with their units.
#[must_use]
pub fn schema_of<T: JsonSchema>() -> Value {
    let mut schema = schemars::schema_for!(T).to_value();
    unescape(&mut schema);
    schema
}

/// [`schema_of`] a type, made once.
pub(super) fn cached<T: JsonSchema + 'static>() -> Arc<Value> {
    static MADE: Mutex<BTreeMap<TypeId, Arc<Value>>> = Mutex::new(BTreeMap::new());
    // A schema is put in whole or not at all.
    let mut made = MADE.lock().unwrap_or_else(PoisonError::into_inner);
    made.entry(TypeId::of::<T>()).or_insert_with(|| Arc::new(schema_of::<T>())).clone()
}

/// Documentation escapes brackets and marks links with them, a schema does not.
fn unescape(value: &mut Value) {
    match value {
        Value::Object(map) => map.iter_mut().for_each(|(key, entry)| match entry {
            Value::String(text) if key == "description" => {
                *text = text.replace("[`", "`").replace("`]", "`").replace("\\[", "[").replace("\\]", "]")
            }
            other => unescape(other),
        }),
        Value::Array(items) => items.iter_mut().for_each(unescape),
        _ => {}
    }
}
