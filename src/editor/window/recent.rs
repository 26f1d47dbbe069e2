//! The list of recent studios, stored in the user's settings folder as JSON.

use std::path::{Path, PathBuf};

/// Most entries.
const CAPACITY: usize = 10;
const FILE_NAME: &str = "recent.json";

/// The recent studios. Without a folder they are kept in memory only.
#[derive(Clone, Debug, Default)]
pub struct RecentFiles {
    folder: Option<PathBuf>,
    paths: Vec<PathBuf>,
}

impl RecentFiles {
    /// Reads the list from a settings folder. A missing or broken file is an empty list.
    pub fn load(folder: Option<PathBuf>) -> Self {
        let text = folder.as_ref().and_then(|folder| std::fs::read_to_string(folder.join(FILE_NAME)).ok());
        let mut paths: Vec<PathBuf> = text.and_then(|text| serde_json::from_str(&text).ok()).unwrap_or_default();
        paths.truncate(CAPACITY);
        RecentFiles { folder, paths }
    }

    /// Returns the paths, newest first.
    pub fn paths(&self) -> &[PathBuf] {
        &self.paths
    }

    /// Adds a path at the top and writes the list.
    pub fn push(&mut self, path: &Path) {
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        self.paths.retain(|p| *p != path);
        self.paths.insert(0, path);
        self.paths.truncate(CAPACITY);
        self.store();
    }

    /// Removes a path that no longer exists.
    pub fn forget(&mut self, path: &Path) {
        self.paths.retain(|p| p != path);
        self.store();
    }

    /// Clears the list.
    pub fn clear(&mut self) {
        self.paths.clear();
        self.store();
    }

    fn store(&self) {
        let Some(folder) = &self.folder else { return };
        let written = std::fs::create_dir_all(folder)
            .and_then(|()| serde_json::to_vec_pretty(&self.paths).map_err(std::io::Error::other))
            .and_then(|json| std::fs::write(folder.join(FILE_NAME), json));
        if let Err(error) = written {
            // The loss of this list needs no message to the user.
            log::warn!("the list of recent studios could not be written: {error}");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_list_survives_and_keeps_each_path_once() {
        let folder = tempfile::tempdir().unwrap();
        let mut recent = RecentFiles::load(Some(folder.path().to_owned()));
        for i in 0..12 {
            recent.push(Path::new(&format!("/studios/{i}.ron")));
        }
        recent.push(Path::new("/studios/5.ron"));
        let again = RecentFiles::load(Some(folder.path().to_owned()));
        assert_eq!(again.paths().len(), CAPACITY);
        assert_eq!(again.paths()[0], Path::new("/studios/5.ron"));
        assert_eq!(again.paths().iter().filter(|p| p.ends_with("5.ron")).count(), 1);
    }

    #[test]
    fn a_broken_list_is_empty() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(FILE_NAME), "[1, {").unwrap();
        assert!(RecentFiles::load(Some(folder.path().to_owned())).paths().is_empty());
    }
}
