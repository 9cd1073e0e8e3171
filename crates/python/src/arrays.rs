//! Arrays of numbers of equal length.

use crate::error::input;
use numpy::{PyReadonlyArray1, PyUntypedArrayMethods};
use pyo3::PyResult;

/// Array of numbers from Python.
pub(crate) type Numbers<'py> = PyReadonlyArray1<'py, f64>;

/// Copies named arrays.
///
/// # Errors
///
/// They have different lengths.
pub(crate) fn columns<const N: usize>(named: [(&str, &Numbers<'_>); N]) -> PyResult<[Vec<f64>; N]> {
    let expected = named.first().map_or(0, |(_, first)| first.len());
    if let Some((name, other)) = named.iter().find(|(_, array)| array.len() != expected) {
        return Err(input(format!("{name}: found {} values; expected {expected}", other.len())));
    }
    Ok(named.map(|(_, array)| array.as_array().to_vec()))
}
