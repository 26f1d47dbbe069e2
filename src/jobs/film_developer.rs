//! Development of films in the background, with the lights as they are now.

use super::threads::Priority;
use super::worker::{Inbox, Interrupt, Wake, Worker, WorkerSettings};
use crate::photo::Picture;
use crate::raytrace::Film;
use crate::scene::Scene;
use std::sync::Arc;

/// A developed film.
#[derive(Debug)]
pub struct Developed<I> {
    /// Scene-linear, for export.
    pub picture: Arc<Picture>,
    /// For the screen.
    pub image: I,
    /// Samples per pixel.
    pub spp: u32,
    /// Name of the method, for the picture's file.
    pub method: &'static str,
}

/// A film to be developed.
#[derive(Debug)]
struct Request {
    film: Arc<Film>,
    scene: Scene,
    /// Longest side of the image for the screen, pixels.
    max_side: usize,
}

/// A worker that develops films. Only the newest request counts.
#[derive(Debug)]
pub struct FilmDeveloper<I> {
    worker: Worker<Request, Developed<I>>,
}

/// A relit picture follows a slider: its thread has the priority of the window's.
const WORKER: WorkerSettings = WorkerSettings {
    name: "develop",
    priority: Priority::Normal,
    interrupt: Interrupt::AfterResult,
    panic_message: "The picture could not be developed, because of an internal error.",
};

impl<I: Send + 'static> FilmDeveloper<I> {
    /// Returns a developer. `to_image` makes a picture's image for the screen, with a longest side in pixels.
    pub fn new(to_image: fn(&Picture, usize) -> I) -> Self {
        let work = move |inbox: &Inbox<Request, Developed<I>>| {
            while let Some((Request { film, scene, max_side }, _)) = inbox.next() {
                let picture = film.develop(&scene);
                let image = to_image(&picture, max_side);
                let (spp, method) = (film.spp(), film.method());
                inbox.publish(Developed { picture: Arc::new(picture), image, spp, method });
            }
        };
        FilmDeveloper { worker: Worker::new(WORKER, work) }
    }

    /// Requests a picture with the lights of `scene`, and an image with sides of at most `max_side` pixels.
    pub fn request(&mut self, film: Arc<Film>, scene: Scene, max_side: usize, wake: &Wake) {
        self.worker.request(Request { film, scene, max_side }, wake);
    }

    /// Takes the newest picture, or the message of an error.
    pub fn take(&self) -> Option<Result<Developed<I>, String>> {
        self.worker.take()
    }

    /// Returns true while there is a picture to be developed or to be taken.
    pub fn is_busy(&self) -> bool {
        self.worker.is_busy()
    }
}
