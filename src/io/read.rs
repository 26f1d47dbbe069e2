//! Reads whole files of bounded size.

use super::error::AssetError;
use super::load_progress::{LoadProgress, READING};
use std::io::{ErrorKind, Read};
use std::path::Path;

/// Bytes that are read at a time.
const BLOCK_BYTES: u64 = 16 << 20;

/// Returns the content of a regular file of at most `limit_bytes` bytes.
///
/// # Errors
/// If the file can't be read, is no regular file, or is larger than the limit.
pub(super) fn read_limited(path: &Path, limit_bytes: u64) -> Result<Vec<u8>, AssetError> {
    read_model(path, limit_bytes, &LoadProgress::default())
}

/// As [`read_limited`], for an import that can be cancelled.
///
/// # Errors
/// As [`read_limited`], and if the import is cancelled.
pub(super) fn read_model(path: &Path, limit_bytes: u64, progress: &LoadProgress) -> Result<Vec<u8>, AssetError> {
    let read_error = |error| AssetError::Read { error, path: path.to_owned() };
    // Opening a pipe would block until another program writes to it.
    let metadata = std::fs::metadata(path).map_err(read_error)?;
    if !metadata.is_file() {
        return Err(read_error(std::io::Error::new(ErrorKind::InvalidInput, "it is no regular file")));
    }
    let too_large = |amount| {
        let (what, path) = ("the file's number of bytes", path.to_owned());
        AssetError::TooLarge { what, amount, limit: limit_bytes, path }
    };
    if metadata.len() > limit_bytes {
        return Err(too_large(metadata.len()));
    }
    let mut file = std::fs::File::open(path).map_err(read_error)?;
    let length = usize::try_from(metadata.len()).unwrap_or_default();
    let mut bytes = Vec::with_capacity(length);
    // It may grow, and some files of the system tell no length.
    while bytes.len() as u64 <= limit_bytes {
        progress.reach_between(READING, bytes.len(), length)?;
        let part = BLOCK_BYTES.min(limit_bytes + 1 - bytes.len() as u64);
        if file.by_ref().take(part).read_to_end(&mut bytes).map_err(read_error)? == 0 {
            break;
        }
    }
    if bytes.len() as u64 > limit_bytes { Err(too_large(bytes.len() as u64)) } else { Ok(bytes) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_of_a_terabyte_is_refused_without_being_read() {
        // A sparse file; reading it would take the memory.
        let file = tempfile::NamedTempFile::new().unwrap();
        file.as_file().set_len(1 << 40).unwrap();
        let error = read_limited(file.path(), 1 << 30).unwrap_err().to_string();
        assert!(error.starts_with("the file's number of bytes is too large: 1099511627776, at most"), "{error}");
    }
}
