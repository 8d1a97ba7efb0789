//! Reading path files, which may be hostile: regular files only, never more than a cap, and no more memory than a small
//! multiple of the text.

use crate::path_file::document::PathFile;
use crate::path_file::error::PathFileError;
use crate::path_file::version;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Largest path file that is read, bytes: some hundred thousand knots.
const CAP: u64 = 1 << 28;
/// Most lists of a file. A list takes more memory than the two bytes that it may be written in.
const LISTS: usize = 2_000_000;
/// Most tables of a file, likewise.
const TABLES: usize = 400_000;

/// Reads a path file.
///
/// # Errors
/// It is no regular file, cannot be read, is larger than 256 MiB or has too many lists, is not JSON, is of another format, or
/// has a key that its version of the format does not know.
pub fn read(path: &Path) -> Result<PathFile, PathFileError> {
    let io = |source| PathFileError::Io { path: path.to_owned(), source };
    let text = text(path).map_err(io)?;
    counts(&text).map_err(io)?;
    serde_json::from_str::<PathFile>(&text)
        .map_err(|source| {
            // A file of another format is refused by its name and not by a missing field.
            if let Ok(Format { format }) = serde_json::from_str(&text)
                && !version::is_known(&format)
            {
                return PathFileError::Format { path: path.to_owned(), found: format };
            }
            let place = super::place::json_path(&text, source.line(), source.column());
            PathFileError::Json { path: path.to_owned(), place, source }
        })
        .and_then(|file| match version::is_known(&file.format) {
            true => Ok(file),
            false => Err(PathFileError::Format { path: path.to_owned(), found: file.format }),
        })
        .and_then(|file| match version::later_key(&file) {
            None => Ok(file),
            Some(key) => Err(PathFileError::Version { path: path.to_owned(), key }),
        })
}

fn text(path: &Path) -> std::io::Result<String> {
    String::from_utf8(regular_file(path, CAP)?)
        .map_err(|error| std::io::Error::other(format!("byte {} is not UTF-8", error.utf8_error().valid_up_to())))
}

/// The bytes of a regular file, at most `cap`; a pipe would block, and a device has no end.
pub(crate) fn regular_file(path: &Path, cap: u64) -> std::io::Result<Vec<u8>> {
    let metadata = std::fs::metadata(path)?;
    if !metadata.is_file() {
        return Err(std::io::Error::other("is not a regular file"));
    }
    let too_large = |size: u64| std::io::Error::other(format!("{size} bytes are more than the {cap} that are read"));
    if metadata.len() > cap {
        return Err(too_large(metadata.len()));
    }
    let mut content = Vec::with_capacity(metadata.len() as usize + 1);
    File::open(path)?.take(cap + 1).read_to_end(&mut content)?;
    if content.len() as u64 > cap {
        return Err(too_large(content.len() as u64));
    }
    Ok(content)
}

/// Refuses what would take far more memory than its text.
pub(crate) fn counts(text: &str) -> std::io::Result<()> {
    let (mut lists, mut tables) = (0_usize, 0_usize);
    for byte in text.bytes() {
        lists += usize::from(byte == b'[');
        tables += usize::from(byte == b'{');
    }
    for (count, most, what) in [(lists, LISTS, "lists"), (tables, TABLES, "tables")] {
        if count > most {
            return Err(std::io::Error::other(format!("{count} {what} are more than the {most} that are read")));
        }
    }
    Ok(())
}

/// Only the format.
#[derive(serde::Deserialize)]
struct Format {
    format: String,
}
