//! What the processor spent on this thread, where the system tells it exactly.

use std::time::Duration;

/// Time that this thread has had on a processor so far; none where the system does not tell.
#[cfg(target_os = "linux")]
pub(crate) fn of_this_thread() -> Option<Duration> {
    let time = nix::time::clock_gettime(nix::time::ClockId::CLOCK_THREAD_CPUTIME_ID).ok()?;
    Some(time.into())
}

/// Time that this thread has had on a processor so far; none where the system does not tell.
#[cfg(not(target_os = "linux"))]
pub(crate) fn of_this_thread() -> Option<Duration> {
    None
}

/// What was spent since then.
pub(crate) fn since(then: Option<Duration>) -> Option<Duration> {
    of_this_thread()?.checked_sub(then?)
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;
    use std::time::Instant;

    #[test]
    fn work_counts_and_sleep_does_not() {
        let then = of_this_thread();
        std::thread::sleep(Duration::from_millis(100));
        assert!(since(then).unwrap() < Duration::from_millis(50));
        let started = Instant::now();
        while since(then).unwrap() < Duration::from_millis(60) {
            assert!(started.elapsed() < Duration::from_secs(60), "{:?}", since(then));
        }
    }
}
