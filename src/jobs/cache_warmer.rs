//! The acceleration structures of the next render, built while the studio does not change: the render starts at once.

use super::clock::Clock;
use super::quiet_time::{Due, QuietTime};
use super::threads::{Priority, background_pool};
use super::worker::{Inbox, Interrupt, Wake, Worker, WorkerSettings};
use crate::raytrace::{self, GeometryCache, Purpose};
use crate::scene::{Assets, Scene};
use std::sync::Arc;
use std::time::Duration;

/// Time without a change of the surfaces after which the build starts.
const DELAY: Duration = Duration::from_millis(400);

/// What the acceleration structures of a render depend on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WarmSubject {
    /// Revision of the document's surfaces.
    pub surfaces: u64,
    /// Pixels across and down of the picture.
    pub picture: (u32, u32),
}

#[derive(Debug)]
struct Request {
    scene: Scene,
    assets: Assets,
    picture: (u32, u32),
}

/// Fills the geometry cache for the next render of the open studio.
#[derive(Debug)]
pub struct CacheWarmer {
    worker: Worker<Request, ()>,
    quiet: QuietTime<WarmSubject>,
}

const WORKER: WorkerSettings = WorkerSettings {
    name: "warm",
    priority: Priority::Background,
    interrupt: Interrupt::Always,
    panic_message: "Building ahead of a render stopped with an internal error.",
};

impl CacheWarmer {
    /// Returns a warmer of the cache that renders use.
    pub fn new(cache: Arc<GeometryCache>, clock: Clock) -> Self {
        let worker = Worker::new(WORKER, move |inbox: &Inbox<Request, ()>| serve(inbox, &cache));
        CacheWarmer { worker, quiet: QuietTime::new(DELAY, clock) }
    }

    /// Builds when nothing has changed for a while, but not beside a render. To be called each frame. Returns the time
    /// after which it is to be called again, if there is one.
    pub fn update(
        &mut self,
        subject: WarmSubject,
        scene: &Scene,
        assets: &Assets,
        is_rendering: bool,
        wake: &Wake,
    ) -> Option<Duration> {
        self.quiet.follow(subject);
        match self.quiet.due(!is_rendering) {
            Due::Now => {
                let request = Request { scene: scene.clone(), assets: assets.clone(), picture: subject.picture };
                self.worker.request(request, wake);
                None
            }
            Due::After(wait) => Some(wait),
            Due::No => None,
        }
    }

    /// Returns true while it builds or is about to.
    pub fn is_busy(&self) -> bool {
        self.quiet.is_waiting() || self.worker.is_busy()
    }
}

/// The body of the thread.
fn serve(inbox: &Inbox<Request, ()>, cache: &GeometryCache) {
    while let Some((Request { scene, assets, picture }, _)) = inbox.next() {
        // Without threads, or of a studio with errors, nothing is built: the render says so
        let Ok(pool) = background_pool(0, "warm") else { continue };
        let purpose = Purpose { picture: Some(picture), shares_layers: false };
        let prepared = pool.install(|| raytrace::prepare_for(&scene, &assets, purpose, cache));
        drop(prepared);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Object, ObjectId, Shape};
    use std::sync::mpsc::channel;

    #[test]
    fn what_a_render_needs_is_built_when_the_surfaces_have_not_changed_for_a_while_and_nothing_renders() {
        let (clock, advance) = Clock::by_hand();
        let (sender, woken) = channel();
        let wake: Wake = Arc::new(move || sender.send(()).unwrap_or_default());
        let cache: Arc<GeometryCache> = Arc::default();
        let mut warmer = CacheWarmer::new(cache.clone(), clock);
        let ball = Object { id: ObjectId(1), ..Object::new("Ball".to_owned(), Shape::Sphere { radius_m: 0.3 }) };
        let (scene, assets) = (Scene { objects: vec![ball], ..Scene::default() }, Assets::default());
        let mut update = |surfaces, is_rendering| {
            let wait =
                warmer.update(WarmSubject { surfaces, picture: (72, 108) }, &scene, &assets, is_rendering, &wake);
            (wait, warmer.is_busy())
        };
        assert_eq!(update(1, false), (Some(DELAY), true));
        advance(DELAY / 4);
        assert_eq!(update(1, false), (Some(DELAY - DELAY / 4), true));
        assert_eq!(update(2, false), (Some(DELAY), true), "a change starts the delay anew");
        advance(DELAY);
        assert_eq!(update(2, true), (None, true), "a render has the CPU for itself");
        assert_eq!(cache.builds(), 0);
        while update(2, false).1 {
            woken.recv().unwrap();
        }
        let builds = cache.builds();
        assert!(builds > 0);
        let purpose = Purpose { picture: Some((72, 108)), shares_layers: false };
        raytrace::prepare_for(&scene, &assets, purpose, &cache).unwrap();
        assert_eq!(cache.builds(), builds, "a render builds nothing more");
    }
}
