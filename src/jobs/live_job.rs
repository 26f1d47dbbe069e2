//! The live traced view's thread: traces what it was asked for last, and hands pictures over while they grow.

use super::{LiveImage, LivePace, Wake, lock, sentence};
use crate::raytrace::{GeometryCache, LiveCamera, RenderControl};
use crate::scene::{Assets, Scene};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// How long after the last press of mouse or key the user counts as being at work.
const AT_WORK: Duration = Duration::from_millis(1200);

/// What is to be shown.
#[derive(Clone, Debug)]
pub struct LiveRequest {
    /// The studio.
    pub scene: Arc<Scene>,
    /// Its meshes and textures.
    pub assets: Assets,
    /// From where, at which size.
    pub camera: LiveCamera,
    /// Whether grain is smoothed until the picture is done.
    pub smooth: bool,
}

#[derive(Debug, Default)]
struct State {
    wanted: Option<LiveRequest>,
    result: Option<Result<LiveImage, String>>,
    /// Lets the slice of work that is under way be given up.
    control: Arc<RenderControl>,
    /// The picture of the last request has been handed over once, so that it may be given up.
    has_shown: bool,
    is_idle: bool,
    paused: bool,
    closed: bool,
    last_input: Option<Instant>,
    /// Rays traced so far.
    rays: u64,
}

/// The thread, started when it is first asked for something.
#[derive(Debug, Default)]
pub struct LiveJob {
    shared: Arc<(Mutex<State>, Condvar)>,
    cache: Arc<GeometryCache>,
    running: bool,
}

impl LiveJob {
    /// A job that shares meshes' trees with the renders.
    pub fn new(cache: Arc<GeometryCache>) -> Self {
        LiveJob { shared: Arc::default(), cache, running: false }
    }

    /// Asks for a picture; what was asked before is shown once and then given up.
    pub fn request(&mut self, request: LiveRequest, wake: &Wake) {
        if !self.running {
            self.running = true;
            let (shared, cache, wake) = (self.shared.clone(), self.cache.clone(), wake.clone());
            std::thread::spawn(move || live_loop(&shared, cache, &wake));
        }
        let mut state = lock(&self.shared.0);
        state.wanted = Some(request);
        state.is_idle = false;
        if state.has_shown {
            state.control.cancel();
        }
        self.shared.1.notify_one();
    }

    /// Stops tracing until it is switched on again; what is there is kept.
    pub fn pause(&self, paused: bool) {
        let mut state = lock(&self.shared.0);
        if state.paused != paused {
            state.paused = paused;
            if paused {
                state.control.cancel();
            }
            self.shared.1.notify_one();
        }
    }

    /// The user moves the mouse or types: a core is left alone for a while.
    pub fn note_input(&self) {
        lock(&self.shared.0).last_input = Some(Instant::now());
    }

    /// The newest picture, once, or why there is none.
    pub fn take(&self) -> Option<Result<LiveImage, String>> {
        lock(&self.shared.0).result.take()
    }

    /// Whether all that was asked for has been traced and handed over.
    pub fn is_idle(&self) -> bool {
        let state = lock(&self.shared.0);
        (state.is_idle || !self.running) && state.wanted.is_none() && state.result.is_none()
    }

    /// Rays traced so far.
    pub fn rays(&self) -> u64 {
        lock(&self.shared.0).rays
    }
}

impl Drop for LiveJob {
    fn drop(&mut self) {
        let mut state = lock(&self.shared.0);
        state.closed = true;
        state.control.cancel();
        self.shared.1.notify_one();
    }
}

fn live_loop(shared: &(Mutex<State>, Condvar), cache: Arc<GeometryCache>, wake: &Wake) {
    let work = || match LivePace::new(cache) {
        Ok(pace) => trace(shared, pace, wake),
        Err(error) => show(shared, Err(format!("No threads to trace with: {error}.")), wake),
    };
    // The tracer does not panic; if it did, the user would get a message and keep the window.
    if std::panic::catch_unwind(std::panic::AssertUnwindSafe(work)).is_err() {
        show(shared, Err("The live view stopped with an internal error.".to_owned()), wake);
    }
}

/// What the thread does next.
enum Next {
    Take(Box<LiveRequest>),
    Work { user_is_active: bool, control: Arc<RenderControl> },
}

fn trace(shared: &(Mutex<State>, Condvar), mut pace: LivePace, wake: &Wake) {
    while let Some(next) = next(shared, &pace) {
        match next {
            Next::Take(request) => {
                pace.set_smooth(request.smooth);
                if let Err(error) = pace.update(request.scene, &request.assets, request.camera) {
                    show(shared, Err(sentence(&error)), wake);
                }
            }
            Next::Work { user_is_active, control } => {
                let before = control.rays();
                pace.slice(user_is_active, &control);
                lock(&shared.0).rays += control.rays() - before;
                if let Some(image) = pace.look() {
                    show(shared, Ok(image), wake);
                }
            }
        }
    }
}

/// Waits until there is something to do; none when the window has closed.
fn next(shared: &(Mutex<State>, Condvar), pace: &LivePace) -> Option<Next> {
    let mut state = lock(&shared.0);
    loop {
        if state.closed {
            return None;
        }
        let idle = pace.is_idle();
        // What was asked for is shown once before it is given up, or a moving view would never be seen.
        if !state.paused && (idle || state.has_shown) && state.wanted.is_some() {
            (state.control, state.has_shown) = (Arc::default(), false);
            return state.wanted.take().map(|request| Next::Take(Box::new(request)));
        }
        if !state.paused && !idle {
            if state.control.is_cancelled() {
                state.control = Arc::default();
            }
            let user_is_active = state.last_input.is_some_and(|last| last.elapsed() < AT_WORK);
            return Some(Next::Work { user_is_active, control: state.control.clone() });
        }
        state.is_idle = idle && state.wanted.is_none();
        state = shared.1.wait(state).unwrap_or_else(PoisonError::into_inner);
    }
}

fn show(shared: &(Mutex<State>, Condvar), result: Result<LiveImage, String>, wake: &Wake) {
    let mut state = lock(&shared.0);
    state.result = Some(result);
    state.has_shown = true;
    drop(state);
    wake();
}
