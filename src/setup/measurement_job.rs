//! Measurements of a set-up in the background.

use crate::jobs::worker::{Inbox, Interrupt, Worker, WorkerSettings};
use crate::jobs::{Priority, Wake, background_pool};
use crate::raytrace::{GeometryCache, PrepareError, RenderControl};
use crate::scene::{Assets, Scene};
use std::sync::Arc;

/// A measurement of a studio. None once it is cancelled.
pub type Measure<R> = fn(&Scene, &Assets, &GeometryCache, &RenderControl) -> Result<Option<R>, PrepareError>;

#[derive(Debug)]
struct Request {
    scene: Scene,
    assets: Assets,
    revision: u64,
}

/// The latest measurement of the studio.
#[derive(Debug)]
pub struct MeasurementJob<R> {
    worker: Worker<Request, (u64, R)>,
    /// Revision of the document that was requested last.
    requested: Option<u64>,
    /// The latest result, with the revision that it is of.
    latest: Option<Result<(u64, R), String>>,
}

const WORKER: WorkerSettings = WorkerSettings {
    name: "measure",
    priority: Priority::Background,
    interrupt: Interrupt::Always,
    panic_message: "The lights can't be metered. This is an error in Catchlight.",
};

impl<R: Send + 'static> MeasurementJob<R> {
    /// Returns a job that shares BVHs of meshes with renders and live view.
    pub fn new(measure: Measure<R>, cache: Arc<GeometryCache>) -> Self {
        let work = move |inbox: &Inbox<Request, (u64, R)>| serve(inbox, measure, &cache);
        MeasurementJob { worker: Worker::new(WORKER, work), requested: None, latest: None }
    }

    /// Measures the studio anew when it has changed, and takes in the newest result. To be called once a frame.
    pub fn update(&mut self, scene: &Scene, assets: &Assets, revision: u64, wake: &Wake) {
        if let Some(result) = self.worker.take() {
            self.latest = Some(result);
        }
        if self.requested != Some(revision) {
            self.requested = Some(revision);
            self.worker.request(Request { scene: scene.clone(), assets: assets.clone(), revision }, wake);
        }
    }

    /// Ends the measurement and forgets its result.
    pub fn reset(&mut self) {
        if self.requested.is_some() {
            (self.requested, self.latest) = (None, None);
            self.worker.reset();
        }
    }

    /// Returns the latest result, or the message of an error; none until the first one is there.
    pub fn latest(&self) -> Option<Result<&R, &str>> {
        Some(self.latest.as_ref()?.as_ref().map(|(_, result)| result).map_err(String::as_str))
    }

    /// Returns true if the latest result is that of the studio as it was last seen.
    pub fn is_current(&self) -> bool {
        self.latest.as_ref().is_some_and(|latest| latest.as_ref().is_ok_and(|(of, _)| Some(*of) == self.requested))
    }

    /// Returns true while a measurement is running.
    pub fn is_busy(&self) -> bool {
        self.worker.is_busy()
    }
}

/// The body of the thread.
fn serve<R: Send + 'static>(inbox: &Inbox<Request, (u64, R)>, measure: Measure<R>, cache: &GeometryCache) {
    let pool = match background_pool(0, "measure") {
        Ok(pool) => pool,
        Err(error) => return inbox.fail_all(&format!("No threads to meter the lights with: {error}.")),
    };
    while let Some((Request { scene, assets, revision }, control)) = inbox.next() {
        match pool.install(|| measure(&scene, &assets, cache, &control)) {
            Ok(Some(result)) => inbox.publish_unless_cancelled(&control, (revision, result)),
            Ok(None) => {}
            Err(error) => inbox.fail(error.to_string()),
        }
    }
}
