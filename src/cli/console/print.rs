//! Standard output and standard error, and how a command may end.

use crate::scene::SceneError;
use std::io::Write;
use std::sync::OnceLock;

/// How a command ended that did what it was asked.
pub(crate) enum Ending {
    /// Exit code 0.
    Done,
    /// Exit code 1: no solution within limits, a check that fails, something that is not there.
    Failed,
    /// Exit code 3: what is proved holds only relative to what a file says of itself.
    Relative,
    /// Exit code 4: undecided within the limits of work, time or resolution.
    Undecided,
    /// Exit code 130: a signal has stopped it.
    Interrupted,
}

/// Why a command did not do what it was asked: exit code 2, and what is said on standard error.
pub(crate) struct Refusal(pub String);

impl From<SceneError> for Refusal {
    fn from(error: SceneError) -> Self {
        Self(error.to_string())
    }
}

/// Why output was lost, once it was: no command may end as if it had told what it found.
pub(crate) static LOST: OnceLock<std::io::Error> = OnceLock::new();

/// A reader that has gone away has read what it wanted; the verdict stands, and so does the exit code.
pub(crate) fn lose(error: std::io::Error) {
    if error.kind() != std::io::ErrorKind::BrokenPipe {
        let _the_first_is_told = LOST.set(error);
    }
}

/// Writes to standard output. What cannot be written makes the program end with exit code 2, see `command_line::main`.
pub(crate) fn print(text: &str) {
    let mut out = std::io::stdout().lock();
    if let Err(error) = out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        lose(error);
    }
}

/// Writes to standard error.
pub(crate) fn say(text: &str) {
    let _gone = std::io::stderr().lock().write_all(text.as_bytes());
}

/// Writes an object as one line of JSON.
pub(crate) fn print_json(value: &impl serde::Serialize) -> Result<(), Refusal> {
    let text = serde_json::to_string(value).map_err(|e| Refusal(format!("cannot write JSON: {e}")))?;
    print(&format!("{text}\n"));
    Ok(())
}
