//! Proving path files.

use crate::arguments::{folders, target, text};
use crate::error::{Failure, FoliateStatus, status_of};
use foliate::check::{CheckOptions, SceneChoice, Verdict, check};
use foliate::path_file::save;
use foliate::prelude::PackagePath;
use std::ffi::c_char;
use std::path::Path;
use std::time::Duration;

/// What a check found.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FoliateVerdict {
    /// Everything is proved, against a scene.
    Proved = 0,
    /// A promise is broken.
    Refused = 1,
    /// Proved, but only relative to what the file says of itself.
    Relative = 3,
    /// The limits ended the check before that.
    Undecided = 4,
}

/// Proves a path file over the continuum, by code that shares nothing with the search. `scene` is what it has to answer, a shipped scene's name or a file; null: the scene that the file names.
/// `time_limit` is in seconds. Where the verdict is not `FOLIATE_VERDICT_PROVED`, `foliate_error` says what was found.
///
/// # Safety
/// `file` is a text, `scene` is null or one; `packages` has `package_count` texts; `out` can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foliate_check(
    file: *const c_char,
    scene: *const c_char,
    packages: *const *const c_char,
    package_count: usize,
    time_limit: f64,
    out: *mut FoliateVerdict,
) -> FoliateStatus {
    let mut found = String::new();
    let status = status_of(|| {
        // SAFETY: the caller's promise.
        let (file, packages) = unsafe { (Path::new(text(file, "file")?), folders(packages, package_count)?) };
        // SAFETY: the caller's promise.
        let out = unsafe { target(out, "out") }?;
        let scene = match scene.is_null() {
            true => SceneChoice::Named,
            // SAFETY: not null; the caller's promise.
            false => SceneChoice::Given(unsafe { text(scene, "scene") }?.to_owned()),
        };
        let limit = Duration::try_from_secs_f64(time_limit)
            .map_err(|_| Failure::argument(format!("`time_limit`: {time_limit} is not a number of seconds")))?;
        let unreadable = |why: &dyn ToString| Failure::new(FoliateStatus::Unreadable, why.to_string());
        let read = save::read(file).map_err(|why| unreadable(&why))?;
        let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let options = CheckOptions { time_limit: Some(limit), scene, ..CheckOptions::default() };
        let report = check(&read, folder, &PackagePath::from_environment(&packages), &options);
        let report = report.map_err(|why| unreadable(&why))?;
        *out = match report.verdict() {
            Verdict::Proved => FoliateVerdict::Proved,
            Verdict::Refused => FoliateVerdict::Refused,
            Verdict::Relative(_) => FoliateVerdict::Relative,
            Verdict::Undecided => FoliateVerdict::Undecided,
        };
        found = report.violations.iter().map(|violation| violation.subject.clone()).collect::<Vec<_>>().join("; ");
        Ok(())
    });
    if status == FoliateStatus::Ok {
        crate::error::remember(&found);
    }
    status
}
