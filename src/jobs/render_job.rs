//! Rendering in the background, on an immutable copy of the studio, and developing the film in a thread of its own.

use super::threads::background_pool;
use super::{Wake, lock, sentence};
use crate::io;
use crate::photo::Picture;
use crate::raytrace::{self, Film, GeometryCache, RenderControl, Settings};
use crate::scene::{Assets, Scene};
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// How far a render is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Building trees and tables.
    Preparing,
    /// Taking samples.
    Tracing,
    /// All samples are taken.
    Done,
    /// Stopped by the user; what was complete is kept.
    Cancelled,
    /// It could not be done.
    Failed(String),
}

impl Phase {
    /// Whether the job still works.
    pub fn is_running(&self) -> bool {
        matches!(self, Phase::Preparing | Phase::Tracing)
    }
}

/// Numbers for the progress bar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Part of the work that is done, 0 to 1.
    pub fraction: f32,
    /// Samples a pixel so far.
    pub samples: f32,
    /// Rays a second, millions.
    pub mrays_s: f32,
    /// Since the start.
    pub elapsed: Duration,
    /// Estimate of what is left; none before there is enough to judge by.
    pub left: Option<Duration>,
}

/// What a render that ran to its end took and left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// Files, trees and tables, seconds.
    pub build_s: f64,
    /// Sampling, seconds.
    pub trace_s: f64,
    /// Samples a pixel.
    pub spp: u32,
    /// Estimated noise of the picture, stops.
    pub noise_stops: f32,
}

#[derive(Debug)]
struct Shared {
    phase: Mutex<Phase>,
    film: Mutex<Option<Arc<Film>>>,
    tracing_since: Mutex<Option<Instant>>,
    ended: Mutex<Option<Instant>>,
    outcome: Mutex<Option<Outcome>>,
}

/// One render. Dropping it cancels it.
#[derive(Debug)]
pub struct RenderJob {
    control: Arc<RenderControl>,
    shared: Arc<Shared>,
    /// The studio as it is being rendered.
    pub scene: Arc<Scene>,
    /// What was asked for.
    pub settings: Settings,
    started: Instant,
}

/// Snapshots come at most this often: each is a copy of the film.
const SNAPSHOT_EVERY: Duration = Duration::from_millis(150);

impl RenderJob {
    /// Starts to render a copy of the studio. Assets that are still on their way are loaded first; meshes whose trees are
    /// there cost nothing.
    pub fn start(
        trees: Arc<GeometryCache>,
        scene: Scene,
        assets: Assets,
        folder: Option<PathBuf>,
        settings: Settings,
        wake: Wake,
    ) -> Self {
        let control = Arc::new(RenderControl::new());
        let shared = Arc::new(Shared {
            phase: Mutex::new(Phase::Preparing),
            film: Mutex::new(None),
            tracing_since: Mutex::new(None),
            ended: Mutex::new(None),
            outcome: Mutex::new(None),
        });
        let job = RenderJob {
            control: control.clone(),
            shared: shared.clone(),
            scene: Arc::new(scene),
            settings: settings.clone(),
            started: Instant::now(),
        };
        let scene = job.scene.clone();
        std::thread::spawn(move || {
            let work = || trace(&trees, &scene, assets, folder, &settings, &control, &shared, &wake);
            // The tracer does not panic; if it did, the user would get a message and keep the window.
            let end = std::panic::catch_unwind(std::panic::AssertUnwindSafe(work))
                .unwrap_or_else(|_| Phase::Failed("The renderer stopped with an internal error.".to_owned()));
            *lock(&shared.ended) = Some(Instant::now());
            *lock(&shared.phase) = end;
            wake();
        });
        job
    }

    /// Asks it to stop.
    pub fn cancel(&self) {
        self.control.cancel();
    }

    /// How far it is.
    pub fn phase(&self) -> Phase {
        lock(&self.shared.phase).clone()
    }

    /// The latest snapshot.
    pub fn film(&self) -> Option<Arc<Film>> {
        lock(&self.shared.film).clone()
    }

    /// What it took and left, once, when it has ran to its end.
    pub fn take_outcome(&self) -> Option<Outcome> {
        lock(&self.shared.outcome).take()
    }

    /// Numbers for the progress bar.
    pub fn progress(&self) -> Progress {
        let pixels = u64::from(self.settings.width) * u64::from(self.settings.height);
        let total = (pixels * u64::from(self.settings.spp)).max(1);
        let done = self.control.samples_done().min(total);
        let end = lock(&self.shared.ended).unwrap_or_else(Instant::now);
        let tracing = lock(&self.shared.tracing_since).map_or(0.0, |since| (end - since).as_secs_f64());
        let fraction = done as f64 / total as f64;
        let enough = tracing > 0.3 && fraction > 0.002;
        Progress {
            fraction: fraction as f32,
            samples: done as f32 / pixels.max(1) as f32,
            mrays_s: if tracing > 0.0 { (self.control.rays() as f64 * 1e-6 / tracing) as f32 } else { 0.0 },
            elapsed: end - self.started,
            left: enough.then(|| Duration::from_secs_f64(tracing * (1.0 - fraction) / fraction)),
        }
    }
}

impl Drop for RenderJob {
    fn drop(&mut self) {
        self.cancel();
    }
}

/// The body of the render thread.
#[expect(clippy::too_many_arguments, reason = "one call site")]
fn trace(
    trees: &GeometryCache,
    scene: &Scene,
    mut assets: Assets,
    folder: Option<PathBuf>,
    settings: &Settings,
    control: &RenderControl,
    shared: &Shared,
    wake: &Wake,
) -> Phase {
    let began = Instant::now();
    io::load_assets(scene, folder.as_deref(), &mut assets);
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let pool = match background_pool(threads, "trace") {
        Ok(pool) => pool,
        Err(error) => return Phase::Failed(format!("No threads to render with: {error}.")),
    };
    let prepared = match pool.install(|| raytrace::prepare_kept(scene, &assets, trees)) {
        Ok(prepared) => prepared,
        Err(error) => return Phase::Failed(sentence(&error)),
    };
    if control.is_cancelled() {
        return Phase::Cancelled;
    }
    let tracing = Instant::now();
    *lock(&shared.tracing_since) = Some(tracing);
    *lock(&shared.phase) = Phase::Tracing;
    wake();
    if let Some(coarse) = settings.coarse() {
        let film = pool
            .install(|| raytrace::render(&prepared, &coarse, &RenderControl::new(), &mut |_| ControlFlow::Break(())));
        *lock(&shared.film) = Some(Arc::new(film));
        wake();
    }
    let mut last_snapshot: Option<Instant> = None;
    let film = pool.install(|| {
        raytrace::render(&prepared, settings, control, &mut |film| {
            if last_snapshot.is_none_or(|last| last.elapsed() >= SNAPSHOT_EVERY) {
                *lock(&shared.film) = Some(Arc::new(film.clone()));
                last_snapshot = Some(Instant::now());
                wake();
            }
            if control.is_cancelled() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })
    });
    if !control.is_cancelled() {
        let (build_s, trace_s) = ((tracing - began).as_secs_f64(), tracing.elapsed().as_secs_f64());
        *lock(&shared.outcome) = Some(Outcome { build_s, trace_s, spp: film.spp(), noise_stops: film.noise_stops() });
    }
    if film.spp() > 0 {
        *lock(&shared.film) = Some(Arc::new(film));
    }
    if control.is_cancelled() { Phase::Cancelled } else { Phase::Done }
}

/// A developed film, ready to be shown and exported.
#[derive(Debug)]
pub struct Developed<I> {
    /// Scene-linear, for export.
    pub picture: Arc<Picture>,
    /// For the screen.
    pub image: I,
    /// Samples a pixel in it.
    pub spp: u32,
    /// How it was made, for its file.
    pub method: &'static str,
}

#[derive(Debug)]
struct DeveloperState<I> {
    wanted: Option<(Arc<Film>, Scene, usize)>,
    result: Option<Developed<I>>,
    busy: bool,
    closed: bool,
}

/// A thread that develops films; of several requests only the last one counts.
pub struct Developer<I> {
    state: Arc<(Mutex<DeveloperState<I>>, Condvar)>,
    present: fn(&Picture, usize) -> I,
    running: bool,
}

impl<I> std::fmt::Debug for Developer<I> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Developer").field("running", &self.running).finish_non_exhaustive()
    }
}

impl<I: Send + 'static> Developer<I> {
    /// Creates a developer whose pictures are made ready for the screen by `present`, for a longest side in pixels.
    pub fn new(present: fn(&Picture, usize) -> I) -> Self {
        let state = DeveloperState { wanted: None, result: None, busy: false, closed: false };
        Developer { state: Arc::new((Mutex::new(state), Condvar::new())), present, running: false }
    }

    /// Asks for a picture with the lights as they are in `scene`.
    pub fn request(&mut self, film: Arc<Film>, scene: Scene, most: usize, wake: &Wake) {
        if !self.running {
            self.running = true;
            let (state, present, wake) = (self.state.clone(), self.present, wake.clone());
            std::thread::spawn(move || develop_loop(&state, present, &wake));
        }
        lock(&self.state.0).wanted = Some((film, scene, most));
        self.state.1.notify_one();
    }

    /// The newest picture, once.
    pub fn take(&self) -> Option<Developed<I>> {
        lock(&self.state.0).result.take()
    }

    /// Whether a picture is on its way.
    pub fn is_busy(&self) -> bool {
        let state = lock(&self.state.0);
        state.busy || state.wanted.is_some() || state.result.is_some()
    }
}

impl<I> Drop for Developer<I> {
    fn drop(&mut self) {
        lock(&self.state.0).closed = true;
        self.state.1.notify_one();
    }
}

fn develop_loop<I>(state: &(Mutex<DeveloperState<I>>, Condvar), present: fn(&Picture, usize) -> I, wake: &Wake) {
    loop {
        let (film, scene, most) = {
            let mut guard = lock(&state.0);
            loop {
                if guard.closed {
                    return;
                }
                if let Some(wanted) = guard.wanted.take() {
                    guard.busy = true;
                    break wanted;
                }
                guard = state.1.wait(guard).unwrap_or_else(PoisonError::into_inner);
            }
        };
        let developed = develop(&film, &scene, |picture| present(picture, most));
        let mut guard = lock(&state.0);
        guard.result = Some(developed);
        guard.busy = false;
        drop(guard);
        wake();
    }
}

/// Develops a film with the lights of a scene.
fn develop<I>(film: &Film, scene: &Scene, present: impl FnOnce(&Picture) -> I) -> Developed<I> {
    let picture = film.develop(scene);
    let image = present(&picture);
    Developed { picture: Arc::new(picture), image, spp: film.spp(), method: film.method() }
}
