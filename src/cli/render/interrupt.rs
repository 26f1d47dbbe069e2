//! Signals that end a render: Ctrl+C, and on Unix SIGTERM (a scheduler, a shutdown) and SIGHUP (a closed terminal).

use crate::cli::failure::Failure;
use crate::raytrace::RenderControl;
use anyhow::anyhow;
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Makes the first signal cancel the render, which keeps its picture. A Ctrl+C after it ends the program at once; other
/// signals do not, as a closing terminal sends several. Returns a flag that the first signal sets.
pub fn cancel_on_signals(control: &Arc<RenderControl>) -> Result<Arc<AtomicBool>, Failure> {
    let interrupted = Arc::new(AtomicBool::new(false));
    let (flag, control) = (interrupted.clone(), control.clone());
    listen(move |is_ctrl_c| {
        if flag.swap(true, Ordering::Relaxed) && is_ctrl_c {
            std::process::exit(130);
        }
        control.cancel();
    })
    .map_err(|error| Failure::Machine(anyhow!(error).context("can't listen for Ctrl+C")))?;
    Ok(interrupted)
}

/// Calls `act` in a thread on each signal; its argument is true for Ctrl+C.
#[cfg(unix)]
fn listen(mut act: impl FnMut(bool) + Send + 'static) -> io::Result<()> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    let mut signals = signal_hook::iterator::Signals::new([SIGINT, SIGTERM])?;
    // `nohup` starts programs that ignore SIGHUP, to outlive their terminal.
    if !is_ignored(SIGHUP) {
        signals.add_signal(SIGHUP)?;
    }
    std::thread::spawn(move || signals.forever().for_each(|signal| act(signal == SIGINT)));
    Ok(())
}

/// Returns true if the process was started to ignore a signal, as Linux lists it: `SigIgn`, a mask in hexadecimal,
/// whose lowest bit is signal 1 (proc(5)).
#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0);
    mask >> (signal - 1) & 1 == 1
}

/// Calls `act` in a thread on each Ctrl+C.
#[cfg(not(unix))]
fn listen(mut act: impl FnMut(bool) + Send + 'static) -> io::Result<()> {
    ctrlc::set_handler(move || act(true)).map_err(io::Error::other)
}
