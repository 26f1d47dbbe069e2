//! The signal from a background job to the window.

use crate::jobs::Wake;
use eframe::egui::Context;
use std::sync::Arc;

/// Returns a callback that repaints the window.
pub fn wake(ctx: &Context) -> Wake {
    let ctx = ctx.clone();
    Arc::new(move || ctx.request_repaint())
}
