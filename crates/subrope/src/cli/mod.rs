//! The command line: the only part that prints.

mod arguments;
mod commands;
mod interrupt;
mod output;
mod report;
mod stress;
mod study;
mod templates;
mod terminal;

use std::io::{IsTerminal as _, Write as _};

use crate::{Error, ExitCode};
use arguments::Arguments;
use clap::Parser as _;

/// Reads the arguments, runs the command, and prints the error if there is one.
#[must_use]
pub fn main() -> std::process::ExitCode {
    let code = match commands::run(Arguments::parse().command) {
        Ok(()) => ExitCode::Done,
        Err(error) => {
            explain(&error);
            error.exit_code()
        }
    };
    std::process::ExitCode::from(code as u8)
}

/// On a terminal with colours and frames, otherwise as plain text.
fn explain(error: &Error) {
    let mut stderr = std::io::stderr();
    let drawn = stderr.is_terminal().then(|| report::graphical(error).ok()).flatten();
    // Nothing is left to do when even the error cannot be printed.
    let _ = stderr.write_all(drawn.unwrap_or_else(|| error.plain()).as_bytes());
}
