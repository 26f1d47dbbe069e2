//! Execution of the commands about environment maps.

use crate::editor::commands::command::Command;
use crate::editor::document::action::Action;
use crate::editor::document::catalog;
use crate::editor::document::environment::{self, ReadEnvironment};
use crate::editor::document::studio_document::ENVIRONMENTS;
use crate::editor::panels::prompts::{self, PanoramaAnswer};
use crate::editor::window::app::App;
use crate::editor::window::background_tasks::TaskResult;
use crate::editor::window::run_file_command::waker;
use crate::io;
use crate::scene::{Assets, Emitter, LightId, Modifier, Output};
use eframe::egui::Context;
use std::path::PathBuf;

/// Illuminance of a new environment, lx: an overcast day.
const NEW_LUX: f32 = 20_000.0;

impl App {
    /// Opens a dropped EXR picture with its studio; asks about one that may be a panorama.
    pub(super) fn take_picture(&mut self, path: PathBuf, out: &mut Vec<Command>) {
        if io::is_panorama(&path) {
            self.session.panorama = Some(path);
        } else {
            out.push(Command::OpenPath(path));
        }
    }

    /// Draws the prompt about a panorama and handles its answer.
    pub(super) fn ask_about_picture(&mut self, ctx: &Context, out: &mut Vec<Command>) {
        let Some(answer) = self.session.panorama.as_deref().and_then(|path| prompts::panorama_ui(ctx, path)) else {
            return;
        };
        if let Some(path) = self.session.panorama.take()
            && answer == PanoramaAnswer::LightTheStudio
        {
            out.push(Command::EnvironmentMapPath(self.light_for_drop(), path));
        }
    }

    /// Reads an environment map in the background, for a surround or for a new one.
    pub(super) fn read_environment(&mut self, light: Option<LightId>, path: PathBuf, ctx: &Context) {
        let work = move || TaskResult::Environment(light, environment::read(path));
        self.background.tasks.start(work, waker(ctx));
    }

    /// Puts an environment map that was read on its surround, or adds a surround with it.
    pub(super) fn use_environment(&mut self, light: Option<LightId>, environment: ReadEnvironment) {
        let ReadEnvironment { file, map, warnings } = environment;
        let path = self.document.asset_path_for(&file, ENVIRONMENTS);
        let mut assets = Assets::default();
        assets.insert_environment(path.clone(), map);
        self.document.insert_assets(assets, &Default::default());
        self.document.note_import(path.clone(), file);
        let existing = light.and_then(|id| self.document.scene().light(id)).cloned();
        let action = match existing.filter(|light| light.emitter == Emitter::Surround) {
            Some(mut light) => {
                light.environment_map = Some(path);
                Action::SetLight(Box::new(light))
            }
            None => {
                let output = Output::Lux(NEW_LUX);
                let mut light = catalog::new_light("Environment", Emitter::Surround, Modifier::default(), output);
                light.environment_map = Some(path);
                Action::AddLight(Box::new(light))
            }
        };
        self.apply(action, None);
        warnings.into_iter().for_each(|warning| self.toasts.warning(warning));
    }
}
