//! File operations in the background and their results.

use crate::editor::document::files::{ImportedModel, OpenedStudio, StudioSource};
use crate::scene::Assets;
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, Sender, channel};

/// What came out of a background task.
#[derive(Debug)]
pub enum TaskResult {
    /// A studio was read, or not; with what was asked for.
    Opened(StudioSource, Result<Box<OpenedStudio>, String>),
    /// A model was read, or not.
    Imported(Result<Box<ImportedModel>, String>),
    /// Assets of the scene were read: what was loaded, what was asked for, what is odd.
    Assets(Assets, BTreeSet<String>, Vec<String>),
    /// A picture was written, or not.
    Exported(PathBuf, Result<(), String>),
}

/// Background tasks and the channel their results come through.
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
    /// Runs `work` in a thread; `wake` is called when its result is there.
    pub fn start(&mut self, work: impl FnOnce() -> TaskResult + Send + 'static, wake: impl FnOnce() + Send + 'static) {
        let sender = self.sender.clone();
        self.running += 1;
        std::thread::spawn(move || {
            let _ = sender.send(work());
            wake();
        });
    }

    /// Results that have come in.
    pub fn finished(&mut self) -> Vec<TaskResult> {
        let done: Vec<TaskResult> = self.receiver.try_iter().collect();
        self.running -= done.len();
        done
    }

    /// Whether something is on its way.
    pub fn is_busy(&self) -> bool {
        self.running > 0
    }
}
