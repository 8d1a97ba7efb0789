//! Working memory that outlives a step: parallel systems borrow buffers that are warm already instead of growing new ones.

use std::ops::{Deref, DerefMut};
use std::sync::{Mutex, PoisonError};

/// Buffers of one system, to be kept in a `Local` of it. What they hold may differ from thread to thread and from step to step, so
/// nothing of it may change an answer.
#[derive(Debug, Default)]
pub struct ScratchPool<T>(Mutex<Vec<T>>);

impl<T: Default> ScratchPool<T> {
    /// Buffers that are not in use elsewhere; they come back when they are dropped.
    pub fn borrow(&self) -> Borrowed<'_, T> {
        let known = self.0.lock().unwrap_or_else(PoisonError::into_inner).pop();
        Borrowed { buffers: known.unwrap_or_default(), pool: self }
    }
}

/// Buffers on loan.
#[derive(Debug)]
pub struct Borrowed<'a, T: Default> {
    buffers: T,
    pool: &'a ScratchPool<T>,
}

impl<T: Default> Deref for Borrowed<'_, T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.buffers
    }
}

impl<T: Default> DerefMut for Borrowed<'_, T> {
    fn deref_mut(&mut self) -> &mut T {
        &mut self.buffers
    }
}

impl<T: Default> Drop for Borrowed<'_, T> {
    fn drop(&mut self) {
        let buffers = std::mem::take(&mut self.buffers);
        self.pool.0.lock().unwrap_or_else(PoisonError::into_inner).push(buffers);
    }
}
