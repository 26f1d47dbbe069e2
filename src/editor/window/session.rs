//! Prompts and file dialogs in progress.

use crate::editor::commands::file_purpose::FilePurpose;
use crate::editor::document::files::StudioSource;
use crate::editor::document::item::Item;
use crate::editor::panels::prompts::PathPrompt;
use crate::editor::window::dialogs::{DialogAnswer, FileDialogs};
use crate::editor::window::recent::RecentFiles;
use crate::scene::TextureSlot;
use std::sync::mpsc::Receiver;

/// An operation that waits for the prompt for unsaved changes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PendingOperation {
    Load(StudioSource),
    Quit,
}

impl PendingOperation {
    pub fn description(&self) -> &'static str {
        match self {
            PendingOperation::Load(StudioSource::File(_)) => "opening another studio",
            PendingOperation::Load(StudioSource::Preset(_)) => "starting a new studio",
            PendingOperation::Quit => "quitting",
        }
    }
}

/// Prompts and dialogs in progress.
#[derive(Debug)]
pub struct Session {
    pub(super) dialogs: FileDialogs,
    /// Studios opened recently.
    pub(super) recent: RecentFiles,
    pub(super) dialog: Option<(FilePurpose, Receiver<DialogAnswer>)>,
    pub(super) prompt: Option<PathPrompt>,
    pub(super) unsaved_prompt: Option<PendingOperation>,
    pub(super) after_save: Option<PendingOperation>,
    /// The item and part whose material gets the chosen texture.
    pub(super) texture_for: Option<(Item, Option<String>, TextureSlot)>,
    pub(super) may_close: bool,
}

impl Session {
    /// Returns a session with these dialogs and recent studios.
    pub fn new(dialogs: FileDialogs, recent: RecentFiles) -> Self {
        Session {
            dialogs,
            recent,
            dialog: None,
            prompt: None,
            unsaved_prompt: None,
            after_save: None,
            texture_for: None,
            may_close: false,
        }
    }

    /// Returns true while the desktop's dialog is open.
    pub fn is_waiting(&self) -> bool {
        self.dialog.is_some()
    }

    /// Returns true while a prompt is open in the window.
    pub fn is_asking(&self) -> bool {
        self.prompt.is_some() || self.unsaved_prompt.is_some()
    }
}
