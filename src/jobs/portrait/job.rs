//! The pattern check of the selected figure, in the background.

use super::check::{Face, check_patterns};
use crate::jobs::threads::{Priority, background_pool};
use crate::jobs::worker::{Inbox, Interrupt, Wake, Worker, WorkerSettings};
use crate::raytrace::GeometryCache;
use crate::scene::{Assets, ObjectId, Scene, Shape};

#[derive(Debug)]
struct Request {
    scene: Scene,
    assets: Assets,
    figure: ObjectId,
}

/// The light on the selected figure's face and in its eyes.
#[derive(Debug)]
pub struct PatternJob {
    worker: Worker<Request, Face>,
    /// Figure and revision of the document that were requested last.
    requested: Option<(ObjectId, u64)>,
    latest: Option<Result<Face, String>>,
}

/// Each check is finished: the line follows the mouse in a drag.
const WORKER: WorkerSettings = WorkerSettings {
    name: "pattern",
    priority: Priority::Background,
    interrupt: Interrupt::AfterResult,
    panic_message: "The pattern check failed. This is an error in Catchlight.",
};

impl Default for PatternJob {
    fn default() -> Self {
        PatternJob { worker: Worker::new(WORKER, serve), requested: None, latest: None }
    }
}

impl PatternJob {
    /// Requests a check when the studio or the selected figure has changed, and takes in the newest result. To be
    /// called once a frame.
    pub fn update(&mut self, scene: &Scene, assets: &Assets, figure: Option<ObjectId>, revision: u64, wake: &Wake) {
        let is_figure =
            |id: &ObjectId| scene.object(*id).is_some_and(|o| o.visible && matches!(o.shape, Shape::Figure(_)));
        let Some(figure) = figure.filter(is_figure) else {
            if self.requested.is_some() {
                (self.requested, self.latest) = (None, None);
                self.worker.reset();
            }
            return;
        };
        if let Some(result) = self.worker.take() {
            self.latest = Some(result);
        }
        if self.requested != Some((figure, revision)) {
            self.requested = Some((figure, revision));
            self.worker.request(Request { scene: scene.clone(), assets: assets.clone(), figure }, wake);
        }
    }

    /// Returns the latest light on a figure's face, or the message of an error; none until the first one is there.
    pub fn face(&self, figure: ObjectId) -> Option<Result<&Face, &str>> {
        match self.latest.as_ref()? {
            Ok(face) => (face.object == figure).then_some(Ok(face)),
            Err(message) => Some(Err(message)),
        }
    }
}

/// The body of the thread. One thread of low priority: the live view needs the others.
fn serve(inbox: &Inbox<Request, Face>) {
    let pool = match background_pool(1, "pattern") {
        Ok(pool) => pool,
        Err(error) => return inbox.fail_all(&format!("No threads to check the pattern with: {error}.")),
    };
    // Not shared with renders: figures are checked without the hair on the face
    let cache = GeometryCache::default();
    while let Some((Request { scene, assets, figure }, control)) = inbox.next() {
        match pool.install(|| check_patterns(&scene, &assets, &[figure], &cache, &control)) {
            Ok(faces) => faces.into_iter().flatten().for_each(|face| inbox.publish(face)),
            Err(error) => inbox.fail(error.to_string()),
        }
    }
}
