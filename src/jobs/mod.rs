//! Background work for the window and the command line: renders, BVHs built ahead of them, development of films, the live
//! traced view, bounced light of the preview, light meter readings, pattern checks of faces, render forecasts and
//! thumbnails.
//!
//! It depends on neither egui nor wgpu. A job of the window is a [`worker`]: a thread with a request slot and a result
//! slot, each of which holds the latest value only, and a [`Wake`] callback. The command line calls the functions that
//! those threads run: [`render()`], [`read_meter`], [`LivePacing::step`].

mod bounce;
mod cache_warmer;
mod clock;
mod denoised_film;
mod film_developer;
mod forecast;
mod forecaster;
mod live_job;
mod live_pacing;
mod memory;
mod meter;
mod monitor;
mod portrait;
mod quiet_time;
mod render;
mod render_job;
mod render_part;
mod sentence;
mod spot_meter;
mod threads;
mod thumbnails;
pub mod worker;

pub use bounce::{BounceJob, trace_bounced_light};
pub use cache_warmer::{CacheWarmer, WarmSubject};
pub use clock::Clock;
pub use film_developer::{Developed, Development, FilmDeveloper};
pub use forecast::{Estimate, Forecast};
pub use forecaster::{ForecastSubject, Forecaster};
pub use live_job::{LiveJob, LiveRequest};
pub use live_pacing::{LiveImage, LivePacing};
pub use memory::{Bytes, RenderMemory};
pub use meter::{MeterJob, read_meter};
pub use monitor::{Progress, RenderMonitor};
pub use portrait::{Catchlight, Face, FaceLighting, KeyPlace, Modelling, PatternJob, check_patterns, faces_in_view};
pub use render::{RenderError, RenderInput, RenderStage, Rendered, render, render_all_passes};
pub use render_job::{RenderJob, RenderOutcome, RenderPhase, RenderRequest};
pub use render_part::{RenderedPart, render_part};
pub use sentence::sentence;
pub use spot_meter::{SpotMeterJob, SpotRay};
pub use threads::{Priority, background_pool};
pub use thumbnails::{BACKGROUND, ThumbnailImage, ThumbnailJob, ThumbnailSubject, draw_thumbnail};
pub use worker::Wake;
