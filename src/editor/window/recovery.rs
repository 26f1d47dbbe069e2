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

/// What becomes of the picture on the disk.
#[derive(Debug)]
enum PictureChange {
    Stays,
    Goes,
    Is(KeptPicture),
}

/// The content of the window's folder.
#[derive(Debug, Default)]
struct Kept {
    /// Revision of the document, whether it has unsaved changes, and its file.
    studio: (u64, bool, Option<PathBuf>),
    /// The film of the picture.
    film: Option<Weak<Film>>,
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
    kept: Option<Kept>,
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
    pub fn update(
        &mut self,
        document: &Document,
        picture: Option<&KeptPicture>,
        is_rendering: bool,
        now: f64,
        wake: &Wake,
    ) -> Option<f64> {
        self.parent.as_ref()?;
        // A saved studio is kept with its picture only
        let has_film = self.kept.as_ref().is_some_and(|kept| kept.film.is_some());
        if !document.is_dirty() && (picture.is_none() || !has_film) {
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
        // Find what has changed, and when it is written
        let studio = (document.revision(), document.is_dirty(), document.path().map(Path::to_owned));
        let film = picture.map(|picture| Arc::downgrade(&picture.film));
        let kept_film = self.kept.as_ref().and_then(|kept| kept.film.as_ref());
        let same_film = match (&film, kept_film) {
            (Some(film), Some(kept)) => Weak::ptr_eq(film, kept),
            (None, None) => true,
            _ => false,
        };
        let same_studio = self.kept.as_ref().is_some_and(|kept| kept.studio == studio);
        if !same_studio && (document.is_dirty() || has_film) {
            self.studio_due.get_or_insert(now + DELAY_S);
        }
        if !same_film {
            let due = now + if is_rendering { RUNNING_DELAY_S } else { DELAY_S };
            self.picture_due = Some(self.picture_due.map_or(due, |earlier| earlier.min(due)));
        }
        let due = self.studio_due.into_iter().chain(self.picture_due).reduce(f64::min)?;
        if now < due {
            return Some(due - now);
        }
        // Write the studio, and the picture if it is due
        let is_picture_due = self.picture_due.is_some_and(|due| due <= now);
        let (change, film) = match picture {
            Some(picture) if is_picture_due => (PictureChange::Is(picture.clone()), film),
            None => (PictureChange::Goes, None),
            Some(_) => (PictureChange::Stays, kept_film.cloned()),
        };
        let info = RecoveryInfo {
            title: document.title(),
            path: document.path().map(absolute),
            stamp: document.stamp().cloned(),
            imported: document.imported_files().iter().map(|(name, file)| (name.clone(), absolute(file))).collect(),
            changed_at: SystemTime::now(),
            is_saved: !document.is_dirty(),
            has_picture: false,
        };
        self.worker.request(Request::Keep(Box::new((document.scene().clone(), info)), change), wake);
        self.studio_due = None;
        if is_picture_due || picture.is_none() {
            self.picture_due = None;
        }
        self.kept = Some(Kept { studio, film });
        self.picture_due.map(|due| (due - now).max(RETRY_S))
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
        let studio = (document.revision(), document.is_dirty(), document.path().map(Path::to_owned));
        self.kept = Some(Kept { studio, film: picture.map(|picture| Arc::downgrade(&picture.film)) });
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
                PictureChange::Is(picture) => folder.write_picture(picture).map_err(|error| error.to_string())?,
                PictureChange::Goes => folder.remove_picture(),
                PictureChange::Stays => {}
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
    use crate::scene::Assets;

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
        assert_eq!(recovery.update(&document, None, false, 10.0, &wake), Some(DELAY_S));
        assert_eq!(recovery.update(&document, None, false, 10.0 + DELAY_S, &wake), None);
        written.recv().unwrap();
        assert_eq!(recovery.failure(), None);
        drop(recovery);
        let [(window, info)] = &RecoveryFolder::abandoned(folder.path())[..] else { panic!("it is not kept") };
        let here = std::env::current_dir().unwrap();
        assert_eq!((&info.path, &info.imported["models/cup.obj"]), (&Some(here.join("a.ron")), &here.join("cup.obj")));
        assert_eq!(window.read().unwrap().name, "Changed");
    }
}
