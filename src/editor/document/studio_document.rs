//! The open studio: scene, assets, file, history. The scene changes only in [`Document::apply`], undo and redo;
//! [`Document::show_variant`] shows another of its variants.

use crate::editor::document::action::Action;
use crate::editor::document::action_error::ActionError;
use crate::editor::document::history::{History, MergeKey};
use crate::editor::document::item::Item;
use crate::editor::document::revisions::Revisions;
use crate::figures;
use crate::io::{self, AssetFiles, FileStamp};
use crate::scene::{
    AssetKey, AssetRef, Assets, Finding, ObjectId, Scene, SceneChange, Severity, Shape, Tank, TextureRef, VariantId,
    validate,
};
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Folder beside a studio for imported models.
pub const MODELS: &str = "models";
/// Folder for imported textures.
pub const TEXTURES: &str = "textures";
/// Folder for imported photometric files.
pub const LAMPS: &str = "lamps";
/// Folder for imported environment maps.
pub const ENVIRONMENTS: &str = "environments";

/// The open studio.
#[derive(Clone, Debug, Default)]
pub struct Document {
    scene: Scene,
    assets: Assets,
    path: Option<PathBuf>,
    /// State of the file when it was read or written last.
    stamp: Option<FileStamp>,
    saved: Scene,
    /// The scene differs from `saved`.
    is_changed: bool,
    /// The studio counts as changed even where it equals `saved`.
    is_unsaved: bool,
    history: History,
    revisions: Revisions,
    /// Imported files by asset path, until a save copies them beside the scene.
    imported: BTreeMap<String, PathBuf>,
    /// Assets that could not be loaded; they are not retried until the scene is opened again.
    failed: BTreeSet<AssetKey>,
    /// Figures that are shown with the meshes of before their last change until their own are built, with their objects.
    stand_ins: BTreeMap<AssetKey, ObjectId>,
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

    /// Returns the loaded meshes and textures. A figure that has just changed may have the meshes of before.
    pub fn assets(&self) -> &Assets {
        &self.assets
    }

    /// Returns the loaded meshes and textures, without those of figures that are not built yet.
    pub fn finished_assets(&self) -> Assets {
        let mut assets = self.assets.clone();
        self.stand_ins.keys().for_each(|key| assets.remove(key));
        assets
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
        self.is_unsaved || self.is_changed
    }

    /// Compares the scene with the saved one. Which variant is shown is no change.
    fn compare_with_saved(&mut self) {
        let of_studio = |scene: &Scene| figures::as_variant(scene, scene.variants.studio_id);
        self.is_changed = match self.scene.variants.is_empty() && self.saved.variants.is_empty() {
            true => self.scene != self.saved,
            false => of_studio(&self.scene) != of_studio(&self.saved),
        };
    }

    /// Returns the state of the file when it was read or written last.
    pub fn stamp(&self) -> Option<&FileStamp> {
        self.stamp.as_ref()
    }

    /// Sets the state of the file when it was read.
    pub fn set_stamp(&mut self, stamp: Option<FileStamp>) {
        self.stamp = stamp;
    }

    /// Returns true if another program has changed the file since it was read or written.
    pub fn is_changed_outside(&self) -> bool {
        let (Some(path), Some(stamp)) = (&self.path, &self.stamp) else { return false };
        stamp.is_outdated(path)
    }

    /// Keeps the studio although another program has changed its file: it counts as changed until it is saved.
    pub fn keep_over_file(&mut self) {
        self.stamp = self.path.as_deref().and_then(|path| FileStamp::of(path).ok());
        self.is_unsaved = true;
    }

    /// Takes over what is known of a recovered studio: files that were imported before, and whether it is unsaved.
    pub fn mark_recovered(&mut self, imported: BTreeMap<String, PathBuf>, is_unsaved: bool) {
        self.imported = imported;
        self.is_unsaved = is_unsaved;
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
        let variant = before.variants.shown();
        let merge = press_id.filter(|_| !targets.is_empty()).map(|press_id| MergeKey { press_id, targets, variant });
        let checked = |scene: &Scene| match new_error(&before, scene) {
            // Of a variant that is not shown, the place says which
            Some(error) if error.place.starts_with("variants") => Err(ActionError::Invalid(error.to_string())),
            Some(error) => Err(ActionError::Invalid(error.message)),
            None => Ok(()),
        };
        let done = action.apply(&mut self.scene).and_then(|select| {
            checked(&self.scene)?;
            // Only valid figures have eyes to turn.
            figures::follow_gazes(&mut self.scene);
            self.scene.drop_equal_parts_of_variants();
            checked(&self.scene).map(|()| select)
        });
        if done.is_err() {
            self.scene = before;
        } else if self.scene != before {
            self.note_change(&before);
            self.history.record(before, label, merge, self.scene.variants.shown());
        }
        done
    }

    /// Shows a variant, which is no undo step. Returns false if there is no such variant.
    pub fn show_variant(&mut self, id: VariantId) -> bool {
        let before = self.scene.clone();
        let is_there = figures::show_variant(&mut self.scene, id);
        self.note_change(&before);
        is_there
    }

    /// Updates what depends on the scene after a change.
    fn note_change(&mut self, before: &Scene) {
        if self.scene != *before {
            self.revisions.note(&SceneChange::between(before, &self.scene));
            self.keep_meshes(before);
            self.compare_with_saved();
        }
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
        self.note_change(&before);
        done
    }

    /// Lets changed figures and tanks keep the meshes of before until their own are built, so that they do not vanish
    /// meanwhile.
    fn keep_meshes(&mut self, before: &Scene) {
        for object in &self.scene.objects {
            let older = before.object(object.id).and_then(|object| made_key(&object.shape));
            let (Some(new), Some(old)) = (made_key(&object.shape), older) else { continue };
            let is_missing = new.is_tank() == old.is_tank() && !self.assets.contains(&new);
            if let Some(made) = self.assets.get(&old).filter(|_| is_missing) {
                self.assets.insert(new.clone(), made);
                self.stand_ins.insert(new, object.id);
            }
        }
    }

    /// Returns the assets that the scene refers to and that are neither loaded nor failed.
    pub fn wanted_assets(&self) -> BTreeSet<AssetKey> {
        let used = self.scene.assets().map(|(_, key)| key.into_owned());
        let stand_ins: BTreeSet<AssetKey> = used.filter(|key| self.stand_ins.contains_key(key)).collect();
        &(&self.missing_assets() | &stand_ins) - &self.failed
    }

    fn missing_assets(&self) -> BTreeSet<AssetKey> {
        io::missing_assets(&self.scene, &self.assets).into_iter().map(|(_, key)| key).collect()
    }

    /// Adds assets that were loaded in the background. Those of `tried` that are still missing have failed.
    pub fn insert_assets(&mut self, loaded: Assets, tried: &BTreeSet<AssetKey>) {
        for (key, built) in loaded.iter() {
            // It has changed since it was sent off: what was built is nearer to it than what stands in
            let owner = self.stand_ins.remove(key).and_then(|owner| self.scene.object(owner));
            let now = owner.and_then(|object| made_key(&object.shape));
            if let Some(now) = now.filter(|now| self.stand_ins.contains_key(now)) {
                self.assets.insert(now, built.clone());
            }
        }
        self.assets.extend(loaded);
        self.assets.drop_unused_made(&self.scene);
        let assets = &self.assets;
        self.stand_ins.retain(|key, _| assets.contains(key));
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
            Some(other) => other == file || other.canonicalize().is_ok_and(|other| other == file),
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

    /// Marks the current scene as saved to `path`. Imported files of what was deleted stay known: undo brings it back.
    pub fn mark_saved(&mut self, path: PathBuf) {
        let path_of = |asset: &AssetRef<'_>| asset.path().map(str::to_owned);
        let copied: BTreeSet<String> = self.scene.assets().filter_map(|(_, asset)| path_of(&asset)).collect();
        self.imported.retain(|asset_path, _| !copied.contains(asset_path));
        (self.saved, self.is_unsaved, self.is_changed) = (self.scene.clone(), false, false);
        self.stamp = FileStamp::of(&path).ok();
        self.path = Some(path);
    }
}

/// Returns the folder beside a studio into which a save copies an imported file of an asset.
pub fn import_folder(asset: &AssetRef<'_>) -> &'static str {
    match asset {
        AssetRef::Mesh(_) | AssetRef::Figure(_) => MODELS,
        AssetRef::Texture(texture) => match &**texture {
            TextureRef::Embedded { .. } => MODELS,
            TextureRef::File(_) | TextureRef::Builtin(_) => TEXTURES,
        },
        AssetRef::Tank(_) => TEXTURES,
        AssetRef::Photometry(_) => LAMPS,
        AssetRef::Environment(_) => ENVIRONMENTS,
    }
}

/// Returns an error of the scene that it did not have before.
fn new_error(before: &Scene, after: &Scene) -> Option<Finding> {
    let errors = |scene| validate(scene).into_iter().filter(|f| f.severity == Severity::Error);
    let old: Vec<Finding> = errors(before).collect();
    errors(after).find(|error| !old.contains(error))
}

/// Returns the reference to what is built of a shape's parameters: a figure or a tank.
fn made_key(shape: &Shape) -> Option<AssetKey> {
    match shape {
        Shape::Figure(figure) => Some(AssetRef::figure(Cow::Owned(**figure))),
        Shape::Tank(tank) => Some(AssetRef::tank(Cow::Owned(Tank::clone(tank)))),
        _ => None,
    }
}

#[cfg(test)]
mod tests;
