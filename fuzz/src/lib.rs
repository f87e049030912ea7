//! What is fuzzed: every parser of files that come from elsewhere, on bytes in memory.

pub mod checksums;
mod parsers;

pub use parsers::{checkpoint, deck, scene, table, tiny};
