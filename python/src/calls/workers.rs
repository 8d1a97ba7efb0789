//! Threads that work for calls of Python, one call at a time each.
//!
//! A thread that has worked waits for more: it keeps the memory that it got from the system, which a new thread for each call would ask for again.

use foliate::crossbeam_channel::{Sender, bounded};
use std::sync::{Mutex, PoisonError};

pub(crate) type Work = Box<dyn FnOnce() + Send>;

/// The threads that wait, and the process that they belong to: a fork has none of them.
struct Waiting {
    process: u32,
    threads: Vec<Sender<Work>>,
}

static WAITING: Mutex<Waiting> = Mutex::new(Waiting { process: 0, threads: Vec::new() });

/// Works on a thread that waits, or on a new one. The work does not panic.
pub(crate) fn run(work: Work) {
    let work = match waiting(|threads| threads.pop()) {
        Some(thread) => match thread.send(work) {
            Ok(()) => return,
            Err(refused) => refused.into_inner(),
        },
        None => work,
    };
    std::thread::spawn(move || {
        // A search on one thread uses this one.
        let alone = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build();
        let do_here = |work: Work| match &alone {
            Ok(pool) => pool.install(work),
            Err(_) => work(),
        };
        let (sender, more) = bounded::<Work>(1);
        do_here(work);
        loop {
            waiting(|threads| threads.push(sender.clone()));
            match more.recv() {
                Ok(work) => do_here(work),
                Err(_) => return,
            }
        }
    });
}

fn waiting<T>(look: impl FnOnce(&mut Vec<Sender<Work>>) -> T) -> T {
    let mut waiting = WAITING.lock().unwrap_or_else(PoisonError::into_inner);
    let process = std::process::id();
    if waiting.process != process {
        *waiting = Waiting { process, threads: Vec::new() };
    }
    look(&mut waiting.threads)
}
