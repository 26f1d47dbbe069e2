//! Execution of the commands about photometric files.

use crate::editor::document::action::Action;
use crate::editor::document::item::Item;
use crate::editor::document::measured_light::{self, MeasuredFile};
use crate::editor::document::placement;
use crate::editor::document::studio_document::LAMPS;
use crate::editor::window::app::App;
use crate::editor::window::background_tasks::TaskResult;
use crate::editor::window::run_file_command::waker;
use crate::scene::{Assets, LightId};
use eframe::egui::Context;
use std::path::PathBuf;

impl App {
    /// Reads a photometric file in the background, for a light or for a new one.
    pub(super) fn read_measured_light(&mut self, light: Option<LightId>, path: PathBuf, ctx: &Context) {
        let work = move || TaskResult::Measured(light, measured_light::read(path));
        self.background.tasks.start(work, waker(ctx));
    }

    /// Puts a photometric file that was read on its light, or adds a light with it.
    pub(super) fn use_measured_light(&mut self, light: Option<LightId>, measured: MeasuredFile) {
        let MeasuredFile { file, table, warnings } = measured;
        let path = self.document.asset_path_for(&file, LAMPS);
        let mut assets = Assets::default();
        assets.insert_photometry(path.clone(), table.clone());
        self.document.insert_assets(assets, &Default::default());
        self.document.note_import(path.clone(), file);
        let existing = light.and_then(|id| self.document.scene().light(id)).cloned();
        let action = match existing {
            Some(mut light) => {
                measured_light::put_on(&mut light, path, &table);
                Action::SetLight(Box::new(light))
            }
            None => {
                let mut light = measured_light::new_light(path, &table);
                let power = light.power;
                let (scene, assets) = (self.document.scene(), self.document.assets());
                placement::place_light(scene, assets, self.selection.last(), &mut light);
                light.power = power;
                Action::AddLight(Box::new(light))
            }
        };
        self.apply(action, None);
        warnings.into_iter().for_each(|warning| self.toasts.warning(warning));
    }

    /// Returns the light that a dropped photometric file is put on: the selected one.
    pub(super) fn light_for_drop(&self) -> Option<LightId> {
        match self.selection.last() {
            Some(Item::Light(id)) => Some(id),
            _ => None,
        }
    }
}
