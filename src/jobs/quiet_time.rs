//! Background work that waits until what it is about has not changed for a while.

use super::clock::Clock;
use std::time::{Duration, Instant};

/// The subject of some background work, and since when it has been the same.
#[derive(Debug)]
pub(super) struct QuietTime<S> {
    clock: Clock,
    delay: Duration,
    subject: Option<S>,
    /// When the subject changed; none once its work is due.
    changed: Option<Instant>,
}

/// Whether the work on a subject is due.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Due {
    /// Now, and not again until the subject changes.
    Now,
    /// After this time without a change.
    After(Duration),
    /// Not before a change, or not while it may not start.
    No,
}

impl<S: PartialEq> QuietTime<S> {
    /// Returns one without a subject, whose work is due after so much time without a change.
    pub fn new(delay: Duration, clock: Clock) -> Self {
        QuietTime { clock, delay, subject: None, changed: None }
    }

    /// Takes over the subject. Returns true if it has changed.
    pub fn follow(&mut self, subject: S) -> bool {
        let is_new = self.subject.as_ref() != Some(&subject);
        if is_new {
            (self.subject, self.changed) = (Some(subject), Some(self.clock.now()));
        }
        is_new
    }

    /// Takes over a subject whose work is done. Returns true if it has changed.
    pub fn settle(&mut self, subject: S) -> bool {
        let is_new = self.subject.as_ref() != Some(&subject);
        (self.subject, self.changed) = (Some(subject), None);
        is_new
    }

    /// Returns whether the work is due, if it may start now.
    pub fn due(&mut self, may_start: bool) -> Due {
        let Some(changed) = self.changed.filter(|_| may_start) else { return Due::No };
        let age = self.clock.now() - changed;
        if age < self.delay {
            return Due::After(self.delay - age);
        }
        self.changed = None;
        Due::Now
    }

    /// Returns true until the work is due.
    pub fn is_waiting(&self) -> bool {
        self.changed.is_some()
    }
}
