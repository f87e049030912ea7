//! Where something stands in a document, by keys and indices.

use std::fmt;

/// One step down the tree.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Segment {
    /// Into a table.
    Key(String),
    /// Into a list, counted from 0.
    Index(usize),
}

impl Segment {
    fn key(&self) -> Option<&str> {
        match self {
            Self::Key(key) => Some(key),
            Self::Index(_) => None,
        }
    }
}

impl From<&str> for Segment {
    fn from(key: &str) -> Self {
        Self::Key(key.to_owned())
    }
}

impl From<usize> for Segment {
    fn from(index: usize) -> Self {
        Self::Index(index)
    }
}

/// Keys and indices from the root of a document; shown as `step[0].bend.angle`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Location(Vec<Segment>);

impl Location {
    /// The root.
    #[must_use]
    pub fn root() -> Self {
        Self::default()
    }

    /// One step down: a key or an index.
    #[must_use]
    pub fn at(&self, segment: impl Into<Segment>) -> Self {
        let mut segments = self.0.clone();
        segments.push(segment.into());
        Self(segments)
    }

    /// The steps from the root.
    #[must_use]
    pub fn segments(&self) -> &[Segment] {
        &self.0
    }

    /// The table a reader of the file would name: `[strand.mesh]`, or the document.
    #[must_use]
    pub fn table_name(&self) -> String {
        let keys: Vec<_> = self.0.iter().filter_map(Segment::key).collect();
        if keys.is_empty() { "the top of the file".to_owned() } else { format!("[{}]", keys.join(".")) }
    }
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (position, segment) in self.0.iter().enumerate() {
            match segment {
                Segment::Key(key) if position == 0 => write!(f, "{key}")?,
                Segment::Key(key) => write!(f, ".{key}")?,
                Segment::Index(index) => write!(f, "[{index}]")?,
            }
        }
        Ok(())
    }
}
