//! Background work: renders, the traced live view, light meter readings and render forecasts, each in its own thread.
//!
//! Window and command line share it. It depends on neither egui nor wgpu: a job signals its owner through a [`Wake`].

mod forecast;
mod live_job;
mod live_pace;
mod meter_job;
mod render_job;
mod threads;

pub use forecast::{Estimate, Forecast, Forecaster};
pub use live_job::{LiveJob, LiveRequest};
pub use live_pace::{LiveImage, LivePace};
pub use meter_job::MeterJob;
pub use render_job::{Developed, Developer, Outcome, Phase, Progress, RenderJob};
pub use threads::background_pool;

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A callback that tells a job's owner to fetch its result, such as a request to repaint a window.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// Locks a mutex whose data stays valid after a panic.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Returns an error's message as a sentence: with a capital letter and a full stop.
pub fn sentence(error: &dyn std::error::Error) -> String {
    let text = error.to_string();
    let mut chars = text.chars();
    let first = chars.next().map(|c| c.to_uppercase().to_string()).unwrap_or_default();
    let rest = chars.as_str();
    if rest.ends_with(['.', '!', '?']) { format!("{first}{rest}") } else { format!("{first}{rest}.") }
}
