//! File operations in the background and their results.

use crate::editor::document::environment::ReadEnvironment;
use crate::editor::document::files::{ImportedModel, OpenedStudio, RecoveredStudio, StudioSource};
use crate::editor::document::measured_light::MeasuredFile;
use crate::editor::window::recovery::Unsaved;
use crate::io::{FileStamp, LoadProgress};
use crate::raytrace::Film;
use crate::scene::{AssetKey, Assets, LightId};
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Weak};

/// The result of a background task.
#[derive(Debug)]
pub enum TaskResult {
    /// An opened studio or an error, with the source and the progress of its reading.
    Opened(StudioSource, Arc<LoadProgress>, Result<Box<OpenedStudio>, String>),
    /// An imported model or an error, with the progress of its import.
    Imported(Arc<LoadProgress>, Result<Box<ImportedModel>, String>),
    /// A photometric file for a light (none: a new one), or an error.
    Measured(Option<LightId>, Result<Box<MeasuredFile>, String>),
    /// An environment map for a surround (none: a new one), or an error.
    Environment(Option<LightId>, Result<Box<ReadEnvironment>, String>),
    /// Assets of the scene: those loaded, those requested, and warnings.
    Assets(Assets, BTreeSet<AssetKey>, Vec<String>),
    /// The unsaved studios of windows that have ended.
    Unsaved(Vec<Unsaved>),
    /// A recovered studio or an error.
    Recovered(Unsaved, Result<Box<RecoveredStudio>, String>),
    /// The studio's file compared with its stamp.
    FileChecked {
        /// The file.
        path: PathBuf,
        /// The stamp.
        stamp: FileStamp,
        /// Another program has changed the file.
        is_changed: bool,
    },
    /// A written picture or an error, with the film that it was developed from.
    Exported(PathBuf, Weak<Film>, Result<(), String>),
    /// A written sheet or an error, with the name of its kind.
    SheetExported(&'static str, PathBuf, Result<(), String>),
}

/// The background tasks and the channel of their results.
#[derive(Debug)]
pub struct BackgroundTasks {
    sender: Sender<TaskResult>,
    receiver: Receiver<TaskResult>,
    running: usize,
}

impl Default for BackgroundTasks {
    fn default() -> Self {
        let (sender, receiver) = channel();
        BackgroundTasks { sender, receiver, running: 0 }
    }
}

impl BackgroundTasks {
    /// Runs `work` in a thread and calls `wake` when it has its result.
    pub fn start(&mut self, work: impl FnOnce() -> TaskResult + Send + 'static, wake: impl FnOnce() + Send + 'static) {
        let sender = self.sender.clone();
        self.running += 1;
        std::thread::spawn(move || {
            let _ = sender.send(work());
            wake();
        });
    }

    /// Returns the results since the last call.
    pub fn finished(&mut self) -> Vec<TaskResult> {
        let done: Vec<TaskResult> = self.receiver.try_iter().collect();
        self.running -= done.len();
        done
    }

    /// Returns true while a task runs.
    pub fn is_busy(&self) -> bool {
        self.running > 0
    }
}
