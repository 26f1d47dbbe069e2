//! Finds the files that a scene refers to, and copies them beside a saved scene.

use super::contained_file::find_in;
use super::error::AssetError;
use super::{atomic, importers, obj, photometric, texture};
use crate::scene::{AssetRef, Assets, IntensityTable, Mesh, Scene, Texture, TextureRef};
use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The places of a scene's asset files.
#[derive(Clone, Copy, Debug)]
pub struct AssetFiles<'a> {
    /// The scene file's folder, which the scene's paths are relative to; `None` for a scene without a file.
    pub folder: Option<&'a Path>,
    /// Files that lie elsewhere until the scene is saved, by the scene's path for them.
    pub imported: &'a BTreeMap<String, PathBuf>,
}

/// A file that a save has to write beside the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct AssetCopy {
    /// Its content.
    pub from: AssetSource,
    /// Its place beside the saved scene.
    pub to: PathBuf,
}

/// The content of an asset's file.
#[derive(Clone, Debug, PartialEq)]
pub enum AssetSource {
    /// That of another file.
    File(PathBuf),
    /// A mesh whose file no longer exists.
    Mesh(Arc<Mesh>),
    /// A texture whose file no longer exists.
    Texture(Arc<Texture>),
    /// The distribution of a photometric file that no longer exists.
    Photometry(Arc<IntensityTable>),
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

    /// Returns the files of a scene's assets, by the scene's paths. Those that are not found are left out.
    pub fn found(&self, scene: &Scene) -> BTreeMap<String, PathBuf> {
        let paths: BTreeSet<String> = scene.assets().filter_map(|(_, asset)| asset.path().map(str::to_owned)).collect();
        paths.into_iter().filter_map(|path| self.find(&path).ok().map(|file| (path, file))).collect()
    }

    /// Returns the copies that make every file of the scene lie where a scene file in `folder` looks for it. A file that
    /// was deleted after it was loaded is written from `assets`; those of a format that is not written are returned second,
    /// by the scene's paths. Files that exist in neither are left out.
    pub fn copies_into(&self, folder: &Path, scene: &Scene, assets: &Assets) -> (Vec<AssetCopy>, Vec<String>) {
        let mut gone = Vec::new();
        let by_path: BTreeMap<String, AssetRef<'_>> =
            scene.assets().filter_map(|(_, asset)| Some((asset.path()?.to_owned(), asset))).collect();
        let copy = |(path, asset): (String, AssetRef<'_>)| {
            let file = self.imported.get(&path).cloned().or_else(|| Some(self.folder?.join(&path)));
            let to = folder.join(&path);
            match file.filter(|file| file.exists()) {
                Some(file) => (file != to).then_some(AssetCopy { from: AssetSource::File(file), to }),
                None => {
                    let content = in_memory(&asset, assets);
                    gone.extend((content.is_none() && assets.contains(&asset)).then_some(path));
                    Some(AssetCopy { from: content?, to })
                }
            }
        };
        let copies: Vec<AssetCopy> = by_path.into_iter().filter_map(copy).collect();
        let companions: Vec<AssetCopy> = copies.iter().flat_map(companions).collect();
        (copies.into_iter().chain(companions).collect(), gone)
    }
}

impl AssetCopy {
    /// Writes the file, and makes its folder if need be. A file that is there already is never overwritten, and one that
    /// could not be written as a whole is removed.
    ///
    /// # Errors
    /// If another file has the name, or if a file can't be read or written.
    pub fn make(&self) -> Result<(), AssetError> {
        let AssetCopy { from, to } = self;
        let failed = |error| match from {
            AssetSource::File(file) => AssetError::Copy { error, path: file.clone() },
            AssetSource::Mesh(_) | AssetSource::Texture(_) | AssetSource::Photometry(_) => {
                AssetError::Copy { error, path: to.clone() }
            }
        };
        if to.exists() {
            let is_same = from.content(to).map_err(failed)? == std::fs::read(to).map_err(failed)?;
            return if is_same { Ok(()) } else { Err(AssetError::NameTaken { path: to.clone() }) };
        }
        if let Some(folder) = to.parent() {
            std::fs::create_dir_all(folder).map_err(failed)?;
        }
        match from {
            AssetSource::File(file) => File::open(file).and_then(|file| atomic::write_new(to, file)),
            memory => memory.content(to).and_then(|content| atomic::write_new(to, &content[..])),
        }
        .map_err(failed)
    }
}

impl AssetSource {
    /// Returns the bytes of a file at `to`.
    fn content(&self, to: &Path) -> std::io::Result<Vec<u8>> {
        match self {
            AssetSource::File(file) => std::fs::read(file),
            AssetSource::Photometry(table) => Ok(photometric::encode(table).into_bytes()),
            AssetSource::Mesh(mesh) => Ok(obj::write(mesh).into_bytes()),
            AssetSource::Texture(image) => texture::encode(image, to).map_err(std::io::Error::other),
        }
    }
}

/// Returns the copies of the files with data of a model that is copied itself.
fn companions(copy: &AssetCopy) -> Vec<AssetCopy> {
    let AssetSource::File(model) = &copy.from else { return Vec::new() };
    let beside = |name: String| {
        let from = AssetSource::File(find_in(&name, model.parent()).ok()?);
        Some(AssetCopy { from, to: copy.to.parent()?.join(name) })
    };
    importers::companions(model).into_iter().filter_map(beside).collect()
}

/// Returns a loaded asset as the content of its file. None for a format that is not written, such as a model with
/// images in its file.
fn in_memory(asset: &AssetRef<'_>, assets: &Assets) -> Option<AssetSource> {
    match asset {
        AssetRef::Mesh(path) if path.to_lowercase().ends_with(".obj") => assets.mesh(path).map(AssetSource::Mesh),
        AssetRef::Photometry(path) if path.to_lowercase().ends_with(".ies") => {
            assets.photometry(path).map(AssetSource::Photometry)
        }
        AssetRef::Texture(reference) if matches!(**reference, TextureRef::File(_)) => {
            assets.texture(reference).map(AssetSource::Texture)
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Material, MaterialTextures, Object, Room, Shape};

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
        let (copies, _) = files.copies_into(home.path(), &scene, &Assets::default());
        let to = home.path().join("models/chair.glb");
        assert_eq!(copies, [AssetCopy { from: AssetSource::File(file), to: to.clone() }]);
        copies[0].make().unwrap();
        copies[0].make().unwrap();
        std::fs::write(&to, "another chair").unwrap();
        assert!(matches!(copies[0].make(), Err(AssetError::NameTaken { .. })));
        assert_eq!(std::fs::read_to_string(&to).unwrap(), "another chair");
    }

    #[test]
    fn a_loaded_model_whose_file_is_gone_and_that_no_file_can_be_made_of_is_named() {
        let home = tempfile::tempdir().unwrap();
        let imported = BTreeMap::from([("models/chair.stl".to_owned(), home.path().join("gone.stl"))]);
        let mut scene = Scene::default();
        scene.objects.push(Object::new("Chair", Shape::MeshFile { path: "models/chair.stl".to_owned() }));
        let mut assets = Assets::default();
        assets.insert_mesh("models/chair.stl".to_owned(), Arc::default());
        let files = AssetFiles { folder: None, imported: &imported };
        assert_eq!(files.copies_into(home.path(), &scene, &assets), (vec![], vec!["models/chair.stl".to_owned()]));
    }

    #[test]
    fn a_texture_whose_file_was_deleted_is_written_from_memory() {
        let home = tempfile::tempdir().unwrap();
        let texture = Arc::new(Texture::opaque(2, 1, vec![[200, 100, 50], [1, 2, 3]]));
        let imported = BTreeMap::from([("textures/wood.png".to_owned(), home.path().join("gone.png"))]);
        let floor = Material {
            textures: MaterialTextures::with_base_color(TextureRef::file("textures/wood.png")),
            ..Material::default()
        };
        let scene = Scene { room: Some(Room { floor, ..Room::default() }), ..Scene::default() };
        let mut assets = Assets::default();
        let files = AssetFiles { folder: None, imported: &imported };
        assert_eq!(files.copies_into(home.path(), &scene, &assets), (vec![], vec![]), "it was never loaded");
        assets.insert_texture(TextureRef::file("textures/wood.png"), texture.clone());
        let (copies, _) = files.copies_into(home.path(), &scene, &assets);
        copies.iter().for_each(|copy| copy.make().unwrap());
        let written = texture::load(&home.path().join("textures/wood.png")).unwrap();
        assert_eq!(written.texture.rgb, texture.rgb);
    }
}
