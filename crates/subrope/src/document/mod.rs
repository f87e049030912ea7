//! TOML documents checked against a schema, with the position of everything in them.
//!
//! A document is read in three passes: the text becomes a [`Document`], a tree of values with positions; the tree is
//! compared with the JSON schema of the type it must become, which finds every unknown key, wrong type and value out of
//! bounds at once; only then serde builds the type. Checks that need several values follow on the typed data and find
//! their positions by [`Location`].

mod error;
mod keywords;
mod location;
mod node;
mod schema;
mod shape;
mod suggest;

pub use error::{InvalidDocument, Problem, ProblemKind};
pub use location::{Location, Segment};
pub use node::{Document, Node, Value};
pub use schema::schema_of;
pub use suggest::nearest;

use schemars::JsonSchema;
use serde::de::DeserializeOwned;

/// Problems that are looked for: each of them costs a walk through the text, and nobody reads more.
pub(crate) const MOST_PROBLEMS: usize = 200;

/// Reads a type out of TOML text; the document comes back as well, to locate later findings.
///
/// # Errors
/// [`InvalidDocument`] with all syntax errors, or all unknown keys, wrong types and values out of bounds.
pub fn read<T: DeserializeOwned + JsonSchema + 'static>(
    name: &str,
    text: &str,
) -> Result<(T, Document), InvalidDocument> {
    let document = Document::parse(name, text)?;
    document.reject(shape::check(&document, &schema::cached::<T>()))?;
    match toml::from_str(text) {
        Ok(value) => Ok((value, document)),
        Err(error) => {
            let kind = ProblemKind::Syntax { message: error.message().to_owned() };
            let span = error.span().unwrap_or(0..0);
            Err(document.invalid(vec![document.problem_at(span, kind)]))
        }
    }
}
