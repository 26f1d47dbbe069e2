//! Output to the terminal: results on stdout; progress, warnings and errors on stderr. No other module of the command
//! line prints.
//!
//! A closed pipe (`catchlight presets | head -1`) is not an error: the rest is not printed, and the command goes on.
//! Any other write error of stdout ends the program with exit code 2, once the command is done. Nothing depends on
//! stderr.

use super::failure::Failure;
use crate::io::reason;
use anyhow::anyhow;
use std::fmt::Display;
use std::io::{self, ErrorKind, Write};
use std::sync::OnceLock;

/// The first write error of stdout other than a closed pipe.
static WRITE_ERROR: OnceLock<io::Error> = OnceLock::new();

/// Prints a line of a result.
pub fn result(text: impl Display) {
    note_written(writeln!(io::stdout(), "{text}"));
}

/// Keeps a write error of stdout for [`finish`].
pub fn note_written(written: io::Result<()>) {
    if let Err(error) = written
        && error.kind() != ErrorKind::BrokenPipe
    {
        // Later errors follow from the first.
        let _ = WRITE_ERROR.set(error);
    }
}

/// Fails if a result could not be written to stdout.
pub fn finish() -> Result<(), Failure> {
    note_written(io::stdout().flush());
    match WRITE_ERROR.get() {
        Some(error) => Err(Failure::Machine(anyhow!("can't write the output: {}", reason(error)))),
        None => Ok(()),
    }
}

/// Prints a line on what the command is doing or has done.
pub fn progress(text: impl Display) {
    let _ = writeln!(io::stderr(), "{text}");
}

/// Prints a warning.
pub fn warning(text: impl Display) {
    progress(format_args!("warning: {text}"));
}

/// Prints the error that ended the program.
pub fn error(error: &anyhow::Error) {
    let words = |cause: &(dyn std::error::Error + 'static)| match cause.downcast_ref::<io::Error>() {
        Some(error) => reason(error),
        None => cause.to_string(),
    };
    let causes: Vec<String> = error.chain().map(words).collect();
    progress(format_args!("catchlight: {}", causes.join(": ")));
}
