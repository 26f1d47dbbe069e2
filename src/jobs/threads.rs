//! Threads in the background, whose priority is lower than that of the window's threads.

use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};
use std::sync::{Mutex, MutexGuard, PoisonError};
use thread_priority::{ThreadPriority, ThreadPriorityValue, set_current_thread_priority};

/// Priority of a worker's thread.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Priority {
    /// As the window's threads.
    Normal,
    /// Lower than the window's threads.
    Background,
}

/// Priority of a background thread, of 100: niceness 9 on Linux. Against a thread of normal priority it gets an eighth
/// of a core that both use, and all of a core that no other thread uses.
const BACKGROUND: u8 = 25;

/// Returns a pool of `threads` background threads, or of one per core for 0, whose names begin with `name`.
///
/// # Errors
/// When the system gives no threads.
pub fn background_pool(threads: usize, name: &'static str) -> Result<ThreadPool, ThreadPoolBuildError> {
    let builder = ThreadPoolBuilder::new().num_threads(threads).thread_name(move |i| format!("{name} {i}"));
    builder.start_handler(|_| lower_priority()).build()
}

/// Locks a mutex. Its data stays valid when a thread panics.
pub(super) fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Lowers the priority of the current thread. The thread keeps its priority where the system does not allow it.
pub(super) fn lower_priority() {
    let priority = ThreadPriorityValue::try_from(BACKGROUND).map(ThreadPriority::Crossplatform);
    match priority.map(set_current_thread_priority) {
        Ok(Ok(())) => {}
        Ok(Err(error)) => log::debug!("a thread keeps its priority: {error}"),
        Err(error) => log::debug!("{BACKGROUND} is not a valid priority: {error}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(target_os = "linux")]
    fn background_threads_have_a_niceness_of_9() {
        // Field 19 of /proc/thread-self/stat is the niceness (proc(5)); the name before it may hold spaces.
        let niceness = || {
            let stat = std::fs::read_to_string("/proc/thread-self/stat").unwrap();
            stat.rsplit(')').next().unwrap().split_whitespace().nth(16).unwrap().parse::<i32>().unwrap()
        };
        let pool = background_pool(2, "test").unwrap();
        assert_eq!(pool.install(niceness), 9.max(niceness()));
    }
}
