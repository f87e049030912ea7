//! Lists whose errors name the entry.

use std::fmt;
use std::marker::PhantomData;

use serde::de::{Deserialize, Deserializer, Error as _, SeqAccess, Visitor};

use super::record::{PathRecord, StepRecord};

/// The list `paths`.
pub(super) fn paths<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<PathRecord>, D::Error> {
    deserializer.deserialize_seq(Entries { name: "paths", entry: PhantomData })
}

/// The list `steps`.
pub(super) fn steps<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<StepRecord>, D::Error> {
    deserializer.deserialize_seq(Entries { name: "steps", entry: PhantomData })
}

struct Entries<T> {
    name: &'static str,
    entry: PhantomData<T>,
}

impl<'de, T: Deserialize<'de>> Visitor<'de> for Entries<T> {
    type Value = Vec<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a list `{}`", self.name)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Vec<T>, A::Error> {
        let mut entries = Vec::new();
        loop {
            match list.next_element() {
                Ok(Some(entry)) => entries.push(entry),
                Ok(None) => return Ok(entries),
                Err(error) => {
                    return Err(A::Error::custom(format_args!("{}[{}]: {error}", self.name, entries.len())));
                }
            }
        }
    }
}
