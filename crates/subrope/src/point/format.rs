//! JSON on one line with a blank after every comma and colon, numbers as the shortest decimals.

use std::io::{self, Write};

use serde::Serialize as _;
use serde_json::ser::{Formatter, Serializer};

use super::PathFile;

/// The text of a file of paths. Numbers are the shortest decimals that give the same double back.
///
/// # Errors
/// [`serde_json::Error`] when a number is not finite.
pub fn to_json(paths: &PathFile) -> Result<Vec<u8>, serde_json::Error> {
    let mut text = Vec::new();
    paths.serialize(&mut Serializer::with_formatter(&mut text, Spaced))?;
    Ok(text)
}

/// `{"key": value, "key": [1, 2]}`.
struct Spaced;

impl Formatter for Spaced {
    fn write_f64<W: ?Sized + Write>(&mut self, writer: &mut W, value: f64) -> io::Result<()> {
        // Debug and LowerExp both give the shortest digits that read back to the same double.
        let scientific = format!("{value:e}");
        match scientific.split_once('e').map(|(digits, exponent)| (digits, exponent.parse::<i32>())) {
            Some((digits, Ok(exponent))) if !(-4..16).contains(&exponent) && value != 0.0 => {
                let sign = if exponent < 0 { '-' } else { '+' };
                write!(writer, "{digits}e{sign}{:02}", exponent.abs())
            }
            _ => write!(writer, "{value:?}"),
        }
    }

    fn begin_array_value<W: ?Sized + Write>(&mut self, writer: &mut W, first: bool) -> io::Result<()> {
        if first { Ok(()) } else { writer.write_all(b", ") }
    }

    fn begin_object_key<W: ?Sized + Write>(&mut self, writer: &mut W, first: bool) -> io::Result<()> {
        if first { Ok(()) } else { writer.write_all(b", ") }
    }

    fn begin_object_value<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        writer.write_all(b": ")
    }
}
