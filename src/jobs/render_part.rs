//! A part of a picture's samples from scene to sums, for farms.

use super::monitor::RenderMonitor;
use super::render::{Layers, RenderError, RenderInput, RenderStage, prepared};
use crate::raytrace::{self, FilmPart, RenderScene};
use rayon::ThreadPool;
use std::ops::Range;
use std::time::Instant;

/// A rendered part.
#[derive(Debug)]
pub struct RenderedPart {
    /// The scene as it was traced.
    pub scene: RenderScene,
    /// The sums; of fewer samples if the render was cancelled.
    pub part: FilmPart,
    /// Name of the method, for the picture's file.
    pub method: String,
    /// Caustics come from photons.
    pub has_photons: bool,
    /// Time to build BVHs and tables, seconds.
    pub build_s: f64,
    /// Time to trace, seconds.
    pub trace_s: f64,
}

/// Renders the samples of `range` on `pool`, keeping `monitor` up to date. Checkpoint and time limit of `input` are
/// not used.
///
/// # Errors
/// When the scene cannot be prepared, or the memory does not suffice.
pub fn render_part(
    input: &RenderInput<'_>,
    range: Range<u32>,
    pool: &ThreadPool,
    monitor: &RenderMonitor,
    observe: &mut (dyn FnMut(RenderStage<'_>) + Send),
) -> Result<RenderedPart, RenderError> {
    let (scene, build_s) = prepared(input, Layers::OfPart, pool, observe)?;
    let trace_started = Instant::now();
    monitor.start_tracing(trace_started);
    let after_sample = &mut |_: &FilmPart| monitor.finish_pass();
    let part = pool
        .install(|| raytrace::render_part(&scene, input.scene, input.settings, range, monitor.control(), after_sample));
    monitor.finish();
    let film = pool.install(|| raytrace::empty_film(&scene, input.settings));
    let (method, has_photons) = (film.method(), film.approximations().photons);
    Ok(RenderedPart { scene, part, method, has_photons, build_s, trace_s: trace_started.elapsed().as_secs_f64() })
}
