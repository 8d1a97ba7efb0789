//! Opening files: regular ones only, and never more than a cap.

use crate::scene::reading::error::SceneError;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Largest URDF or SRDF, bytes.
pub(crate) const MODEL_CAP: u64 = 32 << 20;
/// Largest scene file, bytes.
pub(crate) const SCENE_CAP: u64 = 4 << 20;
/// Largest mesh file, bytes.
pub(crate) const MESH_CAP: u64 = 256 << 20;

/// The bytes of a regular file of at most `cap` bytes.
///
/// # Errors
/// Where the file is missing, is no regular file (a pipe would block), or is larger.
pub(crate) fn bytes(path: &Path, cap: u64) -> Result<Vec<u8>, SceneError> {
    let mut content = Vec::new();
    bytes_into(path, cap, &mut content)?;
    Ok(content)
}

/// As [`bytes`], into memory that was used before: new memory takes as long as to read the file.
///
/// # Errors
/// As [`bytes`].
pub(crate) fn bytes_into(path: &Path, cap: u64, content: &mut Vec<u8>) -> Result<(), SceneError> {
    content.clear();
    let fail = |message: String| SceneError::new(path.display().to_string(), "file", message);
    let metadata = std::fs::metadata(path).map_err(|e| fail(format!("cannot be opened: {e}")).because(e))?;
    if !metadata.is_file() {
        return Err(fail("is not a regular file".into()));
    }
    let too_large = |size: u64| {
        fail(format!("has {size} bytes, more than the {cap} that are read")).hint("split or simplify the model")
    };
    if metadata.len() > cap {
        return Err(too_large(metadata.len()));
    }
    content.reserve_exact(metadata.len() as usize);
    let file = File::open(path).map_err(|e| fail(format!("cannot be opened: {e}")).because(e))?;
    file.take(cap + 1).read_to_end(content).map_err(|e| fail(format!("cannot be read: {e}")).because(e))?;
    if content.len() as u64 > cap {
        return Err(too_large(content.len() as u64));
    }
    Ok(())
}

/// Bytes as UTF-8 text, without a byte order mark.
///
/// # Errors
/// Names the line of the first byte that is not UTF-8.
pub(crate) fn decode(content: Vec<u8>, file: &str) -> Result<String, SceneError> {
    if content.starts_with(&[0xFE, 0xFF]) || content.starts_with(&[0xFF, 0xFE]) {
        return Err(SceneError::new(file, "file", "is UTF-16").at(1).hint("save it as UTF-8"));
    }
    match String::from_utf8(content) {
        Ok(mut text) => {
            if text.starts_with('\u{feff}') {
                text.drain(..'\u{feff}'.len_utf8());
            }
            Ok(text)
        }
        Err(error) => {
            let valid = error.utf8_error().valid_up_to();
            let line = 1 + error.as_bytes()[..valid].iter().filter(|&&b| b == b'\n').count() as u32;
            Err(SceneError::new(file, "file", "is not UTF-8 text").at(line).hint("save it as UTF-8"))
        }
    }
}
