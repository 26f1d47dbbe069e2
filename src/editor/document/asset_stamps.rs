//! The states of the studio's asset files, to notice that another program has changed one.

use crate::io::FileStamp;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The states of asset files.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AssetStamps(BTreeMap<PathBuf, FileStamp>);

impl AssetStamps {
    /// Reads the files whose states are not known, and adds their present states.
    pub fn add_new<'f>(&mut self, files: impl IntoIterator<Item = &'f PathBuf>) {
        for file in files {
            if !self.0.contains_key(file) {
                self.renew(file);
            }
        }
    }

    /// Replaces the state of a file by the present one.
    pub fn renew(&mut self, file: &Path) {
        if let Ok(stamp) = FileStamp::of(file) {
            self.0.insert(file.to_owned(), stamp);
        }
    }

    /// Replaces the state of a file by the one that it has in `from`, if it has one.
    pub fn restore(&mut self, file: &Path, from: &AssetStamps) {
        self.0.extend(from.0.get(file).map(|stamp| (file.to_owned(), stamp.clone())));
    }

    /// Returns true if a file has other content now. One whose state is not known has not.
    pub fn is_outdated(&self, file: &Path) -> bool {
        self.0.get(file).is_some_and(|stamp| stamp.is_outdated(file))
    }
}
