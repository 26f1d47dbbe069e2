//! A render in the background, on an immutable copy of the studio.

use super::memory::RenderMemory;
use super::monitor::{Progress, RenderMonitor};
use super::render::{RenderInput, RenderStage, Rendered, render};
use super::sentence::sentence;
use super::threads::{Priority, background_pool};
use super::worker::{Inbox, Interrupt, Wake, Worker, WorkerSettings};
use crate::io::{self, AssetFiles, LoadProgress};
use crate::raytrace::{Film, GeometryCache, RenderControl, Settings};
use crate::scene::{Assets, Scene};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// The phase that a render is in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RenderPhase {
    /// Loads missing assets, builds BVHs and tables.
    Preparing,
    /// Takes samples.
    Tracing,
    /// All samples are taken.
    Done,
    /// Cancelled by the user; complete samples are kept.
    Cancelled,
    /// Ended by an error, with its message.
    Failed(String),
}

impl RenderPhase {
    /// Returns true until the render has ended.
    pub fn is_running(&self) -> bool {
        matches!(self, RenderPhase::Preparing | RenderPhase::Tracing)
    }
}

/// Cost of a render that was not cancelled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RenderOutcome {
    /// Time to load missing assets and to build BVHs and tables, seconds.
    pub build_s: f64,
    /// Time to trace, seconds.
    pub trace_s: f64,
}

/// A render to be made in the background.
#[derive(Debug)]
pub struct RenderRequest {
    /// The studio.
    pub scene: Arc<Scene>,
    /// Its assets, as far as they are loaded.
    pub assets: Assets,
    /// Folder of the studio's file, where missing assets are looked up.
    pub folder: Option<PathBuf>,
    /// Files that lie elsewhere until the studio is saved, by the studio's paths for them.
    pub imported: BTreeMap<String, PathBuf>,
    /// BVHs of meshes, shared with the live view.
    pub cache: Arc<GeometryCache>,
    /// Size, method and number of samples.
    pub settings: Settings,
}

/// A request with the monitor that both threads share.
#[derive(Debug)]
struct Task {
    request: RenderRequest,
    monitor: Arc<RenderMonitor>,
}

/// State of a render as its thread publishes it.
#[derive(Clone, Debug)]
struct Report {
    phase: RenderPhase,
    film: Option<Arc<Film>>,
    outcome: Option<RenderOutcome>,
    memory: Option<RenderMemory>,
    /// What is said about assets that could not be read.
    missing: Arc<[String]>,
}

/// One render. Dropping it cancels it.
#[derive(Debug)]
pub struct RenderJob {
    worker: Worker<Task, Report>,
    monitor: Arc<RenderMonitor>,
    latest: Report,
    has_warned: bool,
    /// The studio as it is being rendered.
    pub scene: Arc<Scene>,
    /// Size, method and number of samples.
    pub settings: Settings,
}

const WORKER: WorkerSettings = WorkerSettings {
    name: "render",
    priority: Priority::Background,
    interrupt: Interrupt::Always,
    panic_message: "The renderer stopped with an internal error.",
};

/// Least time between two films that are published, each of which is developed.
const FILM_INTERVAL: Duration = Duration::from_millis(150);

impl RenderJob {
    /// Starts a render.
    pub fn start(request: RenderRequest, wake: &Wake) -> Self {
        let (scene, settings) = (request.scene.clone(), request.settings.clone());
        let control: Arc<RenderControl> = Arc::default();
        let monitor = Arc::new(RenderMonitor::new(&settings, control.clone()));
        let mut worker = Worker::new(WORKER, |inbox: &Inbox<Task, Report>| {
            while let Some((task, _)) = inbox.next() {
                run(&task, inbox);
            }
        });
        let task = Task { request, monitor: monitor.clone() };
        worker.request_with(control, wake, |_| task);
        let latest =
            Report { phase: RenderPhase::Preparing, film: None, outcome: None, memory: None, missing: Arc::default() };
        RenderJob { worker, monitor, latest, has_warned: false, scene, settings }
    }

    /// Returns a job that has ended with a film, complete or not.
    pub fn ended(scene: Arc<Scene>, settings: Settings, film: Arc<Film>, is_complete: bool) -> Self {
        let monitor = Arc::new(RenderMonitor::new(&settings, Arc::default()));
        monitor.control().count(0, (film.mean_spp() * settings.pixels() as f64).round() as u64);
        monitor.finish();
        let phase = if is_complete { RenderPhase::Done } else { RenderPhase::Cancelled };
        let latest = Report { phase, film: Some(film), outcome: None, memory: None, missing: Arc::default() };
        let worker = Worker::new(WORKER, |_: &Inbox<Task, Report>| {});
        RenderJob { worker, monitor, latest, has_warned: true, scene, settings }
    }

    /// Cancels the render. Complete samples are kept.
    pub fn cancel(&self) {
        self.monitor.control().cancel();
    }

    /// Takes in what the thread has published. To be called once a frame.
    pub fn update(&mut self) {
        match self.worker.take() {
            Some(Ok(report)) => self.latest = report,
            Some(Err(message)) => {
                self.monitor.finish();
                self.latest.phase = RenderPhase::Failed(message);
            }
            None => {}
        }
    }

    /// Returns the phase.
    pub fn phase(&self) -> &RenderPhase {
        &self.latest.phase
    }

    /// Returns the latest film.
    pub fn film(&self) -> Option<&Arc<Film>> {
        self.latest.film.as_ref()
    }

    /// Returns true until the render has ended and its result is taken in.
    pub fn is_busy(&self) -> bool {
        self.worker.is_busy()
    }

    /// Takes the outcome of a render that was not cancelled.
    pub fn take_outcome(&mut self) -> Option<RenderOutcome> {
        self.latest.outcome.take()
    }

    /// Returns what the user should know about the picture, once: assets that could not be read, and why lights share
    /// layers, if they do.
    pub fn take_warnings(&mut self) -> Vec<String> {
        let Some(memory) = self.latest.memory.filter(|_| !self.has_warned) else { return Vec::new() };
        self.has_warned = true;
        self.latest.missing.iter().cloned().chain(memory.sharing()).collect()
    }

    /// Returns the current progress.
    pub fn progress(&self) -> Progress {
        self.monitor.progress()
    }
}

/// The body of the render thread.
fn run(task: &Task, inbox: &Inbox<Task, Report>) {
    let Task { request: RenderRequest { scene, assets, folder, imported, cache, settings }, monitor } = task;
    let control = monitor.control();
    let started = Instant::now();
    // Load the assets that are missing.
    let mut assets = assets.clone();
    let files = AssetFiles { folder: folder.as_deref(), imported };
    let missing = io::load_assets_from(scene, files, &LoadProgress::default(), &mut assets);
    let missing = missing.iter().map(ToString::to_string).collect();
    let load_s = started.elapsed().as_secs_f64();
    // Render, and publish the film from time to time.
    let pool = match background_pool(0, "trace") {
        Ok(pool) => pool,
        Err(error) => return inbox.fail(format!("No threads to render with: {error}.")),
    };
    let mut report = Report { phase: RenderPhase::Preparing, film: None, outcome: None, memory: None, missing };
    let mut last_film: Option<Instant> = None;
    let input = RenderInput { snapshots: true, ..RenderInput::new(scene, &assets, cache, settings) };
    let rendered = render(&input, &pool, monitor, &mut |stage| {
        match stage {
            RenderStage::Prepared(_, memory) => (report.phase, report.memory) = (RenderPhase::Tracing, Some(memory)),
            RenderStage::Coarse(film) => report.film = Some(Arc::new(film.clone())),
            RenderStage::Pass(film) => {
                if last_film.is_some_and(|last| last.elapsed() < FILM_INTERVAL) {
                    return;
                }
                (report.film, last_film) = (Some(Arc::new(film.clone())), Some(Instant::now()));
            }
        }
        inbox.publish(report.clone());
    });
    monitor.finish();
    let Rendered { film, build_s, trace_s, .. } = match rendered {
        Ok(rendered) => rendered,
        Err(error) => return inbox.fail(sentence(&error)),
    };
    // Publish the outcome.
    report.phase = if control.is_cancelled() { RenderPhase::Cancelled } else { RenderPhase::Done };
    if !control.is_cancelled() {
        report.outcome = Some(RenderOutcome { build_s: load_s + build_s, trace_s });
    }
    if film.spp() > 0 {
        report.film = Some(Arc::new(film));
    }
    inbox.publish(report);
}
