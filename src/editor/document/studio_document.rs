//! The open studio: scene, assets, file, history. The scene changes only in [`Document::apply`], undo and redo.

use crate::editor::document::action::Action;
use crate::editor::document::action_error::ActionError;
use crate::editor::document::history::{History, MergeKey};
use crate::editor::document::item::Item;
use crate::editor::document::revisions::Revisions;
use crate::scene::{AssetRef, Assets, Finding, Scene, SceneChange, Severity, validate};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// A studio that is open in the window.
#[derive(Clone, Debug, Default)]
pub struct Document {
    scene: Scene,
    assets: Assets,
    path: Option<PathBuf>,
    saved: Scene,
    history: History,
    revisions: Revisions,
    /// Where the files behind asset paths lie, when they were imported and not yet saved beside the scene.
    imported: BTreeMap<String, PathBuf>,
    /// Asset paths that could not be loaded; they are not tried again until the scene is opened again.
    failed: BTreeSet<String>,
}

impl Document {
    /// A studio as it was loaded.
    pub fn new(scene: Scene, assets: Assets, path: Option<PathBuf>) -> Self {
        let saved = scene.clone();
        let revisions = Revisions::new();
        let mut document = Document { scene, assets, path, saved, revisions, ..Document::default() };
        // What loading could not find has been reported by loading.
        document.failed = document.missing_assets();
        document
    }

    /// The studio now.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Its meshes and textures, as far as they are loaded.
    pub fn assets(&self) -> &Assets {
        &self.assets
    }

    /// Its file, once it has one.
    pub fn path(&self) -> Option<&Path> {
        self.path.as_deref()
    }

    /// The folder that asset paths are relative to.
    pub fn folder(&self) -> Option<&Path> {
        self.path.as_deref().and_then(Path::parent)
    }

    /// Another number after every change of scene or assets, and for every studio that is opened: what is shown is up
    /// to date when it was made from this number.
    pub fn revision(&self) -> u64 {
        self.revisions.document
    }

    /// Revision numbers by what a change makes stale.
    pub fn revisions(&self) -> Revisions {
        self.revisions
    }

    /// Whether there is something to save.
    pub fn is_dirty(&self) -> bool {
        self.scene != self.saved
    }

    /// The undo and redo lists.
    pub fn history(&self) -> &History {
        &self.history
    }

    /// The studio's title, or its file's name, or "Untitled".
    pub fn title(&self) -> String {
        let file = self.path.as_deref().and_then(Path::file_name).map(|name| name.to_string_lossy().into_owned());
        let name = (!self.scene.name.is_empty()).then(|| self.scene.name.clone());
        file.or(name).unwrap_or_else(|| "Untitled".to_owned())
    }

    /// Does an action as one undo step; returns what should be selected then, if anything. Steps of one `press_id` (one
    /// press of the mouse) on the same things join. On an error the scene is as it was.
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

    /// Gives up what a press has changed so far, as if it had never begun.
    pub fn abandon(&mut self, press_id: u64) {
        self.step_history(|history, scene| history.abandon(scene, press_id).then_some(()));
    }

    /// Takes the last step back; returns what it was.
    pub fn undo(&mut self) -> Option<String> {
        self.step_history(History::undo)
    }

    /// Does a step again; returns what it was.
    pub fn redo(&mut self) -> Option<String> {
        self.step_history(History::redo)
    }

    /// Replaces the scene by one of the history, if there is one.
    fn step_history<T>(&mut self, step: impl FnOnce(&mut History, &mut Scene) -> Option<T>) -> Option<T> {
        let before = self.scene.clone();
        let done = step(&mut self.history, &mut self.scene);
        if done.is_some() {
            self.revisions.note(&SceneChange::between(&before, &self.scene));
        }
        done
    }

    /// Asset paths and mannequins that the scene needs and that are neither loaded nor known to fail.
    pub fn wanted_assets(&self) -> BTreeSet<String> {
        &self.missing_assets() - &self.failed
    }

    fn missing_assets(&self) -> BTreeSet<String> {
        let missing = self.scene.assets().filter(|(_, asset)| !self.assets.contains(asset));
        missing.map(|(_, asset)| asset_label(&asset)).collect()
    }

    /// Takes in assets that were loaded in the background. What is still missing of `tried` has failed.
    pub fn insert_assets(&mut self, loaded: Assets, tried: &BTreeSet<String>) {
        self.assets.meshes.extend(loaded.meshes);
        self.assets.mannequins.extend(loaded.mannequins);
        self.assets.textures.extend(loaded.textures);
        self.failed.extend(self.missing_assets().intersection(tried).cloned());
        self.revisions = Revisions::new();
    }

    /// Remembers where an imported file lies until a save puts it beside the scene.
    pub fn note_import(&mut self, asset_path: String, file: PathBuf) {
        self.failed.remove(&asset_path);
        self.imported.insert(asset_path, file);
    }

    /// Imported files that no save has put beside the scene yet, by the path the scene names.
    pub fn imported_files(&self) -> Vec<(String, PathBuf)> {
        self.imported.iter().map(|(path, file)| (path.clone(), file.clone())).collect()
    }

    /// The name by which the scene can refer to a file: its path under the scene's folder, or else a name of its own
    /// in `models/` or `textures/`, where a save will copy it.
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
                let in_use = self.assets.meshes.contains_key(name) || self.assets.textures.contains_key(name);
                !in_use && !self.folder().is_some_and(|folder| folder.join(name).exists())
            }
        };
        (1..10_000).map(name).find(is_free).unwrap_or_else(|| name(1))
    }

    /// The files that must be copied so that a scene in `folder` finds its assets: (from, to).
    pub fn files_to_copy(&self, folder: &Path) -> Vec<(PathBuf, PathBuf)> {
        let used: BTreeSet<String> =
            self.scene.assets().filter_map(|(_, asset)| asset.path().map(str::to_owned)).collect();
        let source = |path: &String| self.imported.get(path).cloned().or_else(|| Some(self.folder()?.join(path)));
        used.iter()
            .filter_map(|path| Some((source(path)?, folder.join(path))))
            .filter(|(from, to)| from != to && from.exists())
            .collect()
    }

    /// The scene as it is now is what the file at `path` holds.
    pub fn mark_saved(&mut self, path: PathBuf) {
        self.imported.clear();
        self.saved = self.scene.clone();
        self.path = Some(path);
    }
}

/// A name for an asset: its path, or the figure and its pose.
fn asset_label(asset: &AssetRef<'_>) -> String {
    match asset {
        AssetRef::Mesh(path) | AssetRef::Texture(path) => path.to_string(),
        AssetRef::Figure(figure) => format!("{figure:?}"),
    }
}

/// An error of the scene that it did not have before.
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
        // The meter went on showing the studio that was open before: both were at their first revision.
        let open = || Document::new(Scene::default(), Assets::default(), None);
        assert_ne!(open().revision(), open().revision());
        assert_ne!(open().revision(), Document::default().revision());
    }

    #[test]
    fn a_refused_action_leaves_no_trace() {
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
