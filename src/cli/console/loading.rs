//! Loading under the time limit and the signals of a command.

use crate::batch::Entry;
use crate::cli::console::interrupt;
use crate::cli::console::print::{Ending, Refusal, print, print_json};
use crate::components::outcome::SearchOutcome;
use crate::output;
use crate::scene::{LoadLimits, LoadStop, PackagePath, Scene, SceneError, StartFile, UpAxis};
use crate::systems::events::StopSignal;
use crate::systems::planning_model::ProblemTables;
use serde_json::json;
use std::sync::Arc;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// Between two checks of the token.
const INTERVAL: Duration = Duration::from_millis(20);
/// A file that is being written may take so long to be finished before the process ends without it.
const LONGEST_WRITE: Duration = Duration::from_millis(500);

/// The up axis that an option names.
pub(crate) fn up_axis(word: &str) -> Result<UpAxis, String> {
    UpAxis::of_word(word).ok_or_else(|| "it is `as-written` or `declared`".into())
}

/// Why there is nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Cut {
    /// The limit was reached.
    OutOfTime,
    /// A signal came.
    Interrupted,
}

/// Why work done beside has no result.
pub(crate) enum Failure {
    /// It was asked to stop.
    Stopped,
    /// Something is wrong.
    Refused(Refusal),
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        match error.stopped {
            Some(LoadStop::Deadline | LoadStop::Cancelled) => Self::Stopped,
            Some(LoadStop::Memory) | None => Self::Refused(error.into()),
        }
    }
}

impl From<Refusal> for Failure {
    fn from(refusal: Refusal) -> Self {
        Self::Refused(refusal)
    }
}

/// Does what may take long on a thread of its own, and waits for it until the limit is reached or a signal comes, and then as long as
/// `patience` says: some of it (a disk that does not answer, say) checks no signal. What is left to itself ends with the process,
/// but for a file that it is just writing.
pub(crate) fn beside<T: Send + 'static>(
    limit: Duration,
    patience: Duration,
    work: impl FnOnce(&StopSignal) -> Result<T, Failure> + Send + 'static,
) -> Result<Result<T, Cut>, Refusal> {
    let token = interrupt::token();
    let deadline = Instant::now().checked_add(limit);
    let stop = StopSignal { deadline, token: token.clone(), memory: None };
    let (sender, receiver) = channel();
    let (signal, mut asked) = (stop.clone(), None);
    std::thread::spawn(move || {
        let _gone = sender.send(work(&signal));
    });
    let cut = || if token.is_cancelled() { Cut::Interrupted } else { Cut::OutOfTime };
    loop {
        let left = deadline.map_or(INTERVAL, |deadline| deadline.saturating_duration_since(Instant::now()));
        let pause = if left.is_zero() { INTERVAL / 10 } else { left.min(INTERVAL) };
        match receiver.recv_timeout(pause) {
            Ok(Ok(done)) => return Ok(Ok(done)),
            Ok(Err(Failure::Stopped)) => return Ok(Err(cut())),
            Ok(Err(Failure::Refused(refusal))) => return Err(refusal),
            Err(RecvTimeoutError::Disconnected) => return Err(Refusal("reading ended without an answer".into())),
            Err(RecvTimeoutError::Timeout) if !stop.is_raised() => {}
            Err(RecvTimeoutError::Timeout) => {
                let waited = asked.get_or_insert_with(Instant::now).elapsed();
                if waited >= patience && (waited >= LONGEST_WRITE || !output::is_writing()) {
                    return Ok(Err(cut()));
                }
            }
        }
    }
}

/// The same places to look for packages, for reading that ends with the signal.
pub(crate) fn until(packages: &PackagePath, stop: &StopSignal) -> PackagePath {
    let limits = LoadLimits { stop: stop.clone(), ..packages.limits().clone() };
    packages.clone().with_limits(limits)
}

/// A scene with its tables.
pub(crate) fn scene(
    name: &str,
    packages: &PackagePath,
    limit: Duration,
    start: Option<StartFile>,
) -> Result<Result<(Scene, Arc<ProblemTables>), Cut>, Refusal> {
    let (name, packages) = (name.to_owned(), packages.clone());
    beside(limit, Duration::ZERO, move |stop| {
        let scene = Scene::load_from(&name, &until(&packages, stop), start.as_ref())?;
        let tables = ProblemTables::new_until(scene.problem.clone(), stop).ok_or(Failure::Stopped)?;
        Ok((scene, Arc::new(tables)))
    })
}

/// A problem of a batch.
pub(crate) fn entry(name: &str, packages: &PackagePath, limit: Duration) -> Result<Result<Entry, Cut>, Refusal> {
    let (name, packages) = (name.to_owned(), packages.clone());
    beside(limit, Duration::ZERO, move |stop| Ok(Entry::load(&name, &until(&packages, stop))?))
}

impl Cut {
    /// Says that there was no search, and why.
    pub(crate) fn tell(self, name: &str, time: Duration, in_json: bool) -> Result<Ending, Refusal> {
        let (outcome, why, ending) = match self {
            Self::OutOfTime => (SearchOutcome::Timeout, "the time limit was reached", Ending::Failed),
            Self::Interrupted => (SearchOutcome::Cancelled, "a signal came", Ending::Interrupted),
        };
        let (outcome, ms) = (outcome.name(), time.as_secs_f64() * 1e3);
        match in_json {
            true => print_json(&json!({
                "scene": name, "outcome": outcome, "load_ms": ms, "reason": format!("{why} while the scene was read"),
            }))?,
            false => print(&format!("{name}: {outcome} after {ms:.0} ms: {why} while the scene was read\n")),
        }
        Ok(ending)
    }
}
