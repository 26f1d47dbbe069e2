//! Keeping, offering and opening unsaved studios.

use crate::editor::CentralView;
use crate::editor::document::files::{self, RecoveredStudio};
use crate::editor::panels::recovery_prompt::{RecoveryAnswer, UnsavedStudio, recovery_ui};
use crate::editor::ui::wake::wake;
use crate::editor::window::app::App;
use crate::editor::window::background_tasks::{RecoveryLoad, TaskResult};
use crate::editor::window::recovery::{Unsaved, WindowContent};
use crate::editor::window::run_file_command::waker;
use crate::editor::window::session::PendingOperation;
use crate::io::RecoveryFolder;
use crate::jobs::ThumbnailSubject;
use eframe::egui::Context;
use std::path::Path;
use std::time::Duration;

impl App {
    /// Looks for the unsaved studios of windows that have ended, in the background.
    pub(super) fn look_for_unsaved(&mut self, ctx: &Context) {
        if let Some(parent) = self.session.recovery.parent().map(ToOwned::to_owned) {
            self.background.tasks.start(move || TaskResult::Unsaved(RecoveryFolder::abandoned(&parent)), waker(ctx));
        }
    }

    /// Keeps unsaved changes on the disk.
    pub(super) fn keep_unsaved(&mut self, ctx: &Context) {
        let (now, picture) = (ctx.input(|i| i.time), self.variant_pictures.to_keep(&self.rendering));
        let (document, is_rendering) =
            (&self.document, self.rendering.is_running() || self.variant_pictures.running().is_some());
        let content = WindowContent { document, picture: picture.as_ref(), is_rendering };
        if let Some(seconds) = self.session.recovery.update(content, now, &wake(ctx)) {
            ctx.request_repaint_after(Duration::from_secs_f64(seconds));
        }
        if let Some(why) = self.session.recovery.failure() {
            self.toasts.warning(format!("Unsaved changes are not kept for the case of a crash: {why}."));
        }
    }

    /// Draws the offer of an unsaved studio and handles its answer.
    pub(super) fn ask_to_recover(&mut self, ctx: &Context) {
        // The studio that is being opened would replace the recovered one.
        if self.background.tasks.is_busy() || self.session.has_prompt() {
            return;
        }
        let Some((folder, info)) = self.session.recovery.offered() else { return };
        let more = self.session.recovery.offered_after();
        let beside = || info.path.as_deref().and_then(Path::parent).map(Path::to_owned);
        let subject = || Some(ThumbnailSubject::Scene(Box::new(folder.read().ok()?), beside()));
        let picture = self.background.thumbnails.unsaved(ctx, info.changed_at, subject);
        match recovery_ui(ctx, &UnsavedStudio { info, has_picture: folder.has_picture(), more, picture }) {
            Some(RecoveryAnswer::Recover) => self.confirm_unsaved(PendingOperation::Recover, ctx),
            Some(RecoveryAnswer::Discard) => {
                if let Some((folder, _)) = self.session.recovery.take_offered() {
                    folder.remove();
                }
            }
            Some(RecoveryAnswer::Later) => self.session.recovery.put_off(),
            None => {}
        }
    }

    /// Reads the unsaved studio on offer in the background.
    pub(super) fn recover(&mut self, ctx: &Context) {
        let Some(unsaved) = self.session.recovery.take_offered() else { return };
        // One window has one studio: the others are offered at the next start.
        self.session.recovery.put_off();
        let load = RecoveryLoad { unsaved, open: Box::new(self.document.scene().clone()) };
        let work = move || {
            let result = files::recover(&load.unsaved.0, &load.unsaved.1);
            TaskResult::Recovered(load, result)
        };
        self.background.tasks.start(work, waker(ctx));
    }

    /// Takes a recovered studio. Asks first if the open one has changed meanwhile.
    pub(super) fn take_recovered(
        &mut self,
        load: RecoveryLoad,
        result: Result<Box<RecoveredStudio>, String>,
        ctx: &Context,
    ) {
        if result.is_ok() && self.document.is_dirty() && *self.document.scene() != *load.open {
            self.session.recovery.offer(vec![load.unsaved]);
            self.session.unsaved_prompt = Some(PendingOperation::Recover);
        } else {
            self.show_recovered(load.unsaved, result, ctx);
        }
    }

    /// Opens a recovered studio, or says why that failed.
    fn show_recovered(&mut self, (folder, info): Unsaved, result: Result<Box<RecoveredStudio>, String>, ctx: &Context) {
        match result {
            Ok(recovered) => {
                let RecoveredStudio { opened, picture } = *recovered;
                self.show_opened(opened, ctx);
                self.document.mark_recovered(info.imported, !info.is_saved);
                let picture = match picture {
                    Ok(picture) => {
                        self.session.recovery.adopt(folder, &self.document, picture.as_ref());
                        picture
                    }
                    // Its folder stays for the user, and is offered again.
                    Err(why) => {
                        let folder = folder.path().display();
                        self.toasts
                            .warning(format!("The picture could not be recovered: {why}. It is kept in {folder}"));
                        None
                    }
                };
                self.toasts.info(match (info.is_saved, &picture) {
                    (false, None) => "The unsaved studio is open again. Save it to keep it.",
                    (false, Some(_)) => "The unsaved studio is open again, with its picture. Save it to keep it.",
                    (true, Some(_)) => "The studio and its picture are open again. Export the picture to keep it.",
                    (true, None) => "The studio is open again, without its picture.",
                });
                if let Some(picture) = picture {
                    self.show_variant_of(&picture.scene);
                    self.rendering.restore(picture, false);
                    self.views.central = CentralView::Picture;
                }
            }
            Err(message) => {
                let file = folder.studio();
                self.toasts.error(format!(
                    "{} could not be recovered. {message} It is kept in {}",
                    info.title,
                    file.display()
                ));
            }
        }
    }
}
