//! Threads that stay awake while a search runs, and what they do when it has no work to share.
//!
//! The parallel sections of a step take some hundred microseconds each and serial systems lie between them. A thread of the
//! pool that finds nothing to steal goes to sleep after a few of them, and waking it costs as much as a section is worth. So
//! the other threads *watch*: they look for work again and again, for a while. One that finds none does an idle task, if some
//! were left: work whose result may be asked for later, and is the same whoever does it and whether or not it is done.
//! Neither can change an answer.

use bevy_ecs::prelude::Resource;
use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// Looks in vain after which a watching thread leaves: some milliseconds. The next step calls it back.
const PATIENCE: u32 = 1 << 13;

/// Of so many looks in vain one offers the core to other processes.
const YIELD: u32 = 16;

/// What is left for threads that have nothing else to do. Clones share one list.
#[derive(Clone, Default, Resource)]
pub struct IdleTasks(Arc<List>);

type IdleTask = Box<dyn FnOnce() + Send>;

#[derive(Default)]
struct List {
    waiting: Mutex<VecDeque<IdleTask>>,
    /// Idle tasks that wait, to be looked at without a lock.
    count: AtomicUsize,
    /// Threads that watch.
    watching: AtomicUsize,
}

impl IdleTasks {
    /// Whether anybody would do an idle task.
    #[must_use]
    pub fn are_done(&self) -> bool {
        self.0.watching.load(Ordering::Relaxed) > 0
    }

    /// Leaves idle tasks instead of those that still wait. A panic in one of them ends with it.
    pub(crate) fn replace(&self, idle_tasks: impl Iterator<Item = IdleTask>) {
        let mut waiting = self.0.waiting.lock().unwrap_or_else(PoisonError::into_inner);
        waiting.clear();
        waiting.extend(idle_tasks);
        self.0.count.store(waiting.len(), Ordering::Relaxed);
    }

    /// As if somebody watched.
    #[cfg(test)]
    pub(crate) fn pretend(&self) {
        self.0.watching.fetch_add(1, Ordering::Relaxed);
    }

    /// Does the idle task that has waited longest; `false` where there is none.
    pub(crate) fn do_one(&self) -> bool {
        if self.0.count.load(Ordering::Relaxed) == 0 {
            return false;
        }
        let mut waiting = self.0.waiting.lock().unwrap_or_else(PoisonError::into_inner);
        let idle_task = waiting.pop_front();
        self.0.count.store(waiting.len(), Ordering::Relaxed);
        drop(waiting);
        let Some(idle_task) = idle_task else { return false };
        let _panicked = catch_unwind(AssertUnwindSafe(idle_task));
        true
    }
}

/// The other threads of the pool in which it was made watch until it is dropped.
pub(crate) struct Watch(Option<Arc<Post>>);

struct Post {
    idle_tasks: IdleTasks,
    /// The thread that runs the search.
    own: usize,
    /// Threads that may watch at once: no more than there are cores for, once a thread has found out.
    most: AtomicUsize,
    /// By thread of the pool.
    watches: Vec<AtomicBool>,
    is_over: AtomicBool,
}

impl Watch {
    /// Outside of a pool, in a pool of one and on a single core nobody watches.
    pub(crate) fn begin(idle_tasks: &IdleTasks) -> Self {
        let threads = rayon::current_num_threads();
        let post = |own| Post {
            idle_tasks: idle_tasks.clone(),
            own,
            most: AtomicUsize::new(threads - 1),
            watches: (0..threads).map(|_| AtomicBool::new(false)).collect(),
            is_over: AtomicBool::new(false),
        };
        Self(rayon::current_thread_index().filter(|_| threads > 1).map(|own| Arc::new(post(own))))
    }

    /// Calls back who has left.
    pub(crate) fn call(&self) {
        let Some(post) = &self.0 else { return };
        if post.idle_tasks.0.watching.load(Ordering::Relaxed) < post.most.load(Ordering::Relaxed) {
            let post = Arc::clone(post);
            rayon::spawn_broadcast(move |context| post.keep(context.index()));
        }
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        if let Some(post) = &self.0 {
            post.is_over.store(true, Ordering::Relaxed);
            post.idle_tasks.replace(std::iter::empty());
        }
    }
}

impl Post {
    /// Looks for work until it is over, or nothing was found for long.
    fn keep(&self, thread: usize) {
        // Whoever looks for work may come upon the next call.
        if thread == self.own || self.watches[thread].swap(true, Ordering::Relaxed) {
            return;
        }
        // To ask for the cores takes longer than a search may wait.
        let most = self.most.fetch_min(cores() - 1, Ordering::Relaxed).min(cores() - 1);
        let watching = &self.idle_tasks.0.watching;
        if watching.fetch_add(1, Ordering::Relaxed) < most {
            let mut in_vain = 0;
            while in_vain < PATIENCE && !self.is_over.load(Ordering::Relaxed) {
                let found = rayon::yield_now() == Some(rayon::Yield::Executed) || self.idle_tasks.do_one();
                in_vain = if found { 0 } else { in_vain + 1 };
                rest(in_vain);
            }
        }
        watching.fetch_sub(1, Ordering::Relaxed);
        self.watches[thread].store(false, Ordering::Relaxed);
    }
}

/// Waits for something that another thread is about to bring about, for a while.
pub(crate) fn wait_for(is_so: impl Fn() -> bool) {
    let mut in_vain = 0;
    while in_vain < PATIENCE && !is_so() {
        in_vain += 1;
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
    use super::{IdleTasks, Watch, wait_for};
    use crate::runtime::idle_tasks::cores;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicUsize, Ordering};

    #[test]
    fn errands_are_done_one_by_one_and_a_panic_ends_with_its_own() {
        let (idle_tasks, done) = (IdleTasks::default(), Arc::new(AtomicUsize::new(0)));
        let idle_task = |number: usize| {
            let done = Arc::clone(&done);
            let work = move || {
                assert_ne!(number, 1, "an errand that fails");
                done.fetch_add(number, Ordering::Relaxed);
            };
            Box::new(work) as Box<dyn FnOnce() + Send>
        };
        idle_tasks.replace([idle_task(50)].into_iter());
        idle_tasks.replace([idle_task(1), idle_task(2), idle_task(3)].into_iter());
        assert!(idle_tasks.do_one() && idle_tasks.do_one());
        assert_eq!(done.load(Ordering::Relaxed), 2);
        assert!(idle_tasks.do_one() && !idle_tasks.do_one());
        assert_eq!(done.load(Ordering::Relaxed), 5);
    }

    #[test]
    fn threads_watch_while_they_are_wanted() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build();
        let idle_tasks = IdleTasks::default();
        let run = || {
            let watch = Watch::begin(&idle_tasks);
            (0..3).for_each(|_| watch.call());
            let watching = || idle_tasks.0.watching.load(Ordering::Relaxed);
            while cores() > 1 && watching() == 0 {
                std::thread::yield_now();
            }
            // Sections find their threads, and nobody is taken twice.
            for _ in 0..100 {
                let (a, b) = rayon::join(|| 1, || 2);
                assert_eq!(a + b, 3);
                watch.call();
            }
            drop(watch);
            while watching() > 0 {
                std::thread::yield_now();
            }
        };
        assert!(pool.as_ref().map(|pool| pool.install(run)).is_ok());
        wait_for(|| true);
    }
}
