//! A render from scene to film: prepare, coarse first picture, sample passes, timings. Command line, window and the
//! pilot renders of forecasts all use it, each with its own observer.

use super::memory::{self, Bytes, RenderMemory};
use super::monitor::RenderMonitor;
use crate::io;
use crate::raytrace::{
    self, Film, GeometryCache, PrepareError, Purpose, RenderControl, RenderScene, Settings, Shortcut, TracedFilm,
};
use crate::scene::{Assets, Scene};
use rayon::ThreadPool;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, PoisonError};
use std::time::{Duration, Instant};
use thiserror::Error;

/// A render to be made.
#[derive(Clone, Copy, Debug)]
pub struct RenderInput<'a> {
    /// The studio.
    pub scene: &'a Scene,
    /// Its meshes and textures.
    pub assets: &'a Assets,
    /// BVHs of meshes, shared with other renders and the live view.
    pub cache: &'a GeometryCache,
    /// Size, method and number of samples.
    pub settings: &'a Settings,
    /// Shortcuts of the plan that are not taken.
    pub without: &'a [Shortcut],
    /// Stored samples of an earlier run to go on from ([`Film::store`]).
    pub checkpoint: Option<&'a [u8]>,
    /// Time after which the render ends, once every pixel has a sample.
    pub time_limit: Option<Duration>,
    /// Memory that it may take beside the prepared scene; none takes what is free.
    pub memory: Option<Bytes>,
    /// Films are cloned while the render goes on.
    pub snapshots: bool,
}

impl<'a> RenderInput<'a> {
    /// Returns the input of a render from the first sample to the last, without snapshots.
    pub fn new(scene: &'a Scene, assets: &'a Assets, cache: &'a GeometryCache, settings: &'a Settings) -> Self {
        RenderInput {
            scene,
            assets,
            cache,
            settings,
            without: &[],
            checkpoint: None,
            time_limit: None,
            memory: None,
            snapshots: false,
        }
    }
}

/// The reason why a render does not begin.
#[derive(Debug, Error)]
pub enum RenderError {
    /// The scene cannot be prepared.
    #[error(transparent)]
    Prepare(#[from] PrepareError),
    /// The machine has too little memory.
    #[error("{0}: choose a smaller size, or close other programs")]
    Memory(RenderMemory),
    /// The checkpoint belongs to another render.
    #[error("can't go on from the checkpoint: {0}")]
    Checkpoint(String),
}

/// A stage that a render has reached, for its observer.
#[derive(Clone, Copy, Debug)]
pub enum RenderStage<'a> {
    /// BVHs and tables are built.
    Prepared(&'a RenderScene, RenderMemory),
    /// One sample a pixel of the coarse version of a large picture.
    Coarse(&'a Film),
    /// A sample pass is complete.
    Pass(&'a Film),
}

/// A finished or interrupted render.
#[derive(Debug)]
pub struct Rendered {
    /// The scene as it was traced.
    pub scene: RenderScene,
    /// The coarse version of a large picture; none if the render was cancelled in it.
    pub coarse: Option<Film>,
    /// The picture; without samples if the render was cancelled in its first pass.
    pub film: Film,
    /// Time to build BVHs and tables, seconds.
    pub build_s: f64,
    /// Time to trace, seconds.
    pub trace_s: f64,
}

/// Renders on `pool`, keeping `monitor` up to date and calling `observe` at each stage.
///
/// # Errors
/// When the scene cannot be prepared, when the memory does not suffice for the picture, even with a layer for each role of
/// lights, or when the checkpoint is none of this render.
pub fn render(
    input: &RenderInput<'_>,
    pool: &ThreadPool,
    monitor: &RenderMonitor,
    observe: &mut (dyn FnMut(RenderStage<'_>) + Send),
) -> Result<Rendered, RenderError> {
    let RenderInput { settings, .. } = *input;
    let control = monitor.control();
    // Build the acceleration structures and the light tables.
    let layers = if input.checkpoint.is_some() { Layers::Stored } else { Layers::OneEach };
    let (mut scene, build_s) = prepared(input, layers, pool, observe)?;
    let trace_started = Instant::now();
    monitor.start_tracing(trace_started);
    let film = match input.checkpoint {
        None => pool.install(|| raytrace::empty_film(&scene, settings)),
        Some(bytes) => stored_film(input, bytes, &mut scene, pool)?,
    };
    // Trace the coarse version of a large picture, then sample passes until the samples, the noise limit or the time
    // limit are reached.
    let mut coarse = None;
    let film = pool.install(|| {
        within_time(input.time_limit, trace_started, control, |deadline| {
            raytrace::resume_coarse_first(&scene, settings, film, control, &mut |traced| match traced {
                TracedFilm::Coarse(film) => {
                    monitor.finish_coarse(film.traced_rays());
                    observe(RenderStage::Coarse(film));
                    coarse = Some(film.clone());
                    ControlFlow::Continue(())
                }
                TracedFilm::Pass(film) => {
                    monitor.finish_pass();
                    if let Some(left) = raytrace::predicted_rays_left(film, &scene, settings, monitor.rays()) {
                        monitor.predict_rays_left(left);
                    }
                    observe(RenderStage::Pass(film));
                    deadline.after_pass()
                }
            })
        })
    });
    monitor.finish();
    Ok(Rendered { scene, coarse, film, build_s, trace_s: trace_started.elapsed().as_secs_f64() })
}

/// The layers that a film may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Layers {
    /// One for each light, or for each role of lights where the memory suffices for no more.
    OneEach,
    /// Those of a stored film, whatever the memory.
    Stored,
    /// One for each light whatever the memory, because parts of all machines are merged.
    OfPart,
}

/// Prepares the scene for the picture, with the plan that the input asks for, and with a layer for each light or for each
/// role of lights.
fn prepared_with(input: &RenderInput<'_>, shares_layers: bool, pool: &ThreadPool) -> Result<RenderScene, PrepareError> {
    let purpose = Purpose { picture: Some((input.settings.width, input.settings.height)), shares_layers };
    let mut prepared = pool.install(|| raytrace::prepare_for(input.scene, input.assets, purpose, input.cache))?;
    if !input.without.is_empty() {
        let plan = input.without.iter().fold(prepared.plan().clone(), |plan, shortcut| plan.without(*shortcut));
        prepared.set_plan(plan);
    }
    Ok(prepared)
}

/// Prepares the scene, with the plan that the input asks for, and returns it with the time that it took, seconds.
pub(super) fn prepared(
    input: &RenderInput<'_>,
    layers: Layers,
    pool: &ThreadPool,
    observe: &mut (dyn FnMut(RenderStage<'_>) + Send),
) -> Result<(RenderScene, f64), RenderError> {
    let started = Instant::now();
    let mut prepared = prepared_with(input, false, pool)?;
    // Share layers, or refuse, if the memory does not suffice
    let need = |scene: &RenderScene| match layers {
        Layers::OfPart => memory::needed_by_part(input.settings, scene.layers().len()),
        Layers::OneEach | Layers::Stored => memory::needed(input.settings, scene.layers().len(), input.snapshots),
    };
    let mut memory = RenderMemory { need: need(&prepared), free: input.memory.or_else(memory::free), unshared: None };
    if memory.is_too_little() && layers == Layers::OneEach {
        prepared = prepared_with(input, true, pool)?;
        memory = RenderMemory { need: need(&prepared), unshared: Some(memory.need), ..memory };
    }
    if memory.is_too_little() && layers != Layers::Stored {
        return Err(RenderError::Memory(memory));
    }
    observe(RenderStage::Prepared(&prepared, memory));
    Ok((prepared, started.elapsed().as_secs_f64()))
}

/// Returns the film with the samples of an earlier run. If lights shared layers in that run, they do so in `scene` from now
/// on.
fn stored_film(
    input: &RenderInput<'_>,
    bytes: &[u8],
    scene: &mut RenderScene,
    pool: &ThreadPool,
) -> Result<Film, RenderError> {
    let film = |scene: &RenderScene| raytrace::empty_film(scene, input.settings).with_stored(&mut &bytes[..]);
    if let Ok(film) = film(scene) {
        return Ok(film);
    }
    *scene = prepared_with(input, true, pool)?;
    film(scene).map_err(|error| RenderError::Checkpoint(io::reason(&error)))
}

/// Traces all passes of a prepared scene on the current pool, without an observer.
pub fn render_all_passes(scene: &RenderScene, settings: &Settings, control: &RenderControl) -> Film {
    raytrace::render(scene, settings, control, &mut |_| ControlFlow::Continue(()))
}

/// The end of a render with a time limit.
struct Deadline {
    at: Option<Instant>,
    has_pass: AtomicBool,
}

impl Deadline {
    /// Ends the render after a pass once the time is over.
    fn after_pass(&self) -> ControlFlow<()> {
        self.has_pass.store(true, Ordering::SeqCst);
        let is_over = self.at.is_some_and(|at| Instant::now() >= at);
        if is_over { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// Traces with a time limit. At its end the current pass is cancelled, unless it is the first one.
fn within_time(
    limit: Option<Duration>,
    started: Instant,
    control: &RenderControl,
    trace: impl FnOnce(&Deadline) -> Film,
) -> Film {
    let deadline =
        Deadline { at: limit.and_then(|limit| started.checked_add(limit)), has_pass: AtomicBool::new(false) };
    let Some(at) = deadline.at else { return trace(&deadline) };
    let (is_done, done) = (Mutex::new(false), Condvar::new());
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let left = at.saturating_duration_since(Instant::now());
            let is_done = is_done.lock().unwrap_or_else(PoisonError::into_inner);
            let waited = done.wait_timeout_while(is_done, left, |is_done| !*is_done);
            let (is_done, _) = waited.unwrap_or_else(PoisonError::into_inner);
            if !*is_done && deadline.has_pass.load(Ordering::SeqCst) {
                control.cancel();
            }
        });
        let film = trace(&deadline);
        *is_done.lock().unwrap_or_else(PoisonError::into_inner) = true;
        done.notify_one();
        film
    })
}
