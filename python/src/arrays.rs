//! Rows of numbers as numpy arrays. The memory of the rows becomes that of the array: nothing is copied.

use foliate::prelude::Pose;
use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray1};
use pyo3::inspect::PyStaticExpr;
use pyo3::prelude::*;
use pyo3::{type_hint_identifier, type_hint_subscript};
use std::convert::Infallible;

/// An array of f64.
pub(crate) struct Array<'py>(Bound<'py, PyAny>);

impl<'py> IntoPyObject<'py> for Array<'py> {
    type Target = PyAny;
    type Output = Bound<'py, PyAny>;
    type Error = Infallible;

    const OUTPUT_TYPE: PyStaticExpr = type_hint_subscript!(
        type_hint_identifier!("numpy.typing", "NDArray"),
        type_hint_identifier!("numpy", "float64")
    );

    fn into_pyobject(self, _: Python<'py>) -> Result<Self::Output, Self::Error> {
        Ok(self.0)
    }
}

/// An array of u32.
pub(crate) struct Corners<'py>(Bound<'py, PyAny>);

impl<'py> IntoPyObject<'py> for Corners<'py> {
    type Target = PyAny;
    type Output = Bound<'py, PyAny>;
    type Error = Infallible;

    const OUTPUT_TYPE: PyStaticExpr = type_hint_subscript!(
        type_hint_identifier!("numpy.typing", "NDArray"),
        type_hint_identifier!("numpy", "uint32")
    );

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
    Array(PyArray1::from_vec(py, numbers).into_any())
}

/// An array of `rows.len() / columns` rows.
pub(crate) fn matrix(py: Python<'_>, rows: Vec<f64>, columns: usize) -> PyResult<Array<'_>> {
    let count = rows.len().checked_div(columns).unwrap_or(0);
    Ok(Array(PyArray1::from_vec(py, rows).reshape([count, columns])?.into_any()))
}

/// Three indices for each triangle.
pub(crate) fn triangles(py: Python<'_>, triangles: Vec<[u32; 3]>) -> PyResult<Corners<'_>> {
    let count = triangles.len();
    let indices: Vec<u32> = triangles.into_iter().flatten().collect();
    Ok(Corners(PyArray1::from_vec(py, indices).reshape([count, 3])?.into_any()))
}

/// An array of blocks of so many rows and columns.
pub(crate) fn blocks(py: Python<'_>, numbers: Vec<f64>, shape: [usize; 3]) -> PyResult<Array<'_>> {
    Ok(Array(PyArray1::from_vec(py, numbers).reshape(shape)?.into_any()))
}

/// A pose as seven numbers: x, y, z in metres, then the quaternion x, y, z, w.
pub(crate) fn pose_row(pose: &Pose) -> [f64; 7] {
    let (t, r) = (pose.translation, pose.rotation);
    [t.x, t.y, t.z, r.x, r.y, r.z, r.w]
}
