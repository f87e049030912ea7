//! Problems in a document, each with its place.

use std::fmt::{self, Write as _};
use std::ops::Range;
use std::sync::Arc;

use miette::{Diagnostic, LabeledSpan, NamedSource, SourceCode, SourceSpan};

/// What is wrong at a place of a document.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ProblemKind {
    /// The text is not TOML.
    #[error("{message}")]
    Syntax {
        /// What the parser says.
        message: String,
    },
    /// A key that nobody reads.
    #[error("unknown key `{key}` in {table}")]
    UnknownKey {
        /// The key.
        key: String,
        /// The table it stands in.
        table: String,
        /// The keys that may stand there.
        allowed: Vec<String>,
    },
    /// A key that must be there.
    #[error("{table} needs the key `{key}`")]
    MissingKey {
        /// The key.
        key: String,
        /// The table that lacks it.
        table: String,
    },
    /// A value of another type.
    #[error("`{key}` must be {expected}, not {found}")]
    WrongType {
        /// The key.
        key: String,
        /// What it must be.
        expected: String,
        /// What it is.
        found: String,
    },
    /// A word that is none of those known.
    #[error("`{key}` cannot be \"{found}\"")]
    UnknownWord {
        /// The key.
        key: String,
        /// The word.
        found: String,
        /// The words known.
        allowed: Vec<String>,
    },
    /// A number outside its bounds.
    #[error("`{key}` = {} is out of range: it must be {requirement}", super::keywords::number(*found))]
    OutOfRange {
        /// The key.
        key: String,
        /// The value.
        found: f64,
        /// The bounds in words.
        requirement: String,
    },
    /// A list of the wrong length.
    #[error("`{key}` must hold {requirement}, not {found}")]
    WrongLength {
        /// The key.
        key: String,
        /// How many entries it has.
        found: usize,
        /// How many it must have.
        requirement: String,
    },
    /// A name that is defined nowhere.
    #[error("there is no {what} named \"{found}\"")]
    UnknownName {
        /// What is named.
        what: &'static str,
        /// The name.
        found: String,
        /// The names defined.
        allowed: Vec<String>,
    },
    /// A file that cannot be used.
    #[error("{cause}")]
    UnusableFile {
        /// Why.
        cause: String,
    },
    /// Values that contradict each other.
    #[error("{cause}")]
    Inconsistent {
        /// Why.
        cause: String,
    },
}

impl ProblemKind {
    /// What stands at the caret.
    fn label(&self) -> &'static str {
        match self {
            Self::Syntax { .. } => "here",
            Self::UnknownKey { .. } => "not a key of this table",
            Self::MissingKey { .. } => "a key is missing here",
            Self::WrongType { .. } => "wrong type",
            Self::UnknownWord { .. } => "not one of the allowed values",
            Self::OutOfRange { .. } => "out of range",
            Self::WrongLength { .. } => "wrong length",
            Self::UnknownName { .. } => "not defined",
            Self::UnusableFile { .. } => "this file",
            Self::Inconsistent { .. } => "contradiction",
        }
    }

    /// Allowed values and the nearest of them.
    fn advice(&self) -> Option<String> {
        let (word, allowed, title) = match self {
            Self::UnknownKey { key, allowed, .. } => (key, allowed, "allowed keys"),
            Self::UnknownWord { found, allowed, .. } => (found, allowed, "allowed values"),
            Self::UnknownName { found, allowed, .. } => (found, allowed, "known names"),
            _ => return None,
        };
        let listed = if allowed.is_empty() { "none".to_owned() } else { allowed.join(", ") };
        let list = format!("{title}: {listed}");
        match super::nearest(word, allowed.iter().map(String::as_str)) {
            Some(suggestion) => Some(format!("did you mean `{suggestion}`? {list}")),
            None => Some(list),
        }
    }
}

/// One problem and its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    kind: ProblemKind,
    span: Range<usize>,
    line: usize,
    column: usize,
    help: Vec<String>,
}

impl Problem {
    pub(super) fn new(text: &str, span: Range<usize>, kind: ProblemKind) -> Self {
        let start = floor_boundary(text, span.start);
        let before = text.get(..start).unwrap_or_default();
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
        let help = kind.advice().into_iter().collect();
        Self { kind, span: start..span.end.clamp(start, text.len()), line, column, help }
    }

    /// Adds advice.
    #[must_use]
    pub fn help(mut self, advice: impl Into<String>) -> Self {
        self.help.push(advice.into());
        self
    }

    /// What is wrong.
    #[must_use]
    pub fn kind(&self) -> &ProblemKind {
        &self.kind
    }

    /// Line, counted from 1.
    #[must_use]
    pub fn line(&self) -> usize {
        self.line
    }

    /// Column in characters, counted from 1.
    #[must_use]
    pub fn column(&self) -> usize {
        self.column
    }

    fn plain(&self, name: &str, text: &str, out: &mut String) -> fmt::Result {
        let shown = text.lines().nth(self.line - 1).unwrap_or_default();
        let number = self.line.to_string();
        let margin = " ".repeat(number.len());
        let indent: String = shown.chars().take(self.column - 1).map(|c| if c == '\t' { c } else { ' ' }).collect();
        let covered = text.get(self.span.clone()).unwrap_or_default().lines().next().unwrap_or_default();
        let carets = "^".repeat(covered.chars().count().max(1));
        writeln!(out, "error: {}", self.kind)?;
        writeln!(out, "{margin}--> {name}:{}:{}", self.line, self.column)?;
        writeln!(out, "{margin} |\n{number} | {shown}\n{margin} | {indent}{carets} {}", self.kind.label())?;
        for advice in &self.help {
            writeln!(out, "{margin} = help: {advice}")?;
        }
        Ok(())
    }
}

fn floor_boundary(text: &str, byte: usize) -> usize {
    let mut byte = byte.min(text.len());
    while !text.is_char_boundary(byte) {
        byte -= 1;
    }
    byte
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.kind.fmt(f)
    }
}

impl std::error::Error for Problem {}

impl Diagnostic for Problem {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        if self.help.is_empty() { None } else { Some(Box::new(self.help.join("\n"))) }
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let span = SourceSpan::from(self.span.clone());
        let label = LabeledSpan::new_primary_with_span(Some(self.kind.label().to_owned()), span);
        Some(Box::new(std::iter::once(label)))
    }
}

/// A document with problems: its name, its text and all problems sorted by position.
#[derive(Clone, Debug)]
pub struct InvalidDocument {
    source: NamedSource<Arc<str>>,
    text: Arc<str>,
    problems: Vec<Problem>,
}

impl InvalidDocument {
    pub(super) fn new(name: Arc<str>, text: Arc<str>, mut problems: Vec<Problem>) -> Self {
        problems.sort_by_key(|p| (p.span.start, p.span.end));
        Self { source: NamedSource::new(name, text.clone()).with_language("TOML"), text, problems }
    }

    /// One problem at a byte of a text.
    #[must_use]
    pub fn at(name: &str, text: &str, byte: usize, kind: ProblemKind) -> Self {
        Self::new(name.into(), text.into(), vec![Problem::new(text, byte..byte, kind)])
    }

    /// All problems, sorted by position.
    #[must_use]
    pub fn problems(&self) -> &[Problem] {
        &self.problems
    }

    /// All problems as plain text: cause, file, line and column, the line with a caret, and advice.
    #[must_use]
    pub fn plain(&self) -> String {
        let mut out = String::new();
        for (position, problem) in self.problems.iter().enumerate() {
            if position > 0 {
                out.push('\n');
            }
            // Writing to a string cannot fail.
            let _ = problem.plain(self.source.name(), &self.text, &mut out);
        }
        out
    }
}

impl fmt::Display for InvalidDocument {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = self.source.name();
        match self.problems.as_slice() {
            [] => write!(f, "{name}: invalid"),
            [one] => write!(f, "{name}:{}:{}: {one}", one.line, one.column),
            [first, rest @ ..] => {
                let more = if rest.len() == 1 { "problem" } else { "problems" };
                write!(f, "{name}:{}:{}: {first} (and {} more {more})", first.line, first.column, rest.len())
            }
        }
    }
}

impl std::error::Error for InvalidDocument {}

impl Diagnostic for InvalidDocument {
    fn source_code(&self) -> Option<&dyn SourceCode> {
        Some(&self.source)
    }

    fn related<'a>(&'a self) -> Option<Box<dyn Iterator<Item = &'a dyn Diagnostic> + 'a>> {
        Some(Box::new(self.problems.iter().map(|p| p as &dyn Diagnostic)))
    }
}
