//! Threads that work for a caller who takes what they have made in the order in which it was asked for.

use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, bounded, unbounded};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::collections::VecDeque;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Work that one of the threads does.
type Work = Box<dyn FnOnce() + Send>;
/// What work has made, or the payload of its panic.
type Made<T> = std::thread::Result<T>;

/// Threads that each do one piece of work at a time, with a rayon pool of one thread: what is planned in it uses that thread alone. Pieces are
/// begun in the order in which they were added; [`Self::take`] gives what they made in the same order.
///
/// Where it is dropped, pieces that were not begun never are, and those under way are waited for.
#[derive(Debug)]
pub struct Pool<T> {
    /// None once the pool ends.
    work: Option<Sender<Work>>,
    waiting: VecDeque<Receiver<Made<T>>>,
    /// Nothing more is to be begun.
    has_ended: Arc<AtomicBool>,
    /// Rayon pools of one thread, which works until the pool ends.
    threads: Vec<ThreadPool>,
    /// Disconnected once no thread works any more.
    working: Receiver<()>,
}

impl<T: Send + 'static> Pool<T> {
    /// So many threads, at least one.
    ///
    /// # Errors
    /// The operating system refuses them.
    pub fn new(threads: usize) -> io::Result<Self> {
        let (sender, receiver) = unbounded::<Work>();
        let (works, working) = bounded(0);
        let start = |number: usize| {
            let name = move |_| format!("plan {number}");
            let thread = ThreadPoolBuilder::new().num_threads(1).thread_name(name).build().map_err(io::Error::other)?;
            let (receiver, works) = (receiver.clone(), works.clone());
            thread.spawn(move || work_on(&receiver, works));
            Ok(thread)
        };
        let threads = (0..threads.max(1)).map(start).collect::<io::Result<_>>()?;
        Ok(Self { work: Some(sender), waiting: VecDeque::new(), has_ended: Arc::default(), threads, working })
    }

    /// How many threads there are.
    #[must_use]
    pub fn threads(&self) -> usize {
        self.threads.len()
    }

    /// Pieces of work that were added and not taken.
    #[must_use]
    pub fn len(&self) -> usize {
        self.waiting.len()
    }

    /// Whether there is nothing to take.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.waiting.is_empty()
    }

    /// Adds a piece of work.
    pub fn add(&mut self, work: impl FnOnce() -> T + Send + 'static) {
        let (made, waiting) = bounded(1);
        let has_ended = Arc::clone(&self.has_ended);
        let piece: Work = Box::new(move || {
            if !has_ended.load(Ordering::Relaxed) {
                let _is_taken = made.send(catch_unwind(AssertUnwindSafe(work)));
            }
        });
        let sent = self.work.as_ref().map(|sender| sender.send(piece));
        debug_assert!(matches!(sent, Some(Ok(()))), "the threads wait as long as the pool is there");
        self.waiting.push_back(waiting);
    }

    /// What the piece that was added first has made, once it has; `None` where none is left.
    ///
    /// # Panics
    /// If that piece has panicked, with its payload.
    pub fn take(&mut self) -> Option<T> {
        let made = self.waiting.pop_front()?.recv();
        made.ok().map(|made| made.unwrap_or_else(|payload| resume_unwind(payload)))
    }

    /// As [`Self::take`], but waits no longer than this: `None` where it is not made by then. [`Self::is_empty`] tells that none is left.
    ///
    /// # Panics
    /// As [`Self::take`].
    pub fn take_within(&mut self, patience: Duration) -> Option<T> {
        match self.waiting.front()?.recv_timeout(patience) {
            Err(RecvTimeoutError::Timeout) => None,
            Err(RecvTimeoutError::Disconnected) => {
                self.waiting.pop_front();
                None
            }
            Ok(made) => {
                self.waiting.pop_front();
                Some(made.unwrap_or_else(|payload| resume_unwind(payload)))
            }
        }
    }
}

/// Works until no more comes.
fn work_on(receiver: &Receiver<Work>, _works: Sender<()>) {
    receiver.iter().for_each(|work| work());
}

impl<T> Drop for Pool<T> {
    fn drop(&mut self) {
        self.has_ended.store(true, Ordering::Relaxed);
        self.work = None;
        self.waiting.clear();
        // Nothing is ever sent: this waits for the threads.
        let _disconnected = self.working.recv();
    }
}

#[cfg(test)]
mod tests {
    use super::Pool;
    use std::time::Duration;

    #[test]
    fn what_is_made_comes_in_order_and_panics_come_to_who_takes() {
        let mut pool = Pool::new(3).unwrap();
        for number in 0..40_u64 {
            pool.add(move || {
                std::thread::sleep(Duration::from_millis((number * 7) % 5));
                assert_ne!(number, 20);
                number
            });
        }
        assert_eq!((pool.len(), pool.threads()), (40, 3));
        assert!((0..20).all(|number| pool.take() == Some(number)));
        assert!(std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| pool.take())).is_err());
        assert!((21..40).all(|number| pool.take() == Some(number)));
        assert_eq!(pool.take(), None);
    }

    #[test]
    fn patience_ends() {
        let mut pool = Pool::new(1).unwrap();
        pool.add(|| std::thread::sleep(Duration::from_millis(300)));
        assert_eq!(pool.take_within(Duration::from_millis(1)), None);
        assert!(!pool.is_empty());
        assert_eq!(pool.take_within(Duration::from_secs(60)), Some(()));
        assert!(pool.is_empty());
    }
}
