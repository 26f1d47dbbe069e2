//! The times at which the display of a render's progress is updated.

use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::Duration;

/// Time between two updates.
const INTERVAL: Duration = Duration::from_millis(100);

/// The moments at which the display is updated: the last one at the end.
#[derive(Debug)]
pub struct Updates {
    ended: Receiver<()>,
    is_over: bool,
}

impl Updates {
    /// Returns the updates of a render that is over when the sender of `ended` is dropped.
    pub fn until(ended: Receiver<()>) -> Self {
        Updates { ended, is_over: false }
    }
}

impl Iterator for Updates {
    type Item = ();

    fn next(&mut self) -> Option<()> {
        if self.is_over {
            return None;
        }
        self.is_over = self.ended.recv_timeout(INTERVAL) != Err(RecvTimeoutError::Timeout);
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::channel;

    #[test]
    fn the_last_update_comes_at_the_end() {
        let (end, ended) = channel();
        let mut updates = Updates::until(ended);
        assert_eq!(updates.next(), Some(()));
        drop(end);
        assert_eq!(updates.count(), 1);
    }
}
