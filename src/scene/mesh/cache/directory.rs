//! The files of the cache: read whole, written so that no reader ever sees half of one, the oldest deleted where there are too many.

use crate::os::output;
use crate::os::output::UNFINISHED;
use std::fs::{self, File};
use std::io::{self, ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Of entries, after 64 hexadecimal digits.
pub(crate) const EXTENSION: &str = ".mesh";

/// Reads a file of at most `cap` bytes into `bytes`; whether it exists.
///
/// # Errors
/// It is there but no regular file, too large, or cannot be read; in words.
pub(crate) fn read(path: &Path, cap: u64, bytes: &mut Vec<u8>) -> Result<bool, String> {
    bytes.clear();
    let metadata = match fs::metadata(path) {
        Ok(metadata) => metadata,
        // Also where the directory is none.
        Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => return Ok(false),
        Err(error) => return Err(format!("cannot be opened: {error}")),
    };
    // A pipe would block.
    if !metadata.is_file() {
        return Err("is not a regular file".into());
    }
    if metadata.len() > cap {
        return Err(format!("has {} bytes, an entry at most {cap}", metadata.len()));
    }
    bytes.reserve_exact(metadata.len() as usize);
    let file = match File::open(path) {
        Ok(file) => file,
        // Another process has just deleted it.
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(false),
        Err(error) => return Err(format!("cannot be opened: {error}")),
    };
    file.take(cap).read_to_end(bytes).map_err(|error| format!("cannot be read: {error}"))?;
    Ok(true)
}

/// Writes a file; the directory is made where it is missing.
pub(crate) fn write(directory: &Path, name: &str, bytes: &[u8]) -> io::Result<()> {
    fs::create_dir_all(directory)?;
    output::write_kept(&directory.join(name), bytes)
}

/// Deletes the oldest files of the cache until these have at most so many bytes together. Files with other names are left alone.
pub(crate) fn trim(directory: &Path, most_bytes: u64) {
    let mut files = ours(directory);
    let mut bytes: u64 = files.iter().map(|file| file.bytes).sum();
    if bytes <= most_bytes {
        return;
    }
    files.sort_by(|a, b| (a.written, &a.path).cmp(&(b.written, &b.path)));
    for file in files {
        if bytes <= most_bytes {
            break;
        }
        // Another process may have been faster.
        let _gone = fs::remove_file(&file.path);
        bytes = bytes.saturating_sub(file.bytes);
    }
}

struct Ours {
    path: PathBuf,
    bytes: u64,
    written: SystemTime,
}

fn ours(directory: &Path) -> Vec<Ours> {
    let Ok(entries) = fs::read_dir(directory) else { return Vec::new() };
    entries
        .filter_map(Result::ok)
        .filter(|entry| entry.file_name().to_str().is_some_and(is_ours))
        .filter_map(|entry| {
            let metadata = entry.metadata().ok().filter(fs::Metadata::is_file)?;
            let written = metadata.modified().unwrap_or(SystemTime::UNIX_EPOCH);
            Some(Ours { path: entry.path(), bytes: metadata.len(), written })
        })
        .collect()
}

fn is_ours(name: &str) -> bool {
    // Files that are being written have a dot in front; so have those of processes that were killed meanwhile.
    let (name, is_finished) = name.strip_prefix('.').map_or((name, true), |name| (name, false));
    let Some((digits, rest)) = name.split_at_checked(64) else { return false };
    let is_entry = (is_finished && rest == EXTENSION) || (rest.starts_with(EXTENSION) && rest.ends_with(UNFINISHED));
    digits.bytes().all(|b| b.is_ascii_hexdigit()) && is_entry
}
