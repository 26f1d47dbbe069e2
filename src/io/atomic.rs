//! Atomic file replacement: a reader sees the older file or the whole new one.

use super::error::SaveError;
use std::fs::{File, Metadata};
use std::io::{self, Cursor, ErrorKind, Read, Seek, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};
use tempfile::NamedTempFile;

/// First and last characters of the names of temporary files.
const TEMPORARY: (&str, &str) = (".catchlight-", ".tmp");
/// Age from which a temporary file is one that a killed save has left.
const LEFT_OVER_AGE: Duration = Duration::from_secs(3600);

/// Writes `content` to a new file beside `path`, flushes it to the disk and renames it over `path`. On failure an
/// older file at `path` is unchanged. The target of a symbolic link is replaced, the link kept. An older file's
/// permissions are kept.
pub(super) fn write(path: &Path, content: &[u8]) -> Result<(), SaveError> {
    write_with(path, |file| file.write_all(content))
}

/// As [`write()`], with the content that `fill` writes.
pub(super) fn write_with(path: &Path, fill: impl FnOnce(&mut File) -> io::Result<()>) -> Result<(), SaveError> {
    let target = Target::of(path)?;
    if target.is_special() {
        return Err(SaveError::NotRegular(path.to_owned()));
    }
    let written = target.replace(fill);
    remove_left_over(&target.folder);
    written.map_err(|error| SaveError::Write { error, path: path.to_owned() })
}

/// A destination of content that is not written from beginning to end.
pub(super) trait WriteSeek: Write + Seek {}
impl<T: Write + Seek> WriteSeek for T {}

/// As [`write_with`]; a pipe and a device of characters, such as `/dev/stdout`, take the content and are not replaced.
pub(super) fn send(path: &Path, fill: impl Fn(&mut dyn WriteSeek) -> io::Result<()>) -> Result<(), SaveError> {
    if !Target::of(path)?.takes_a_stream() {
        return write_with(path, |file| fill(file));
    }
    let mut content = Cursor::new(Vec::new());
    let sent = fill(&mut content).and_then(|()| {
        let mut stream = File::options().write(true).open(path)?;
        stream.write_all(content.get_ref())
    });
    sent.map_err(|error| SaveError::Write { error, path: path.to_owned() })
}

/// Writes what `content` reads to a new file at `path`, or nothing: on failure there is no file.
///
/// # Errors
/// If `content` can't be read to its end, if the file can't be written, or if there is a file of this name.
pub(super) fn write_new(path: &Path, mut content: impl Read) -> io::Result<()> {
    let folder = folder_of(path);
    let mut file = temporary_file(&folder)?;
    io::copy(&mut content, file.as_file_mut())?;
    file.as_file().sync_all()?;
    // Some file systems of memory cards have no way to rename to a name that must be free.
    let placed = file.persist_noclobber(path).or_else(|error| match error.error.kind() {
        ErrorKind::AlreadyExists => Err(error.error),
        _ => error.file.persist(path).map_err(|error| error.error),
    });
    sync_folder(&folder);
    remove_left_over(&folder);
    placed.map(drop)
}

/// Fails if [`send`] to `path` would fail now. Leaves no file.
pub(super) fn check(path: &Path) -> Result<(), SaveError> {
    let target = Target::of(path)?;
    if target.takes_a_stream() {
        return Ok(());
    }
    if target.is_special() {
        return Err(SaveError::NotRegular(path.to_owned()));
    }
    target
        .check_older()
        .and_then(|()| temporary_file(&target.folder).map(drop))
        .map_err(|error| SaveError::Write { error, path: path.to_owned() })
}

/// The file to write.
struct Target {
    /// The file, behind symbolic links.
    file: PathBuf,
    folder: PathBuf,
    /// The older file, if any.
    older: Option<Metadata>,
}

impl Target {
    fn of(path: &Path) -> Result<Self, SaveError> {
        if path.file_name().is_none() || path.is_dir() {
            return Err(SaveError::NoFileName(path.to_owned()));
        }
        let file =
            if path.is_symlink() { path.canonicalize().unwrap_or_else(|_| path.to_owned()) } else { path.to_owned() };
        let folder = folder_of(&file);
        if !folder.is_dir() {
            return Err(SaveError::NoFolder(folder));
        }
        let older = match std::fs::metadata(&file) {
            Ok(older) => Some(older),
            Err(error) if error.kind() == ErrorKind::NotFound => None,
            // A name that is too long, a folder that may not be searched.
            Err(error) => return Err(SaveError::Write { error, path: path.to_owned() }),
        };
        Ok(Target { file, folder, older })
    }

    /// Returns true for a pipe, a device or a socket.
    fn is_special(&self) -> bool {
        self.older.as_ref().is_some_and(|older| !older.is_file())
    }

    /// Returns true for a pipe and for a device of characters.
    #[cfg(unix)]
    fn takes_a_stream(&self) -> bool {
        use std::os::unix::fs::FileTypeExt;
        let kind = self.older.as_ref().map(Metadata::file_type);
        kind.is_some_and(|kind| kind.is_fifo() || kind.is_char_device())
    }

    #[cfg(not(unix))]
    fn takes_a_stream(&self) -> bool {
        false
    }

    fn check_older(&self) -> io::Result<()> {
        match &self.older {
            Some(older) if older.permissions().readonly() => {
                Err(io::Error::new(ErrorKind::PermissionDenied, "the older file is read-only"))
            }
            _ => Ok(()),
        }
    }

    fn replace(&self, fill: impl FnOnce(&mut File) -> io::Result<()>) -> io::Result<()> {
        self.check_older()?;
        let mut file = temporary_file(&self.folder)?;
        fill(file.as_file_mut())?;
        if let Some(older) = &self.older {
            file.as_file().set_permissions(older.permissions())?;
        }
        file.as_file().sync_all()?;
        // On any error up to here, dropping the temporary file removes it.
        file.persist(&self.file).map_err(|error| error.error)?;
        sync_folder(&self.folder);
        Ok(())
    }
}

fn folder_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
        _ => PathBuf::from("."),
    }
}

fn temporary_file(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(TEMPORARY.0).suffix(TEMPORARY.1);
    #[cfg(unix)]
    {
        // The mode of `File::create`, before the umask; the default of `tempfile` is 0o600.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder)
}

/// Removes the temporary files that killed saves have left in a folder.
fn remove_left_over(folder: &Path) {
    let is_old = |path: &Path| {
        let modified = std::fs::symlink_metadata(path).and_then(|metadata| metadata.modified()).ok();
        modified.and_then(|at| SystemTime::now().duration_since(at).ok()).is_some_and(|age| age > LEFT_OVER_AGE)
    };
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let is_temporary =
            name.to_str().is_some_and(|name| name.starts_with(TEMPORARY.0) && name.ends_with(TEMPORARY.1));
        if is_temporary
            && is_old(&entry.path())
            && let Err(error) = std::fs::remove_file(entry.path())
        {
            log::debug!("{} can't be removed: {error}", entry.path().display());
        }
    }
}

/// Flushes the rename to the disk. Some file systems can't; the file is whole either way, so this is no error.
fn sync_folder(folder: &Path) {
    if let Err(error) = File::open(folder).and_then(|folder| folder.sync_all()) {
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
    fn a_save_removes_what_killed_saves_have_left_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let old = SystemTime::now() - 2 * LEFT_OVER_AGE;
        for (name, modified) in [
            (".catchlight-killed.tmp", old),
            (".catchlight-running.tmp", SystemTime::now()),
            ("catchlight-mine.tmp", old),
            (".catchlight-notes.txt", old),
        ] {
            File::create(folder.path().join(name)).unwrap().set_modified(modified).unwrap();
        }
        write(&folder.path().join("a.ron"), b"").unwrap();
        let entries = std::fs::read_dir(folder.path()).unwrap();
        let mut names: Vec<String> = entries.map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        assert_eq!(names, [".catchlight-notes.txt", ".catchlight-running.tmp", "a.ron", "catchlight-mine.tmp"]);
    }

    #[test]
    fn a_copy_that_a_full_disk_stops_half_way_leaves_no_file() {
        struct Failing(u32);
        impl Read for Failing {
            fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
                self.0 -= 1;
                if self.0 == 0 { Err(ErrorKind::StorageFull.into()) } else { Ok(bytes.len()) }
            }
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("cup.obj");
        assert_eq!(write_new(&path, Failing(3)).unwrap_err().kind(), ErrorKind::StorageFull);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
        write_new(&path, &b"whole"[..]).unwrap();
        assert_eq!(write_new(&path, &b"another"[..]).unwrap_err().kind(), ErrorKind::AlreadyExists);
        assert_eq!(std::fs::read(&path).unwrap(), b"whole");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[cfg(unix)]
    #[test]
    fn a_studio_is_not_saved_over_a_device_or_into_a_pipe() {
        let folder = tempfile::tempdir().unwrap();
        let link = folder.path().join("a.ron");
        std::os::unix::fs::symlink("/dev/null", &link).unwrap();
        assert!(matches!(write(&link, b"").unwrap_err(), SaveError::NotRegular(_)));
        // A picture may go there.
        send(&link, |out| out.write_all(b"a picture")).unwrap();
        assert!(link.is_symlink() && !std::fs::metadata("/dev/null").unwrap().is_file());
    }

    #[test]
    fn a_failure_keeps_the_older_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.ron");
        write(&path, b"old").unwrap();
        let mut permissions = std::fs::metadata(&path).unwrap().permissions();
        permissions.set_readonly(true);
        std::fs::set_permissions(&path, permissions).unwrap();
        assert!(matches!(check(&path).unwrap_err(), SaveError::Write { .. }));
        assert!(matches!(write(&path, b"new").unwrap_err(), SaveError::Write { .. }));
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
