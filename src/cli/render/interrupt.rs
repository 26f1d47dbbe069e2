//! Ctrl+C in a render.

use crate::cli::failure::Failure;
use crate::raytrace::RenderControl;
use anyhow::anyhow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Makes the first Ctrl+C cancel the render, which keeps its picture, and the second one end the program. Returns a
/// flag that is set by the first one.
pub fn cancel_on_ctrl_c(control: &Arc<RenderControl>) -> Result<Arc<AtomicBool>, Failure> {
    let interrupted = Arc::new(AtomicBool::new(false));
    let (flag, control) = (interrupted.clone(), control.clone());
    ctrlc::set_handler(move || {
        if flag.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
        control.cancel();
    })
    .map_err(|error| Failure::Machine(anyhow!(error).context("can't listen for Ctrl+C")))?;
    Ok(interrupted)
}
