//! The command line: the only part that prints.

mod arguments;
mod commands;
mod interrupt;
mod output;
mod templates;
mod terminal;

use std::io::{IsTerminal as _, Write as _};

use clap::Parser as _;
use miette::GraphicalReportHandler;

use crate::{Error, ExitCode};
use arguments::Arguments;

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
    let mut text = String::new();
    let drawn = stderr.is_terminal() && GraphicalReportHandler::new().render_report(&mut text, error).is_ok();
    // Nothing is left to do when even the error cannot be printed.
    let _ = stderr.write_all(if drawn { text } else { error.plain() }.as_bytes());
}
