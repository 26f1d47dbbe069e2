//! `catchlight truth`: the README's table of readings beside closed forms, measured anew. For developers; hidden.

use super::{Failure, say};
use crate::truth;

/// No arguments.
#[derive(Debug, clap::Args)]
pub struct Arguments {}

/// Prints the table; fails when a row is further off than sampling explains.
pub fn run(_arguments: &Arguments) -> Result<(), Failure> {
    let rows = truth::rows();
    say(truth::markdown(&rows).trim_end());
    let wrong: Vec<&str> = rows
        .iter()
        .filter(|row| row.difference().abs().partial_cmp(&row.tolerance).is_none_or(|o| o.is_gt()))
        .map(|row| row.case.as_str())
        .collect();
    if wrong.is_empty() {
        Ok(())
    } else {
        Err(Failure::Input(anyhow::anyhow!("further off than it should be: {}", wrong.join("; "))))
    }
}
