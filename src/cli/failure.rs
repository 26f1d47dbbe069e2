//! Failures of commands, each with its exit code.

use crate::io::SaveError;
use crate::jobs::RenderError;
use std::io::ErrorKind;

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
        let error = error.into();
        if is_of_machine(&error) { Failure::Machine(error) } else { Failure::Input(error) }
    }
}

/// Returns true if the memory is the reason, or a disk or a folder: it is full, read-only or not the user's.
fn is_of_machine(error: &anyhow::Error) -> bool {
    if matches!(error.downcast_ref(), Some(RenderError::Memory(_))) {
        return true;
    }
    error.chain().any(|cause| {
        let system = match cause.downcast_ref::<SaveError>() {
            Some(SaveError::Write { error, .. }) => Some(error),
            _ => cause.downcast_ref(),
        };
        system.is_some_and(|error: &std::io::Error| {
            use ErrorKind::{FileTooLarge, PermissionDenied, QuotaExceeded, ReadOnlyFilesystem, StorageFull};
            matches!(error.kind(), StorageFull | QuotaExceeded | FileTooLarge | ReadOnlyFilesystem | PermissionDenied)
        })
    })
}
