//! Atomic file replacement: a reader sees the older file or the whole new one.

use super::error::SaveError;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Writes `content` to a new file beside `path`, flushes it to the disk and renames it over `path`. On failure an
/// older file at `path` is unchanged. The target of a symbolic link is replaced, the link kept. An older file's
/// permissions are kept.
pub(super) fn write(path: &Path, content: &[u8]) -> Result<(), SaveError> {
    if path.file_name().is_none() || path.is_dir() {
        return Err(SaveError::NoFileName(path.to_owned()));
    }
    let target =
        if path.is_symlink() { path.canonicalize().unwrap_or_else(|_| path.to_owned()) } else { path.to_owned() };
    let folder = folder_of(&target);
    if !folder.is_dir() {
        return Err(SaveError::NoFolder(folder));
    }
    replace(&target, &folder, content).map_err(|error| SaveError::Write { error, path: path.to_owned() })
}

fn folder_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
        _ => PathBuf::from("."),
    }
}

fn replace(target: &Path, folder: &Path, content: &[u8]) -> std::io::Result<()> {
    let older = std::fs::metadata(target).ok();
    if older.as_ref().is_some_and(|older| older.permissions().readonly()) {
        return Err(std::io::Error::new(std::io::ErrorKind::PermissionDenied, "the older file is read-only"));
    }
    let mut builder = tempfile::Builder::new();
    builder.prefix(".catchlight-").suffix(".tmp");
    #[cfg(unix)]
    {
        // The mode of `File::create`, before the umask; the default of `tempfile` is 0o600.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut file = builder.tempfile_in(folder)?;
    file.write_all(content)?;
    if let Some(older) = older {
        file.as_file().set_permissions(older.permissions())?;
    }
    file.as_file().sync_all()?;
    // On any error up to here, dropping the temporary file removes it.
    file.persist(target).map_err(|error| error.error)?;
    sync_folder(folder);
    Ok(())
}

/// Flushes the rename to the disk. Some file systems can't; the file is whole either way, so this is no error.
fn sync_folder(folder: &Path) {
    if let Err(error) = std::fs::File::open(folder).and_then(|folder| folder.sync_all()) {
        log::debug!("{} can't be synced: {error}", folder.display());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_write_replaces_the_file_and_leaves_no_other() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.ron");
        write(&path, b"one").unwrap();
        write(&path, b"two").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"two");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_missing_folder_and_a_folder_as_file_name_are_errors() {
        let folder = tempfile::tempdir().unwrap();
        let error = write(&folder.path().join("none/a.ron"), b"").unwrap_err();
        assert!(matches!(error, SaveError::NoFolder(_)), "{error}");
        assert!(matches!(write(folder.path(), b"").unwrap_err(), SaveError::NoFileName(_)));
    }

    #[cfg(unix)]
    #[test]
    fn symbolic_links_and_permissions_are_kept() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let (real, link) = (folder.path().join("real.ron"), folder.path().join("link.ron"));
        write(&real, b"one").unwrap();
        std::fs::set_permissions(&real, std::fs::Permissions::from_mode(0o640)).unwrap();
        std::os::unix::fs::symlink(&real, &link).unwrap();
        write(&link, b"two").unwrap();
        assert!(link.is_symlink());
        assert_eq!(std::fs::read(&real).unwrap(), b"two");
        assert_eq!(std::fs::metadata(&real).unwrap().permissions().mode() & 0o777, 0o640);
    }

    #[test]
    fn a_failure_keeps_the_older_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.ron");
        write(&path, b"old").unwrap();
        let mut permissions = std::fs::metadata(&path).unwrap().permissions();
        permissions.set_readonly(true);
        std::fs::set_permissions(&path, permissions).unwrap();
        assert!(matches!(write(&path, b"new").unwrap_err(), SaveError::Write { .. }));
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
