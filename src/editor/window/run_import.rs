//! Bringing imported models into the studio, after a prompt where something is to be chosen.

use crate::editor::document::files::{self, ImportedModel};
use crate::editor::document::model_import::{self, ModelChoice, RunningLoad};
use crate::editor::document::placement;
use crate::editor::document::studio_document::{MODELS, TEXTURES};
use crate::editor::panels::import_prompt::{ImportAnswer, PendingModel, import_ui};
use crate::editor::window::app::App;
use crate::editor::window::background_tasks::TaskResult;
use crate::editor::window::run_file_command::waker;
use crate::io::{self, LoadProgress};
use crate::scene::{Assets, Material, MaterialPreset, Mesh, Object, Shape, TextureRef, TextureSlot};
use eframe::egui::Context;
use std::path::{Path, PathBuf};
use std::sync::Arc;

impl App {
    /// Reads a model in the background.
    pub(super) fn import(&mut self, path: PathBuf, ctx: &Context) {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let progress = self.begin_load(name, false, 0.0);
        let work = move || {
            let result = files::import(path, &progress);
            TaskResult::Imported(progress, result)
        };
        self.background.tasks.start(work, waker(ctx));
    }

    /// Lists a file that is read in the background, and returns its progress.
    pub(super) fn begin_load(&mut self, name: String, is_studio: bool, shown_from_s: f64) -> Arc<LoadProgress> {
        let progress: Arc<LoadProgress> = Arc::default();
        self.background.loads.push(RunningLoad { name, is_studio, shown_from_s, progress: progress.clone() });
        progress
    }

    /// Removes the files from the list whose reading ended by an internal error.
    pub(super) fn drop_panicked_loads(&mut self) {
        self.background.loads.retain(|load| Arc::strong_count(&load.progress) > 1);
    }

    /// Removes a file that is read from the list, and returns its name.
    pub(super) fn end_load(&mut self, progress: &Arc<LoadProgress>) -> String {
        let place = self.background.loads.iter().position(|load| Arc::ptr_eq(&load.progress, progress));
        place.map(|place| self.background.loads.remove(place).name).unwrap_or_default()
    }

    /// Cancels the models and studios that are read.
    pub(super) fn cancel_loads(&mut self) {
        self.background.loads.iter().for_each(|load| load.progress.cancel());
    }

    /// Takes the result of an import, unless it was cancelled.
    pub(super) fn take_import(&mut self, progress: &Arc<LoadProgress>, result: Result<Box<ImportedModel>, String>) {
        let name = self.end_load(progress);
        match result {
            _ if progress.is_cancelled() => self.toasts.info(format!("The import of {name} was cancelled.")),
            Ok(model) => self.take_model(model),
            Err(message) => self.toasts.error(format!("The model could not be brought in. {message}")),
        }
    }

    /// Brings a model in, or asks about it first.
    fn take_model(&mut self, model: Box<ImportedModel>) {
        let choice = ModelChoice::offered(&model);
        if model_import::is_asked(&model) {
            self.session.models.push_back(PendingModel { model, choice });
        } else {
            self.bring_in(*model, choice);
        }
    }

    /// Draws the prompt about the first model that waits for it, and handles its answer.
    pub(super) fn ask_about_model(&mut self, ctx: &Context) {
        let Some(answer) = self.session.models.front_mut().and_then(|model| import_ui(ctx, model)) else { return };
        if let Some(PendingModel { model, choice }) = self.session.models.pop_front()
            && answer == ImportAnswer::BringIn
        {
            self.bring_in(*model, choice);
        }
    }

    fn bring_in(&mut self, mut model: ImportedModel, choice: ModelChoice) {
        let file = model.file.clone();
        let path = self.document.asset_path_for(&file, MODELS);
        let stem = file.file_stem().map_or_else(|| "Model".to_owned(), |stem| stem.to_string_lossy().into_owned());
        let mut assets = Assets::default();
        assets.insert_mesh(path.clone(), model.mesh.clone());
        self.document.insert_assets(assets, &Default::default());
        self.document.note_import(path.clone(), file.clone());
        let folder = file.parent().unwrap_or(Path::new("")).to_owned();
        let part_materials: Vec<_> = std::mem::take(&mut model.part_materials)
            .into_iter()
            .map(|(part, m)| (part, self.adopt_textures(m, &folder)))
            .collect();
        let (material, part_materials) = surfaces_of(&model.mesh, part_materials);
        let mut object = Object { material, part_materials, ..Object::new(stem, Shape::MeshFile { path }) };
        let guess = io::fit_model(&mut object, &model.mesh);
        let is_asked = model_import::is_size_asked(&model);
        io::scale_model(&mut object, &model.mesh, choice.metres);
        placement::place_object(self.document.scene(), self.selection.last(), &mut object);
        let lamps = if choice.lamps { model.set_up.lights.len() } else { 0 };
        let came = format!("{} came{}.", object.name, model_import::with_lamps(lamps));
        let action = model_import::action(self.document.scene(), object, &model, choice);
        self.apply(action, None);
        guess.filter(|_| !is_asked).into_iter().for_each(|sentence| self.toasts.info(sentence));
        if lamps > 0 {
            self.toasts.info(came);
        }
        model.warnings.into_iter().for_each(|warning| self.toasts.warning(warning));
    }

    /// Returns an imported model's material with textures named as the open studio can name them.
    fn adopt_textures(&mut self, mut material: Material, folder: &Path) -> Material {
        for slot in TextureSlot::ALL {
            let texture = material.textures.get_mut(slot);
            if let Some(reference) = texture.take() {
                let (path, kind_folder) = match &reference {
                    TextureRef::File(path) => (path, TEXTURES),
                    TextureRef::Embedded { model, .. } => (model, MODELS),
                    TextureRef::Builtin(_) => {
                        *texture = Some(reference);
                        continue;
                    }
                };
                let file = folder.join(path);
                let path = self.document.asset_path_for(&file, kind_folder);
                self.document.note_import(path.clone(), file);
                *texture = Some(reference.at_path(path));
            }
        }
        material
    }
}

/// Returns the surface of a whole model, and those of the parts that differ from it. The whole has that of the first part
/// if all parts have one.
fn surfaces_of(mesh: &Mesh, mut parts: Vec<(String, Material)>) -> (Material, Vec<(String, Material)>) {
    let has_own = |part: &str| parts.iter().any(|(name, _)| name == part);
    let first = mesh.part_names().next().filter(|_| mesh.part_names().all(has_own));
    let first = first.and_then(|first| parts.iter().find(|(name, _)| name == first));
    let Some((_, material)) = first.cloned() else { return (MaterialPreset::MatteFabric.material(), parts) };
    parts.retain(|(_, own)| *own != material);
    (material, parts)
}
