//! Work on many slots by all threads of the pool.

use crate::runtime::watch::wait_for;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Fewer candidates than these are not worth another thread.
pub const LEAST_SHARED: usize = 8;

/// Does `work` on every item: threads take one item after another from the front, each with a scratch of its own, so that
/// no thread waits while items are left, and the first are begun first. Items are of unequal length (one candidate's motions
/// take a hundred times another's), so that halves of the list would not be halves of the work. What comes out must not
/// depend on the scratch, and then does not depend on the threads.
pub fn each<T: Send, S>(items: &mut [T], scratch: impl Fn() -> S + Sync, work: impl Fn(&mut S, &mut T) + Sync) {
    let workers = rayon::current_num_threads().min(items.len());
    if workers <= 1 {
        let mut scratch = scratch();
        return items.iter_mut().for_each(|item| work(&mut scratch, item));
    }
    let unfinished = AtomicUsize::new(items.len());
    let caller = rayon::current_thread_index();
    let queue = Mutex::new(items.iter_mut());
    // A panic in `work` leaves the queue as sound as it was.
    let next = || queue.lock().unwrap_or_else(PoisonError::into_inner).next();
    (0..workers).into_par_iter().with_max_len(1).for_each(|_| {
        let mut own = None;
        while let Some(item) = next() {
            work(own.get_or_insert_with(&scratch), item);
            unfinished.fetch_sub(1, Ordering::Relaxed);
        }
        // The caller goes on when all is done: it must not fall asleep over the last items.
        if caller.is_some() && rayon::current_thread_index() == caller {
            wait_for(|| unfinished.load(Ordering::Relaxed) == 0);
        }
    });
}

/// Does `work` on every run of neighbouring items that are of the `same` kind. Each thread takes one part of the list, so that a
/// long run may come in two; what comes out must not depend on that, nor on the scratch.
pub fn runs<T: Send, S>(
    items: &mut [T],
    same: impl Fn(&T, &T) -> bool + Sync,
    scratch: impl Fn() -> S + Sync,
    work: impl Fn(&mut S, &mut [T]) + Sync,
) {
    let part = items.len().div_ceil(rayon::current_num_threads()).max(LEAST_SHARED);
    items.par_chunks_mut(part).for_each(|part| {
        let mut scratch = scratch();
        part.chunk_by_mut(&same).for_each(|run| work(&mut scratch, run));
    });
}

#[cfg(test)]
mod tests {
    use super::{each, runs};

    #[test]
    fn every_item_is_worked_on_once() {
        for threads in [1, 2, 5] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            for count in [0, 1, 2, 100] {
                let mut items = vec![1; count];
                let run = || each(&mut items, || 2, |two, item| *item += *two);
                assert!(pool.as_ref().map(|pool| pool.install(run)).is_ok());
                assert_eq!(items, vec![3; count]);
            }
        }
    }

    #[test]
    fn runs_are_of_one_kind_and_leave_nothing_out() {
        for threads in [1, 2, 5] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            for count in [0, 1, 7, 100] {
                let mut items: Vec<_> = (0..count).map(|index| (index / 10, 0)).collect();
                let add = |_: &mut (), run: &mut [(i32, i32)]| {
                    let kind = run[0].0;
                    run.iter_mut().for_each(|item| item.1 += i32::from(item.0 == kind));
                };
                let run = || runs(&mut items, |a, b| a.0 == b.0, || (), add);
                assert!(pool.as_ref().map(|pool| pool.install(run)).is_ok());
                assert!(items.iter().all(|item| item.1 == 1));
            }
        }
    }
}
