//! The open studio: scene, assets, file, history. The scene changes only in [`Document::apply`], undo and redo.

use crate::editor::document::action::Action;
use crate::editor::document::action_error::ActionError;
use crate::editor::document::history::{History, MergeKey};
use crate::editor::document::item::Item;
use crate::editor::document::revisions::Revisions;
use crate::io::{self, AssetFiles};
use crate::scene::{AssetKey, Assets, Finding, Scene, SceneChange, Severity, validate};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The open studio.
#[derive(Clone, Debug, Default)]
pub struct Document {
    scene: Scene,
    assets: Assets,
    path: Option<PathBuf>,
    saved: Scene,
    history: History,
    revisions: Revisions,
    /// Imported files by asset path, until a save copies them beside the scene.
    imported: BTreeMap<String, PathBuf>,
    /// Assets that could not be loaded; they are not retried until the scene is opened again.
    failed: BTreeSet<AssetKey>,
}

impl Document {
    /// Returns the document of a loaded studio.
    pub fn new(scene: Scene, assets: Assets, path: Option<PathBuf>) -> Self {
        let saved = scene.clone();
        let revisions = Revisions::new();
        let mut document = Document { scene, assets, path, saved, revisions, ..Document::default() };
        // Missing assets have been reported by loading.
        document.failed = document.missing_assets();
        document
    }

    /// Returns the current scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Returns the loaded meshes and textures.
    pub fn assets(&self) -> &Assets {
        &self.assets
    }

    /// Returns the file, if any.
    pub fn path(&self) -> Option<&Path> {
        self.path.as_deref()
    }

    /// Returns the folder that asset paths are relative to.
    pub fn folder(&self) -> Option<&Path> {
        self.path.as_deref().and_then(Path::parent)
    }

    /// Returns the revision number: a new one after every change of scene or assets and for every opened studio.
    pub fn revision(&self) -> u64 {
        self.revisions.document
    }

    /// Returns the revision numbers by what a change makes stale.
    pub fn revisions(&self) -> Revisions {
        self.revisions
    }

    /// Returns true if there are unsaved changes.
    pub fn is_dirty(&self) -> bool {
        self.scene != self.saved
    }

    /// Returns the undo and redo lists.
    pub fn history(&self) -> &History {
        &self.history
    }

    /// Returns the file's name, else the studio's title, else "Untitled".
    pub fn title(&self) -> String {
        let file = self.path.as_deref().and_then(Path::file_name).map(|name| name.to_string_lossy().into_owned());
        let name = (!self.scene.name.is_empty()).then(|| self.scene.name.clone());
        file.or(name).unwrap_or_else(|| "Untitled".to_owned())
    }

    /// Applies an action as one undo step; returns the items to select. Steps of one `press_id` (one press of the
    /// mouse) with equal targets are merged. On an error the scene is unchanged.
    pub fn apply(&mut self, action: Action, press_id: Option<u64>) -> Result<Vec<Item>, ActionError> {
        let before = self.scene.clone();
        let label = action.label(&before);
        let targets = action.targets();
        let merge = press_id.filter(|_| !targets.is_empty()).map(|press_id| MergeKey { press_id, targets });
        let done = action.apply(&mut self.scene).and_then(|select| match new_error(&before, &self.scene) {
            Some(error) => Err(ActionError::Invalid(error.message)),
            None => Ok(select),
        });
        if done.is_err() {
            self.scene = before;
        } else if self.scene != before {
            self.revisions.note(&SceneChange::between(&before, &self.scene));
            self.history.record(before, label, merge);
        }
        done
    }

    /// Discards the changes of a press.
    pub fn abandon(&mut self, press_id: u64) {
        self.step_history(|history, scene| history.abandon(scene, press_id).then_some(()));
    }

    /// Undoes the last step; returns its label.
    pub fn undo(&mut self) -> Option<String> {
        self.step_history(History::undo)
    }

    /// Redoes a step; returns its label.
    pub fn redo(&mut self) -> Option<String> {
        self.step_history(History::redo)
    }

    /// Steps through the history and updates the revisions.
    fn step_history<T>(&mut self, step: impl FnOnce(&mut History, &mut Scene) -> Option<T>) -> Option<T> {
        let before = self.scene.clone();
        let done = step(&mut self.history, &mut self.scene);
        if done.is_some() {
            self.revisions.note(&SceneChange::between(&before, &self.scene));
        }
        done
    }

    /// Returns the assets that the scene refers to and that are neither loaded nor failed.
    pub fn wanted_assets(&self) -> BTreeSet<AssetKey> {
        &self.missing_assets() - &self.failed
    }

    fn missing_assets(&self) -> BTreeSet<AssetKey> {
        io::missing_assets(&self.scene, &self.assets).into_iter().map(|(_, key)| key).collect()
    }

    /// Adds assets that were loaded in the background. Those of `tried` that are still missing have failed.
    pub fn insert_assets(&mut self, loaded: Assets, tried: &BTreeSet<AssetKey>) {
        self.assets.extend(loaded);
        self.assets.drop_unused_figures(&self.scene);
        self.failed.extend(self.missing_assets().intersection(tried).cloned());
        self.revisions = Revisions::new();
    }

    /// Records the file behind an asset path until a save copies it beside the scene.
    pub fn note_import(&mut self, asset_path: String, file: PathBuf) {
        self.failed.retain(|key| key.path() != Some(&asset_path));
        self.imported.insert(asset_path, file);
    }

    /// Returns the imported files that no save has copied beside the scene, by asset path.
    pub fn imported_files(&self) -> &BTreeMap<String, PathBuf> {
        &self.imported
    }

    /// Returns the asset path of a file: its path under the scene's folder, or else a free name in `models/` or
    /// `textures/`, where a save copies it.
    pub fn asset_path_for(&self, file: &Path, kind_folder: &str) -> String {
        let under = self.folder().and_then(|folder| {
            let (file, folder) = (file.canonicalize().ok()?, folder.canonicalize().ok()?);
            file.strip_prefix(folder).ok().map(Path::to_owned)
        });
        if let Some(inside) = under {
            return inside.iter().map(|part| part.to_string_lossy()).collect::<Vec<_>>().join("/");
        }
        let stem = file.file_stem().map_or_else(|| "file".to_owned(), |s| s.to_string_lossy().into_owned());
        let ending = file.extension().map(|e| format!(".{}", e.to_string_lossy())).unwrap_or_default();
        let name = |n: u32| match n {
            1 => format!("{kind_folder}/{stem}{ending}"),
            n => format!("{kind_folder}/{stem}-{n}{ending}"),
        };
        let is_free = |name: &String| match self.imported.get(name) {
            Some(other) => other == file,
            None => {
                let exists = self.folder().is_some_and(|folder| folder.join(name).exists());
                !exists && !self.assets.contains_file(name)
            }
        };
        (1..10_000).map(name).find(is_free).unwrap_or_else(|| name(1))
    }

    /// Returns the places of the scene's asset files.
    pub fn asset_files(&self) -> AssetFiles<'_> {
        AssetFiles { folder: self.folder(), imported: &self.imported }
    }

    /// Marks the current scene as saved to `path`.
    pub fn mark_saved(&mut self, path: PathBuf) {
        self.imported.clear();
        self.saved = self.scene.clone();
        self.path = Some(path);
    }
}

/// Returns an error of the scene that it did not have before.
fn new_error(before: &Scene, after: &Scene) -> Option<Finding> {
    let errors = |scene| validate(scene).into_iter().filter(|f| f.severity == Severity::Error);
    let old: Vec<Finding> = errors(before).collect();
    errors(after).find(|error| !old.contains(error))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::document::catalog;

    fn with_a_light() -> (Document, crate::scene::Light) {
        let mut document = Document::default();
        let light = catalog::light_named("Octa 120").unwrap();
        document.apply(Action::AddLight(Box::new(light)), None).unwrap();
        let light = document.scene().lights[0].clone();
        (document, light)
    }

    #[test]
    fn a_drag_is_one_step_and_dirty_ends_where_it_began() {
        let (mut document, mut light) = with_a_light();
        document.mark_saved("a.ron".into());
        for i in 0..20 {
            light.position.x = i as f32 * 0.1;
            document.apply(Action::SetLight(Box::new(light.clone())), Some(7)).unwrap();
        }
        assert!(document.is_dirty());
        assert_eq!(document.undo().as_deref(), Some("Move Octa 120"));
        assert!(!document.is_dirty());
        document.redo();
        assert_eq!(document.scene().lights[0].position.x, 1.9);
    }

    #[test]
    fn two_studios_are_never_at_the_same_revision() {
        // Regression: the meter kept the reading of the previous studio, since both were at their first revision.
        let open = || Document::new(Scene::default(), Assets::default(), None);
        assert_ne!(open().revision(), open().revision());
        assert_ne!(open().revision(), Document::default().revision());
    }

    #[test]
    fn a_rejected_action_changes_nothing() {
        let (mut document, _) = with_a_light();
        let (revision, depth) = (document.revision(), document.history().depth());
        assert!(document.apply(Action::Rename(Item::Camera, "Eye".into()), None).is_err());
        let same = document.scene().camera.clone();
        document.apply(Action::SetCamera(Box::new(same)), None).unwrap();
        assert_eq!((revision, depth), (document.revision(), document.history().depth()));
    }

    #[test]
    fn imported_files_get_relative_names_that_do_not_clash() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("props")).unwrap();
        std::fs::write(folder.path().join("props/chair.obj"), "").unwrap();
        let path = Some(folder.path().join("a.ron"));
        let mut document = Document::new(Scene::default(), Assets::default(), path);
        assert_eq!(document.asset_path_for(&folder.path().join("props/chair.obj"), "models"), "props/chair.obj");
        let outside = Path::new("/somewhere/chair.obj");
        assert_eq!(document.asset_path_for(outside, "models"), "models/chair.obj");
        document.note_import("models/chair.obj".into(), "/elsewhere/chair.obj".into());
        assert_eq!(document.asset_path_for(outside, "models"), "models/chair-2.obj");
    }
}
