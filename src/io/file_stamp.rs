//! The state of a file at a time, to notice that another program has changed it.

use serde::{Deserialize, Serialize};
use std::fs::Metadata;
use std::hash::{DefaultHasher, Hasher};
use std::io;
use std::path::Path;
use std::time::SystemTime;

/// Size, time and content of a file when it was read or written.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FileStamp {
    bytes: u64,
    /// None where the file system stores no times.
    modified: Option<SystemTime>,
    /// Hash of the content.
    hash: u64,
}

impl FileStamp {
    /// Returns the stamp of a file as it is now.
    ///
    /// # Errors
    /// If the file can't be read.
    pub fn of(path: &Path) -> io::Result<Self> {
        let metadata = std::fs::metadata(path)?;
        Ok(FileStamp { bytes: metadata.len(), modified: modified(&metadata), hash: hash(path)? })
    }

    /// Returns true if the file has other content now. The content is read only if size or time differ. A file that was
    /// deleted or can't be read has no other content.
    pub fn is_outdated(&self, path: &Path) -> bool {
        let Ok(metadata) = std::fs::metadata(path) else { return false };
        let is_untouched =
            metadata.len() == self.bytes && self.modified.is_some() && modified(&metadata) == self.modified;
        !is_untouched && hash(path).is_ok_and(|hash| hash != self.hash)
    }
}

fn modified(metadata: &Metadata) -> Option<SystemTime> {
    metadata.modified().ok()
}

fn hash(path: &Path) -> io::Result<u64> {
    let mut hasher = DefaultHasher::new();
    hasher.write(&std::fs::read(path)?);
    Ok(hasher.finish())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn other_content_outdates_a_stamp_and_a_new_time_alone_does_not() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.ron");
        std::fs::write(&path, "one").unwrap();
        let stamp = FileStamp::of(&path).unwrap();
        let later = SystemTime::now() + Duration::from_secs(9);
        std::fs::File::options().write(true).open(&path).unwrap().set_modified(later).unwrap();
        assert!(!stamp.is_outdated(&path), "touched");
        std::fs::write(&path, "two").unwrap();
        assert!(stamp.is_outdated(&path), "of the same size");
        std::fs::write(&path, "three").unwrap();
        assert!(stamp.is_outdated(&path));
        std::fs::remove_file(&path).unwrap();
        assert!(!stamp.is_outdated(&path));
    }
}
