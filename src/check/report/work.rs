//! How much a check may still do: distances and residuals are counted, and the clock is read now and then.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Distances and residuals between two readings of the clock.
const LOOK: u64 = 16;
/// What is still done once a promise is broken: enough to tell what else is, little beside a proof.
const AFTER_REFUSAL: u64 = 4_000;

/// Why a check stopped before its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stop {
    WorkLimit,
    TimeLimit,
    Cancelled,
    /// A promise is broken already.
    Refused,
}

impl Stop {
    pub(crate) fn told(self) -> &'static str {
        match self {
            Self::WorkLimit => "the work limit is reached",
            Self::TimeLimit => "the time limit is reached",
            Self::Cancelled => "the check was cancelled",
            Self::Refused => "the path is refused already",
        }
    }
}

/// What is left of the work that a check may be.
pub(crate) struct Work {
    left: u64,
    deadline: Option<Instant>,
    cancelled: Option<Arc<AtomicBool>>,
    until_look: u64,
    refused: bool,
    stop: Option<Stop>,
}

impl Work {
    pub(crate) fn new(left: u64, deadline: Option<Instant>, cancelled: Option<Arc<AtomicBool>>) -> Self {
        Self { left, deadline, cancelled, until_look: LOOK, refused: false, stop: None }
    }

    /// Whether there was this much left. Once there was not there never is again.
    pub(crate) fn spend(&mut self, amount: u64) -> bool {
        self.until_look = self.until_look.saturating_sub(amount);
        if self.until_look == 0 {
            self.look();
        }
        if self.stop.is_none() && self.left < amount {
            self.stop = Some(if self.refused { Stop::Refused } else { Stop::WorkLimit });
        }
        if self.stop.is_some() {
            return false;
        }
        self.left -= amount;
        true
    }

    /// Reads the clock, and whether somebody wants an end.
    pub(crate) fn look(&mut self) {
        self.until_look = LOOK;
        if self.stop.is_none() && self.cancelled.as_ref().is_some_and(|cancelled| cancelled.load(Ordering::Relaxed)) {
            self.stop = Some(Stop::Cancelled);
        }
        if self.stop.is_none() && self.deadline.is_some_and(|deadline| Instant::now() >= deadline) {
            self.stop = Some(Stop::TimeLimit);
        }
    }

    /// A promise is broken: what else is found adds little.
    pub(crate) fn refused(&mut self) {
        if !self.refused {
            self.refused = true;
            self.left = self.left.min(AFTER_REFUSAL);
        }
    }

    pub(crate) fn is_over(&self) -> bool {
        self.stop.is_some()
    }

    /// Why there is nothing left, where there is nothing.
    pub(crate) fn stop(&self) -> Option<Stop> {
        self.stop
    }
}
