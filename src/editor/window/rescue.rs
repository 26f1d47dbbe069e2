//! Saves unsaved changes to a new file when no window is left.

use crate::editor::document::studio_document::Document;
use crate::io;
use std::path::{Path, PathBuf};

/// Most names tried in a folder.
const MAX_NAMES: u32 = 1000;

/// Writes unsaved changes to a new file beside the studio's own, which is unchanged; if that fails, into a new folder
/// in the first writable folder of `elsewhere`, with the studio's assets. Returns the file or the error; none without
/// unsaved changes.
pub fn rescue(document: &Document, elsewhere: &[PathBuf]) -> Option<Result<PathBuf, String>> {
    if !document.is_dirty() {
        return None;
    }
    let mut failure = "there is no folder to save it in".to_owned();
    for path in places(document, elsewhere) {
        match write(document, &path) {
            Ok(()) => return Some(Ok(path)),
            Err(error) => failure = error,
        }
    }
    Some(Err(failure))
}

/// Returns a new path in each folder, the preferred one first.
fn places(document: &Document, elsewhere: &[PathBuf]) -> Vec<PathBuf> {
    let title = document.title();
    let stem = title.strip_suffix(".ron").unwrap_or(&title).replace(['/', '\\', ':'], "-");
    let name = |n: u32| format!("{stem} (rescued {n})");
    let new_in = |folder: &Path, place: &dyn Fn(String) -> PathBuf| {
        (1..=MAX_NAMES).map(|n| folder.join(place(name(n)))).find(|path| !path.exists())
    };
    let beside = document.folder().and_then(|folder| new_in(folder, &|name| PathBuf::from(name + ".ron")));
    // A new folder each, so that models and textures do not collide with others.
    let own_folders = elsewhere.iter().filter_map(|folder| new_in(folder, &PathBuf::from));
    beside.into_iter().chain(own_folders.map(|folder| folder.join(format!("{stem}.ron")))).collect()
}

fn write(document: &Document, path: &Path) -> Result<(), String> {
    let folder = path.parent().unwrap_or(Path::new(""));
    if document.folder() != Some(folder) {
        std::fs::create_dir(folder).map_err(|error| format!("{} could not be made: {error}", folder.display()))?;
    }
    let (copies, _) = document.asset_files().copies_into(folder, document.scene(), document.assets());
    for copy in copies {
        // A missing model can be imported again; the lighting cannot be recovered.
        if let Err(error) = copy.make() {
            log::warn!("{error}");
        }
    }
    io::save_scene(document.scene(), path).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::document::action::Action;
    use crate::editor::document::catalog;
    use crate::scene::{Asset, Assets, Object, Shape};

    const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

    /// Returns a shipped studio with an added light and an imported model that is not copied beside it yet.
    fn changed_studio(path: Option<PathBuf>, model: &Path) -> Document {
        let loaded = io::presets()[0].load().unwrap();
        let mut document = Document::new(loaded.scene, loaded.assets, path);
        let light = catalog::light_named("Octa 120").unwrap();
        document.apply(Action::AddLight(Box::new(light)), None).unwrap();
        std::fs::write(model, TRIANGLE).unwrap();
        let name = document.asset_path_for(model, "models");
        let mut assets = Assets::default();
        assets.insert_mesh(name.clone(), io::import_model(model).unwrap().mesh.into());
        document.insert_assets(assets, &Default::default());
        document.note_import(name.clone(), model.to_owned());
        let object = Object { shape: Shape::MeshFile { path: name }, ..catalog::object_named("Box").unwrap() };
        document.apply(Action::AddObject(Box::new(object)), None).unwrap();
        document
    }

    /// Returns true if the file holds the studio with its assets.
    fn holds(path: &Path, document: &Document) -> bool {
        let loaded = io::load_scene(path).unwrap();
        assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
        io::write_scene(&loaded.scene) == io::write_scene(document.scene())
            && loaded.assets.iter().any(|(_, asset)| matches!(asset, Asset::Mesh(mesh) if mesh.triangles.len() == 1))
    }

    #[test]
    fn unsaved_changes_are_written_beside_the_unchanged_file() {
        let (home, desktop) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let file = home.path().join("studio.ron");
        std::fs::write(&file, "as it was").unwrap();
        let document = changed_studio(Some(file.clone()), &desktop.path().join("cup.obj"));
        for n in 1..=2 {
            let rescued = rescue(&document, &[desktop.path().to_owned()]).unwrap().unwrap();
            assert_eq!(rescued, home.path().join(format!("studio (rescued {n}).ron")), "no file is written twice");
            assert!(holds(&rescued, &document));
        }
        assert_eq!(std::fs::read_to_string(&file).unwrap(), "as it was");
    }

    #[test]
    fn an_unwritable_folder_falls_back_to_the_next_one_with_models() {
        let (home, desktop) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        // A file in place of the folder makes every write fail, as a full or removed disk does.
        let no_folder = desktop.path().join("a file");
        std::fs::write(&no_folder, "").unwrap();
        let document = changed_studio(Some(no_folder.join("studio.ron")), &desktop.path().join("cup.obj"));
        std::fs::create_dir(home.path().join("models")).unwrap();
        let other_cup = home.path().join("models/cup.obj");
        std::fs::write(&other_cup, "another cup").unwrap();
        let rescued = rescue(&document, &[no_folder.clone(), home.path().to_owned()]).unwrap().unwrap();
        assert_eq!(rescued, home.path().join("studio (rescued 1)/studio.ron"));
        assert!(holds(&rescued, &document));
        assert_eq!(std::fs::read_to_string(&other_cup).unwrap(), "another cup");
        let failure = rescue(&document, std::slice::from_ref(&no_folder)).unwrap().unwrap_err();
        assert!(failure.contains("a file"), "{failure}");
        assert!(rescue(&document, &[]).unwrap().is_err());
    }

    #[test]
    fn a_deleted_model_is_rescued_from_memory() {
        let (home, desktop) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let model = desktop.path().join("cup.obj");
        let document = changed_studio(None, &model);
        std::fs::remove_file(&model).unwrap();
        let rescued = rescue(&document, &[home.path().to_owned()]).unwrap().unwrap();
        assert!(holds(&rescued, &document));
    }

    #[test]
    fn saved_studios_are_not_rescued() {
        let home = tempfile::tempdir().unwrap();
        let mut document = changed_studio(None, &home.path().join("cup.obj"));
        document.mark_saved(home.path().join("studio.ron"));
        assert_eq!(rescue(&document, &[home.path().to_owned()]), None);
    }
}
