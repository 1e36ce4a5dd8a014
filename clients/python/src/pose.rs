//! Poses of tools.

use crate::values::{array, finite, floats, shape_text, slice};
use numpy::{PyArray1, PyUntypedArrayMethods};
use palpate_proto::messages::ToolPose;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

/// Pose and velocity of a tool, world frame.
///
/// Parameters
/// ----------
/// position : sequence of 3 floats
///     Reference point of the tool, m.
/// orientation : sequence of 4 floats
///     Unit quaternion x y z w.
/// linear_velocity, angular_velocity : sequence of 3 floats
///     m/s and rad/s.
/// buttons : int
///     Bit 0: grab what the tool touches.
/// t_client_ns : int
///     Time of the sender, ns; part of what is recorded and hashed.
///
/// Raises
/// ------
/// ValueError
///     Values that are not finite, of another count, or a quaternion whose length differs from 1
///     by more than 1e-6.
#[pyclass(frozen, module = "palpate")]
#[derive(Clone, Copy, Debug)]
pub struct Pose {
    /// Its `seq` is set where it is used.
    pub inner: ToolPose,
}

impl Pose {
    /// Checked as the daemon checks a pose that arrives.
    pub fn checked(inner: ToolPose) -> PyResult<Self> {
        let norm = inner.orientation.iter().map(|x| x * x).sum::<f64>().sqrt();
        if (norm - 1.0).abs() > 1e-6 {
            return Err(PyValueError::new_err(format!(
                "orientation has the length {norm}; a unit quaternion x y z w is needed: divide it by its length"
            )));
        }
        Ok(Self { inner })
    }

    /// A [`Pose`], or 3 numbers (position), 7 (with orientation) or 13 (with velocities).
    pub fn of(value: &Bound<'_, PyAny>, name: &str) -> PyResult<ToolPose> {
        if let Ok(pose) = value.cast::<Self>() {
            return Ok(pose.get().inner);
        }
        let array = array(value, name)?;
        let counted = array.shape().len() == 1 && [3, 7, 13].contains(&array.shape()[0]);
        if !counted {
            let shape = shape_text(array.shape());
            return Err(PyValueError::new_err(format!(
                "{name} must be a Pose, or 3 (position), 7 (and orientation) or 13 numbers (and velocities), not {shape}"
            )));
        }
        finite(slice(&array), name)?;
        Ok(Self::checked(of_numbers(slice(&array)))?.inner)
    }
}

/// A pose from 3, 7 or 13 numbers.
pub fn of_numbers(values: &[f64]) -> ToolPose {
    let part = |from: usize| {
        values
            .get(from..from + 3)
            .and_then(|part| part.try_into().ok())
            .unwrap_or([0.0; 3])
    };
    ToolPose {
        orientation: values
            .get(3..7)
            .and_then(|q| q.try_into().ok())
            .unwrap_or([0.0, 0.0, 0.0, 1.0]),
        linear_velocity: part(7),
        angular_velocity: part(10),
        ..palpate_proto::pose_at(part(0))
    }
}

#[pymethods]
impl Pose {
    #[new]
    #[pyo3(signature = (position=None, orientation=None, linear_velocity=None, angular_velocity=None, *, buttons=0, t_client_ns=0))]
    fn new(
        position: Option<&Bound<'_, PyAny>>,
        orientation: Option<&Bound<'_, PyAny>>,
        linear_velocity: Option<&Bound<'_, PyAny>>,
        angular_velocity: Option<&Bound<'_, PyAny>>,
        buttons: u32,
        t_client_ns: u64,
    ) -> PyResult<Self> {
        let triple = |value: Option<&Bound<'_, PyAny>>, name: &str| {
            value.map_or(Ok([0.0; 3]), |value| floats::<3>(value, name))
        };
        Self::checked(ToolPose {
            orientation: orientation
                .map_or(Ok([0.0, 0.0, 0.0, 1.0]), |q| floats::<4>(q, "orientation"))?,
            linear_velocity: triple(linear_velocity, "linear_velocity")?,
            angular_velocity: triple(angular_velocity, "angular_velocity")?,
            buttons,
            t_client_ns,
            ..palpate_proto::pose_at(triple(position, "position")?)
        })
    }

    /// (3,) m.
    #[getter]
    fn position<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.inner.position)
    }

    /// (4,) unit quaternion x y z w.
    #[getter]
    fn orientation<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.inner.orientation)
    }

    /// (3,) m/s.
    #[getter]
    fn linear_velocity<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.inner.linear_velocity)
    }

    /// (3,) rad/s.
    #[getter]
    fn angular_velocity<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.inner.angular_velocity)
    }

    /// Bit 0: grab.
    #[getter]
    fn buttons(&self) -> u32 {
        self.inner.buttons
    }

    /// Time of the sender, ns.
    #[getter]
    fn t_client_ns(&self) -> u64 {
        self.inner.t_client_ns
    }

    /// (13,) position, orientation, linear and angular velocity.
    fn array<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let ToolPose {
            position,
            orientation,
            linear_velocity,
            angular_velocity,
            ..
        } = &self.inner;
        PyArray1::from_vec(
            py,
            [
                &position[..],
                orientation,
                linear_velocity,
                angular_velocity,
            ]
            .concat(),
        )
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other
            .cast::<Self>()
            .is_ok_and(|other| other.get().inner == self.inner)
    }

    fn __repr__(&self) -> String {
        let ToolPose {
            position: [x, y, z],
            orientation: [a, b, c, d],
            ..
        } = self.inner;
        format!("Pose(position=({x:?}, {y:?}, {z:?}), orientation=({a:?}, {b:?}, {c:?}, {d:?}))")
    }

    fn __getnewargs_ex__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyTuple>, Bound<'py, PyDict>)> {
        let ToolPose {
            position,
            orientation,
            linear_velocity,
            angular_velocity,
            buttons,
            t_client_ns,
            ..
        } = self.inner;
        let arguments =
            (position, orientation, linear_velocity, angular_velocity).into_pyobject(py)?;
        let named = PyDict::new(py);
        named.set_item("buttons", buttons)?;
        named.set_item("t_client_ns", t_client_ns)?;
        Ok((arguments, named))
    }
}
