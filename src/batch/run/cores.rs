//! As many threads at once as a batch may use, however many each of its solves takes.

use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// Threads to share. Who asks first is served first: a solve that needs many is not overtaken for ever by those that need few.
#[derive(Debug)]
pub(crate) struct Cores {
    all: usize,
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Debug)]
struct State {
    free: usize,
    /// Number that the next to ask gets.
    next: u64,
    /// Number that is served next.
    served: u64,
}

/// Threads that are taken; they are given back when this goes.
#[derive(Debug)]
pub(crate) struct Taken<'a> {
    from: &'a Cores,
    count: usize,
}

impl Cores {
    pub(crate) fn new(all: usize) -> Self {
        let all = all.max(1);
        Self { all, state: Mutex::new(State { free: all, next: 0, served: 0 }), changed: Condvar::new() }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits for so many threads; for all, where more are asked for than there are.
    pub(crate) fn take(&self, count: usize) -> Taken<'_> {
        let count = count.clamp(1, self.all);
        let mut state = self.state();
        let number = state.next;
        state.next += 1;
        while state.served != number || state.free < count {
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
        state.served += 1;
        state.free -= count;
        drop(state);
        self.changed.notify_all();
        Taken { from: self, count }
    }
}

impl Drop for Taken<'_> {
    fn drop(&mut self) {
        self.from.state().free += self.count;
        self.from.changed.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use super::Cores;
    use std::sync::atomic::{AtomicUsize, Ordering};

    #[test]
    fn no_more_threads_run_than_there_are_and_all_are_served() {
        let (cores, running, most) = (Cores::new(3), AtomicUsize::new(0), AtomicUsize::new(0));
        let served = AtomicUsize::new(0);
        std::thread::scope(|scope| {
            for worker in 0..6_usize {
                let (cores, running, most, served) = (&cores, &running, &most, &served);
                scope.spawn(move || {
                    for round in 0..50 {
                        let count = 1 + (worker + round) % 4;
                        let taken = cores.take(count);
                        let now = running.fetch_add(count.min(3), Ordering::SeqCst) + count.min(3);
                        most.fetch_max(now, Ordering::SeqCst);
                        served.fetch_add(1, Ordering::SeqCst);
                        running.fetch_sub(count.min(3), Ordering::SeqCst);
                        drop(taken);
                    }
                });
            }
        });
        assert_eq!((served.load(Ordering::SeqCst), most.load(Ordering::SeqCst)), (300, 3));
    }
}
