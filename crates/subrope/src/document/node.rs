//! The tree of a TOML document with positions.

use std::ops::Range;
use std::sync::Arc;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::{InvalidDocument, Location, MOST_PROBLEMS, Problem, ProblemKind, Segment};

/// A value of a document.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A string.
    String(String),
    /// An integer that fits 64 bits.
    Integer(i64),
    /// A floating-point number, also `nan` and `inf`.
    Float(f64),
    /// `true` or `false`.
    Boolean(bool),
    /// A date or a time.
    Datetime,
    /// A list.
    Array(Vec<Node>),
    /// A table: keys with their positions, and values.
    Table(Vec<(String, Range<usize>, Node)>),
}

/// A value and the bytes of the text that hold it.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// Bytes of the text.
    pub span: Range<usize>,
    /// What stands there.
    pub value: Value,
}

impl Node {
    /// The entry of a table.
    #[must_use]
    pub fn get(&self, key: &str) -> Option<(&Range<usize>, &Self)> {
        match &self.value {
            Value::Table(entries) => entries.iter().find(|(k, _, _)| k == key).map(|(_, span, node)| (span, node)),
            _ => None,
        }
    }

    /// What the value is, in words.
    #[must_use]
    pub fn kind(&self) -> &'static str {
        match self.value {
            Value::String(_) => "a string",
            Value::Integer(_) => "an integer",
            Value::Float(_) => "a number",
            Value::Boolean(_) => "true or false",
            Value::Datetime => "a date or time",
            Value::Array(_) => "a list",
            Value::Table(_) => "a table",
        }
    }
}

/// A parsed TOML text: its name, the text and the tree.
#[derive(Clone, Debug)]
pub struct Document {
    name: Arc<str>,
    text: Arc<str>,
    root: Node,
}

impl Document {
    /// Parses TOML text; `name` is what errors call it, usually the path of the file.
    ///
    /// # Errors
    /// [`InvalidDocument`] with every syntax error, duplicate key and number that no 64 bits hold.
    pub fn parse(name: &str, text: &str) -> Result<Self, InvalidDocument> {
        let (table, errors) = DeTable::parse_recoverable(text);
        let mut faults: Vec<_> =
            errors.iter().take(MOST_PROBLEMS).map(|e| (e.span(), e.message().to_owned())).collect();
        let span = 0..text.len();
        let value = table_value(table.get_ref(), &mut faults);
        let document = Self { name: name.into(), text: text.into(), root: Node { span, value } };
        let problems = faults
            .into_iter()
            .take(MOST_PROBLEMS)
            .map(|(span, message)| document.problem_at(span.unwrap_or(0..0), ProblemKind::Syntax { message }));
        document.reject(problems.collect())?;
        Ok(document)
    }

    /// What errors call the document.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The whole text.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The table that everything is in.
    #[must_use]
    pub fn root(&self) -> &Node {
        &self.root
    }

    /// The bytes that best show a location: the value itself, or the key when the value is a table or a list, or what
    /// encloses a location that does not exist.
    #[must_use]
    pub fn span(&self, location: &Location) -> Range<usize> {
        let mut node = &self.root;
        let mut shown = 0..0;
        for segment in location.segments() {
            let Some((span, next)) = child(node, segment) else { break };
            shown = span;
            node = next;
        }
        shown
    }

    /// Whether something stands at a location.
    #[must_use]
    pub fn contains(&self, location: &Location) -> bool {
        let mut node = Some(&self.root);
        for segment in location.segments() {
            node = node.and_then(|n| child(n, segment)).map(|(_, next)| next);
        }
        node.is_some()
    }

    /// A problem at a location.
    #[must_use]
    pub fn problem(&self, location: &Location, kind: ProblemKind) -> Problem {
        self.problem_at(self.span(location), kind)
    }

    /// A problem at given bytes.
    #[must_use]
    pub fn problem_at(&self, span: Range<usize>, kind: ProblemKind) -> Problem {
        Problem::new(&self.text, span, kind)
    }

    /// The error that carries these problems, sorted by position.
    #[must_use]
    pub fn invalid(&self, problems: Vec<Problem>) -> InvalidDocument {
        InvalidDocument::new(self.name.clone(), self.text.clone(), problems)
    }

    /// An error if there are problems.
    ///
    /// # Errors
    /// [`InvalidDocument`] if the list is not empty.
    pub fn reject(&self, problems: Vec<Problem>) -> Result<(), InvalidDocument> {
        if problems.is_empty() { Ok(()) } else { Err(self.invalid(problems)) }
    }
}

fn child<'a>(node: &'a Node, segment: &Segment) -> Option<(Range<usize>, &'a Node)> {
    match (segment, &node.value) {
        (Segment::Key(key), Value::Table(_)) => node.get(key).map(|(span, n)| (shown_span(span, n), n)),
        (Segment::Index(i), Value::Array(items)) => items.get(*i).map(|n| (n.span.clone(), n)),
        _ => None,
    }
}

/// Scalars and short lists are shown themselves, tables and lists of tables by their key.
fn shown_span(key: &Range<usize>, node: &Node) -> Range<usize> {
    match &node.value {
        Value::Table(_) => key.clone(),
        Value::Array(items) if items.iter().any(|i| matches!(i.value, Value::Table(_))) => key.clone(),
        _ => node.span.clone(),
    }
}

type Fault = (Option<Range<usize>>, String);

fn node(value: &Spanned<DeValue<'_>>, faults: &mut Vec<Fault>) -> Node {
    let span = value.span();
    let value = match value.get_ref() {
        DeValue::String(s) => Value::String(s.to_string()),
        DeValue::Boolean(b) => Value::Boolean(*b),
        DeValue::Datetime(_) => Value::Datetime,
        DeValue::Array(items) => Value::Array(items.iter().map(|i| node(i, faults)).collect()),
        DeValue::Table(table) => table_value(table, faults),
        number => number_value(number, &span, faults),
    };
    Node { span, value }
}

fn table_value(table: &DeTable<'_>, faults: &mut Vec<Fault>) -> Value {
    Value::Table(table.iter().map(|(k, v)| (k.get_ref().to_string(), k.span(), node(v, faults))).collect())
}

fn number_value(value: &DeValue<'_>, span: &Range<usize>, faults: &mut Vec<Fault>) -> Value {
    let parsed = match value {
        DeValue::Integer(i) => i64::from_str_radix(i.as_str(), i.radix()).ok().map(Value::Integer),
        DeValue::Float(f) => f.as_str().parse().ok().map(Value::Float),
        _ => None,
    };
    parsed.unwrap_or_else(|| {
        faults.push((Some(span.clone()), "the number is too large".to_owned()));
        Value::Integer(0)
    })
}
