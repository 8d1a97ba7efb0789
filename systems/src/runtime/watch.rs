//! Keeps the threads of a pool awake while a search runs.
//!
//! The parallel sections of a step take some hundred microseconds each, and serial systems lie between them. A thread of the
//! pool that finds nothing to steal goes to sleep after a few of them, and waking it costs as much as a section is worth. So
//! the other threads *watch*: they look for work again and again, for some milliseconds. This changes no answer.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};

/// Failed looks for work after which a watching thread leaves: some milliseconds. The next step calls it back.
const PATIENCE: u32 = 1 << 13;

/// Of so many failed looks one offers the core to other processes.
const YIELD: u32 = 16;

/// The other threads of the pool in which it was made watch until it is dropped.
pub(crate) struct Watch(Option<Arc<Post>>);

struct Post {
    /// The thread that runs the search.
    own: usize,
    /// Threads that may watch at once: no more than there are cores for, once a thread has found out.
    most: AtomicUsize,
    /// Threads that watch.
    watching: AtomicUsize,
    /// By thread of the pool.
    watches: Vec<AtomicBool>,
    is_over: AtomicBool,
}

impl Watch {
    /// Outside of a pool, in a pool of one and on a single core no thread watches.
    pub(crate) fn begin() -> Self {
        let threads = rayon::current_num_threads();
        let post = |own| Post {
            own,
            most: AtomicUsize::new(threads - 1),
            watching: AtomicUsize::new(0),
            watches: (0..threads).map(|_| AtomicBool::new(false)).collect(),
            is_over: AtomicBool::new(false),
        };
        Self(rayon::current_thread_index().filter(|_| threads > 1).map(|own| Arc::new(post(own))))
    }

    /// Calls back the threads that have left.
    pub(crate) fn call(&self) {
        let Some(post) = &self.0 else { return };
        if post.watching.load(Ordering::Relaxed) < post.most.load(Ordering::Relaxed) {
            let post = Arc::clone(post);
            rayon::spawn_broadcast(move |context| post.keep(context.index()));
        }
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        if let Some(post) = &self.0 {
            post.is_over.store(true, Ordering::Relaxed);
        }
    }
}

impl Post {
    /// Looks for work until the search is over, or nothing was found for long.
    fn keep(&self, thread: usize) {
        // A thread that looks for work may come upon the next call.
        if thread == self.own || self.watches[thread].swap(true, Ordering::Relaxed) {
            return;
        }
        // To ask for the cores takes longer than a search may wait.
        let most = self.most.fetch_min(cores() - 1, Ordering::Relaxed).min(cores() - 1);
        if self.watching.fetch_add(1, Ordering::Relaxed) < most {
            wait_until(|| self.is_over.load(Ordering::Relaxed), || rayon::yield_now() == Some(rayon::Yield::Executed));
        }
        self.watching.fetch_sub(1, Ordering::Relaxed);
        self.watches[thread].store(false, Ordering::Relaxed);
    }
}

/// Waits for something that another thread is about to bring about, for some milliseconds.
pub(crate) fn wait_for(is_so: impl Fn() -> bool) {
    wait_until(is_so, || false);
}

/// Waits until something is so, or until `work` was found to do nothing for some milliseconds.
fn wait_until(is_so: impl Fn() -> bool, work: impl Fn() -> bool) {
    let mut in_vain = 0;
    while in_vain < PATIENCE && !is_so() {
        in_vain = if work() { 0 } else { in_vain + 1 };
        rest(in_vain);
    }
}

/// A fraction of a microsecond.
fn rest(in_vain: u32) {
    if in_vain % YIELD == YIELD - 1 {
        std::thread::yield_now();
    } else {
        (0..8).for_each(|_| std::hint::spin_loop());
    }
}

/// Cores that this process may use; asked once.
fn cores() -> usize {
    static CORES: OnceLock<usize> = OnceLock::new();
    *CORES.get_or_init(|| std::thread::available_parallelism().map_or(1, usize::from))
}

#[cfg(test)]
mod tests {
    use super::{Watch, cores};
    use std::sync::atomic::Ordering;

    #[test]
    fn threads_watch_while_a_search_runs() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build();
        let run = || {
            let watch = Watch::begin();
            let post = watch.0.clone();
            assert!(post.is_some());
            let Some(post) = post else { return };
            (0..3).for_each(|_| watch.call());
            let watching = || post.watching.load(Ordering::Relaxed);
            while cores() > 1 && watching() == 0 {
                std::thread::yield_now();
            }
            // Sections find their threads, and no thread is taken twice.
            for _ in 0..100 {
                let (a, b) = rayon::join(|| 1, || 2);
                assert_eq!(a + b, 3);
                assert!(watching() <= 2);
                watch.call();
            }
            drop(watch);
            while watching() > 0 {
                std::thread::yield_now();
            }
        };
        assert!(pool.as_ref().map(|pool| pool.install(run)).is_ok());
    }
}
