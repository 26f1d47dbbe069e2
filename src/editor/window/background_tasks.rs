//! File operations in the background and their results.

use crate::editor::document::asset_stamps::AssetStamps;
use crate::editor::document::environment::ReadEnvironment;
use crate::editor::document::files::{ImportedModel, OpenedStudio, RecoveredStudio, RereadAssets, StudioSource};
use crate::editor::document::measured_light::MeasuredFile;
use crate::editor::window::recovery::Unsaved;
use crate::io::{FileStamp, LoadProgress};
use crate::raytrace::Film;
use crate::scene::{AssetKey, Assets, LightId, Scene};
use std::collections::BTreeSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Weak};

/// The reading of a studio.
#[derive(Debug)]
pub struct StudioLoad {
    /// What is read.
    pub source: StudioSource,
    /// How far it is.
    pub progress: Arc<LoadProgress>,
    /// The open studio when it began.
    pub open: Box<Scene>,
}

/// The reading of an unsaved studio.
#[derive(Debug)]
pub struct RecoveryLoad {
    /// What is read.
    pub unsaved: Unsaved,
    /// The open studio when it began.
    pub open: Box<Scene>,
}

/// The result of a background task.
#[derive(Debug)]
pub enum TaskResult {
    /// An opened studio or an error.
    Opened(StudioLoad, Result<Box<OpenedStudio>, String>),
    /// An imported model or an error, with the progress of its import.
    Imported(Arc<LoadProgress>, Result<Box<ImportedModel>, String>),
    /// A photometric file for a light (none: a new one), or an error.
    Measured(Option<LightId>, Result<Box<MeasuredFile>, String>),
    /// An environment map for a surround (none: a new one), or an error.
    Environment(Option<LightId>, Result<Box<ReadEnvironment>, String>),
    /// Assets of the scene: those loaded, those requested, and warnings.
    Assets(Assets, BTreeSet<AssetKey>, Vec<String>),
    /// The states of the studio's asset files.
    AssetsStamped(AssetStamps),
    /// Assets whose files another program has changed.
    AssetsReread(Box<RereadAssets>),
    /// The unsaved studios of windows that have ended.
    Unsaved(Vec<Unsaved>),
    /// A recovered studio or an error.
    Recovered(RecoveryLoad, Result<Box<RecoveredStudio>, String>),
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
    /// An import for a studio that is no longer open, with its progress.
    ImportOfAnotherStudio(Arc<LoadProgress>),
    /// The task ended by an internal error.
    Panicked,
}

impl TaskResult {
    /// Returns what is left of a result for a studio that is no longer open.
    fn of_another_studio(self) -> Option<Self> {
        match self {
            TaskResult::Measured(..)
            | TaskResult::Environment(..)
            | TaskResult::Assets(..)
            | TaskResult::AssetsStamped(_)
            | TaskResult::AssetsReread(_) => None,
            TaskResult::Imported(progress, _) => Some(TaskResult::ImportOfAnotherStudio(progress)),
            other => Some(other),
        }
    }
}

/// The background tasks and the channel of their results.
#[derive(Debug)]
pub struct BackgroundTasks {
    sender: Sender<(u64, TaskResult)>,
    receiver: Receiver<(u64, TaskResult)>,
    running: usize,
    /// Number of the open studio.
    studio: u64,
}

impl Default for BackgroundTasks {
    fn default() -> Self {
        let (sender, receiver) = channel();
        BackgroundTasks { sender, receiver, running: 0, studio: 0 }
    }
}

impl BackgroundTasks {
    /// Runs `work` in a thread and calls `wake` when it has its result.
    pub fn start(&mut self, work: impl FnOnce() -> TaskResult + Send + 'static, wake: impl FnOnce() + Send + 'static) {
        let (sender, studio) = (self.sender.clone(), self.studio);
        self.running += 1;
        std::thread::spawn(move || {
            let result = catch_unwind(AssertUnwindSafe(work)).unwrap_or(TaskResult::Panicked);
            let _ = sender.send((studio, result));
            wake();
        });
    }

    /// Notes that another studio is open: what tasks read for the former one is left out.
    pub fn begin_studio(&mut self) {
        self.studio += 1;
    }

    /// Returns the results since the last call.
    pub fn finished(&mut self) -> Vec<TaskResult> {
        let done: Vec<(u64, TaskResult)> = self.receiver.try_iter().collect();
        self.running -= done.len();
        let of_studio = |(studio, result): (u64, TaskResult)| {
            if studio == self.studio { Some(result) } else { result.of_another_studio() }
        };
        done.into_iter().filter_map(of_studio).collect()
    }

    /// Returns true while a task runs.
    pub fn is_busy(&self) -> bool {
        self.running > 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Starts tasks, shows another studio before they end, and returns their results.
    fn results_after_another_studio(results: Vec<TaskResult>) -> Vec<TaskResult> {
        let mut tasks = BackgroundTasks::default();
        let count = results.len();
        results.into_iter().for_each(|result| tasks.start(move || result, || ()));
        tasks.begin_studio();
        wait_for(&mut tasks, count)
    }

    /// Returns the results of so many tasks that are running.
    fn wait_for(tasks: &mut BackgroundTasks, count: usize) -> Vec<TaskResult> {
        let sent: Vec<_> = tasks.receiver.iter().take(count).collect();
        sent.into_iter().for_each(|result| tasks.sender.send(result).unwrap());
        tasks.finished()
    }

    #[test]
    fn what_was_read_for_another_studio_is_left_out() {
        let assets = || TaskResult::Assets(Assets::default(), BTreeSet::new(), Vec::new());
        let environment = TaskResult::Environment(Some(LightId(1)), Err("".to_owned()));
        let measured = TaskResult::Measured(Some(LightId(1)), Err("".to_owned()));
        let imported = TaskResult::Imported(Arc::default(), Err("".to_owned()));
        let exported = TaskResult::Exported(PathBuf::new(), Weak::new(), Ok(()));
        let left = results_after_another_studio(vec![assets(), environment, measured, imported, exported]);
        let of_import = left.iter().filter(|result| matches!(result, TaskResult::ImportOfAnotherStudio(_))).count();
        let of_export = left.iter().filter(|result| matches!(result, TaskResult::Exported(..))).count();
        assert_eq!((left.len(), of_import, of_export), (2, 1, 1), "{left:?}");
        // Those of the open one come in
        let mut tasks = BackgroundTasks::default();
        tasks.begin_studio();
        tasks.start(assets, || ());
        assert!(matches!(wait_for(&mut tasks, 1)[..], [TaskResult::Assets(..)]));
    }

    #[test]
    fn a_task_that_panics_has_ended() {
        let mut tasks = BackgroundTasks::default();
        tasks.start(|| panic!("as asked for by the test"), || ());
        assert!(tasks.is_busy());
        assert!(matches!(wait_for(&mut tasks, 1)[..], [TaskResult::Panicked]));
        assert!(!tasks.is_busy());
    }
}
