//! `catchlight truth`: measures the README's table of readings beside closed forms. A hidden command for
//! developers.

use super::failure::Failure;
use super::terminal;
use crate::truth;

/// No arguments.
#[derive(Debug, clap::Args)]
pub struct Arguments {}

/// Prints the table; fails if the error of a row is larger than sampling explains.
pub fn run(_arguments: &Arguments) -> Result<(), Failure> {
    let rows = truth::rows();
    terminal::result(truth::markdown(&rows).trim_end());
    let wrong: Vec<&str> = rows
        .iter()
        .filter(|row| row.difference().abs().partial_cmp(&row.tolerance).is_none_or(|o| o.is_gt()))
        .map(|row| row.case.as_str())
        .collect();
    if wrong.is_empty() {
        Ok(())
    } else {
        Err(Failure::Input(anyhow::anyhow!("the error is larger than the tolerance: {}", wrong.join("; "))))
    }
}
