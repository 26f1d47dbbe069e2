//! Output to the terminal: results on stdout; progress, warnings and errors on stderr. No other module of the command
//! line prints.
//!
//! A closed pipe (`catchlight presets | head -1`) is not an error.

use std::fmt::Display;
use std::io::Write;

/// Prints a line of a result.
pub fn result(text: impl Display) {
    let _ = writeln!(std::io::stdout(), "{text}");
}

/// Prints a line on what the command is doing or has done.
pub fn progress(text: impl Display) {
    let _ = writeln!(std::io::stderr(), "{text}");
}

/// Prints a warning.
pub fn warning(text: impl Display) {
    progress(format_args!("warning: {text}"));
}

/// Prints the error that ended the program.
pub fn error(error: &anyhow::Error) {
    progress(format_args!("catchlight: {error:#}"));
}
