//! Arrays that come from Python, and those that go there.

use nalgebra::{DMatrix, DVector, Vector3};
use numpy::{
    IntoPyArray, PyArray1, PyArray2, PyArray3, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn,
    PyUntypedArrayMethods,
};
use pyo3::exceptions::PyValueError;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Numbers with a shape, copied from anything that NumPy can make an array of.
#[derive(Debug)]
pub(crate) struct Numbers {
    pub(crate) shape: Vec<usize>,
    pub(crate) values: Vec<f64>,
}

impl<'a, 'py> FromPyObject<'a, 'py> for Numbers {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        let py = object.py();
        let keywords = PyDict::new(py);
        keywords.set_item(intern!(py, "dtype"), intern!(py, "float64"))?;
        let numpy = py.import(intern!(py, "numpy"))?;
        let array = numpy.call_method("ascontiguousarray", (object,), Some(&keywords))?;
        // `ascontiguousarray` makes a number an array of one.
        let scalar = object.getattr_opt(intern!(py, "ndim"))?.map_or_else(
            || Ok::<_, PyErr>(object.len().is_err()),
            |ndim| Ok(ndim.extract::<usize>()? == 0),
        )?;
        let array: PyReadonlyArrayDyn<'_, f64> = array.extract()?;
        let shape = if scalar { Vec::new() } else { array.shape().to_vec() };
        Ok(Self { shape, values: array.as_slice()?.to_vec() })
    }
}

impl Numbers {
    /// Refuses another shape than `expected`, whose dimensions are called `names`.
    pub(crate) fn expect(&self, what: &str, names: &str, expected: &[usize]) -> PyResult<()> {
        if self.shape == expected {
            return Ok(());
        }
        let found = tuple(&self.shape);
        let message = format!("{what} has shape {found}; give {names} = {}", tuple(expected));
        Err(PyValueError::new_err(message))
    }

    /// The numbers in threes.
    pub(crate) fn triples(&self) -> Vec<Vector3<f64>> {
        self.values.chunks_exact(3).map(Vector3::from_column_slice).collect()
    }

    /// A vector.
    pub(crate) fn vector(&self) -> DVector<f64> {
        DVector::from_column_slice(&self.values)
    }

    /// A matrix; the shape must have two dimensions.
    pub(crate) fn matrix(&self, what: &str) -> PyResult<DMatrix<f64>> {
        let [rows, columns] = self.shape[..] else {
            let message = format!("{what} has shape {}; give a matrix", tuple(&self.shape));
            return Err(PyValueError::new_err(message));
        };
        Ok(DMatrix::from_row_slice(rows, columns, &self.values))
    }
}

/// A shape as Python writes it.
pub(crate) fn tuple(shape: &[usize]) -> String {
    match shape {
        [one] => format!("({one},)"),
        _ => format!("({})", shape.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")),
    }
}

/// Vectors as an array of (n, 3).
pub(crate) fn triples<'py>(
    py: Python<'py>,
    vectors: &[Vector3<f64>],
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let values: Vec<f64> = vectors.iter().flat_map(|v| [v.x, v.y, v.z]).collect();
    values.into_pyarray(py).reshape([vectors.len(), 3])
}

/// Lists of vectors, all of one length, as an array of (lists, n, 3).
pub(crate) fn tables<'a, 'py>(
    py: Python<'py>,
    lists: impl Iterator<Item = &'a [Vector3<f64>]>,
    shape: [usize; 3],
) -> PyResult<Bound<'py, PyArray3<f64>>> {
    let mut values = Vec::with_capacity(shape.iter().product());
    lists.for_each(|list| values.extend(list.iter().flat_map(|v| [v.x, v.y, v.z])));
    values.into_pyarray(py).reshape(shape)
}

/// A vector.
pub(crate) fn vector<'py>(py: Python<'py>, v: &DVector<f64>) -> Bound<'py, PyArray1<f64>> {
    v.as_slice().to_vec().into_pyarray(py)
}

/// A matrix.
pub(crate) fn matrix<'py>(
    py: Python<'py>,
    m: &DMatrix<f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    m.transpose().as_slice().to_vec().into_pyarray(py).reshape([m.nrows(), m.ncols()])
}

/// Numbers as an array of a shape, row-major.
pub(crate) fn array<'py>(
    py: Python<'py>,
    values: Vec<f64>,
    shape: &[usize],
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    values.into_pyarray(py).reshape(shape)
}
