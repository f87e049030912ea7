//! What can be wrong with a deck.

use std::io;
use std::path::PathBuf;

/// A line of a deck that cannot be accepted.
#[derive(Debug, thiserror::Error)]
#[error("{}:{line}: {kind}{}", file.display(), quoted(text))]
pub struct DeckError {
    /// The file, which may be an included one.
    pub file: PathBuf,
    /// One-based line; 0 when the file as a whole is meant.
    pub line: u32,
    /// The line itself, where it could be found.
    pub text: Box<str>,
    /// What is wrong.
    pub kind: DeckErrorKind,
}

fn quoted(text: &str) -> String {
    if text.is_empty() { String::new() } else { format!(" in {text:?}") }
}

/// What is wrong with a line of a deck.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DeckErrorKind {
    /// A file cannot be opened or read.
    #[error("{} cannot be read: {source}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// A path is a folder, a device or a pipe.
    #[error("{} is not a regular file", path.display())]
    NotAFile {
        /// The path.
        path: PathBuf,
    },
    /// A file includes itself, directly or through others.
    #[error("{} includes itself", path.display())]
    IncludeCycle {
        /// The file.
        path: PathBuf,
    },
    /// Too many files are included.
    #[error("more than {limit} files are included")]
    TooManyIncludes {
        /// The limit.
        limit: usize,
    },
    /// Files are included too deeply.
    #[error("files are included more than {limit} levels deep")]
    IncludeDepth {
        /// The limit.
        limit: usize,
    },
    /// A line is too long to be one of a deck.
    #[error("the line has more than {limit} bytes")]
    LineTooLong {
        /// The limit.
        limit: usize,
    },
    /// A quotation mark is not closed.
    #[error("a quotation mark is not closed")]
    OpenQuote,
    /// A data line comes before the first keyword.
    #[error("data before the first keyword")]
    NoKeyword,
    /// A parameter of a keyword has no proper name.
    #[error("parameter {parameter:?} is malformed")]
    BadParameter {
        /// The parameter as written.
        parameter: String,
    },
    /// A keyword lacks a parameter.
    #[error("the parameter {parameter} is missing")]
    MissingParameter {
        /// Name of the parameter.
        parameter: &'static str,
    },
    /// A parameter would change the mesh in a way that is not supported.
    #[error("{parameter}={value} is not supported")]
    UnsupportedParameter {
        /// Name of the parameter.
        parameter: &'static str,
        /// Its value.
        value: String,
    },
    /// A keyword would change the mesh in a way that is not supported; ignoring it would give another mesh.
    #[error("the keyword *{keyword} is not supported")]
    UnsupportedKeyword {
        /// The keyword.
        keyword: String,
    },
    /// The element type is not a supported hexahedron.
    #[error("element type {element_type:?} is not supported (C3D8, C3D20, C3D20R, C3D27)")]
    UnsupportedElement {
        /// The type as written.
        element_type: String,
    },
    /// Bricks of 8 and of 27 nodes are mixed.
    #[error("element type {element_type:?} in a deck of bricks of {nodes} nodes")]
    MixedElements {
        /// The type as written.
        element_type: String,
        /// Nodes of the bricks before.
        nodes: usize,
    },
    /// A data line has a wrong number of entries.
    #[error("{got} entries where {expected} are expected")]
    FieldCount {
        /// The number expected.
        expected: usize,
        /// The number found.
        got: usize,
    },
    /// A keyword lacks its data lines.
    #[error("data lines are missing")]
    NoData,
    /// A number cannot be understood.
    #[error("{field:?} is not a number")]
    BadNumber {
        /// The entry.
        field: String,
    },
    /// A number is not finite.
    #[error("{field:?} is not finite")]
    NotFinite {
        /// The entry.
        field: String,
    },
    /// A label is not a positive integer.
    #[error("{field:?} is not a positive integer")]
    BadLabel {
        /// The entry.
        field: String,
    },
    /// A face is not S1 to S6.
    #[error("{field:?} is not a face S1 to S6")]
    BadFace {
        /// The entry.
        field: String,
    },
    /// A node is defined twice.
    #[error("node {label} is already defined at {}:{line}", file.display())]
    DuplicateNode {
        /// Label of the node.
        label: u64,
        /// File of the first definition.
        file: PathBuf,
        /// Line of the first definition.
        line: u32,
    },
    /// An element is defined twice.
    #[error("element {label} is already defined at {}:{line}", file.display())]
    DuplicateElement {
        /// Label of the element.
        label: u64,
        /// File of the first definition.
        file: PathBuf,
        /// Line of the first definition.
        line: u32,
    },
    /// A name is defined twice.
    #[error("{name:?} is already defined")]
    DuplicateName {
        /// The name.
        name: String,
    },
    /// A node does not exist.
    #[error("node {label} is not defined")]
    UndefinedNode {
        /// Label of the node.
        label: u64,
    },
    /// An element does not exist.
    #[error("element {label} is not defined")]
    UndefinedElement {
        /// Label of the element.
        label: u64,
    },
    /// An element uses a node twice.
    #[error("element {element} uses node {label} twice")]
    RepeatedNode {
        /// Label of the element.
        element: u64,
        /// Label of the node.
        label: u64,
    },
    /// The seven inner nodes of a 27-node brick are not near its face centres and its centre.
    #[error("nodes 21 to 27 of element {element} are not near its face centres and its centre")]
    InnerNodes {
        /// Label of the element.
        element: u64,
    },
    /// A node set is not defined (before its use).
    #[error("node set {name:?} is not defined here or above")]
    UnknownNodeSet {
        /// Name of the set.
        name: String,
    },
    /// An element set is not defined (before its use).
    #[error("element set {name:?} is not defined here or above")]
    UnknownElementSet {
        /// Name of the set.
        name: String,
    },
    /// A generated range is empty or does not advance.
    #[error("the range {first} to {last} by {step} is empty or endless")]
    BadRange {
        /// First label.
        first: u64,
        /// Last label.
        last: u64,
        /// Increment.
        step: u64,
    },
    /// A generated range holds more labels than there are nodes or elements.
    #[error("the range holds {count} labels, but only {defined} are defined")]
    LongRange {
        /// Labels in the range.
        count: u64,
        /// Labels defined.
        defined: usize,
    },
    /// The sets of the deck hold too many members together.
    #[error("the sets hold more than {limit} members")]
    TooManyMembers {
        /// The limit.
        limit: usize,
    },
    /// More nodes or elements than 32-bit indices can count.
    #[error("more than {limit} nodes or elements")]
    TooManyItems {
        /// The limit.
        limit: usize,
    },
    /// An orientation is not defined.
    #[error("orientation {name:?} is not defined")]
    UnknownOrientation {
        /// Its name.
        name: String,
    },
    /// A distribution is not defined.
    #[error("distribution {name:?} is not defined")]
    UnknownDistribution {
        /// Its name.
        name: String,
    },
    /// A distribution used by an orientation does not give points per element.
    #[error("distribution {name:?} does not give the points a, b per element (LOCATION=ELEMENT, COORD3D)")]
    UnsupportedDistribution {
        /// Its name.
        name: String,
    },
    /// A distribution gives no axes for an element and has no default.
    #[error("distribution {name:?} gives no axes for element {element}")]
    MissingAxes {
        /// Its name.
        name: String,
        /// Label of the element.
        element: u64,
    },
    /// The points a and b of an orientation do not span a plane.
    #[error("the points a and b do not define axes")]
    DegenerateAxes,
    /// An element belongs to two sections.
    #[error("element {element} already has a section")]
    SecondSection {
        /// Label of the element.
        element: u64,
    },
    /// The deck defines no element.
    #[error("the deck defines no element")]
    NoElements,
}
