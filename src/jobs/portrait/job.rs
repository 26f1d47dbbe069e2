//! The pattern check of the selected figure, in the background.

use super::check::check_patterns;
use super::face_lighting::FaceLighting;
use crate::jobs::threads::{Priority, background_pool};
use crate::jobs::worker::{Inbox, Interrupt, Wake, Worker, WorkerSettings};
use crate::scene::{Assets, ObjectId, Scene, Shape};

#[derive(Debug)]
struct Request {
    scene: Scene,
    assets: Assets,
    figure: ObjectId,
}

/// The lighting of the selected figure's face.
#[derive(Debug)]
pub struct PatternJob {
    worker: Worker<Request, (ObjectId, FaceLighting)>,
    /// Figure and revision of the document that were requested last.
    requested: Option<(ObjectId, u64)>,
    latest: Option<Result<(ObjectId, FaceLighting), String>>,
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

    /// Returns the latest lighting of a figure's face, or the message of an error; none until the first one is there.
    pub fn lighting(&self, figure: ObjectId) -> Option<Result<&FaceLighting, &str>> {
        match self.latest.as_ref()? {
            Ok((object, lighting)) => (*object == figure).then_some(Ok(lighting)),
            Err(message) => Some(Err(message)),
        }
    }
}

/// The body of the thread. One thread of low priority: the live view needs the others.
fn serve(inbox: &Inbox<Request, (ObjectId, FaceLighting)>) {
    let pool = match background_pool(1, "pattern") {
        Ok(pool) => pool,
        Err(error) => return inbox.fail_all(&format!("No threads to check the pattern with: {error}.")),
    };
    while let Some((Request { scene, assets, figure }, control)) = inbox.next() {
        match pool.install(|| check_patterns(&scene, &assets, &[figure], &control)) {
            Ok(faces) => faces.into_iter().flatten().for_each(|face| inbox.publish((face.object, face.lighting))),
            Err(error) => inbox.fail(error.to_string()),
        }
    }
}
