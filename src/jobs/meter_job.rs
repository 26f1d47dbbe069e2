//! The meter of the studio, read in the background: first roughly, then well. Of several requests the last one counts.

use super::{Wake, lock};
use crate::photo::meter::Reading;
use crate::raytrace::{LightMeter, MeterEffort, MeterPoint, RenderControl};
use crate::scene::{Assets, Meter, Scene};
use std::sync::{Arc, Condvar, Mutex, PoisonError};

#[derive(Debug)]
struct Request {
    scene: Scene,
    assets: Assets,
    meter: Meter,
    control: Arc<RenderControl>,
}

#[derive(Debug, Default)]
struct State {
    wanted: Option<Request>,
    /// Lets the thorough reading that is under way be given up.
    refining: Option<Arc<RenderControl>>,
    result: Option<Result<Reading, String>>,
    busy: bool,
    closed: bool,
}

/// The thread that reads, and what it has read last.
#[derive(Debug, Default)]
pub struct MeterJob {
    state: Arc<(Mutex<State>, Condvar)>,
    running: bool,
    /// Revision of the document that was asked for last.
    asked: Option<u64>,
    shown: Option<Result<Reading, String>>,
}

impl MeterJob {
    /// Asks for a reading when the studio has changed, and takes in what is ready.
    pub fn update(&mut self, scene: &Scene, assets: &Assets, revision: u64, wake: &Wake) {
        let Some(meter) = scene.meter else {
            (self.asked, self.shown) = (None, None);
            return;
        };
        if let Some(result) = lock(&self.state.0).result.take() {
            self.shown = Some(result);
        }
        if self.asked != Some(revision) {
            self.asked = Some(revision);
            self.request(
                Request { scene: scene.clone(), assets: assets.clone(), meter, control: Arc::default() },
                wake,
            );
        }
    }

    fn request(&mut self, request: Request, wake: &Wake) {
        if !self.running {
            self.running = true;
            let (state, wake) = (self.state.clone(), wake.clone());
            std::thread::spawn(move || read_loop(&state, &wake));
        }
        let mut state = lock(&self.state.0);
        if let Some(refining) = &state.refining {
            refining.cancel();
        }
        state.wanted = Some(request);
        self.state.1.notify_one();
    }

    /// The last reading, or why there is none. Empty until the first one is there.
    pub fn reading(&self) -> Option<&Result<Reading, String>> {
        self.shown.as_ref()
    }

    /// Whether a reading is on its way.
    pub fn is_busy(&self) -> bool {
        let state = lock(&self.state.0);
        state.busy || state.wanted.is_some() || state.result.is_some()
    }
}

impl Drop for MeterJob {
    fn drop(&mut self) {
        let mut state = lock(&self.state.0);
        state.closed = true;
        if let Some(refining) = &state.refining {
            refining.cancel();
        }
        self.state.1.notify_one();
    }
}

fn read_loop(state: &(Mutex<State>, Condvar), wake: &Wake) {
    while let Some(request) = next(state) {
        let work = || read(state, &request, wake);
        // The tracer does not panic; if it did, the user would get a message and keep the window.
        if std::panic::catch_unwind(std::panic::AssertUnwindSafe(work)).is_err() {
            show(state, Err("The meter failed. This is an error in Catchlight.".to_owned()), wake);
        }
        let mut guard = lock(&state.0);
        (guard.busy, guard.refining) = (false, None);
        drop(guard);
        wake();
    }
}

/// Waits for a request; none when the window has closed.
fn next(state: &(Mutex<State>, Condvar)) -> Option<Request> {
    let mut guard = lock(&state.0);
    loop {
        if guard.closed {
            return None;
        }
        if let Some(request) = guard.wanted.take() {
            guard.busy = true;
            guard.refining = Some(request.control.clone());
            return Some(request);
        }
        guard = state.1.wait(guard).unwrap_or_else(PoisonError::into_inner);
    }
}

fn read(state: &(Mutex<State>, Condvar), request: &Request, wake: &Wake) {
    let Request { scene, assets, meter, control } = request;
    let probe = match LightMeter::new(scene, assets, meter.position) {
        Ok(probe) => probe,
        Err(error) => return show(state, Err(error.to_string()), wake),
    };
    let place = MeterPoint { position: meter.position, facing: meter.direction(scene), receptor: meter.receptor };
    // The rough reading is always finished: in a drag the numbers follow the mouse.
    for (effort, control) in [(MeterEffort::quick(), &Arc::default()), (MeterEffort::default(), control)] {
        if let Some(probed) = probe.read(&place, &effort, control) {
            show(state, Ok(probed.reading), wake);
        }
    }
}

fn show(state: &(Mutex<State>, Condvar), result: Result<Reading, String>, wake: &Wake) {
    lock(&state.0).result = Some(result);
    wake();
}
