//! Simulated haptic devices: those of `palpate device`.

use crate::client::{Tool, client_error};
use crate::errors::raised;
use crate::pose::Pose;
use crate::values::{floats, keyword, python};
use numpy::PyArray1;
use palpate_client::device::run::{PATIENCE, RunError, RunSettings, run as run_device};
use palpate_client::device::{self, DeviceModel, Goal, Hand, Motion, Network, devices};
use palpate_proto::messages::ToolPose;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

fn refused(error: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

fn text_of(name: &str) -> PyResult<Option<String>> {
    let path = Path::new(name);
    if !path.is_file() {
        return Ok(None);
    }
    std::fs::read_to_string(path)
        .map(Some)
        .map_err(|error| crate::errors::os_error(path, &error))
}

/// A haptic device with a hand on it, stepped one servo period at a time.
///
/// Parameters
/// ----------
/// model : str
///     Name of a device (`SimulatedDevice.names()`), or a TOML file with its figures.
/// hand : str
///     `light`, `relaxed`, `firm`, or a TOML file.
/// start : sequence of 3 floats
///     Where it is at first, m.
/// seed : int
///     Decides the hand's tremor.
#[pyclass(frozen, module = "palpate")]
pub struct SimulatedDevice {
    inner: Mutex<device::SimulatedDevice>,
    hand: Hand,
    seed: u64,
}

impl SimulatedDevice {
    fn locked(&self) -> std::sync::MutexGuard<'_, device::SimulatedDevice> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl SimulatedDevice {
    #[new]
    #[pyo3(signature = (model="ideal", hand="relaxed", start=None, seed=1))]
    fn new(model: &str, hand: &str, start: Option<&Bound<'_, PyAny>>, seed: u64) -> PyResult<Self> {
        let model = match text_of(model)? {
            Some(text) => DeviceModel::from_toml(&text, model),
            None => DeviceModel::preset(model),
        };
        let hand = match text_of(hand)? {
            Some(text) => Hand::from_toml(&text, hand),
            None => Hand::preset(hand),
        };
        let (model, hand) = (model.map_err(refused)?, hand.map_err(refused)?);
        let start = start.map_or(Ok([0.0; 3]), |start| floats::<3>(start, "start"))?;
        let inner = device::SimulatedDevice::new(model, hand.clone(), start, seed);
        Ok(Self {
            inner: Mutex::new(inner),
            hand,
            seed,
        })
    }

    /// Names of the known devices.
    #[staticmethod]
    fn names() -> Vec<String> {
        devices().into_iter().map(|model| model.name).collect()
    }

    /// Runs one servo period: the hand pulls to `goal`, the motors pull with `force`. Returns the pose
    /// that the encoders tell.
    ///
    /// Parameters
    /// ----------
    /// goal : sequence of 3 floats
    ///     Where the hand wants to be, m.
    /// force : sequence of 3 floats
    ///     N.
    /// goal_velocity, torque : sequence of 3 floats, optional
    ///     m/s and N·m.
    /// dt : float, optional
    ///     s; by default the device's own period.
    #[pyo3(signature = (goal, force, *, goal_velocity=None, torque=None, dt=None))]
    fn step(
        &self,
        goal: &Bound<'_, PyAny>,
        force: &Bound<'_, PyAny>,
        goal_velocity: Option<&Bound<'_, PyAny>>,
        torque: Option<&Bound<'_, PyAny>>,
        dt: Option<f64>,
    ) -> PyResult<Pose> {
        let triple = |value: Option<&Bound<'_, PyAny>>, name: &str| {
            value.map_or(Ok([0.0; 3]), |value| floats::<3>(value, name))
        };
        let goal = Goal::moving(
            floats::<3>(goal, "goal")?,
            triple(goal_velocity, "goal_velocity")?,
        );
        let (force, torque) = (floats::<3>(force, "force")?, triple(torque, "torque")?);
        if let Some(dt) = dt.filter(|dt| !(dt.is_finite() && *dt > 0.0 && *dt <= 1.0)) {
            return Err(PyValueError::new_err(format!(
                "dt is {dt} s; it must be above 0 and at most 1"
            )));
        }
        let mut device = self.locked();
        let dt = dt.unwrap_or(1.0 / device.model().rate_hz);
        device.advance_with_torque(goal, force, torque, dt);
        let inner = ToolPose { ..device.pose() };
        Pose::checked(inner)
    }

    /// The pose that the encoders tell.
    #[getter]
    fn pose(&self) -> PyResult<Pose> {
        Pose::checked(self.locked().pose())
    }

    /// Where it really is, (3,) m.
    #[getter]
    fn position<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.locked().true_position())
    }

    /// What the motors applied over the last period, (3,) N.
    #[getter]
    fn applied<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.locked().applied_n())
    }

    /// Time of the device, s.
    #[getter]
    fn time(&self) -> f64 {
        self.locked().time_s()
    }

    /// Servo rate, Hz.
    #[getter]
    fn rate(&self) -> f64 {
        self.locked().model().rate_hz
    }

    /// Name of the device.
    #[getter]
    fn name(&self) -> String {
        self.locked().model().name.clone()
    }

    /// Where the energy went since the start, J: `hand_j`, `loop_j`, `viscous_j`, `coulomb_j`,
    /// `kinetic_j`.
    fn energy<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let text =
            serde_json::to_string(&self.locked().energy()).map_err(crate::errors::internal)?;
        python(py, "json", "loads", (text,))
    }

    /// Figures of the device, and of the hand, as dictionaries.
    fn figures<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let (device, hand) = self._figures_json()?;
        Ok((
            python(py, "json", "loads", (device,))?,
            python(py, "json", "loads", (hand,))?,
        ))
    }

    fn _figures_json(&self) -> PyResult<(String, String)> {
        let json = |error| crate::errors::internal(error);
        Ok((
            serde_json::to_string(self.locked().model()).map_err(json)?,
            serde_json::to_string(&self.hand).map_err(json)?,
        ))
    }

    /// [`crate::client`]'s `Tool.drive`.
    fn _drive(
        &self,
        py: Python<'_>,
        tool: &Tool,
        motion: &str,
        options: &Bound<'_, PyDict>,
    ) -> PyResult<String> {
        let (seconds, depth): (f64, f64) =
            (keyword(options, "seconds")?, keyword(options, "depth")?);
        let delay = keyword(options, "delay")?;
        if !(seconds.is_finite() && seconds > 0.0) {
            return Err(PyValueError::new_err(format!(
                "seconds is {seconds}; it must be finite and above 0"
            )));
        }
        let scene = py.detach(|| tool.palpate().scene()).map_err(client_error)?;
        let id = tool.name().to_owned();
        let motion = match text_of(motion)? {
            Some(text) => Motion::from_toml(&text, motion, &scene, &id, depth),
            None => Motion::named(motion, &scene, &id, depth),
        };
        let motion = motion.map_err(refused)?;
        let (model, seed) = (self.locked().model().clone(), self.seed);
        tool.announce_info(py, &model.info(delay))?;
        let own_hz = if tool.is_lockstep() {
            1e9 / scene.dt_ns as f64
        } else {
            model.rate_hz
        };
        let settings = RunSettings {
            rate_hz: keyword::<Option<f64>>(options, "rate")?.unwrap_or(own_hz),
            duration_s: seconds,
            network: Network {
                delay_s: delay,
                jitter_s: keyword(options, "jitter")?,
                loss: keyword(options, "loss")?,
                reorder: 0.0,
                seed,
            },
            passivity: keyword(options, "passivity")?,
            patience: PATIENCE,
        };
        if !(1.0..=20_000.0).contains(&settings.rate_hz) {
            return Err(PyValueError::new_err("rate must be 1 to 20000 Hz"));
        }
        let mut device =
            device::SimulatedDevice::new(model, self.hand.clone(), motion.goal(0.0).position, seed);
        let stop = AtomicBool::new(false);
        let done = AtomicBool::new(false);
        let (report, signal) = py.detach(|| {
            std::thread::scope(|scope| {
                let run = scope.spawn(|| {
                    let report = Python::attach(|py| {
                        tool.with(py, |tool| {
                            run_device(tool, &mut device, &motion, &settings, &stop, &mut |_| {})
                        })
                    });
                    done.store(true, Ordering::Release);
                    report
                });
                let mut signal = Ok(());
                while !done.load(Ordering::Acquire) && !run.is_finished() {
                    std::thread::sleep(Duration::from_millis(10));
                    if signal.is_ok() {
                        signal = Python::attach(|py| py.check_signals());
                        stop.store(signal.is_err(), Ordering::Relaxed);
                    }
                }
                (run.join(), signal)
            })
        });
        signal?;
        let report =
            report.map_err(|_| crate::errors::internal("the device's thread panicked"))??;
        let report = report.map_err(|error| match error {
            RunError::Client(error) => client_error(error),
            RunError::Network(error) => raised("ClientError", error),
        })?;
        *self.locked() = device;
        if report.gave_up {
            return Err(raised("NoAnswerError", "the daemon stopped answering"));
        }
        serde_json::to_string(&report).map_err(crate::errors::internal)
    }

    fn __repr__(&self) -> String {
        format!(
            "SimulatedDevice({:?}, hand={:?})",
            self.name(),
            self.hand.name
        )
    }
}
