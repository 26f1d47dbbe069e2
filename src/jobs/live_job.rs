//! The live traced view in the background: traces the newest request and publishes pictures while they grow.

use super::clock::Clock;
use super::live_pacing::{LiveImage, LivePacing};
use super::sentence::sentence;
use super::threads::{Priority, locked};
use super::worker::{Inbox, Interrupt, Pending, Wake, Worker, WorkerSettings};
use crate::raytrace::{GeometryCache, LiveCamera, RenderControl};
use crate::scene::{Assets, Scene};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Time after the last mouse or key event during which the user counts as active.
const ACTIVE_TIME: Duration = Duration::from_millis(1200);

/// A view to be traced.
#[derive(Clone, Debug)]
pub struct LiveRequest {
    /// The studio.
    pub scene: Arc<Scene>,
    /// Its meshes and textures.
    pub assets: Assets,
    /// Position, lens and size of the view.
    pub camera: LiveCamera,
    /// Noise is smoothed until the picture is done.
    pub smooth: bool,
}

/// The live traced view's worker.
#[derive(Debug)]
pub struct LiveJob {
    worker: Worker<LiveRequest, LiveImage>,
    shared: Arc<LiveShared>,
}

/// Values that both threads use.
#[derive(Debug, Default)]
struct LiveShared {
    clock: Clock,
    last_input: Mutex<Option<Instant>>,
    rays: AtomicU64,
}

/// A picture is shown once before the next request replaces it: a moving view would never be seen otherwise.
const WORKER: WorkerSettings = WorkerSettings {
    name: "live view",
    priority: Priority::Background,
    interrupt: Interrupt::AfterResult,
    panic_message: "The live view stopped with an internal error.",
};

impl Default for LiveJob {
    fn default() -> Self {
        LiveJob::new(Arc::default())
    }
}

impl LiveJob {
    /// Returns a job that shares BVHs of meshes with other renders.
    pub fn new(cache: Arc<GeometryCache>) -> Self {
        let shared: Arc<LiveShared> = Arc::default();
        let work = {
            let shared = shared.clone();
            move |inbox: &Inbox<LiveRequest, LiveImage>| serve(inbox, &shared, cache.clone())
        };
        LiveJob { worker: Worker::new(WORKER, work), shared }
    }

    /// Requests a view. The previous one is abandoned once a picture of it was shown.
    pub fn request(&mut self, request: LiveRequest, wake: &Wake) {
        self.worker.request(request, wake);
    }

    /// Abandons the request, and the picture that has not been taken.
    pub fn forget(&self) {
        self.worker.reset();
    }

    /// Pauses or resumes tracing. The picture is kept.
    pub fn pause(&self, paused: bool) {
        self.worker.pause(paused);
    }

    /// Notes a mouse or key event: one core stays free for a while.
    pub fn note_input(&self) {
        *locked(&self.shared.last_input) = Some(self.shared.clock.now());
    }

    /// Takes the newest picture, or the message of an error.
    pub fn take(&self) -> Option<Result<LiveImage, String>> {
        self.worker.take()
    }

    /// Returns true if the request has been traced to its end and its picture taken.
    pub fn is_idle(&self) -> bool {
        !self.worker.is_busy()
    }

    /// Returns true if the job is paused and traces no more.
    pub fn is_stopped(&self) -> bool {
        self.worker.is_stopped()
    }

    /// Returns the number of rays traced so far.
    pub fn rays(&self) -> u64 {
        self.shared.rays.load(Ordering::Relaxed)
    }
}

/// The next step of the live view's thread.
enum LiveStep {
    Update(Box<LiveRequest>),
    Trace(Arc<RenderControl>),
}

/// The body of the live view's thread.
fn serve(inbox: &Inbox<LiveRequest, LiveImage>, shared: &LiveShared, cache: Arc<GeometryCache>) {
    let mut pacing = match LivePacing::new(cache, shared.clock.clone()) {
        Ok(pacing) => pacing,
        Err(error) => return inbox.fail_all(&format!("No threads to trace with: {error}.")),
    };
    while let Some(step) = inbox.next_step(|pending| next_step(pending, pacing.is_idle())) {
        match step {
            LiveStep::Update(request) => {
                pacing.set_smooth(request.smooth);
                if let Err(error) = pacing.update(request.scene, &request.assets, request.camera) {
                    inbox.fail(sentence(&error));
                }
            }
            LiveStep::Trace(control) => {
                let last_input = *locked(&shared.last_input);
                let user_is_active = last_input.is_some_and(|last| shared.clock.now() - last < ACTIVE_TIME);
                let rays = control.rays();
                let image = pacing.step(user_is_active, &control);
                shared.rays.fetch_add(control.rays() - rays, Ordering::Relaxed);
                if let Some(image) = image {
                    inbox.publish(image);
                }
            }
        }
    }
}

/// Chooses the next step; none while there is nothing to do, or while the view is paused.
fn next_step(pending: &mut Pending<'_, LiveRequest, LiveImage>, is_idle: bool) -> Option<LiveStep> {
    if pending.is_paused() || (is_idle && !pending.has_request()) {
        if !is_idle {
            pending.stay_busy();
        }
        return None;
    }
    if (is_idle || pending.has_result())
        && let Some((request, _)) = pending.take_request()
    {
        return Some(LiveStep::Update(Box::new(request)));
    }
    Some(LiveStep::Trace(pending.control()))
}
