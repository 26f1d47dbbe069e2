//! The clock of jobs whose timing depends on elapsed time. Tests replace it by one that they advance.

use std::sync::Arc;
use std::time::Instant;

/// A source of the current time.
#[derive(Clone)]
pub struct Clock(Arc<dyn Fn() -> Instant + Send + Sync>);

impl Clock {
    /// Returns a clock that reads the time from `now`.
    pub fn new(now: impl Fn() -> Instant + Send + Sync + 'static) -> Self {
        Clock(Arc::new(now))
    }

    /// Returns a clock that stands still, and a function that advances it.
    #[cfg(test)]
    pub(super) fn by_hand() -> (Self, impl Fn(std::time::Duration)) {
        use std::sync::{Mutex, PoisonError};
        let time = Arc::new(Mutex::new(Instant::now()));
        let read = time.clone();
        let clock = Clock::new(move || *read.lock().unwrap_or_else(PoisonError::into_inner));
        (clock, move |by| *time.lock().unwrap_or_else(PoisonError::into_inner) += by)
    }

    /// Returns the current time.
    pub fn now(&self) -> Instant {
        (self.0)()
    }
}

impl Default for Clock {
    /// Returns the system's monotonic clock.
    fn default() -> Self {
        Clock::new(Instant::now)
    }
}

impl std::fmt::Debug for Clock {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("Clock").finish()
    }
}
