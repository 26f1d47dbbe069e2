//! A background worker: one thread with a request slot and a result slot, each of which holds the latest value only.
//!
//! The owner writes the request slot and reads the result slot, and never waits for the thread. Each request has a
//! [`RenderControl`], which a newer request cancels as its [`Interrupt`] rule says. A [`Wake`] callback signals a new
//! result. A panic of the work becomes an error in the result slot, and the next request starts the work anew. Dropping
//! the worker cancels its work and ends the thread.

use super::threads::{self, Priority};
use crate::raytrace::RenderControl;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

/// A callback that makes a job's owner fetch its result, such as a request to repaint a window.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// Rule by which a new request cancels the work on the previous one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interrupt {
    /// At once: a result of the previous request is of no use.
    Always,
    /// After the previous request has had its first result, so that a result appears even if requests never pause.
    AfterResult,
}

/// Constant properties of a worker.
#[derive(Clone, Copy, Debug)]
pub struct WorkerSettings {
    /// Name of the thread.
    pub name: &'static str,
    /// Priority of the thread.
    pub priority: Priority,
    /// Rule by which a new request cancels the work on the previous one.
    pub interrupt: Interrupt,
    /// Message of the result after a panic.
    pub panic_message: &'static str,
}

/// A thread with its request slot and its result slot. The first request starts the thread.
pub struct Worker<Q, R> {
    shared: Arc<Shared<Q, R>>,
    settings: WorkerSettings,
    work: Arc<Work<Q, R>>,
    is_started: bool,
}

/// The body of a worker's thread.
type Work<Q, R> = dyn Fn(&Inbox<Q, R>) + Send + Sync;

struct Shared<Q, R> {
    state: Mutex<State<Q, R>>,
    changed: Condvar,
}

struct State<Q, R> {
    request: Option<(Q, Arc<RenderControl>)>,
    result: Option<Result<R, String>>,
    wake: Option<Wake>,
    /// Control of the request that is being worked on.
    control: Arc<RenderControl>,
    /// The request that is being worked on has had a result.
    has_result: bool,
    is_busy: bool,
    is_paused: bool,
    /// The thread waits for a request or for the end of a pause.
    is_waiting: bool,
    is_closed: bool,
}

impl<Q, R> Shared<Q, R> {
    /// Locks the state; its values stay valid when a thread panics.
    fn lock(&self) -> MutexGuard<'_, State<Q, R>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<Q, R> std::fmt::Debug for Worker<Q, R> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Worker").field("settings", &self.settings).finish_non_exhaustive()
    }
}

impl<Q: Send + 'static, R: Send + 'static> Worker<Q, R> {
    /// Returns a worker whose thread runs `work`, which takes requests from its inbox until that is closed.
    pub fn new(settings: WorkerSettings, work: impl Fn(&Inbox<Q, R>) + Send + Sync + 'static) -> Self {
        let state = State {
            request: None,
            result: None,
            wake: None,
            control: Arc::default(),
            has_result: false,
            is_busy: false,
            is_paused: false,
            is_waiting: false,
            is_closed: false,
        };
        let shared = Arc::new(Shared { state: Mutex::new(state), changed: Condvar::new() });
        Worker { shared, settings, work: Arc::new(work), is_started: false }
    }

    /// Replaces the request, and returns the control of the new one.
    pub fn request(&mut self, request: Q, wake: &Wake) -> Arc<RenderControl> {
        let control: Arc<RenderControl> = Arc::default();
        self.request_with(control.clone(), wake, |_| request);
        control
    }

    /// Replaces the request by one with this control, made from that which has not been taken yet.
    pub fn request_with(&mut self, control: Arc<RenderControl>, wake: &Wake, make: impl FnOnce(Option<Q>) -> Q) {
        let mut state = self.shared.lock();
        if state.has_result || self.settings.interrupt == Interrupt::Always {
            state.control.cancel();
        }
        let pending = state.request.take().map(|(request, _)| request);
        state.request = Some((make(pending), control));
        state.wake = Some(wake.clone());
        self.shared.changed.notify_one();
        drop(state);
        if !self.is_started {
            self.start();
        }
    }

    fn start(&mut self) {
        let (inbox, work) = (Inbox { shared: self.shared.clone() }, self.work.clone());
        let WorkerSettings { priority, panic_message, .. } = self.settings;
        let run = move || {
            if priority == Priority::Background {
                threads::lower_priority();
            }
            while catch_unwind(AssertUnwindSafe(|| work(&inbox))).is_err() {
                inbox.fail(panic_message.to_owned());
            }
        };
        match std::thread::Builder::new().name(self.settings.name.to_owned()).spawn(run) {
            Ok(_) => self.is_started = true,
            Err(error) => {
                let mut state = self.shared.lock();
                (state.request, state.result) = (None, Some(Err(format!("The system gives no thread: {error}."))));
            }
        }
    }

    /// Cancels the current work and discards request and result. Work that does not notice may still publish, unless by
    /// [`Inbox::publish_unless_cancelled`].
    pub fn reset(&self) {
        let mut state = self.shared.lock();
        state.control.cancel();
        (state.request, state.result) = (None, None);
    }

    /// Pauses or resumes the work. A pause cancels the current work; the request stays in its slot.
    pub fn pause(&self, is_paused: bool) {
        let mut state = self.shared.lock();
        if state.is_paused != is_paused {
            state.is_paused = is_paused;
            if is_paused {
                state.control.cancel();
            }
            self.shared.changed.notify_one();
        }
    }

    /// Takes the latest result out of its slot.
    pub fn take(&self) -> Option<Result<R, String>> {
        self.shared.lock().result.take()
    }

    /// Returns true while there is a request, work on one, or a result that has not been taken.
    pub fn is_busy(&self) -> bool {
        let state = self.shared.lock();
        state.is_busy || state.request.is_some() || state.result.is_some()
    }

    /// Returns true if the worker is paused and its thread has stopped working.
    pub fn is_stopped(&self) -> bool {
        let state = self.shared.lock();
        state.is_paused && state.is_waiting
    }
}

impl<Q, R> Drop for Worker<Q, R> {
    fn drop(&mut self) {
        let mut state = self.shared.lock();
        state.is_closed = true;
        state.control.cancel();
        self.shared.changed.notify_one();
    }
}

/// The thread's side of the slots.
pub struct Inbox<Q, R> {
    shared: Arc<Shared<Q, R>>,
}

impl<Q, R> std::fmt::Debug for Inbox<Q, R> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Inbox").finish_non_exhaustive()
    }
}

impl<Q, R> Inbox<Q, R> {
    /// Waits for a request. Returns none when the worker is closed.
    pub fn next(&self) -> Option<(Q, Arc<RenderControl>)> {
        self.next_step(|pending| pending.take_request())
    }

    /// Waits until `choose` finds a step to take. Returns none when the worker is closed.
    pub fn next_step<T>(&self, mut choose: impl FnMut(&mut Pending<'_, Q, R>) -> Option<T>) -> Option<T> {
        let mut state = self.shared.lock();
        loop {
            if state.is_closed {
                return None;
            }
            let was_busy = std::mem::replace(&mut state.is_busy, false);
            if let Some(step) = choose(&mut Pending(&mut state)) {
                state.is_busy = true;
                return Some(step);
            }
            state = if was_busy && !state.is_busy {
                // Signal the end of the work, which may have left no result.
                let wake = state.wake.clone();
                drop(state);
                signal(wake);
                self.shared.lock()
            } else {
                state.is_waiting = true;
                let mut woken = self.shared.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
                woken.is_waiting = false;
                woken
            };
        }
    }

    /// Puts a result into its slot.
    pub fn publish(&self, result: R) {
        self.publish_with(|_| result);
    }

    /// Puts a result into its slot, made from that which has not been taken yet.
    pub fn publish_with(&self, make: impl FnOnce(Option<R>) -> R) {
        self.put(|pending| Ok(make(pending.and_then(Result::ok))));
    }

    /// Puts a result into its slot unless its request was cancelled.
    pub fn publish_unless_cancelled(&self, control: &RenderControl, result: R) {
        let mut state = self.shared.lock();
        if control.is_cancelled() {
            return;
        }
        (state.result, state.has_result) = (Some(Ok(result)), true);
        let wake = state.wake.clone();
        drop(state);
        signal(wake);
    }

    /// Puts an error message into the result slot.
    pub fn fail(&self, message: String) {
        self.put(|_| Err(message));
    }

    /// Answers every request with an error message, for work that cannot be done on this system.
    pub fn fail_all(&self, message: &str) {
        while self.next().is_some() {
            self.fail(message.to_owned());
        }
    }

    fn put(&self, make: impl FnOnce(Option<Result<R, String>>) -> Result<R, String>) {
        let mut state = self.shared.lock();
        let pending = state.result.take();
        (state.result, state.has_result) = (Some(make(pending)), true);
        if state.request.is_some() {
            state.control.cancel();
        }
        let wake = state.wake.clone();
        drop(state);
        signal(wake);
    }
}

fn signal(wake: Option<Wake>) {
    if let Some(wake) = wake {
        wake();
    }
}

/// The slots, locked, while the thread chooses its next step.
pub struct Pending<'a, Q, R>(&'a mut State<Q, R>);

impl<Q, R> std::fmt::Debug for Pending<'_, Q, R> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("Pending").finish()
    }
}

impl<Q, R> Pending<'_, Q, R> {
    /// Takes the request and its control out of their slot.
    pub fn take_request(&mut self) -> Option<(Q, Arc<RenderControl>)> {
        let (request, control) = self.0.request.take()?;
        (self.0.control, self.0.has_result) = (control.clone(), false);
        Some((request, control))
    }

    /// Takes one item out of a request that is a list of them.
    pub fn take_part<T>(&mut self, part: impl FnOnce(&mut Q) -> Option<T>) -> Option<T> {
        let found = part(&mut self.0.request.as_mut()?.0);
        if found.is_none() {
            self.0.request = None;
        }
        found
    }

    /// Returns the control of the request that is being worked on: a new one if work was cancelled by a pause.
    pub fn control(&mut self) -> Arc<RenderControl> {
        if self.0.control.is_cancelled() {
            self.0.control = Arc::default();
        }
        self.0.control.clone()
    }

    /// Returns true if there is a request.
    pub fn has_request(&self) -> bool {
        self.0.request.is_some()
    }

    /// Returns true if the request that is being worked on has had a result.
    pub fn has_result(&self) -> bool {
        self.0.has_result
    }

    /// Returns true while the worker is paused.
    pub fn is_paused(&self) -> bool {
        self.0.is_paused
    }

    /// Lets the worker count as busy while it waits.
    pub fn stay_busy(&mut self) {
        self.0.is_busy = true;
    }
}

#[cfg(test)]
mod tests;
