//! Saved states.

use crate::pose::{Pose, of_numbers};
use palpate_geometry::math::SavedState;
use palpate_proto::messages::ToolPose;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyTuple};

/// A saved state. Made by `Simulation.save()`; can be pickled.
#[pyclass(frozen, module = "palpate")]
pub struct Snapshot {
    /// State of the scene.
    pub saved: SavedState,
    /// Its hash.
    pub hash: u64,
    /// By tool: the pose that it sends each tick.
    pub held: Vec<Option<ToolPose>>,
    /// By tool: number of its last pose.
    pub seqs: Vec<u64>,
}

#[pymethods]
impl Snapshot {
    /// Hash of the state.
    #[getter]
    fn hash(&self) -> u64 {
        self.hash
    }

    #[staticmethod]
    fn _of(
        words: &[u8],
        floats: &[u8],
        hash: u64,
        held: Vec<Option<(Vec<f64>, u32, u64)>>,
        seqs: Vec<u64>,
    ) -> PyResult<Self> {
        let groups = |bytes: &[u8]| -> Vec<[u8; 8]> {
            bytes
                .chunks_exact(8)
                .map(|b| b.try_into().expect("eight"))
                .collect()
        };
        let held = held.into_iter().map(|held| {
            held.map(|(values, buttons, t_client_ns)| {
                if values.len() != 13 {
                    return Err(PyValueError::new_err("not a snapshot"));
                }
                Ok(ToolPose {
                    buttons,
                    t_client_ns,
                    ..Pose::checked(of_numbers(&values))?.inner
                })
            })
            .transpose()
        });
        Ok(Self {
            saved: SavedState {
                words: groups(words).into_iter().map(u64::from_le_bytes).collect(),
                floats: groups(floats).into_iter().map(f64::from_le_bytes).collect(),
            },
            hash,
            held: held.collect::<PyResult<_>>()?,
            seqs,
        })
    }

    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let this = slf.get();
        let words: Vec<u8> = this
            .saved
            .words
            .iter()
            .flat_map(|word| word.to_le_bytes())
            .collect();
        let floats: Vec<u8> = this
            .saved
            .floats
            .iter()
            .flat_map(|x| x.to_le_bytes())
            .collect();
        let held: Vec<Option<(Vec<f64>, u32, u64)>> = this
            .held
            .iter()
            .map(|held| {
                held.map(|pose| {
                    let values = [
                        &pose.position[..],
                        &pose.orientation,
                        &pose.linear_velocity,
                        &pose.angular_velocity,
                    ]
                    .concat();
                    (values, pose.buttons, pose.t_client_ns)
                })
            })
            .collect();
        let py = slf.py();
        let bytes = (PyBytes::new(py, &words), PyBytes::new(py, &floats));
        let arguments = (bytes.0, bytes.1, this.hash, held, this.seqs.clone()).into_pyobject(py)?;
        Ok((slf.getattr("_of")?, arguments))
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        let same = |other: &Self| {
            // Bits, not values: a NaN or a signed zero is a difference.
            self.hash == other.hash
                && self.saved.words == other.saved.words
                && self.saved.floats.iter().map(|x| x.to_bits()).eq(other
                    .saved
                    .floats
                    .iter()
                    .map(|x| x.to_bits()))
        };
        other.cast::<Self>().is_ok_and(|other| same(other.get()))
    }

    fn __repr__(&self) -> String {
        format!("Snapshot(hash={:016x})", self.hash)
    }
}
