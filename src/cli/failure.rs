//! Failures of commands, each with its exit code.

/// The reason why a command ended without its result.
#[derive(Debug)]
pub enum Failure {
    /// The input is wrong: exit code 1.
    Input(anyhow::Error),
    /// The machine cannot do it: exit code 2.
    Machine(anyhow::Error),
    /// Interrupted, with what was rendered kept: exit code 130.
    Interrupted,
}

impl<E: Into<anyhow::Error>> From<E> for Failure {
    fn from(error: E) -> Self {
        Failure::Input(error.into())
    }
}
