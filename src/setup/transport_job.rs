//! The measurement of a set-up in the background.

use super::transport::SetupTransport;
use crate::jobs::worker::{Inbox, Interrupt, Worker, WorkerSettings};
use crate::jobs::{Priority, Wake, background_pool};
use crate::raytrace::GeometryCache;
use crate::scene::{Assets, Scene};
use std::sync::Arc;

#[derive(Debug)]
struct Request {
    scene: Scene,
    assets: Assets,
}

/// The exposures of all lights of the studio, measured while somebody wants them.
#[derive(Debug)]
pub struct TransportJob {
    worker: Worker<Request, SetupTransport>,
    /// Revision of the document that was requested last.
    requested: Option<u64>,
    latest: Option<Result<SetupTransport, String>>,
}

const WORKER: WorkerSettings = WorkerSettings {
    name: "dials",
    priority: Priority::Background,
    interrupt: Interrupt::Always,
    panic_message: "The lights can't be metered. This is an error in Catchlight.",
};

impl TransportJob {
    /// Returns a job that shares BVHs of meshes with renders and live view.
    pub fn new(cache: Arc<GeometryCache>) -> Self {
        let work = move |inbox: &Inbox<Request, SetupTransport>| serve(inbox, &cache);
        TransportJob { worker: Worker::new(WORKER, work), requested: None, latest: None }
    }

    /// Measures the studio anew when it has changed, and takes in the newest result. To be called once a frame.
    pub fn update(&mut self, scene: &Scene, assets: &Assets, revision: u64, wake: &Wake) {
        if let Some(result) = self.worker.take() {
            self.latest = Some(result);
        }
        if self.requested != Some(revision) {
            self.requested = Some(revision);
            self.worker.request(Request { scene: scene.clone(), assets: assets.clone() }, wake);
        }
    }

    /// Ends the measurement and forgets its result.
    pub fn reset(&mut self) {
        if self.requested.is_some() {
            (self.requested, self.latest) = (None, None);
            self.worker.reset();
        }
    }

    /// Returns the latest exposures, or the message of an error; none until the first ones are there.
    pub fn latest(&self) -> Option<Result<&SetupTransport, &str>> {
        Some(self.latest.as_ref()?.as_ref().map_err(String::as_str))
    }

    /// Returns true while the latest exposures are not those of the studio.
    pub fn is_busy(&self) -> bool {
        self.worker.is_busy()
    }
}

/// The body of the thread.
fn serve(inbox: &Inbox<Request, SetupTransport>, cache: &GeometryCache) {
    let pool = match background_pool(0, "dials") {
        Ok(pool) => pool,
        Err(error) => return inbox.fail_all(&format!("No threads to meter the lights with: {error}.")),
    };
    while let Some((Request { scene, assets }, control)) = inbox.next() {
        match pool.install(|| SetupTransport::measure(&scene, &assets, cache, &control)) {
            Ok(Some(transport)) => inbox.publish(transport),
            Ok(None) => {}
            Err(error) => inbox.fail(error.to_string()),
        }
    }
}
