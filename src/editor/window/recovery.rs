//! Keeps unsaved changes and the rendered picture in a folder of the window's own while it runs, and holds those of
//! ended windows to be offered.

use crate::editor::document::studio_document::Document;
use crate::io::{KeptPicture, RecoveryFolder, RecoveryInfo};
use crate::jobs::Priority;
use crate::jobs::Wake;
use crate::jobs::worker::{Inbox, Interrupt, Worker, WorkerSettings};
use crate::raytrace::Film;
use crate::scene::Scene;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::time::SystemTime;

/// Time from a change until it is written, seconds: the changes of a drag are written together.
const DELAY_S: f64 = 2.0;
/// Time from a new film of a running render until it is written, seconds: it is large.
const RUNNING_DELAY_S: f64 = 60.0;
/// Time until the next try while the worker writes, seconds.
const RETRY_S: f64 = 0.5;

const WORKER: WorkerSettings = WorkerSettings {
    name: "recovery",
    priority: Priority::Normal,
    interrupt: Interrupt::Always,
    panic_message: "This is an error in Catchlight",
};

/// The state of the window's folder on the disk.
#[derive(Debug)]
enum Request {
    /// It holds this studio.
    Keep(Box<(Scene, RecoveryInfo)>, PictureChange),
    /// It holds no studio: everything is saved.
    Clear,
}

/// The change of the picture on the disk.
#[derive(Debug)]
enum PictureChange {
    Unchanged,
    Removed,
    Replaced(KeptPicture),
}

/// The studio and the picture of a window.
#[derive(Clone, Copy, Debug)]
pub struct WindowContent<'a> {
    /// The studio.
    pub document: &'a Document,
    /// The rendered picture, if it is not exported.
    pub picture: Option<&'a KeptPicture>,
    /// The picture is being rendered.
    pub is_rendering: bool,
}

/// The content of the window's folder.
#[derive(Debug)]
struct FolderContent {
    studio: StudioState,
    /// The film of the picture.
    film: Option<Weak<Film>>,
}

/// The state of a document, to find its changes.
#[derive(Clone, Debug, PartialEq, Eq)]
struct StudioState {
    revision: u64,
    is_dirty: bool,
    path: Option<PathBuf>,
}

impl StudioState {
    fn of(document: &Document) -> Self {
        let path = document.path().map(Path::to_owned);
        StudioState { revision: document.revision(), is_dirty: document.is_dirty(), path }
    }
}

/// The window's folder.
#[derive(Debug, Default)]
enum Slot {
    /// Made with the first unsaved change or picture.
    #[default]
    Unmade,
    Open(RecoveryFolder),
    /// The window has ended.
    Closed,
}

/// An unsaved studio of a window that has ended.
pub type Unsaved = (RecoveryFolder, RecoveryInfo);

/// The recovery of unsaved changes.
#[derive(Debug)]
pub struct Recovery {
    /// The folder of all windows' folders; none where nothing is kept.
    parent: Option<PathBuf>,
    slot: Arc<Mutex<Slot>>,
    worker: Worker<Request, ()>,
    /// What the folder holds; none while it holds nothing.
    kept: Option<FolderContent>,
    /// Times at which the current changes and the current picture are written, in egui's time.
    studio_due: Option<f64>,
    picture_due: Option<f64>,
    /// The last write failed, which was reported.
    has_failed: bool,
    offered: Vec<Unsaved>,
}

impl Recovery {
    /// Returns the recovery of a new window; none without a folder.
    pub fn new(parent: Option<PathBuf>) -> Self {
        let slot: Arc<Mutex<Slot>> = Arc::default();
        let (shared, folder) = (slot.clone(), parent.clone());
        let worker = Worker::new(WORKER, move |inbox: &Inbox<Request, ()>| {
            while let Some((request, _)) = inbox.next() {
                match execute(&request, &mut locked(&shared), folder.as_deref()) {
                    Ok(()) => inbox.publish(()),
                    Err(message) => inbox.fail(message),
                }
            }
        });
        let (kept, studio_due, picture_due) = (None, None, None);
        Recovery { parent, slot, worker, kept, studio_due, picture_due, has_failed: false, offered: Vec::new() }
    }

    /// Returns the folder of all windows' folders.
    pub fn parent(&self) -> Option<&Path> {
        self.parent.as_deref()
    }

    /// Requests that unsaved changes and a picture that is not exported be written, [`DELAY_S`] after the first of them,
    /// and removed when they are saved. The picture of a running render is written every [`RUNNING_DELAY_S`]. Returns the
    /// seconds until the next write. To be called once a frame.
    pub fn update(&mut self, content: WindowContent<'_>, now: f64, wake: &Wake) -> Option<f64> {
        self.parent.as_ref()?;
        let WindowContent { document, picture, .. } = content;
        // A saved studio is kept with its picture only
        if !document.is_dirty() && (picture.is_none() || self.kept_film().is_none()) {
            self.studio_due = None;
            if self.kept.take().is_some() {
                self.worker.request(Request::Clear, wake);
            }
        }
        if !document.is_dirty() && picture.is_none() {
            self.picture_due = None;
            return None;
        }
        // One write after the other: the worker holds a single request
        if self.worker.is_busy() {
            return Some(RETRY_S);
        }
        self.note_changes(content, now);
        let due = self.next_due()?;
        if now < due {
            return Some(due - now);
        }
        self.write(content, now, wake);
        self.next_due().map(|due| (due - now).max(RETRY_S))
    }

    /// Sets the times at which what has changed since the last write is written.
    fn note_changes(&mut self, WindowContent { document, picture, is_rendering }: WindowContent<'_>, now: f64) {
        let is_same_studio = self.kept.as_ref().is_some_and(|kept| kept.studio == StudioState::of(document));
        if !is_same_studio && (document.is_dirty() || self.kept_film().is_some()) {
            self.studio_due.get_or_insert(now + DELAY_S);
        }
        let film = picture.map(|picture| Arc::downgrade(&picture.film));
        let is_same_film = match (&film, self.kept_film()) {
            (Some(film), Some(kept)) => film.ptr_eq(kept),
            (None, None) => true,
            _ => false,
        };
        if !is_same_film {
            let due = now + if is_rendering { RUNNING_DELAY_S } else { DELAY_S };
            self.picture_due = Some(self.picture_due.map_or(due, |earlier| earlier.min(due)));
        }
    }

    /// Requests that the studio be written, and the picture if it is due.
    fn write(&mut self, WindowContent { document, picture, .. }: WindowContent<'_>, now: f64, wake: &Wake) {
        let is_picture_due = self.picture_due.is_some_and(|due| due <= now);
        let (change, film) = match picture {
            Some(picture) if is_picture_due => {
                (PictureChange::Replaced(picture.clone()), Some(Arc::downgrade(&picture.film)))
            }
            Some(_) => (PictureChange::Unchanged, self.kept_film().cloned()),
            None => (PictureChange::Removed, None),
        };
        let info = RecoveryInfo {
            title: document.title(),
            path: document.path().map(absolute),
            stamp: document.stamp().cloned(),
            imported: document.imported_files().iter().map(|(name, file)| (name.clone(), absolute(file))).collect(),
            changed_at: SystemTime::now(),
            is_saved: !document.is_dirty(),
        };
        self.worker.request(Request::Keep(Box::new((document.scene().clone(), info)), change), wake);
        self.kept = Some(FolderContent { studio: StudioState::of(document), film });
        self.studio_due = None;
        if is_picture_due || picture.is_none() {
            self.picture_due = None;
        }
    }

    /// Returns the film of the picture that the folder holds.
    fn kept_film(&self) -> Option<&Weak<Film>> {
        self.kept.as_ref()?.film.as_ref()
    }

    /// Returns the time of the next write.
    fn next_due(&self) -> Option<f64> {
        self.studio_due.into_iter().chain(self.picture_due).reduce(f64::min)
    }

    /// Returns the message of the first of several failed writes.
    pub fn failure(&mut self) -> Option<String> {
        let result = self.worker.take()?;
        let failed_before = std::mem::replace(&mut self.has_failed, result.is_err());
        result.err().filter(|_| !failed_before)
    }

    /// Removes the window's folder: its window closes, with everything saved or given up.
    pub fn end(&self) {
        if let Slot::Open(folder) = std::mem::replace(&mut *locked(&self.slot), Slot::Closed) {
            folder.remove();
        }
    }

    /// Offers the unsaved studios of ended windows, the first of the list first.
    pub fn offer(&mut self, mut found: Vec<Unsaved>) {
        found.reverse();
        self.offered = found;
    }

    /// Returns the studio on offer.
    pub fn offered(&self) -> Option<&Unsaved> {
        self.offered.last()
    }

    /// Returns the number of studios that are offered after this one.
    pub fn offered_after(&self) -> usize {
        self.offered.len().saturating_sub(1)
    }

    /// Takes the studio on offer.
    pub fn take_offered(&mut self) -> Option<Unsaved> {
        self.offered.pop()
    }

    /// Ends the offer; the next start makes it again.
    pub fn put_off(&mut self) {
        self.offered.clear();
    }

    /// Makes a recovered studio's folder the window's own; it holds the document as it is, and this picture.
    pub fn adopt(&mut self, folder: RecoveryFolder, document: &Document, picture: Option<&KeptPicture>) {
        if let Slot::Open(own) = std::mem::replace(&mut *locked(&self.slot), Slot::Open(folder)) {
            own.remove();
        }
        let film = picture.map(|picture| Arc::downgrade(&picture.film));
        self.kept = Some(FolderContent { studio: StudioState::of(document), film });
    }
}

impl Drop for Recovery {
    /// Releases the folder and keeps its files, as the end of the process does.
    fn drop(&mut self) {
        *locked(&self.slot) = Slot::Closed;
    }
}

/// Returns a path that the next start understands in any folder.
fn absolute(path: impl AsRef<Path>) -> PathBuf {
    let path = path.as_ref();
    std::path::absolute(path).unwrap_or_else(|_| path.to_owned())
}

/// Locks the slot; a panic leaves it valid.
fn locked(slot: &Mutex<Slot>) -> MutexGuard<'_, Slot> {
    slot.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Brings the window's folder into the requested state.
fn execute(request: &Request, slot: &mut Slot, parent: Option<&Path>) -> Result<(), String> {
    if let (Request::Keep(..), Slot::Unmade, Some(parent)) = (request, &*slot, parent) {
        *slot = Slot::Open(RecoveryFolder::create(parent).map_err(|error| crate::io::reason(&error))?);
    }
    match (request, slot) {
        (Request::Keep(studio, picture), Slot::Open(folder)) => {
            let write = || folder.write(&studio.0, &studio.1).map_err(|error| error.to_string());
            // A disk that is too full for the picture may take the studio; a saved one is kept for its picture alone
            if !studio.1.is_saved {
                write()?;
            }
            match picture {
                PictureChange::Replaced(picture) => folder.write_picture(picture).map_err(|error| error.to_string())?,
                PictureChange::Removed => folder.remove_picture(),
                PictureChange::Unchanged => {}
            }
            write()?;
        }
        (Request::Clear, Slot::Open(folder)) => folder.clear(),
        _ => {}
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::document::action::Action;
    use crate::raytrace::{Layer, Settings};
    use crate::scene::Assets;
    use std::time::Duration;

    #[test]
    fn a_studio_that_was_opened_by_a_relative_path_is_recovered_from_any_folder() {
        let folder = tempfile::tempdir().unwrap();
        let mut document = Document::new(Scene::default(), Assets::default(), Some("a.ron".into()));
        document.note_import("models/cup.obj".to_owned(), "cup.obj".into());
        let notes = Action::SetNotes { name: "Changed".to_owned(), description: String::new() };
        document.apply(notes, None).unwrap();
        let mut recovery = Recovery::new(Some(folder.path().to_owned()));
        let (sender, written) = std::sync::mpsc::channel();
        let wake: Wake = Arc::new(move || {
            let _ = sender.send(());
        });
        let content = WindowContent { document: &document, picture: None, is_rendering: false };
        assert_eq!(recovery.update(content, 10.0, &wake), Some(DELAY_S));
        assert_eq!(recovery.update(content, 10.0 + DELAY_S, &wake), None);
        written.recv().unwrap();
        assert_eq!(recovery.failure(), None);
        drop(recovery);
        let [(window, info)] = &RecoveryFolder::abandoned(folder.path())[..] else { panic!("it is not kept") };
        let here = std::env::current_dir().unwrap();
        assert_eq!((&info.path, &info.imported["models/cup.obj"]), (&Some(here.join("a.ron")), &here.join("cup.obj")));
        assert_eq!(window.read().unwrap().name, "Changed");
    }

    #[test]
    fn a_running_picture_is_kept_every_minute_and_a_finished_one_at_once_until_it_is_exported() {
        let folder = tempfile::tempdir().unwrap();
        let document = Document::new(Scene::default(), Assets::default(), None);
        let picture = || {
            let settings = Settings { width: 8, height: 8, ..Settings::default() };
            let film = Arc::new(Film::new(&settings, vec![Layer::shared("Glow")], Default::default()));
            KeptPicture { film, scene: Arc::default(), settings, is_complete: false }
        };
        let mut recovery = Recovery::new(Some(folder.path().to_owned()));
        let (sender, done) = std::sync::mpsc::channel();
        let wake: Wake = Arc::new(move || {
            let _ = sender.send(());
        });
        let update = |recovery: &mut Recovery, picture: Option<&KeptPicture>, is_rendering, now| {
            recovery.update(WindowContent { document: &document, picture, is_rendering }, now, &wake)
        };
        // Waits for the end of a write, which wakes the window after its result
        let has_picture_after_write = |recovery: &mut Recovery| {
            loop {
                done.recv_timeout(Duration::from_secs(60)).unwrap();
                assert_eq!(recovery.failure(), None);
                if !recovery.worker.is_busy() {
                    break;
                }
            }
            let window = std::fs::read_dir(folder.path()).unwrap().next().unwrap().unwrap();
            window.path().join("picture.ron").exists()
        };
        let films = [picture(), picture(), picture()];
        assert_eq!(update(&mut recovery, Some(&films[0]), true, 0.0), Some(RUNNING_DELAY_S));
        assert_eq!(update(&mut recovery, Some(&films[1]), true, 59.0), Some(1.0), "a newer film puts nothing off");
        assert_eq!(update(&mut recovery, Some(&films[1]), true, 60.0), None);
        assert!(has_picture_after_write(&mut recovery));
        assert_eq!(update(&mut recovery, Some(&films[1]), true, 61.0), None, "it is kept");
        assert_eq!(update(&mut recovery, Some(&films[2]), true, 61.0), Some(RUNNING_DELAY_S));
        assert_eq!(update(&mut recovery, Some(&films[2]), false, 62.0), Some(DELAY_S), "the render has ended");
        assert_eq!(update(&mut recovery, Some(&films[2]), false, 64.0), None);
        assert!(has_picture_after_write(&mut recovery));
        assert_eq!(update(&mut recovery, None, false, 65.0), None, "it is exported");
        assert!(!has_picture_after_write(&mut recovery));
    }
}
