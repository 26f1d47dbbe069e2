//! Reading of assets in the background: those that the studio wants, and those that another program has changed while
//! the window was not used.

use crate::editor::document::asset_stamps::AssetStamps;
use crate::editor::document::files::{self, RereadAssets};
use crate::editor::window::app::App;
use crate::editor::window::background_tasks::TaskResult;
use crate::editor::window::run_file_command::waker;
use crate::io::AssetFiles;
use eframe::egui::Context;
use std::collections::BTreeSet;
use std::path::Path;

impl App {
    /// Loads missing assets in the background, for example the mesh of a new figure.
    pub(super) fn load_wanted_assets(&mut self, ctx: &Context) {
        if self.background.tasks.is_busy() {
            return;
        }
        let wanted = self.document.wanted_assets();
        if wanted.is_empty() {
            return;
        }
        let (scene, known) = (self.document.scene().clone(), self.document.finished_assets());
        let folder = self.document.folder().map(Path::to_owned);
        let imported = self.document.imported_files().clone();
        let work = move || {
            let (assets, warnings) = files::load_assets(&scene, folder.as_deref(), &known, &imported);
            TaskResult::Assets(assets, wanted, warnings)
        };
        self.background.tasks.start(work, waker(ctx));
    }

    /// Notes the states of the asset files in the background, as the window loses the keyboard.
    pub(super) fn stamp_assets(&mut self, ctx: &Context) {
        let files = self.document.asset_files();
        let (scene, mut stamps) = (self.document.scene().clone(), self.session.asset_stamps.clone());
        let (folder, imported) = (files.folder.map(Path::to_owned), files.imported.clone());
        let work = move || {
            let files = AssetFiles { folder: folder.as_deref(), imported: &imported };
            stamps.add_new(files.found(&scene).values());
            TaskResult::AssetsStamped(stamps)
        };
        self.background.tasks.start(work, waker(ctx));
    }

    /// Reads the asset files that have changed again in the background.
    pub(super) fn reread_changed_assets(&mut self, ctx: &Context) {
        let stamps = self.session.asset_stamps.clone();
        if stamps == AssetStamps::default() {
            return;
        }
        let (scene, known) = (self.document.scene().clone(), self.document.finished_assets());
        let files = self.document.asset_files();
        let (folder, imported) = (files.folder.map(Path::to_owned), files.imported.clone());
        let work = move || {
            let files = AssetFiles { folder: folder.as_deref(), imported: &imported };
            TaskResult::AssetsReread(Box::new(files::reread_changed(&scene, files, &known, stamps)))
        };
        self.background.tasks.start(work, waker(ctx));
    }

    /// Takes assets that were read again. What could not be read stays as it was.
    pub(super) fn take_reread_assets(&mut self, reread: RereadAssets) {
        let RereadAssets { assets, files, stamps, warnings } = reread;
        self.session.asset_stamps = stamps;
        if !files.is_empty() {
            self.document.insert_assets(assets, &BTreeSet::new());
            self.variant_pictures.note_changed_assets(&mut self.rendering);
            self.toasts.info(format!("Changed by another program, and read again: {}.", files.join(", ")));
        }
        warnings.into_iter().for_each(|warning| self.toasts.warning(warning));
    }
}
