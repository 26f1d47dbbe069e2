//! Files of any content, replaced atomically.

use super::atomic;
use super::error::SaveError;
use std::path::Path;

/// Writes a file. An older one is replaced atomically; a pipe or a device takes the bytes.
///
/// # Errors
/// If the folder is missing or the file can't be written.
pub fn write_file(path: &Path, content: &[u8]) -> Result<(), SaveError> {
    atomic::send(path, |out| out.write_all(content))
}

/// Checks that a file can be written, before the work for it: its folder, permissions.
///
/// # Errors
/// As [`write_file`], as far as they can be known before.
pub fn check_file(path: &Path) -> Result<(), SaveError> {
    atomic::check(path)
}
