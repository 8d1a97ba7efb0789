//! What a call ends with.

use foliate::planner::panic_message;
use std::cell::RefCell;
use std::ffi::{CString, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// How a call ended. `foliate_error` says it in words.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FoliateStatus {
    /// It did what was asked.
    Ok = 0,
    /// The search ended without a path: at its deadline or at a limit.
    NoSolution = 1,
    /// A file or a text cannot be read, or has no meaning as a scene.
    Unreadable = 2,
    /// The start or the goals are infeasible, or no path can exist.
    Infeasible = 3,
    /// `foliate_cancel` ended the search.
    Cancelled = 4,
    /// An argument is wrong: a null pointer, text that is not UTF-8, a name or a number that does not exist.
    Argument = 5,
    /// A file cannot be written.
    Unwritable = 6,
    /// A bug of Foliate. The process may go on.
    Bug = 7,
}

thread_local! {
    static LAST: RefCell<CString> = RefCell::default();
}

/// Why a call did not do what was asked.
pub(crate) struct Failure {
    pub status: FoliateStatus,
    pub message: String,
}

impl Failure {
    pub(crate) fn new(status: FoliateStatus, message: impl ToString) -> Self {
        Self { status, message: message.to_string() }
    }

    pub(crate) fn argument(message: impl ToString) -> Self {
        Self::new(FoliateStatus::Argument, message)
    }
}

/// Does something; what goes wrong, a panic included, becomes a status and a message.
pub(crate) fn status_of(work: impl FnOnce() -> Result<(), Failure>) -> FoliateStatus {
    let failure = match catch_unwind(AssertUnwindSafe(work)) {
        Ok(Ok(())) => {
            remember("");
            return FoliateStatus::Ok;
        }
        Ok(Err(failure)) => failure,
        Err(payload) => Failure::new(FoliateStatus::Bug, format!("a bug of foliate: {}", panic_message(&*payload))),
    };
    remember(&failure.message);
    failure.status
}

pub(crate) fn remember(message: &str) {
    let text = CString::new(message.replace('\0', " ")).unwrap_or_default();
    LAST.with(|last| *last.borrow_mut() = text);
}

/// What was wrong with the last call of this thread that returned a status: with file, line and hint where there are some. Empty after `FOLIATE_STATUS_OK`.
/// The text belongs to Foliate and is there until the next call of this thread.
#[unsafe(no_mangle)]
pub extern "C" fn foliate_error() -> *const c_char {
    LAST.with(|last| last.borrow().as_ptr())
}

/// Foliate's version, such as `0.1.0`.
#[unsafe(no_mangle)]
pub extern "C" fn foliate_version() -> *const c_char {
    concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast()
}
