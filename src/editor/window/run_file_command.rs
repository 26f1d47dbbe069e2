//! Execution of file commands: open, save, import, export, drops, and their prompts.

use crate::editor::commands::choices::{CentralView, Comparison};
use crate::editor::commands::command::Command;
use crate::editor::commands::file_purpose::FilePurpose;
use crate::editor::document::action::Action;
use crate::editor::document::files::{self, OpenedStudio, StudioSource};
use crate::editor::document::item::Item;
use crate::editor::document::selection::Selection;
use crate::editor::document::studio_document::{Document, TEXTURES};
use crate::editor::panels::prompts::{self, PathAnswer, PathPrompt, PictureAnswer, ReplaceAnswer, UnsavedAnswer};
use crate::editor::window::app::App;
use crate::editor::window::background_tasks::{StudioLoad, TaskResult};
use crate::editor::window::dialogs::DialogAnswer;
use crate::editor::window::session::PendingOperation;
use crate::io::{self, ModelFormat};
use crate::scene::TextureRef;
use eframe::egui::{self, Align2, Color32, Context, Id, LayerId, Order, ViewportCommand};
use std::path::{Path, PathBuf};
use std::sync::mpsc::TryRecvError;
use std::time::Duration;

/// Time that a studio is read before its progress is shown, seconds.
const QUIET_S: f64 = 0.4;

impl App {
    pub(super) fn run_file_command(&mut self, command: Command, ctx: &Context) {
        match command {
            Command::Open => self.ask_for_path(FilePurpose::OpenScene, ctx),
            Command::Save => match self.document.path().map(Path::to_owned) {
                Some(path) => self.save_to(path, ctx),
                None => self.ask_for_path(FilePurpose::SaveScene, ctx),
            },
            Command::SaveAs => self.ask_for_path(FilePurpose::SaveScene, ctx),
            Command::Import => self.ask_for_path(FilePurpose::ImportModel, ctx),
            Command::ImportPath(path) => self.import(path, ctx),
            Command::CancelLoads => self.cancel_loads(),
            Command::MeasuredLight(light) => self.ask_for_path(FilePurpose::OpenMeasuredLight(light), ctx),
            Command::MeasuredLightPath(light, path) => self.read_measured_light(light, path, ctx),
            Command::EnvironmentMap(light) => self.ask_for_path(FilePurpose::OpenEnvironment(light), ctx),
            Command::EnvironmentMapPath(light, path) => self.read_environment(light, path, ctx),
            Command::ChooseTexture(item, part, slot) => {
                // Only if the dialog is not open for another texture
                if self.session.dialog.is_none() {
                    self.session.texture_for = Some((item, part, slot));
                }
                self.ask_for_path(FilePurpose::OpenTexture, ctx);
            }
            Command::ExportPicture if self.rendering.developed().is_none() => {
                self.toasts.info("There is no picture to export yet: press Render (R) first.");
            }
            Command::ExportPicture => self.ask_for_path(FilePurpose::ExportPicture, ctx),
            Command::ExportLesson(series, light) => self.ask_for_path(FilePurpose::ExportLesson(series, light), ctx),
            Command::ExportSheet(units) => self.ask_for_path(FilePurpose::ExportSheet(units), ctx),
            Command::UseFile(purpose, path) => self.path_chosen(purpose, purpose.with_extension_added(path), ctx),
            _ => {}
        }
    }

    /// Loads another studio in the background.
    pub(super) fn load(&mut self, source: StudioSource, ctx: &Context) {
        // The studio that is asked for last is the one to open
        self.background.loads.iter().filter(|load| load.is_studio).for_each(|load| load.progress.cancel());
        let shown_from_s = ctx.input(|i| i.time) + QUIET_S;
        let progress = self.begin_load(source.name(), true, shown_from_s);
        ctx.request_repaint_after(Duration::from_secs_f64(QUIET_S));
        let load = StudioLoad { source, progress, open: Box::new(self.document.scene().clone()) };
        let work = move || {
            let result = files::open(&load.source, &load.progress);
            TaskResult::Opened(load, result)
        };
        self.background.tasks.start(work, waker(ctx));
    }

    /// Loads another studio, after a prompt for unsaved changes.
    pub(super) fn replace_with(&mut self, source: StudioSource, ctx: &Context) {
        self.confirm_unsaved(PendingOperation::Load(source), ctx);
    }

    /// Does what ends the studio, after a prompt for unsaved changes.
    pub(super) fn confirm_unsaved(&mut self, pending: PendingOperation, ctx: &Context) {
        if self.document.is_dirty() {
            self.session.unsaved_prompt = Some(pending);
        } else {
            self.leave_studio(pending, ctx);
        }
    }

    /// Continues with an operation that ends the studio, whose changes are saved or given up: after a prompt for a picture
    /// that is not exported, and after the files that are being written.
    fn leave_studio(&mut self, pending: PendingOperation, ctx: &Context) {
        if self.variant_pictures.is_costly_to_lose(&self.rendering) {
            self.session.picture_prompt = Some(pending);
        } else {
            self.execute_pending(pending, ctx);
        }
    }

    fn execute_pending(&mut self, pending: PendingOperation, ctx: &Context) {
        match pending {
            PendingOperation::Load(source) => self.load(source, ctx),
            PendingOperation::Recover => self.recover(ctx),
            PendingOperation::Quit if self.background.exports.is_busy() => {
                self.session.quits_after_export = true;
                self.toasts.info("A file is still being written: the window closes when it is complete.");
            }
            PendingOperation::Quit => {
                self.session.may_close = true;
                ctx.send_viewport_cmd(ViewportCommand::Close);
            }
        }
    }

    fn ask_for_path(&mut self, purpose: FilePurpose, ctx: &Context) {
        if self.session.dialog.is_some() {
            self.toasts.info("A file dialog is open already.");
            self.session.after_save = None;
            return;
        }
        let (folder, name) = self.suggestion(purpose);
        let receiver = self.session.dialogs.ask(purpose, folder.as_deref(), &name, waker(ctx));
        self.session.dialog = Some((purpose, receiver));
    }

    /// Returns the initial folder and name of a dialog.
    fn suggestion(&self, purpose: FilePurpose) -> (Option<PathBuf>, String) {
        let recent = self.session.recent.paths().first().and_then(|path| path.parent());
        let folder = self.document.folder().or(recent).filter(|folder| folder.is_dir()).map(Path::to_owned);
        let title = self.document.title();
        let stem = title.strip_suffix(".ron").unwrap_or(&title);
        let stem: String =
            stem.chars().map(|c| if c.is_alphanumeric() || "-_ .".contains(c) { c } else { '-' }).collect();
        (folder, format!("{}{}.{}", stem.trim(), purpose.name_suffix(), purpose.filter().1[0]))
    }

    pub(super) fn take_dialog_answer(&mut self, out: &mut Vec<Command>) {
        let Some((purpose, receiver)) = &self.session.dialog else { return };
        let purpose = *purpose;
        let answer = match receiver.try_recv() {
            Ok(answer) => answer,
            Err(TryRecvError::Disconnected) => DialogAnswer::Unavailable,
            Err(TryRecvError::Empty) => return,
        };
        self.session.dialog = None;
        match answer {
            DialogAnswer::Chosen(path) => self.use_or_ask(purpose, path, true, out),
            DialogAnswer::Cancelled => self.session.after_save = None,
            DialogAnswer::Unavailable => {
                let (folder, name) = self.suggestion(purpose);
                self.session.prompt = Some(PathPrompt::new(purpose, folder.as_deref(), &name));
            }
        }
    }

    /// Uses a chosen file, or asks first if it would replace one that is not the studio's own. `is_confirmed`: the desktop
    /// has asked about the file of just this name.
    fn use_or_ask(&mut self, purpose: FilePurpose, chosen: PathBuf, is_confirmed: bool, out: &mut Vec<Command>) {
        let path = purpose.with_extension_added(chosen.clone());
        let is_own = purpose == FilePurpose::SaveScene && self.document.path() == Some(&path);
        let is_settled = is_own || (is_confirmed && path == chosen);
        if purpose.is_save() && !is_settled && path.exists() {
            self.session.replace = Some((purpose, path));
        } else {
            out.push(Command::UseFile(purpose, path));
        }
    }

    /// Draws the prompt about a file that would be replaced, and handles its answer.
    fn ask_to_replace(&mut self, ctx: &Context, out: &mut Vec<Command>) {
        let Some((purpose, path)) = &self.session.replace else { return };
        match prompts::replace_ui(ctx, path) {
            Some(ReplaceAnswer::Replace) => out.push(Command::UseFile(*purpose, path.clone())),
            Some(ReplaceAnswer::Cancel) => self.session.after_save = None,
            None => return,
        }
        self.session.replace = None;
    }

    fn path_chosen(&mut self, purpose: FilePurpose, path: PathBuf, ctx: &Context) {
        match purpose {
            FilePurpose::OpenScene if io::is_panorama(&path) => self.session.panorama = Some(path),
            FilePurpose::OpenScene => self.replace_with(StudioSource::File(path), ctx),
            FilePurpose::SaveScene => self.save_to(path, ctx),
            FilePurpose::ImportModel => self.run_file_command(Command::ImportPath(path), ctx),
            FilePurpose::OpenMeasuredLight(light) => self.read_measured_light(light, path, ctx),
            FilePurpose::OpenEnvironment(light) => self.read_environment(light, path, ctx),
            FilePurpose::OpenTexture => self.use_texture(&path),
            FilePurpose::ExportPicture => self.export_picture_to(path, ctx),
            FilePurpose::ExportSheet(units) => self.export_sheet_to(path, units, ctx),
            FilePurpose::ExportLesson(series, light) => self.export_lesson_to(path, series, light, ctx),
        }
    }

    fn save_to(&mut self, path: PathBuf, ctx: &Context) {
        if self.ask_before_overwriting(&path) {
            return;
        }
        match files::save(&self.document, &path) {
            Ok(gone) if gone.is_empty() => self.toasts.info(format!("Saved to {}", path.display())),
            Ok(gone) => self.toasts.warning(format!(
                "Saved to {}, but without {}: the file is gone. Opened again, the studio will miss it.",
                path.display(),
                gone.join(", ")
            )),
            Err(message) => {
                self.session.after_save = None;
                self.toasts.error(format!("The studio was not saved. {message}"));
                return;
            }
        }
        self.session.recent.push(&path);
        self.document.mark_saved(path);
        self.session.file_change_put_off = false;
        if let Some(pending) = self.session.after_save.take() {
            self.leave_studio(pending, ctx);
        }
    }

    /// Takes a studio that was read, unless it was cancelled. Asks first if the open one has changed meanwhile.
    fn take_opened(&mut self, load: StudioLoad, result: Result<Box<OpenedStudio>, String>, ctx: &Context) {
        let StudioLoad { source, progress, open } = load;
        let name = self.end_load(&progress);
        match result {
            _ if progress.is_cancelled() => self.toasts.info(format!("{name} was not opened: cancelled.")),
            Ok(_) if self.document.is_dirty() && *self.document.scene() != *open => {
                self.session.unsaved_prompt = Some(PendingOperation::Load(source));
            }
            Ok(mut opened) => {
                if !matches!(source, StudioSource::File(_)) {
                    self.session.preferences.get().calibrate(&mut opened.scene.camera);
                }
                self.show_opened(*opened, ctx);
            }
            Err(message) => {
                if let StudioSource::File(path) = &source
                    && !path.exists()
                {
                    self.session.recent.forget(path);
                }
                self.toasts.error(format!("The studio could not be opened. {message}"));
            }
        }
    }

    pub(super) fn take_done(&mut self, done: TaskResult, ctx: &Context) {
        match done {
            TaskResult::Opened(load, result) => self.take_opened(load, result, ctx),
            TaskResult::Imported(progress, result) => self.take_import(&progress, result),
            TaskResult::Environment(light, Ok(environment)) => self.use_environment(light, *environment),
            TaskResult::Environment(_, Err(message)) => self.toasts.error(message),
            TaskResult::Measured(light, Ok(measured)) => self.use_measured_light(light, *measured),
            TaskResult::Measured(_, Err(message)) => {
                self.toasts.error(format!("The photometric file could not be used. {message}"))
            }
            TaskResult::Assets(assets, tried, warnings) => {
                self.document.insert_assets(assets, &tried);
                warnings.into_iter().for_each(|warning| self.toasts.warning(warning));
            }
            TaskResult::AssetsStamped(stamps) => self.session.asset_stamps = stamps,
            TaskResult::AssetsReread(reread) => self.take_reread_assets(*reread),
            TaskResult::Unsaved(found) => self.session.recovery.offer(found),
            TaskResult::Recovered(recovery, result) => self.take_recovered(recovery, result, ctx),
            TaskResult::FileChecked { path, stamp, is_changed } => {
                // The studio may have been saved or replaced since.
                let is_current = self.document.path() == Some(&*path) && self.document.stamp() == Some(&stamp);
                if is_changed && is_current {
                    self.file_is_changed();
                }
            }
            TaskResult::Exported(path, film, Ok(())) => {
                self.variant_pictures.mark_exported(&mut self.rendering, &film);
                self.toasts.info(format!("Picture written to {}", path.display()));
            }
            TaskResult::Exported(_, _, Err(message)) => {
                self.toasts.error(format!("The picture was not written. {message}"))
            }
            TaskResult::SheetExported(kind, path, Ok(())) => {
                self.toasts.info(format!("{kind} sheet written to {}", path.display()));
            }
            TaskResult::SheetExported(kind, _, Err(message)) => {
                self.toasts.error(format!("{kind} sheet not written. {message}"));
            }
            TaskResult::ImportOfAnotherStudio(progress) => {
                let name = self.end_load(&progress);
                self.toasts.info(format!("{name} was not brought in: another studio is open."));
            }
            TaskResult::Panicked => {
                self.drop_panicked_loads();
                self.toasts.error("A file could not be read or written: an internal error.");
            }
        }
    }

    pub(super) fn show_opened(&mut self, opened: OpenedStudio, ctx: &Context) {
        const SHOWN: usize = 3;
        if let Some(path) = &opened.path {
            self.session.recent.push(path);
        }
        self.toasts.clear_seen();
        let more = opened.warnings.len().saturating_sub(SHOWN);
        opened.warnings.iter().take(SHOWN).for_each(|warning| self.toasts.warning(warning.clone()));
        if more > 0 {
            self.toasts.warning(format!("And {more} more things are odd about this studio."));
        }
        self.rendering.clear();
        self.views.viewport.traced_view.clear();
        self.views.viewport.preview.view_options.only_light = None;
        self.views.viewport.tool = None;
        self.background.tasks.begin_studio();
        self.session.begin_studio();
        self.panels.begin_studio();
        self.document = Document::new(opened.scene, opened.assets, opened.path);
        self.variant_pictures.clear(self.document.scene());
        self.views.picture.comparison = Comparison::default();
        self.document.set_stamp(opened.stamp);
        self.selection = Selection::default();
        self.background.transport.reset();
        self.background.room_audit.reset();
        if matches!(self.views.central, CentralView::Picture | CentralView::Light(_)) {
            self.views.central = CentralView::Studio;
        }
        self.views.viewport.frame_selection(&self.document, &self.selection);
        if let Some(picture) = opened.picture {
            self.rendering.restore(picture, true);
            self.views.central = CentralView::Picture;
        }
        ctx.request_repaint();
    }

    fn use_texture(&mut self, file: &Path) {
        let Some((item, part, slot)) = self.session.texture_for.take() else { return };
        if !io::is_texture_file(file) {
            let name = file.file_name().unwrap_or_default().to_string_lossy();
            let kinds = io::TEXTURE_EXTENSIONS.join(", ");
            let hint = ModelFormat::of(file).map_or("", |_| " It is a model: File > Import model brings it in.");
            self.toasts.error(format!("{name} is no picture, so it can't be a texture ({kinds}).{hint}"));
            return;
        }
        let path = self.document.asset_path_for(file, TEXTURES);
        self.document.note_import(path.clone(), file.to_owned());
        let texture = Some(TextureRef::File(path));
        let scene = self.document.scene();
        let action = match item {
            Item::Object(id) => scene.object(id).cloned().map(|mut object| {
                let own = object.part_materials.iter_mut().find(|(name, _)| Some(name) == part.as_ref());
                let material = own.map_or(&mut object.material, |(_, material)| material);
                *material.textures.get_mut(slot) = texture;
                Action::SetObject(Box::new(object))
            }),
            Item::Room => scene.room.clone().map(|mut room| {
                let material = match part.as_deref() {
                    Some("floor") => &mut room.floor,
                    Some("ceiling") => &mut room.ceiling,
                    _ => &mut room.walls,
                };
                *material.textures.get_mut(slot) = texture;
                Action::SetRoom(Some(Box::new(room)))
            }),
            Item::Camera | Item::Light(_) | Item::Meter => None,
        };
        if let Some(action) = action {
            self.apply(action, None);
        }
    }

    /// Handles files dropped on the window.
    pub(super) fn take_drops(&mut self, ctx: &Context, out: &mut Vec<Command>) {
        for file in ctx.input(|i| i.raw.dropped_files.clone()) {
            let path = file.path().to_owned();
            let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
            match ending.as_str() {
                "ron" => out.push(Command::OpenPath(path)),
                "exr" => self.take_picture(path, out),
                _ if ModelFormat::of(&path).is_some() => out.push(Command::ImportPath(path)),
                _ if io::is_photometric_file(&path) => {
                    out.push(Command::MeasuredLightPath(self.light_for_drop(), path));
                }
                "hdr" => out.push(Command::EnvironmentMapPath(self.light_for_drop(), path)),
                _ => self.toasts.error(format!(
                    "Only a studio (.ron), a rendered picture (.exr), {} can be dropped here, not {}.",
                    io::importable_files_text(),
                    path.display()
                )),
            }
        }
    }

    /// Draws the hint for files that hover over the window.
    pub(super) fn drop_hint(&self, ctx: &Context) {
        if ctx.input(|i| i.raw.hovered_files.is_empty()) {
            return;
        }
        let painter = ctx.layer_painter(LayerId::new(Order::Foreground, Id::unique("drop hint")));
        let rect = ctx.content_rect();
        painter.rect_filled(rect, 0.0, Color32::from_black_alpha(170));
        let to_open = "Drop a studio (.ron) or a rendered picture (.exr) to open it";
        let text = format!("{to_open},\n{} to bring it in", io::importable_files_text());
        painter.text(rect.center(), Align2::CENTER_CENTER, text, egui::FontId::proportional(20.0), Color32::WHITE);
    }

    /// Closes the window that waits for the files that are being written.
    pub(super) fn quit_after_export(&mut self, ctx: &Context) {
        if self.session.quits_after_export && !self.background.exports.is_busy() {
            self.session.quits_after_export = false;
            self.execute_pending(PendingOperation::Quit, ctx);
        }
    }

    /// Handles a request to close the window: prompts for what would be lost.
    pub(super) fn take_close_request(&mut self, ctx: &Context) {
        if !ctx.input(|i| i.viewport().close_requested()) || self.session.may_close {
            return;
        }
        let has_picture = self.variant_pictures.is_costly_to_lose(&self.rendering);
        if self.document.is_dirty() || has_picture || self.background.exports.is_busy() {
            ctx.send_viewport_cmd(ViewportCommand::CancelClose);
            self.confirm_unsaved(PendingOperation::Quit, ctx);
            if ctx.input(|i| i.viewport().visible()) == Some(false) {
                // Restore a minimised window, so that the prompt is visible.
                ctx.send_viewport_cmd(ViewportCommand::Minimized(false));
                ctx.send_viewport_cmd(ViewportCommand::Focus);
            }
        }
    }

    /// Draws the open prompts and handles their answers.
    pub(super) fn ask(&mut self, ctx: &Context, out: &mut Vec<Command>) {
        if let Some(pending) = self.session.unsaved_prompt.clone()
            && let Some(answer) = prompts::unsaved_changes_ui(ctx, &self.document.title(), pending.description())
        {
            self.session.unsaved_prompt = None;
            match answer {
                UnsavedAnswer::Save => {
                    self.session.after_save = Some(pending);
                    out.push(Command::Save);
                }
                UnsavedAnswer::Discard => self.leave_studio(pending, ctx),
                UnsavedAnswer::Cancel => {}
            }
        }
        if let Some(pending) = self.session.picture_prompt.clone()
            && let Some(answer) = prompts::unexported_picture_ui(ctx, pending.description())
        {
            self.session.picture_prompt = None;
            match answer {
                PictureAnswer::Export => out.push(Command::ExportPicture),
                PictureAnswer::Discard => self.execute_pending(pending, ctx),
                PictureAnswer::Cancel => {}
            }
        }
        self.ask_to_replace(ctx, out);
        self.ask_about_model(ctx);
        self.ask_about_picture(ctx, out);
        self.ask_about_file_change(ctx, out);
        self.ask_to_recover(ctx);
        if let Some(prompt) = &mut self.session.prompt {
            let purpose = prompt.purpose;
            match prompt.ui(ctx) {
                Some(PathAnswer::Chosen(path)) => {
                    self.session.prompt = None;
                    self.use_or_ask(purpose, path, false, out);
                }
                Some(PathAnswer::Cancelled) => (self.session.prompt, self.session.after_save) = (None, None),
                None => {}
            }
        }
    }
}

/// Returns a callback that repaints the window once.
pub(super) fn waker(ctx: &Context) -> impl FnOnce() + Send + 'static {
    let ctx = ctx.clone();
    move || ctx.request_repaint()
}
