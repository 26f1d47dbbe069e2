//! Reads whole files of bounded size.

use super::error::AssetError;
use std::io::{ErrorKind, Read};
use std::path::Path;

/// Returns the content of a regular file of at most `limit_bytes` bytes.
///
/// # Errors
/// If the file can't be read, is no regular file, or is larger than the limit.
pub(super) fn read_limited(path: &Path, limit_bytes: u64) -> Result<Vec<u8>, AssetError> {
    let read_error = |error| AssetError::Read { error, path: path.to_owned() };
    // Opening a pipe would block until another program writes to it.
    let metadata = std::fs::metadata(path).map_err(read_error)?;
    if !metadata.is_file() {
        return Err(read_error(std::io::Error::new(ErrorKind::InvalidInput, "it is no regular file")));
    }
    let file = std::fs::File::open(path).map_err(read_error)?;
    let mut bytes = Vec::with_capacity(usize::try_from(metadata.len().min(limit_bytes)).unwrap_or_default());
    file.take(limit_bytes + 1).read_to_end(&mut bytes).map_err(read_error)?;
    if bytes.len() as u64 > limit_bytes {
        let amount = metadata.len().max(bytes.len() as u64);
        let (what, path) = ("the file's number of bytes", path.to_owned());
        return Err(AssetError::TooLarge { what, amount, limit: limit_bytes, path });
    }
    Ok(bytes)
}
