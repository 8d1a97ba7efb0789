//! The limit of memory where no search checks it: while files are read and paths are checked.

use crate::cli::console::print::say;
use crate::memory::{MemoryLimit, resident};
use std::io::Write;
use std::time::Duration;

/// Between two readings of the memory of the process.
const INTERVAL: Duration = Duration::from_millis(20);
/// Beyond the limit, of which a search that ends by itself gets rid: an eighth.
const SLACK: u64 = 8;

/// From now on the process ends, with exit code 2 and a sentence, soon after it takes an eighth more memory than it may. Searches
/// stop at the limit itself, with an outcome; what is left to this are readers, and a single step that asks for too much.
pub(crate) fn start(limit: MemoryLimit) {
    let most = limit.get().saturating_add(limit.get() / SLACK);
    let watch = move || {
        loop {
            std::thread::sleep(INTERVAL);
            if resident().is_some_and(|bytes| bytes > most) {
                say(&format!("error: the memory limit of {limit} is reached; --memory-limit sets another\n"));
                let _flushed = std::io::stdout().flush();
                std::process::exit(2);
            }
        }
    };
    // Without a thread there is no watch; the program works as well.
    let _unwatched = std::thread::Builder::new().name("memory".into()).spawn(watch);
}
