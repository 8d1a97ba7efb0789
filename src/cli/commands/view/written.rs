//! A page on disk: where it was asked for, or in a temporary file whose name is told.

use crate::cli::console::print::Refusal;
use crate::output;
use crate::view::Page;
use std::path::{Path, PathBuf};

/// Writes a page and tells where it is.
pub(crate) fn write(page: &Page, out: Option<&Path>, tell: fn(&str)) -> Result<(), Refusal> {
    let html = page.html().map_err(|e| Refusal(format!("the page cannot be written: {e}")))?;
    let place = out.map_or_else(|| temporary(&page.document.title), Path::to_owned);
    let written = match out {
        Some(out) => output::write(out, html.as_bytes()),
        // In a folder that others write to, nothing is written through what has the name.
        None => output::write_kept(&place, html.as_bytes()),
    };
    written.map_err(|e| Refusal(format!("{}: {e}", place.display())))?;
    if output::is_file(&place) {
        tell(&format!("page: {} ({:.1} MB)\n", place.display(), html.len() as f64 / 1e6));
    }
    Ok(())
}

fn temporary(title: &str) -> PathBuf {
    let plain = |letter: char| if letter.is_ascii_alphanumeric() { letter } else { '-' };
    let title: String = title.chars().take(60).map(plain).collect();
    std::env::temp_dir().join(format!("foliate-{title}-{}.html", std::process::id()))
}
