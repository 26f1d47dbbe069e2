//! Questions and file dialogs in progress.

use crate::editor::commands::file_purpose::Purpose;
use crate::editor::document::files::Source;
use crate::editor::document::item::Item;
use crate::editor::panels::prompts::PathPrompt;
use crate::editor::window::dialogs::{Answer, FileDialogs};
use std::sync::mpsc::Receiver;

/// What waits for the answer to "save the changes?".
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Intent {
    Load(Source),
    Quit,
}

impl Intent {
    pub fn words(&self) -> &'static str {
        match self {
            Intent::Load(Source::File(_)) => "opening another studio",
            Intent::Load(Source::Preset(_)) => "starting a new studio",
            Intent::Quit => "quitting",
        }
    }
}

/// Questions and dialogs under way.
#[derive(Debug)]
pub struct Session {
    pub(super) dialogs: FileDialogs,
    pub(super) dialog: Option<(Purpose, Receiver<Answer>)>,
    pub(super) prompt: Option<PathPrompt>,
    pub(super) guard: Option<Intent>,
    pub(super) after_save: Option<Intent>,
    /// Whose material the texture that is being chosen is for.
    pub(super) texture_for: Option<(Item, Option<String>)>,
    pub(super) may_close: bool,
}

impl Session {
    /// A session that asks these dialogs for file names.
    pub fn new(dialogs: FileDialogs) -> Self {
        Session {
            dialogs,
            dialog: None,
            prompt: None,
            guard: None,
            after_save: None,
            texture_for: None,
            may_close: false,
        }
    }

    /// Whether the desktop's dialog is open.
    pub fn is_waiting(&self) -> bool {
        self.dialog.is_some()
    }

    /// Whether a question is open in the window.
    pub fn is_asking(&self) -> bool {
        self.prompt.is_some() || self.guard.is_some()
    }
}
