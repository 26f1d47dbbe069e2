//! Unsaved studios and pictures. Each window keeps its own in a folder of its own, from which the next start recovers
//! them after a crash, a kill or a power failure.
//!
//! A folder is locked while its window runs, so that no other window takes it. The system releases the lock of a
//! program that has ended, however it ended.

use super::atomic;
use super::error::{LoadError, SaveError};
use super::file_stamp::FileStamp;
use super::kept_picture::{self, KeptPicture};
use super::scene_file::{parse_scene, read_text, write_scene};
use crate::scene::{Assets, Scene};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

/// Names of a folder's files.
const LOCK: &str = "lock";
const STUDIO: &str = "studio.ron";
/// Beginning of the studio file, before the information in JSON on the same line.
const HEADER: &str = "// Unsaved studio, kept by Catchlight: ";
/// Age from which a folder without a studio is removed. A younger one may be about to be locked.
const EMPTY_AGE: Duration = Duration::from_secs(60);

/// What is known about an unsaved studio beside its scene.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RecoveryInfo {
    /// Name of the studio for the user.
    pub title: String,
    /// Its file; none for a studio that was never saved.
    pub path: Option<PathBuf>,
    /// The state of that file when it was opened or saved last.
    pub stamp: Option<FileStamp>,
    /// Imported files that lie elsewhere until the studio is saved, by the scene's path for them.
    pub imported: BTreeMap<String, PathBuf>,
    /// Time of the last change that is kept.
    pub changed_at: SystemTime,
    /// The studio has no unsaved changes, and is kept for its picture.
    #[serde(default)]
    pub is_saved: bool,
}

/// The folder in which a window keeps its unsaved studio. Dropping it releases the folder and keeps its files.
#[derive(Debug)]
pub struct RecoveryFolder {
    path: PathBuf,
    _lock: File,
}

impl RecoveryFolder {
    /// Makes a new folder in `parent`, which is made if need be, and locks it.
    ///
    /// # Errors
    /// If the folder can't be made or locked.
    pub fn create(parent: &Path) -> io::Result<Self> {
        std::fs::create_dir_all(parent)?;
        let path = tempfile::Builder::new().prefix("window-").tempdir_in(parent)?.keep();
        let lock = File::create(path.join(LOCK))?;
        lock.try_lock()?;
        Ok(RecoveryFolder { path, _lock: lock })
    }

    /// Returns the folders in `parent` whose windows have ended and that hold a studio, the last changed first. Folders
    /// without a studio are removed.
    pub fn abandoned(parent: &Path) -> Vec<(RecoveryFolder, RecoveryInfo)> {
        let entries = std::fs::read_dir(parent).into_iter().flatten().flatten();
        let mut found: Vec<_> = entries.filter_map(|entry| abandoned(entry.path())).collect();
        found.sort_by_key(|(_, info)| std::cmp::Reverse(info.changed_at));
        found
    }

    /// Writes a studio in place of the last one. It need not be valid.
    ///
    /// # Errors
    /// If the file can't be written.
    pub fn write(&self, scene: &Scene, info: &RecoveryInfo) -> Result<(), SaveError> {
        let path = self.studio();
        let info = serde_json::to_string(info)
            .map_err(|error| SaveError::Write { error: error.into(), path: path.clone() })?;
        atomic::write(&path, format!("{HEADER}{info}\n{}", write_scene(scene)).as_bytes())
    }

    /// Reads the studio, without its assets.
    ///
    /// # Errors
    /// If it can't be read, or is no valid scene.
    pub fn read(&self) -> Result<Scene, LoadError> {
        let path = self.studio();
        let in_file = |error| LoadError::InFile { error: Box::new(error), path: path.clone() };
        Ok(parse_scene(&read_text(&path)?).map_err(in_file)?.0)
    }

    /// Returns the file of the studio.
    pub fn studio(&self) -> PathBuf {
        self.path.join(STUDIO)
    }

    /// Returns the path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns true if it holds a rendered picture.
    pub fn has_picture(&self) -> bool {
        kept_picture::file_in(&self.path).exists()
    }

    /// Writes a rendered picture in place of the last one.
    ///
    /// # Errors
    /// If a file can't be written; the last picture is kept.
    pub fn write_picture(&self, picture: &KeptPicture) -> Result<(), SaveError> {
        kept_picture::write(&self.path, picture)
    }

    /// Reads the rendered picture. None if there is none.
    ///
    /// # Errors
    /// If the picture is damaged or of another version of the program, or if its studio can't be prepared.
    pub fn read_picture(&self, assets: &Assets) -> Result<Option<KeptPicture>, String> {
        kept_picture::read(&self.path, assets)
    }

    /// Removes the rendered picture, if there is one.
    pub fn remove_picture(&self) {
        kept_picture::remove(&self.path);
    }

    /// Removes studio and picture.
    pub fn clear(&self) {
        self.remove_picture();
        // Without it there is nothing to remove.
        let _ = std::fs::remove_file(self.studio());
    }

    /// Removes the folder.
    pub fn remove(self) {
        if let Err(error) = std::fs::remove_dir_all(&self.path) {
            log::warn!("{} can't be removed: {error}", self.path.display());
        }
    }
}

/// Returns a folder that no window has locked, with its studio; removes it if it has none.
fn abandoned(path: PathBuf) -> Option<(RecoveryFolder, RecoveryInfo)> {
    let lock = File::options().write(true).open(path.join(LOCK)).ok();
    let Some(lock) = lock else {
        remove_if_old(&path);
        return None;
    };
    lock.try_lock().ok()?;
    let folder = RecoveryFolder { path, _lock: lock };
    match read_info(&folder.studio()) {
        Some(info) if info.is_saved && !folder.has_picture() => {
            folder.remove();
            None
        }
        Some(info) => Some((folder, info)),
        // A file that can't be understood stays for the user to look at.
        None if folder.studio().exists() => None,
        None => {
            folder.remove();
            None
        }
    }
}

/// Removes a folder that was made and never locked.
fn remove_if_old(path: &Path) {
    let made = std::fs::metadata(path).and_then(|metadata| metadata.modified()).ok();
    if made.and_then(|made| made.elapsed().ok()).is_some_and(|age| age > EMPTY_AGE) {
        // Fails, as it should, for a folder with files and for a file.
        let _ = std::fs::remove_dir(path);
    }
}

fn read_info(studio: &Path) -> Option<RecoveryInfo> {
    let mut line = String::new();
    BufReader::new(File::open(studio).ok()?).read_line(&mut line).ok()?;
    serde_json::from_str(line.strip_prefix(HEADER)?).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::presets;

    fn info(title: &str, seconds: u64) -> RecoveryInfo {
        RecoveryInfo {
            title: title.to_owned(),
            path: Some("studios/a \"b\"\n.ron".into()),
            stamp: None,
            imported: BTreeMap::from([("models/cup.obj".to_owned(), "/desktop/cup.obj".into())]),
            changed_at: SystemTime::UNIX_EPOCH + Duration::from_secs(seconds),
            is_saved: false,
        }
    }

    #[test]
    fn studios_of_ended_windows_are_found_and_those_of_running_ones_are_not() {
        let folder = tempfile::tempdir().unwrap();
        let parent = folder.path().join("state/recovery");
        assert!(RecoveryFolder::abandoned(&parent).is_empty());
        let windows: Vec<RecoveryFolder> = (0..4).map(|_| RecoveryFolder::create(&parent).unwrap()).collect();
        let scenes: Vec<Scene> = presets()[..3].iter().map(|preset| parse_scene(preset.text).unwrap().0).collect();
        let studios = [("first", 10), ("last", 30), ("running", 20)];
        for ((window, scene), (title, seconds)) in windows.iter().zip(&scenes).zip(studios) {
            window.write(scene, &info("before", 1)).unwrap();
            window.write(scene, &info(title, seconds)).unwrap();
        }
        assert!(RecoveryFolder::abandoned(&parent).is_empty(), "all windows run");
        let mut windows = windows.into_iter();
        drop((windows.next(), windows.next()));
        let running = windows.next();
        drop(windows);
        let found = RecoveryFolder::abandoned(&parent);
        let [(last, last_info), (first, first_info)] = &found[..] else { panic!("{found:?}") };
        assert_eq!((last_info, first_info), (&info("last", 30), &info("first", 10)));
        assert_eq!((last.read().unwrap(), first.read().unwrap()), (scenes[1].clone(), scenes[0].clone()));
        assert!(RecoveryFolder::abandoned(&parent).is_empty(), "another window has taken them");
        assert_eq!(std::fs::read_dir(&parent).unwrap().count(), 3, "the folder without a studio is removed");
        found.into_iter().for_each(|(folder, _)| folder.remove());
        drop(running);
        assert_eq!(RecoveryFolder::abandoned(&parent).len(), 1);
    }

    #[test]
    fn a_saved_studio_is_not_offered() {
        let folder = tempfile::tempdir().unwrap();
        let window = RecoveryFolder::create(folder.path()).unwrap();
        window.write(&Scene::default(), &info("saved", 1)).unwrap();
        window.clear();
        window.clear();
        drop(window);
        assert!(RecoveryFolder::abandoned(folder.path()).is_empty());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
