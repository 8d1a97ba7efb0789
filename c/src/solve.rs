//! Planning.

use crate::arguments::{reference, target, text};
use crate::error::{Failure, FoliateStatus, status_of};
use crate::path::FoliatePath;
use crate::scene::FoliateScene;
use foliate::prelude::{CancelToken, NoSolution, Planner, SearchSettings};
use std::ffi::c_char;
use std::time::Duration;

/// What `improve_work` is for the default budget.
pub const FOLIATE_IMPROVE_DEFAULT: u64 = u64::MAX;

/// How a scene is solved. `foliate_options_default` fills it.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct FoliateOptions {
    /// Same seed, same answer, on any number of threads. Default: 1.
    pub seed: u64,
    /// Seconds. Default: 60.
    pub time_limit: f64,
    /// Threads of one search. Default: 1.
    pub threads: u32,
    /// Counted work that is spent on a better path than the first; 0: the first path with times. Default: `FOLIATE_IMPROVE_DEFAULT`, as `foliate solve`.
    pub improve_work: u64,
    /// Name of a scheduler; null: the default one.
    pub scheduler: *const c_char,
}

/// The default options.
#[unsafe(no_mangle)]
pub extern "C" fn foliate_options_default() -> FoliateOptions {
    FoliateOptions {
        seed: 1,
        time_limit: 60.0,
        threads: 1,
        improve_work: FOLIATE_IMPROVE_DEFAULT,
        scheduler: std::ptr::null(),
    }
}

/// Ends solves from another thread.
pub struct FoliateCancel {
    token: CancelToken,
}

/// Makes one. `foliate_cancel_free` frees it.
#[unsafe(no_mangle)]
pub extern "C" fn foliate_cancel_new() -> *mut FoliateCancel {
    Box::into_raw(Box::new(FoliateCancel { token: CancelToken::default() }))
}

/// Ends the solves that have been given this, and those that will be. May be called from any thread and from a handler of signals.
///
/// # Safety
/// `cancel` is null or came from `foliate_cancel_new` and is not freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foliate_cancel(cancel: *const FoliateCancel) {
    // SAFETY: the caller's promise.
    if let Some(cancel) = unsafe { cancel.as_ref() } {
        cancel.token.cancel();
    }
}

/// Frees it. Null is nothing to free.
///
/// # Safety
/// `cancel` is null or came from `foliate_cancel_new`, no solve has it any more, and it is not used again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foliate_cancel_free(cancel: *mut FoliateCancel) {
    if !cancel.is_null() {
        // SAFETY: the caller's promise.
        drop(unsafe { Box::from_raw(cancel) });
    }
}

/// Plans a path. `options` may be null (the default ones), `cancel` too (nothing ends it but its limit). `out` becomes a path with times; `foliate_path_free` frees it.
///
/// # Safety
/// `scene` came from this interface and does not change meanwhile; `options` and `cancel` are null or can be read; `out` can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foliate_solve(
    scene: *const FoliateScene,
    options: *const FoliateOptions,
    cancel: *const FoliateCancel,
    out: *mut *mut FoliatePath,
) -> FoliateStatus {
    status_of(|| {
        // SAFETY: the caller's promise.
        let (scene, out) = unsafe { (reference(scene, "scene")?, target(out, "out")?) };
        // SAFETY: the caller's promise.
        let options = unsafe { options.as_ref() }.copied().unwrap_or_else(|| foliate_options_default());
        // SAFETY: the caller's promise.
        let token = unsafe { cancel.as_ref() }.map_or_else(CancelToken::default, |cancel| cancel.token.clone());
        let scheduler = match options.scheduler.is_null() {
            true => foliate::schedulers::default_scheduler().name(),
            // SAFETY: not null; the caller's promise.
            false => unsafe { text(options.scheduler, "scheduler") }?,
        };
        let limit = Duration::try_from_secs_f64(options.time_limit).map_err(|_| {
            Failure::argument(format!("`time_limit`: {} is not a number of seconds", options.time_limit))
        })?;
        if options.threads == 0 {
            return Err(Failure::argument("`threads` is at least 1"));
        }
        let planner = Planner::from_model(scene.model()?);
        let planner = planner.settings(SearchSettings::default().with(|s| s.seed = options.seed));
        let planner = planner.cancelled_by(token).time_limit(limit);
        let planner = match options.improve_work {
            FOLIATE_IMPROVE_DEFAULT => planner,
            work => planner.improve_work(work),
        };
        let planner = planner.scheduler_named(scheduler);
        let planner = planner.ok_or_else(|| Failure::argument(format!("there is no scheduler `{scheduler}`")))?;
        let solution = planner.solve_on(options.threads as usize).map_err(|none| refused(&none))?;
        let path = FoliatePath::of(solution, scene.scene.clone(), (options.seed, scheduler.to_owned()));
        *out = Box::into_raw(Box::new(path?));
        Ok(())
    })
}

fn refused(none: &NoSolution) -> Failure {
    let status = match none.reason.name() {
        "cancelled" => FoliateStatus::Cancelled,
        "infeasible_start" | "infeasible_goal" => FoliateStatus::Infeasible,
        "crashed" => FoliateStatus::Bug,
        _ => FoliateStatus::NoSolution,
    };
    let detail = none.reason.detail().map(|detail| format!(": {detail}")).unwrap_or_default();
    Failure::new(status, format!("{}{detail}", none.reason.name()))
}
