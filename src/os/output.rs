//! Writing files. Everything that the program writes goes through here.
//!
//! A regular file is written whole or not at all: under a name that no other process uses, beside it, and then renamed. What is no
//! regular file (a device, a pipe) is never replaced: it is written to. A failure leaves nothing behind.

use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};

/// Of files that are being written: `.NAME.PID-COUNT.unfinished`.
pub(crate) const UNFINISHED: &str = "unfinished";
/// Names that lead to what this process has open, not to a file of their own.
const STANDARD: [(&str, bool); 6] = [
    ("/dev/stdout", true),
    ("/dev/fd/1", true),
    ("/proc/self/fd/1", true),
    ("/dev/stderr", false),
    ("/dev/fd/2", false),
    ("/proc/self/fd/2", false),
];

/// Files that this process is writing.
static BEING_WRITTEN: AtomicUsize = AtomicUsize::new(0);

/// Where bytes that are written to a path go.
enum Target {
    /// A regular file, there already or not: it is replaced. Links are followed first, so that they stay.
    File { path: PathBuf, old: Option<Metadata> },
    /// A device or a pipe: it is written to.
    Stream(PathBuf),
    /// Standard output, or else standard error.
    Standard { is_output: bool },
}

/// Writes a file: all of it, or none.
///
/// A regular file is replaced by renaming, with the permissions that it had; a link stays, and what it leads to is replaced.
/// Devices and pipes are written to, and may have taken a part when an error comes.
///
/// # Errors
/// What the operating system says; a directory, a link that leads nowhere, a file that may not be written.
pub fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    match target(path)? {
        Target::File { path, old } => replace(&path, old.as_ref(), bytes, true),
        Target::Stream(path) => {
            let mut stream = OpenOptions::new().append(true).open(path)?;
            stream.write_all(bytes).and_then(|()| stream.flush())
        }
        Target::Standard { is_output: true } => {
            let mut out = io::stdout().lock();
            out.write_all(bytes).and_then(|()| out.flush())
        }
        Target::Standard { is_output: false } => io::stderr().lock().write_all(bytes),
    }
}

/// Writes a file that can be made anew at any time, and that its reader verifies: all of it, or none, but without waiting
/// for the disk. What had the name is replaced whatever it was, a link too; nothing is written through it.
///
/// # Errors
/// What the operating system says; a directory has the name.
pub fn write_kept(path: &Path, bytes: &[u8]) -> io::Result<()> {
    replace(path, None, bytes, false)
}

/// Whether a path could be written to, as far as that can be told without writing: for work that takes long before it has
/// something to write.
///
/// # Errors
/// As [`write()`], and where the folder is missing.
pub fn check(path: &Path) -> io::Result<()> {
    let Target::File { path, .. } = target(path)? else { return Ok(()) };
    match fs::metadata(folder_of(&path)) {
        Ok(folder) if folder.is_dir() => Ok(()),
        Ok(_) => Err(ErrorKind::NotADirectory.into()),
        Err(error) => Err(error),
    }
}

/// Whether a path is, or will be, a regular file, so that other files can lie beside it.
#[must_use]
pub fn is_file(path: &Path) -> bool {
    !matches!(target(path), Ok(Target::Stream(_) | Target::Standard { .. }))
}

fn target(path: &Path) -> io::Result<Target> {
    if let Some(&(_, is_output)) = STANDARD.iter().find(|(name, _)| path == Path::new(name)) {
        return Ok(Target::Standard { is_output });
    }
    let found = match fs::metadata(path) {
        Ok(found) => found,
        Err(error) if error.kind() == ErrorKind::NotFound => {
            // A link that leads nowhere would be replaced.
            return match fs::symlink_metadata(path) {
                Ok(_) => Err(io::Error::new(ErrorKind::NotFound, "is a link that leads nowhere")),
                Err(_) => Ok(Target::File { path: path.to_owned(), old: None }),
            };
        }
        Err(error) => return Err(error),
    };
    match found.file_type() {
        kind if kind.is_dir() => Err(ErrorKind::IsADirectory.into()),
        kind if kind.is_file() && found.permissions().readonly() => Err(ErrorKind::PermissionDenied.into()),
        kind if kind.is_file() => Ok(Target::File { path: fs::canonicalize(path)?, old: Some(found) }),
        _ => Ok(Target::Stream(path.to_owned())),
    }
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Whether some thread is writing a file, which would stay unfinished if the process ended now.
#[must_use]
pub fn is_writing() -> bool {
    BEING_WRITTEN.load(Ordering::SeqCst) > 0
}

fn replace(path: &Path, old: Option<&Metadata>, bytes: &[u8], is_awaited: bool) -> io::Result<()> {
    BEING_WRITTEN.fetch_add(1, Ordering::SeqCst);
    let replaced = written_and_renamed(path, old, bytes, is_awaited);
    BEING_WRITTEN.fetch_sub(1, Ordering::SeqCst);
    replaced
}

fn written_and_renamed(path: &Path, old: Option<&Metadata>, bytes: &[u8], is_awaited: bool) -> io::Result<()> {
    let name = path.file_name().ok_or(ErrorKind::InvalidFilename)?;
    let (unfinished, mut file) = unfinished(folder_of(path), &name.to_string_lossy())?;
    let written = file.write_all(bytes).and_then(|()| match old {
        Some(old) => file.set_permissions(old.permissions()),
        None => Ok(()),
    });
    let written = written.and_then(|()| if is_awaited { file.sync_all() } else { Ok(()) });
    drop(file);
    let renamed = written.and_then(|()| fs::rename(&unfinished, path));
    if renamed.is_err() {
        let _it_stays = fs::remove_file(&unfinished);
    }
    renamed
}

/// A new file under a name that no other write of this or of another process has.
fn unfinished(folder: &Path, name: &str) -> io::Result<(PathBuf, File)> {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    /// Longest part of the name that is kept: file systems allow 255 bytes.
    const KEPT: usize = 100;
    let kept = name.char_indices().map(|(at, c)| at + c.len_utf8()).take_while(|&end| end <= KEPT).last().unwrap_or(0);
    loop {
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let path = folder.join(format!(".{}.{}-{count}.{UNFINISHED}", &name[..kept], std::process::id()));
        match OpenOptions::new().write(true).create_new(true).open(&path) {
            Ok(file) => return Ok((path, file)),
            // Left by a process that had this number and was killed.
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
}

/// A file that grows by whole lines: a line that does not fit is taken back.
#[derive(Debug)]
pub struct Lines {
    file: File,
    length: u64,
}

impl Lines {
    /// A new file, which this process alone appends to as long as this lives.
    ///
    /// # Errors
    /// It is there already ([`ErrorKind::AlreadyExists`]), or cannot be made.
    pub fn create_new(path: &Path) -> io::Result<Self> {
        Self::owned(OpenOptions::new().append(true).create_new(true).open(path)?)
    }

    /// Goes on with a file that is there and ends with a whole line.
    ///
    /// # Errors
    /// It is not there, cannot be written, or another process appends to it ([`ErrorKind::WouldBlock`]).
    pub fn open(path: &Path) -> io::Result<Self> {
        Self::owned(OpenOptions::new().append(true).open(path)?)
    }

    fn owned(file: File) -> io::Result<Self> {
        match file.try_lock() {
            // Where a file system knows no locks, no process is excluded.
            Ok(()) | Err(fs::TryLockError::Error(_)) => Ok(Self { length: file.metadata()?.len(), file }),
            Err(fs::TryLockError::WouldBlock) => Err(ErrorKind::WouldBlock.into()),
        }
    }

    /// Appends a line, which ends with its line break. It is in the file when this returns.
    ///
    /// # Errors
    /// It does not fit; the file then ends with the line before.
    pub fn append(&mut self, line: &str) -> io::Result<()> {
        let written = self.file.write_all(line.as_bytes()).and_then(|()| self.file.flush());
        match written {
            Ok(()) => self.length += line.len() as u64,
            Err(_) => self.file.set_len(self.length)?,
        }
        written
    }
}
