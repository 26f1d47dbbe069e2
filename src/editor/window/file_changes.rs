//! Changes of the studio's file and its assets by other programs: noticed when the window is used again, and those of
//! the studio's file before a save.

use crate::editor::commands::command::Command;
use crate::editor::document::files::StudioSource;
use crate::editor::panels::file_change_prompt::{FileChangeAnswer, file_change_ui};
use crate::editor::window::app::App;
use crate::editor::window::background_tasks::TaskResult;
use crate::editor::window::run_file_command::waker;
use crate::editor::window::session::FileChange;
use eframe::egui::Context;
use std::path::{Path, PathBuf};

impl App {
    /// Checks the studio's files in the background when the window gets the keyboard.
    pub(super) fn check_files_on_focus(&mut self, ctx: &Context) {
        let has_focus = ctx.input(|i| i.viewport().focused) == Some(true);
        match (std::mem::replace(&mut self.window.has_focus, has_focus), has_focus) {
            (false, true) => {
                self.check_studio_file(ctx);
                self.reread_changed_assets(ctx);
            }
            (true, false) => self.stamp_assets(ctx),
            (false, false) | (true, true) => {}
        }
    }

    fn check_studio_file(&mut self, ctx: &Context) {
        if self.session.file_change.is_some() {
            return;
        }
        let (Some(path), Some(stamp)) = (self.document.path(), self.document.stamp()) else { return };
        let (path, stamp) = (path.to_owned(), stamp.clone());
        let work = move || {
            let is_changed = stamp.is_outdated(&path);
            TaskResult::FileChecked { path, stamp, is_changed }
        };
        self.background.tasks.start(work, waker(ctx));
    }

    /// Asks about a change that was noticed when the window got the keyboard.
    pub(super) fn file_is_changed(&mut self) {
        if !self.session.file_change_put_off && self.session.file_change.is_none() {
            self.session.file_change = Some(FileChange::Noticed);
        }
    }

    /// Asks before a save over a file that another program has changed. Returns true if the save has to wait.
    pub(super) fn ask_before_overwriting(&mut self, path: &Path) -> bool {
        let is_changed = self.document.path() == Some(path) && self.document.is_changed_outside();
        if is_changed {
            self.session.file_change = Some(FileChange::OnSave);
        }
        is_changed
    }

    /// Draws the prompt and handles its answer.
    pub(super) fn ask_about_file_change(&mut self, ctx: &Context, out: &mut Vec<Command>) {
        let Some(change) = self.session.file_change else { return };
        let is_dirty = self.document.is_dirty();
        let Some(answer) = file_change_ui(ctx, &self.document.title(), is_dirty) else { return };
        self.session.file_change = None;
        let path: Option<PathBuf> = self.document.path().map(Path::to_owned);
        match answer {
            FileChangeAnswer::KeepMine => {
                self.document.keep_over_file();
                if change == FileChange::OnSave {
                    out.push(Command::Save);
                }
            }
            FileChangeAnswer::TakeTheirs => {
                self.session.after_save = None;
                if let Some(path) = path {
                    self.load(StudioSource::File(path), ctx);
                }
            }
            FileChangeAnswer::SaveAs => out.push(Command::SaveAs),
            FileChangeAnswer::Cancel => {
                self.session.after_save = None;
                // It is asked again before a save.
                self.session.file_change_put_off = true;
            }
        }
    }
}
