//! What C hands over, as what Rust has.

use crate::error::Failure;
use std::ffi::{CStr, c_char};
use std::path::PathBuf;

/// A text.
///
/// # Safety
/// It is null or ends with a zero, and it does not change during the call.
pub(crate) unsafe fn text<'a>(pointer: *const c_char, what: &str) -> Result<&'a str, Failure> {
    if pointer.is_null() {
        return Err(Failure::argument(format!("`{what}` is null")));
    }
    // SAFETY: not null; the caller's promise.
    let text = unsafe { CStr::from_ptr(pointer) };
    text.to_str().map_err(|_| Failure::argument(format!("`{what}` is not UTF-8")))
}

/// What a pointer points to.
///
/// # Safety
/// It is null or points to a value that does not change during the call.
pub(crate) unsafe fn reference<'a, T>(pointer: *const T, what: &str) -> Result<&'a T, Failure> {
    // SAFETY: the caller's promise.
    unsafe { pointer.as_ref() }.ok_or_else(|| Failure::argument(format!("`{what}` is null")))
}

/// What a pointer points to, to be changed.
///
/// # Safety
/// It is null or points to a value that is not used elsewhere during the call.
pub(crate) unsafe fn target<'a, T>(pointer: *mut T, what: &str) -> Result<&'a mut T, Failure> {
    // SAFETY: the caller's promise.
    unsafe { pointer.as_mut() }.ok_or_else(|| Failure::argument(format!("`{what}` is null")))
}

/// An array.
///
/// # Safety
/// It is null or has so many values, and they do not change during the call.
pub(crate) unsafe fn array<'a, T>(pointer: *const T, count: usize, what: &str) -> Result<&'a [T], Failure> {
    if count == 0 {
        return Ok(&[]);
    }
    if pointer.is_null() {
        return Err(Failure::argument(format!("`{what}` is null")));
    }
    // SAFETY: not null; the caller's promise.
    Ok(unsafe { std::slice::from_raw_parts(pointer, count) })
}

/// Folders.
///
/// # Safety
/// As [`array`], and each entry as [`text`].
pub(crate) unsafe fn folders(pointer: *const *const c_char, count: usize) -> Result<Vec<PathBuf>, Failure> {
    // SAFETY: the caller's promise.
    let entries = unsafe { array(pointer, count, "packages") }?;
    // SAFETY: the caller's promise.
    entries.iter().map(|&entry| unsafe { text(entry, "packages") }.map(PathBuf::from)).collect()
}
