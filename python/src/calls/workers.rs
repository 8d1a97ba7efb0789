//! Threads that work for calls of Python, one call at a time each.
//!
//! Each is a rayon pool of one thread: a search on one thread uses it. A thread that has worked waits for more: it keeps the memory that it got
//! from the system, which a new thread for each call would ask for again.

use rayon::{ThreadPool, ThreadPoolBuilder};
use std::sync::{Arc, Mutex, PoisonError};

pub(crate) type Work = Box<dyn FnOnce() + Send>;

/// The threads that wait, and the process that they belong to: a fork has none of them.
struct Waiting {
    process: u32,
    threads: Vec<Arc<ThreadPool>>,
}

static WAITING: Mutex<Waiting> = Mutex::new(Waiting { process: 0, threads: Vec::new() });

/// Works on a thread that waits, or on a new one. The work does not panic.
pub(crate) fn run(work: Work) {
    let new = || ThreadPoolBuilder::new().num_threads(1).build().map(Arc::new);
    match waiting(Vec::pop).map_or_else(new, Ok) {
        Ok(thread) => {
            let own = Arc::clone(&thread);
            thread.spawn(move || {
                work();
                waiting(|threads| threads.push(own));
            });
        }
        // The system refuses a thread. Who waits for the work is told by its channel.
        Err(_) => drop(work),
    }
}

fn waiting<T>(look: impl FnOnce(&mut Vec<Arc<ThreadPool>>) -> T) -> T {
    let mut waiting = WAITING.lock().unwrap_or_else(PoisonError::into_inner);
    let process = std::process::id();
    if waiting.process != process {
        // Threads of another process cannot be told to end.
        std::mem::forget(std::mem::take(&mut waiting.threads));
        waiting.process = process;
    }
    look(&mut waiting.threads)
}
