//! Finds the files that a scene refers to, and copies them beside a saved scene.

use super::error::AssetError;
use crate::scene::{Scene, path_complaint};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The places of a scene's asset files.
#[derive(Clone, Copy, Debug)]
pub struct AssetFiles<'a> {
    /// The scene file's folder, which the scene's paths are relative to; `None` for a scene without a file.
    pub folder: Option<&'a Path>,
    /// Files that lie elsewhere until the scene is saved, by the scene's path for them.
    pub imported: &'a BTreeMap<String, PathBuf>,
}

/// A copy of a file that a save has to make.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AssetCopy {
    /// The file.
    pub from: PathBuf,
    /// Its place beside the saved scene.
    pub to: PathBuf,
}

impl<'a> AssetFiles<'a> {
    /// Returns the places of a scene whose files all lie in its folder.
    pub fn in_folder(folder: Option<&'a Path>) -> Self {
        static NONE: BTreeMap<String, PathBuf> = BTreeMap::new();
        AssetFiles { folder, imported: &NONE }
    }

    /// Returns the file of a path that the scene names. The file lies in the scene's folder, or is the imported one.
    ///
    /// # Errors
    /// If the path leads out of the folder, by itself or through a symbolic link; if the scene has no folder; or if
    /// there is no such file.
    pub(super) fn find(&self, path: &str) -> Result<PathBuf, AssetError> {
        let Some(file) = self.imported.get(path) else { return find_in(path, self.folder) };
        let name = file.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        find_in(&name, file.parent())
    }

    /// Returns the copies that make every file of the scene lie where a scene file in `folder` looks for it. Files that
    /// do not exist are left out.
    pub fn copies_into(&self, folder: &Path, scene: &Scene) -> Vec<AssetCopy> {
        let paths: BTreeSet<String> = scene.assets().filter_map(|(_, asset)| asset.path().map(str::to_owned)).collect();
        let source = |path: &str| self.imported.get(path).cloned().or_else(|| Some(self.folder?.join(path)));
        let copies = paths.iter().filter_map(|path| Some(AssetCopy { from: source(path)?, to: folder.join(path) }));
        copies.filter(|copy| copy.from != copy.to && copy.from.exists()).collect()
    }
}

impl AssetCopy {
    /// Copies the file, and makes its folder if need be. A file that is there already is never overwritten.
    ///
    /// # Errors
    /// If another file has the name, or if a file can't be read or written.
    pub fn make(&self) -> Result<(), AssetError> {
        let AssetCopy { from, to } = self;
        let failed = |error| AssetError::Copy { error, path: from.clone() };
        if to.exists() {
            let is_same = std::fs::read(from).map_err(failed)? == std::fs::read(to).map_err(failed)?;
            return if is_same { Ok(()) } else { Err(AssetError::NameTaken { path: to.clone() }) };
        }
        if let Some(folder) = to.parent() {
            std::fs::create_dir_all(folder).map_err(failed)?;
        }
        std::fs::copy(from, to).map(|_| ()).map_err(failed)
    }
}

/// Returns the file of a relative path. It must lie in the folder, also after symbolic links are followed.
fn find_in(path: &str, folder: Option<&Path>) -> Result<PathBuf, AssetError> {
    let bad_path = |reason| AssetError::BadPath { reason, path: path.to_owned() };
    if let Some(reason) = path_complaint(path) {
        return Err(bad_path(reason));
    }
    let folder = folder.ok_or_else(|| AssetError::NoFolder { path: path.to_owned() })?;
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let read_error = |error| AssetError::Read { error, path: folder.join(path) };
    let root = folder.canonicalize().map_err(read_error)?;
    let file = root.join(path).canonicalize().map_err(read_error)?;
    if file.starts_with(&root) { Ok(file) } else { Err(bad_path("a link leads out of the scene's folder")) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Material, MaterialTextures, Room, TextureRef};

    #[test]
    fn paths_stay_in_the_folder() {
        let folder = tempfile::tempdir().unwrap();
        let inside = folder.path().join("inside");
        std::fs::create_dir(&inside).unwrap();
        std::fs::write(inside.join("a.obj"), "").unwrap();
        std::fs::write(folder.path().join("secret.obj"), "").unwrap();
        let find = |path| AssetFiles::in_folder(Some(&inside)).find(path);
        assert!(find("a.obj").is_ok());
        for path in ["../secret.obj", "/etc/passwd", "c:/x", "x\\y", "a/../../secret.obj", ""] {
            assert!(matches!(find(path), Err(AssetError::BadPath { .. })), "{path}");
        }
        assert!(matches!(AssetFiles::in_folder(None).find("a.obj"), Err(AssetError::NoFolder { .. })));
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(folder.path().join("secret.obj"), inside.join("link.obj")).unwrap();
            assert!(matches!(find("link.obj"), Err(AssetError::BadPath { .. })));
        }
    }

    #[test]
    fn imported_files_are_found_where_they_lie_and_copied_once_beside_the_scene() {
        let (home, elsewhere) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let file = elsewhere.path().join("chair.glb");
        std::fs::write(&file, "a model with two images").unwrap();
        let imported = BTreeMap::from([("models/chair.glb".to_owned(), file.clone())]);
        let files = AssetFiles { folder: None, imported: &imported };
        assert_eq!(files.find("models/chair.glb").unwrap(), file.canonicalize().unwrap());
        let textured = |image| Material {
            textures: MaterialTextures::with_base_color(TextureRef::Embedded {
                model: "models/chair.glb".to_owned(),
                image,
            }),
            ..Material::default()
        };
        let room = Room { floor: textured(0), walls: textured(1), ..Room::default() };
        let scene = Scene { room: Some(room), ..Scene::default() };
        let copies = files.copies_into(home.path(), &scene);
        let to = home.path().join("models/chair.glb");
        assert_eq!(copies, [AssetCopy { from: file, to: to.clone() }]);
        copies[0].make().unwrap();
        copies[0].make().unwrap();
        std::fs::write(&to, "another chair").unwrap();
        assert!(matches!(copies[0].make(), Err(AssetError::NameTaken { .. })));
        assert_eq!(std::fs::read_to_string(&to).unwrap(), "another chair");
    }
}
