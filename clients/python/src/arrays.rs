//! Arrays of a batch: what Python writes to and reads from.

use numpy::{PyArray1, PyArrayDyn};
use palpate_sim::tick::quantity::Quantity;
use palpate_sim::tick::record::ToolOutput;
use pyo3::prelude::*;

/// What is written of each tool after a step: name, and numbers to a copy.
pub const RESULTS: [(&str, usize); 9] = [
    ("force", 3),
    ("torque", 3),
    ("contact_force", 3),
    ("contact_torque", 3),
    ("depth", 1),
    ("proxy", 7),
    ("energy", 1),
    ("dissipated", 1),
    ("error_n", 1),
];

/// Arrays of a tool.
pub struct Arrays {
    /// (n, 7)
    pub pose: Py<PyArrayDyn<f64>>,
    /// (n, 6)
    pub velocity: Py<PyArrayDyn<f64>>,
    /// (n,)
    pub buttons: Py<PyArray1<u32>>,
    /// (n,)
    pub flags: Py<PyArray1<u32>>,
    /// As [`RESULTS`].
    pub results: [Py<PyArrayDyn<f64>>; RESULTS.len()],
}

impl Arrays {
    /// Zeros for `n` copies.
    pub fn new(py: Python<'_>, n: usize) -> Self {
        let zeros = |width: usize| {
            let shape = if width == 1 { vec![n] } else { vec![n, width] };
            PyArrayDyn::zeros(py, shape, false).unbind()
        };
        Self {
            pose: zeros(7),
            velocity: zeros(6),
            buttons: PyArray1::zeros(py, n, false).unbind(),
            flags: PyArray1::zeros(py, n, false).unbind(),
            results: RESULTS.map(|(_, width)| zeros(width)),
        }
    }
}

/// Writes one of [`RESULTS`] of a copy.
pub fn write_result(name: &str, out: &ToolOutput, row: &mut [f64]) {
    if let Some(quantity) = Quantity::named(name) {
        quantity.write(&out.into(), row);
    }
}

/// A view of an array of ours: it cannot be resized, and it keeps the array alive.
pub fn view<'py>(array: &Bound<'py, PyAny>, writeable: bool) -> PyResult<Bound<'py, PyAny>> {
    let view = array.call_method0("view")?;
    if !writeable {
        view.getattr("flags")?.setattr("writeable", false)?;
    }
    Ok(view)
}
