//! Files in a folder tree: by relative paths that do not lead out of it.

use super::error::AssetError;
use crate::scene::path_complaint;
use std::path::{Path, PathBuf};

/// Returns the file of a relative path. It must lie in the folder, also after symbolic links are followed.
pub(super) fn find_in(path: &str, folder: Option<&Path>) -> Result<PathBuf, AssetError> {
    let bad_path = |reason| AssetError::BadPath { reason, path: path.to_owned() };
    if let Some(reason) = path_complaint(path) {
        return Err(bad_path(reason));
    }
    let folder = folder.ok_or_else(|| AssetError::NoFolder { path: path.to_owned() })?;
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let read_error = |error| AssetError::Read { error, path: folder.join(path) };
    let root = folder.canonicalize().map_err(read_error)?;
    let file = root.join(path).canonicalize().map_err(read_error)?;
    if file.starts_with(&root) { Ok(file) } else { Err(bad_path("a link leads out of the studio's folder")) }
}
