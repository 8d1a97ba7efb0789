//! The files that a command is to write, before it begins its work.

use crate::cli::console::print::Refusal;
use crate::output;
use std::fs;
use std::path::{Path, PathBuf};

/// Refuses an output that could not be written, that is an input of the same command, or that is another of its outputs.
/// `inputs` may be names of other things than files.
pub(crate) fn check<'a>(
    inputs: impl IntoIterator<Item = &'a str>,
    outputs: impl IntoIterator<Item = &'a PathBuf>,
) -> Result<(), Refusal> {
    let inputs: Vec<PathBuf> = inputs.into_iter().filter_map(|name| fs::canonicalize(name).ok()).collect();
    let mut written: Vec<PathBuf> = Vec::new();
    for out in outputs {
        let place = out.display();
        output::check(out).map_err(|error| Refusal(format!("{place}: {error}")))?;
        // Devices and pipes can be written to more than once.
        let Some(file) = output::is_file(out).then(|| file_of(out)).flatten() else { continue };
        if inputs.contains(&file) {
            return Err(Refusal(format!("{place}: is read by this command, and would be lost")));
        }
        if written.contains(&file) {
            return Err(Refusal(format!("{place}: would be written twice, for two different things")));
        }
        written.push(file);
    }
    Ok(())
}

/// The file that a path is, or will be.
fn file_of(path: &Path) -> Option<PathBuf> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    fs::canonicalize(path).ok().or_else(|| Some(fs::canonicalize(folder).ok()?.join(path.file_name()?)))
}
