//! Rows of numbers as numpy arrays. The memory of the rows becomes that of the array: nothing is copied.

use numpy::{Element, PyArray1, PyArrayMethods, PyReadonlyArray1};
use pyo3::inspect::PyStaticExpr;
use pyo3::prelude::*;
use pyo3::{type_hint_identifier, type_hint_subscript};
use std::convert::Infallible;
use std::marker::PhantomData;

/// An array of numbers.
pub(crate) struct Array<'py, T = f64>(Bound<'py, PyAny>, PhantomData<T>);

/// A number of numpy's.
pub(crate) trait Number {
    /// Its array, as stubs write it.
    const ARRAY: PyStaticExpr;
}

impl Number for f64 {
    const ARRAY: PyStaticExpr = type_hint_subscript!(
        type_hint_identifier!("numpy.typing", "NDArray"),
        type_hint_identifier!("numpy", "float64")
    );
}

impl Number for u32 {
    const ARRAY: PyStaticExpr = type_hint_subscript!(
        type_hint_identifier!("numpy.typing", "NDArray"),
        type_hint_identifier!("numpy", "uint32")
    );
}

impl<'py, T: Number> IntoPyObject<'py> for Array<'py, T> {
    type Target = PyAny;
    type Output = Bound<'py, PyAny>;
    type Error = Infallible;

    const OUTPUT_TYPE: PyStaticExpr = T::ARRAY;

    fn into_pyobject(self, _: Python<'py>) -> Result<Self::Output, Self::Error> {
        Ok(self.0)
    }
}

/// Numbers that are given as an array, a sequence, or one alone.
pub(crate) struct Numbers(pub Vec<f64>);

impl<'a, 'py> FromPyObject<'a, 'py> for Numbers {
    type Error = PyErr;

    const INPUT_TYPE: PyStaticExpr = type_hint_identifier!("numpy.typing", "ArrayLike");

    fn extract(given: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(array) = given.extract::<PyReadonlyArray1<'_, f64>>() {
            return Ok(Self(array.as_array().to_vec()));
        }
        if let Ok(one) = given.extract::<f64>() {
            return Ok(Self(vec![one]));
        }
        given.extract::<Vec<f64>>().map(Self)
    }
}

/// A row.
pub(crate) fn row(py: Python<'_>, numbers: Vec<f64>) -> Array<'_> {
    Array(PyArray1::from_vec(py, numbers).into_any(), PhantomData)
}

/// An array of `rows.len() / columns` rows.
pub(crate) fn matrix<T: Number + Element>(py: Python<'_>, rows: Vec<T>, columns: usize) -> PyResult<Array<'_, T>> {
    let count = rows.len().checked_div(columns).unwrap_or(0);
    Ok(Array(PyArray1::from_vec(py, rows).reshape([count, columns])?.into_any(), PhantomData))
}

/// An array of blocks of so many rows and columns.
pub(crate) fn blocks(py: Python<'_>, numbers: Vec<f64>, shape: [usize; 3]) -> PyResult<Array<'_>> {
    Ok(Array(PyArray1::from_vec(py, numbers).reshape(shape)?.into_any(), PhantomData))
}
