//! Prompts and file dialogs in progress.

use crate::editor::commands::file_purpose::FilePurpose;
use crate::editor::document::asset_stamps::AssetStamps;
use crate::editor::document::files::StudioSource;
use crate::editor::document::item::Item;
use crate::editor::panels::import_prompt::PendingModel;
use crate::editor::panels::prompts::PathPrompt;
use crate::editor::window::dialogs::{DialogAnswer, FileDialogs};
use crate::editor::window::kept_preferences::KeptPreferences;
use crate::editor::window::recent::RecentFiles;
use crate::editor::window::recovery::Recovery;
use crate::scene::TextureSlot;
use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::mpsc::Receiver;

/// An operation that waits for the prompt for unsaved changes.
#[derive(Clone, Debug, PartialEq)]
pub enum PendingOperation {
    Load(StudioSource),
    /// The opening of the unsaved studio on offer.
    Recover,
    Quit,
}

impl PendingOperation {
    pub fn description(&self) -> &'static str {
        match self {
            PendingOperation::Load(StudioSource::File(_)) => "opening another studio",
            PendingOperation::Load(StudioSource::Preset(_) | StudioSource::Memory(_)) => "starting a new studio",
            PendingOperation::Recover => "opening the recovered studio",
            PendingOperation::Quit => "quitting",
        }
    }
}

/// When it was noticed that another program has changed the studio's file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileChange {
    /// When the window got the keyboard.
    Noticed,
    /// Before a save.
    OnSave,
}

/// Prompts and dialogs in progress.
#[derive(Debug)]
pub struct Session {
    pub(super) dialogs: FileDialogs,
    /// Studios opened recently.
    pub(super) recent: RecentFiles,
    pub(super) preferences: KeptPreferences,
    pub(super) dialog: Option<(FilePurpose, Receiver<DialogAnswer>)>,
    pub(super) prompt: Option<PathPrompt>,
    pub(super) unsaved_prompt: Option<PendingOperation>,
    /// The file that the user is asked about before it is replaced, and what it is replaced by.
    pub(super) replace: Option<(FilePurpose, PathBuf)>,
    /// Imported models that the user is asked about, one after the other.
    pub(super) models: VecDeque<PendingModel>,
    /// The panorama that the user is asked about.
    pub(super) panorama: Option<PathBuf>,
    pub(super) after_save: Option<PendingOperation>,
    /// The item and part whose material gets the chosen texture.
    pub(super) texture_for: Option<(Item, Option<String>, TextureSlot)>,
    pub(super) may_close: bool,
    /// The operation that waits for what the user wants with a picture that is not exported.
    pub(super) picture_prompt: Option<PendingOperation>,
    /// The window closes when the files that are being written are complete.
    pub(super) quits_after_export: bool,
    /// The change of the studio's file that the user is asked about.
    pub(super) file_change: Option<FileChange>,
    /// The user decides about the noticed change before the next save.
    pub(super) file_change_put_off: bool,
    /// The states of the studio's asset files when the window lost the keyboard.
    pub(super) asset_stamps: AssetStamps,
    /// Unsaved changes, kept for the case of a crash.
    pub(super) recovery: Recovery,
}

impl Session {
    /// Returns a session with these dialogs, with what a settings folder holds, and with this recovery.
    pub fn new(dialogs: FileDialogs, settings_folder: Option<PathBuf>, recovery: Recovery) -> Self {
        Session {
            dialogs,
            recent: RecentFiles::load(settings_folder.clone()),
            preferences: KeptPreferences::load(settings_folder),
            dialog: None,
            prompt: None,
            unsaved_prompt: None,
            replace: None,
            models: VecDeque::new(),
            panorama: None,
            after_save: None,
            texture_for: None,
            may_close: false,
            picture_prompt: None,
            quits_after_export: false,
            file_change: None,
            file_change_put_off: false,
            asset_stamps: AssetStamps::default(),
            recovery,
        }
    }

    /// Ends what was asked about the former studio, because another one is open.
    pub fn begin_studio(&mut self) {
        self.models.clear();
        (self.texture_for, self.file_change, self.file_change_put_off) = (None, None, false);
        self.asset_stamps = AssetStamps::default();
    }

    /// Returns true while the desktop's dialog is open.
    pub fn is_waiting(&self) -> bool {
        self.dialog.is_some()
    }

    /// Returns true while a prompt about the open studio is open.
    pub fn has_prompt(&self) -> bool {
        self.prompt.is_some()
            || self.unsaved_prompt.is_some()
            || self.picture_prompt.is_some()
            || self.replace.is_some()
            || self.panorama.is_some()
            || self.file_change.is_some()
            || !self.models.is_empty()
    }

    /// Returns true while a prompt is open in the window.
    pub fn is_asking(&self) -> bool {
        self.has_prompt() || self.recovery.offered().is_some()
    }
}
