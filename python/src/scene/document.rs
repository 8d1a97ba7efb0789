//! Scenes as dictionaries, in the form of scene files.

use pyo3::exceptions::PyValueError;
use pyo3::inspect::PyStaticExpr;
use pyo3::prelude::*;
use pyo3::types::PyMapping;
use pyo3::{type_hint_identifier, type_hint_subscript};

/// A dictionary with the keys of a scene file.
pub(crate) struct Document<'py>(Bound<'py, PyMapping>);

impl<'a, 'py> FromPyObject<'a, 'py> for Document<'py> {
    type Error = PyErr;

    const INPUT_TYPE: PyStaticExpr = type_hint_subscript!(
        type_hint_identifier!("collections.abc", "Mapping"),
        type_hint_identifier!("builtins", "str"),
        type_hint_identifier!("typing", "Any")
    );

    fn extract(given: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        Ok(Self(given.cast::<PyMapping>()?.to_owned()))
    }
}

/// The text of a scene file that says what a dictionary says.
pub(crate) fn text_of(document: &Document<'_>) -> PyResult<String> {
    toml::to_string(&table_of(document)?).map_err(|why| PyValueError::new_err(why.to_string()))
}

/// What a dictionary says, as TOML. Its values are strings, numbers, truth values, lists, and dictionaries with names; arrays of numpy count as lists.
pub(crate) fn table_of(Document(document): &Document<'_>) -> PyResult<toml::Table> {
    let py = document.py();
    let json = py.import("foliate.document")?.getattr("json_of")?.call1((document,))?.extract::<String>()?;
    serde_json::from_str(&json).map_err(|why| PyValueError::new_err(why.to_string()))
}
