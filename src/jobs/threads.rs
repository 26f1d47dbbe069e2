//! Threads that work behind a window: they take what it leaves.

use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};
use thread_priority::{ThreadPriority, ThreadPriorityValue, set_current_thread_priority};

/// Priority of a thread in the background, of 100: niceness 9 on Linux. Against a window's thread it gets an eighth of
/// a core that both want, and all of one that nobody else wants.
const BACKGROUND: u8 = 25;

/// A pool of so many threads whose names begin with `name`, behind those of the window.
///
/// # Errors
/// When the system gives no threads.
pub fn background_pool(threads: usize, name: &'static str) -> Result<ThreadPool, ThreadPoolBuildError> {
    let builder = ThreadPoolBuilder::new().num_threads(threads).thread_name(move |i| format!("{name} {i}"));
    builder.start_handler(|_| step_back()).build()
}

/// Lets other threads go first. A system that does not allow it leaves the thread as it is.
fn step_back() {
    let priority = ThreadPriorityValue::try_from(BACKGROUND).map(ThreadPriority::Crossplatform);
    match priority.map(set_current_thread_priority) {
        Ok(Ok(())) => {}
        Ok(Err(error)) => log::debug!("a thread keeps its priority: {error}"),
        Err(error) => log::debug!("{BACKGROUND} is no priority: {error}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(target_os = "linux")]
    fn threads_in_the_background_are_nicer_than_the_window() {
        // Field 19 of /proc/thread-self/stat is the niceness (proc(5)); the name before it may hold spaces.
        let niceness = || {
            let stat = std::fs::read_to_string("/proc/thread-self/stat").unwrap();
            stat.rsplit(')').next().unwrap().split_whitespace().nth(16).unwrap().parse::<i32>().unwrap()
        };
        let pool = background_pool(2, "test").unwrap();
        assert_eq!(pool.install(niceness), 9.max(niceness()));
    }
}
