//! Pages that show a scene or a path, see `foliate view`.

use crate::calls::errors;
use foliate::view::Page;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::path::PathBuf;

/// Height of a page in a notebook, pixels.
const HEIGHT: u32 = 640;

/// The page as text, or its file's name once it is written.
pub(crate) fn shown(py: Python<'_>, page: &Page, out: Option<PathBuf>) -> PyResult<String> {
    let html = text(page)?;
    let Some(out) = out else { return Ok(html) };
    foliate::output::write(&out, html.as_bytes())
        .map_err(|why| errors::of_path(py, &format!("{}: {why}", out.display())))?;
    Ok(out.display().to_string())
}

/// The page in a frame of a notebook.
pub(crate) fn framed(page: &Page) -> PyResult<String> {
    let escaped = text(page)?.replace('&', "&amp;").replace('"', "&quot;");
    Ok(format!(
        "<iframe srcdoc=\"{escaped}\" style=\"width: 100%; height: {HEIGHT}px; border: 0\" sandbox=\"allow-scripts\"></iframe>"
    ))
}

fn text(page: &Page) -> PyResult<String> {
    page.html().map_err(|why| PyValueError::new_err(why.to_string()))
}
