//! The slots of a worker: latest request, results, cancellation, pauses and panics.

use super::*;
use std::sync::mpsc::{Receiver, Sender, channel};

const SETTINGS: WorkerSettings = WorkerSettings {
    name: "test",
    priority: Priority::Background,
    interrupt: Interrupt::Always,
    panic_message: "It panicked.",
};

/// A wake-up callback that sends a message for each signal.
fn signals() -> (Wake, Receiver<()>) {
    let (sender, receiver) = channel();
    (Arc::new(move || sender.send(()).unwrap_or_default()), receiver)
}

/// The requests that a worker has started, with their controls.
type Starts = Receiver<(u32, Arc<RenderControl>)>;

/// A worker that reports each request it starts, waits for a signal, and returns the request.
fn gated(settings: WorkerSettings) -> (Worker<u32, u32>, Starts, Sender<()>) {
    let (started, starts) = channel();
    let (leave, gate) = channel();
    let gate = Mutex::new(gate);
    let worker = Worker::new(settings, move |inbox: &Inbox<u32, u32>| {
        while let Some((request, control)) = inbox.next() {
            started.send((request, control.clone())).unwrap();
            gate.lock().unwrap().recv().unwrap();
            inbox.publish_unless_cancelled(&control, request);
        }
    });
    (worker, starts, leave)
}

/// Waits for signals until a result can be taken.
fn result<Q: Send + 'static, R: Send + 'static>(worker: &Worker<Q, R>, woken: &Receiver<()>) -> Result<R, String> {
    loop {
        woken.recv().unwrap();
        if let Some(result) = worker.take() {
            return result;
        }
    }
}

#[test]
fn only_the_newest_request_is_worked_on_and_the_older_one_is_cancelled() {
    let (wake, woken) = signals();
    let (mut worker, starts, leave) = gated(SETTINGS);
    let first = worker.request(1, &wake);
    assert_eq!(starts.recv().unwrap().0, 1);
    let second = worker.request(2, &wake);
    worker.request(3, &wake);
    assert!(first.is_cancelled() && !second.is_cancelled() && worker.is_busy());
    leave.send(()).unwrap();
    leave.send(()).unwrap();
    assert_eq!(starts.recv().unwrap().0, 3, "the second request was replaced before it was taken");
    assert_eq!(result(&worker, &woken), Ok(3), "a cancelled request has no result");
}

#[test]
fn work_is_interrupted_only_after_its_first_result_where_the_settings_say_so() {
    let (wake, woken) = signals();
    let (published, leave) = (channel(), channel());
    let leaves = Mutex::new(leave.1);
    let settings = WorkerSettings { interrupt: Interrupt::AfterResult, ..SETTINGS };
    let mut worker = Worker::new(settings, move |inbox: &Inbox<u32, u32>| {
        while let Some((request, _)) = inbox.next() {
            published.0.send(()).unwrap();
            leaves.lock().unwrap().recv().unwrap();
            inbox.publish(request);
            published.0.send(()).unwrap();
            leaves.lock().unwrap().recv().unwrap();
        }
    });
    let first = worker.request(1, &wake);
    published.1.recv().unwrap();
    let second = worker.request(2, &wake);
    assert!(!first.is_cancelled(), "there is no result yet");
    leave.0.send(()).unwrap();
    published.1.recv().unwrap();
    assert_eq!(result(&worker, &woken), Ok(1));
    assert!(first.is_cancelled(), "there is a newer request");
    (0..2).for_each(|_| leave.0.send(()).unwrap());
    (0..2).for_each(|_| published.1.recv().unwrap());
    assert_eq!(result(&worker, &woken), Ok(2));
    worker.request(3, &wake);
    assert!(second.is_cancelled());
    (0..2).for_each(|_| leave.0.send(()).unwrap());
    assert_eq!(result(&worker, &woken), Ok(3));
}

#[test]
fn a_panic_becomes_an_error_and_the_next_request_is_served() {
    let (wake, woken) = signals();
    let mut worker = Worker::new(SETTINGS, |inbox: &Inbox<u32, u32>| {
        while let Some((request, _)) = inbox.next() {
            assert!(request != 13, "an unlucky number");
            inbox.publish(request);
        }
    });
    worker.request(13, &wake);
    assert_eq!(result(&worker, &woken), Err("It panicked.".to_owned()));
    worker.request(14, &wake);
    assert_eq!(result(&worker, &woken), Ok(14));
}

#[test]
fn a_dropped_worker_cancels_its_work_and_ends_its_thread() {
    let (wake, _woken) = signals();
    let (mut worker, starts, leave) = gated(SETTINGS);
    worker.request(1, &wake);
    let (_, control) = starts.recv().unwrap();
    drop(worker);
    assert!(control.is_cancelled());
    leave.send(()).unwrap();
    assert!(starts.recv().is_err(), "the thread has dropped its sender");
}

#[test]
fn reset_discards_request_and_result() {
    let (wake, woken) = signals();
    let (mut worker, starts, leave) = gated(SETTINGS);
    let control = worker.request(1, &wake);
    starts.recv().unwrap();
    worker.reset();
    leave.send(()).unwrap();
    // The signal at the end of the work: it left no result.
    woken.recv().unwrap();
    assert!(control.is_cancelled() && worker.take().is_none());
}

#[test]
fn requests_wait_while_the_worker_is_paused() {
    let (wake, woken) = signals();
    let mut worker = Worker::new(SETTINGS, |inbox: &Inbox<u32, u32>| {
        let next = |pending: &mut Pending<'_, u32, u32>| match pending.is_paused() {
            true => None,
            false => pending.take_request(),
        };
        while let Some((request, _)) = inbox.next_step(next) {
            inbox.publish(request);
        }
    });
    worker.pause(true);
    worker.request(1, &wake);
    assert!(worker.is_busy() && worker.take().is_none());
    worker.request(2, &wake);
    worker.pause(false);
    assert_eq!(result(&worker, &woken), Ok(2));
}

#[test]
fn lists_of_requests_and_of_results_grow_until_they_are_taken() {
    let (wake, woken) = signals();
    let mut worker = Worker::new(SETTINGS, |inbox: &Inbox<Vec<u32>, Vec<u32>>| {
        while let Some(item) = inbox.next_step(|pending| pending.take_part(Vec::pop)) {
            inbox.publish_with(|pending| [pending.unwrap_or_default(), vec![item]].concat());
        }
    });
    let mut results = Vec::new();
    for item in 0..20 {
        worker.request_with(Arc::default(), &wake, |pending| [pending.unwrap_or_default(), vec![item]].concat());
    }
    while results.len() < 20 {
        results.extend(result(&worker, &woken).unwrap());
    }
    results.sort_unstable();
    assert_eq!(results, (0..20).collect::<Vec<u32>>());
}
