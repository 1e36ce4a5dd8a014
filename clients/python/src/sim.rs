//! One simulation in this process: the daemon's own step function, without a clock.

use crate::built::Built;
use crate::errors::{busy, raised, surface_error};
use crate::output::Output;
use crate::pose::{Pose, of_numbers};
use crate::scene::Scene;
use crate::snapshot::Snapshot;
use crate::surface::Surface;
use crate::ticks::{Loop, interruptible};
use crate::values::{array, finite, is_watched, python, shape_text, shaped, slice};
use numpy::{PyArray1, PyArray3, PyArrayMethods, PyUntypedArrayMethods};
use palpate_geometry::math::{Point3, SavedState, state_hash};
use palpate_proto::messages::ToolPose;
use palpate_sim::tick::quantity::Quantity;
use palpate_sim::tick::record::Command;
use palpate_sim::tick::{apply, restore};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};
use std::sync::{Arc, Mutex, MutexGuard, TryLockError};

/// A net that somebody looks at.
struct View {
    body: usize,
    array: Py<PyArray3<f64>>,
}

struct Inner {
    run: Loop,
    views: Vec<View>,
    points: Vec<Point3>,
}

/// A simulation in this process. Made by `Scene.simulate()`.
///
/// A tool keeps sending the pose that it was given last, once a tick, until it is given another,
/// or `None`.
#[pyclass(frozen, module = "palpate")]
pub struct Simulation {
    built: Arc<Built>,
    inner: Mutex<Inner>,
}

impl Simulation {
    /// At the scene's start.
    pub fn start(built: Arc<Built>) -> Self {
        let run = Loop::new(&built.scene);
        let inner = Inner {
            run,
            views: Vec::new(),
            points: Vec::new(),
        };
        Self {
            built,
            inner: Mutex::new(inner),
        }
    }

    fn lock(&self) -> PyResult<MutexGuard<'_, Inner>> {
        match self.inner.try_lock() {
            Ok(inner) => Ok(inner),
            Err(TryLockError::Poisoned(inner)) => Ok(inner.into_inner()),
            Err(TryLockError::WouldBlock) => Err(busy("simulation")),
        }
    }

    /// Poses by tool index, all of them checked.
    fn poses(&self, poses: Option<&Bound<'_, PyAny>>) -> PyResult<Vec<(usize, Option<ToolPose>)>> {
        let Some(poses) = poses else {
            return Ok(Vec::new());
        };
        let Ok(poses) = poses.cast::<PyDict>() else {
            let kind = poses.get_type().name()?;
            return Err(PyTypeError::new_err(format!(
                "poses are a dictionary by tool, not {kind}: {{\"ball\": pose}}"
            )));
        };
        let mut list = Vec::with_capacity(poses.len());
        for (tool, pose) in poses {
            let id = tool.cast::<PyString>()?;
            let id = id.to_cow()?;
            let tool = self.built.tool(&id)?;
            let pose = if pose.is_none() {
                None
            } else {
                Some(Pose::of(&pose, &format!("pose of {id:?}"))?)
            };
            list.push((tool, pose));
        }
        Ok(list)
    }
}

impl Inner {
    /// Writes the nets that somebody holds a view of.
    fn refresh(&mut self, py: Python<'_>) -> PyResult<()> {
        // One reference is ours: nobody looks at the others.
        self.views.retain(|view| is_watched(py, &view.array));
        for view in &self.views {
            write_net(py, &self.run, view, &mut self.points)?;
        }
        Ok(())
    }
}

fn write_net(py: Python<'_>, run: &Loop, view: &View, points: &mut Vec<Point3>) -> PyResult<()> {
    let count = run.scene.skin(view.body).points().len();
    points.resize(count, Point3::origin());
    run.state.copy_net(&run.scene, view.body, points);
    let array = view.array.bind(py).try_readwrite();
    let mut array =
        array.map_err(|error| PyValueError::new_err(format!("the view of a net: {error}")))?;
    let values = array.as_slice_mut().map_err(crate::errors::internal)?;
    for (values, point) in values.chunks_exact_mut(3).zip(points.iter()) {
        values.copy_from_slice(point.coords.as_slice());
    }
    Ok(())
}

#[pymethods]
impl Simulation {
    /// Runs ticks and returns what the last one gave.
    ///
    /// Parameters
    /// ----------
    /// poses : dict of str to Pose, optional
    ///     New poses by tool, as `Pose` or as 3 (position), 7 (and quaternion x y z w) or 13 numbers
    ///     (and velocities). A tool that is not named keeps sending its last one; `None` ends that.
    /// ticks : int
    ///     How many, at least 1.
    /// explain : bool
    ///     Have `Output.explain` say why the forces of the last tick are what they are. Slower, to the same bits.
    ///
    /// Raises
    /// ------
    /// KeyError
    ///     No such tool.
    /// ValueError
    ///     A pose of another shape, not finite, or with a quaternion whose length is not 1. Nothing
    ///     has happened then.
    /// BusyError
    ///     Another thread is stepping this simulation.
    #[pyo3(signature = (poses=None, ticks=1, *, explain=false))]
    fn step(
        &self,
        py: Python<'_>,
        poses: Option<&Bound<'_, PyAny>>,
        ticks: usize,
        explain: bool,
    ) -> PyResult<Output> {
        if ticks == 0 {
            return Err(PyValueError::new_err("ticks is 0; at least one is needed"));
        }
        let poses = self.poses(poses)?;
        let mut inner = self.lock()?;
        for (tool, pose) in poses {
            inner.run.held[tool] = pose;
        }
        let run = &mut inner.run;
        let mut explanation = None;
        let ran = interruptible(py, ticks, |k| match explain && k + 1 == ticks {
            true => explanation = Some(run.explained()),
            false => run.tick(),
        });
        if !inner.views.is_empty() {
            inner.refresh(py)?;
        }
        ran?;
        Ok(Output::of(&inner.run.output, &self.built).explained(explanation))
    }

    /// Runs one tick for each row of the given poses, without the GIL; returns a `Trace` of arrays.
    ///
    /// Parameters
    /// ----------
    /// poses : dict of str to array
    ///     By tool: (ticks, 3) positions, (ticks, 7) poses or (ticks, 13) poses with velocities.
    fn run<'py>(slf: &Bound<'py, Self>, poses: &Bound<'py, PyDict>) -> PyResult<Bound<'py, PyAny>> {
        python(
            slf.py(),
            "palpate._scenes",
            "_trace",
            (slf.get()._run(slf.py(), poses)?,),
        )
    }

    /// The bodies as they stand as a picture on a page, for notebooks: see `docs/python.md`.
    #[pyo3(signature = (width=720, height=420))]
    fn show<'py>(slf: &Bound<'py, Self>, width: u32, height: u32) -> PyResult<Bound<'py, PyAny>> {
        python(
            slf.py(),
            "palpate._notebook",
            "_show_simulation",
            (slf, width, height),
        )
    }

    /// Runs one tick for each row of the given poses; returns a dictionary of arrays.
    ///
    /// Parameters
    /// ----------
    /// poses : dict of str to array
    ///     By tool: (ticks, 3) positions, (ticks, 7) poses or (ticks, 13) poses with velocities.
    ///
    /// Returns
    /// -------
    /// dict
    ///     `tick` (ticks,), `hash` (ticks,), and by tool `force`, `torque`, `contact_force`
    ///     (ticks, 3), `depth`, `flags` and `error_n` (ticks,).
    fn _run<'py>(
        &self,
        py: Python<'py>,
        poses: &Bound<'py, PyDict>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let mut rows: Vec<(usize, usize, Vec<f64>)> = Vec::new();
        let mut ticks = None;
        for (id, values) in poses {
            let id: String = id.extract()?;
            let tool = self.built.tool(&id)?;
            let name = format!("poses of {id:?}");
            let array = array(&values, &name)?;
            let &[count, width @ (3 | 7 | 13)] = array.shape() else {
                let shape = shape_text(array.shape());
                return Err(PyValueError::new_err(format!(
                    "{name} have the shape {shape}; (ticks, 3), (ticks, 7) or (ticks, 13) is needed"
                )));
            };
            if ticks.replace(count).is_some_and(|before| before != count) {
                return Err(PyValueError::new_err("all tools need equally many poses"));
            }
            let values = slice(&array).to_vec();
            finite(&values, &name)?;
            for row in values.chunks_exact(width) {
                Pose::checked(of_numbers(row))?;
            }
            rows.push((tool, width, values));
        }
        let ticks =
            ticks.ok_or_else(|| PyValueError::new_err("no poses: name at least one tool"))?;
        let mut inner = self.lock()?;
        let tools = self.built.scene.tool_count();
        let traced = TRACED.iter().flat_map(|name| Quantity::named(name));
        let traced: Vec<&Quantity> = traced.collect();
        let mut traces = vec![(vec![Vec::new(); traced.len()], Vec::new()); tools];
        let (mut numbers, mut hashes) = (Vec::with_capacity(ticks), Vec::with_capacity(ticks));
        let run = &mut inner.run;
        let ran = interruptible(py, ticks, |k| {
            for (tool, width, values) in &rows {
                run.held[*tool] = Some(of_numbers(&values[k * width..(k + 1) * width]));
            }
            run.tick();
            numbers.push(run.output.tick);
            hashes.push(run.output.state_hash);
            for ((trace, flags), out) in traces.iter_mut().zip(run.output.tools.as_slice()) {
                for (quantity, numbers) in traced.iter().zip(trace) {
                    quantity.push(&out.into(), numbers);
                }
                flags.push(out.flags);
            }
        });
        inner.refresh(py)?;
        ran?;
        let result = PyDict::new(py);
        result.set_item("tick", PyArray1::from_vec(py, numbers))?;
        result.set_item("hash", PyArray1::from_vec(py, hashes))?;
        let of_flags = PyDict::new(py);
        let by_name: Vec<_> = traced.iter().map(|_| PyDict::new(py)).collect();
        for ((trace, flags), id) in traces.into_iter().zip(self.built.tool_ids()) {
            for ((quantity, numbers), by_tool) in traced.iter().zip(trace).zip(&by_name) {
                let shape = [ticks, quantity.width()];
                let shape = if quantity.width() == 1 {
                    &shape[..1]
                } else {
                    &shape
                };
                by_tool.set_item(&id, shaped(py, numbers, shape)?)?;
            }
            of_flags.set_item(&id, PyArray1::from_vec(py, flags))?;
        }
        for (quantity, by_tool) in traced.iter().zip(by_name) {
            result.set_item(quantity.name, by_tool)?;
        }
        result.set_item("flags", of_flags)?;
        Ok(result)
    }

    /// The control net of a body as it stands: (nu, nv, 3) m, a live view that every step updates
    /// while somebody holds it. Copy it to keep it. It stays valid without the simulation.
    fn net<'py>(&self, py: Python<'py>, body: &str) -> PyResult<Bound<'py, PyAny>> {
        let body = self.built.body(body)?;
        let mut inner = self.lock()?;
        let Inner { run, views, points } = &mut *inner;
        let known = views.iter().position(|view| view.body == body);
        let at = known.unwrap_or_else(|| {
            let (_, [rows, columns]) = self.built.scene.net_size(body);
            let array = PyArray3::zeros(py, [rows, columns, 3], false).unbind();
            views.push(View { body, array });
            views.len() - 1
        });
        write_net(py, run, &views[at], points)?;
        let view = views[at].array.bind(py).call_method0("view")?;
        view.getattr("flags")?.setattr("writeable", false)?;
        Ok(view)
    }

    /// The surface of a body as it stands; a copy.
    fn surface(&self, body: &str) -> PyResult<Surface> {
        let body = self.built.body(body)?;
        let inner = self.lock()?;
        let mut points = self.built.scene.skin(body).points().to_vec();
        inner
            .run
            .state
            .copy_net(&self.built.scene, body, &mut points);
        let surface = self.built.scene.surface_with(body, &points);
        match surface.map_err(surface_error)? {
            Some(surface) => Ok(Surface::of(surface)),
            None => Err(crate::errors::no_surface(self.built.scene.body_id(body))),
        }
    }

    /// The whole state, to go back to: equal states are equal by bits.
    fn save(&self) -> PyResult<Snapshot> {
        let inner = self.lock()?;
        let mut saved = SavedState::default();
        saved.save_from(&inner.run.state);
        let run = &inner.run;
        Ok(Snapshot {
            saved,
            hash: state_hash(&run.state),
            held: run.held.clone(),
            seqs: run.seqs.clone(),
        })
    }

    /// Goes back to a saved state, of this scene or of another object of an equal scene.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     The snapshot is of another scene; nothing has changed then.
    fn restore(&self, py: Python<'_>, snapshot: &Snapshot) -> PyResult<()> {
        let mut inner = self.lock()?;
        let run = &mut inner.run;
        if snapshot.held.len() != run.held.len() {
            return Err(PyValueError::new_err("the snapshot is of another scene"));
        }
        let mut before = SavedState::default();
        before.save_from(&run.state);
        if let Err(error) = restore(
            &run.scene,
            &mut run.state,
            &mut run.scratch,
            &snapshot.saved,
        ) {
            // A state that fits in part must not stay.
            restore(&run.scene, &mut run.state, &mut run.scratch, &before)
                .map_err(crate::errors::internal)?;
            return Err(PyValueError::new_err(format!(
                "the snapshot is of another scene: {error}"
            )));
        }
        run.held.clone_from(&snapshot.held);
        run.seqs.clone_from(&snapshot.seqs);
        inner.refresh(py)
    }

    /// Back to the scene's start, as a new simulation.
    fn reset(&self, py: Python<'_>) -> PyResult<()> {
        let mut inner = self.lock()?;
        inner.run.restart();
        inner.refresh(py)
    }

    /// Carries out a command of the daemon between two ticks: `reset` (the tick count goes on, as
    /// in a daemon), `pause`, `resume` or `stop`.
    fn command(&self, py: Python<'_>, name: &str) -> PyResult<()> {
        let command = match name {
            "reset" => Command::Reset,
            "pause" => Command::Pause,
            "resume" => Command::Resume,
            "stop" => Command::Stop,
            _ => {
                return Err(PyValueError::new_err(format!(
                    "{name:?} is not a command; use reset, pause, resume or stop"
                )));
            }
        };
        let mut inner = self.lock()?;
        let run = &mut inner.run;
        apply(&run.scene, &mut run.state, &mut run.scratch, command);
        inner.refresh(py)
    }

    /// Hash of the whole state: equal to that of a daemon in lockstep after the same poses.
    fn hash(&self) -> PyResult<u64> {
        Ok(state_hash(&self.lock()?.run.state))
    }

    /// Ticks done.
    #[getter]
    fn tick(&self) -> PyResult<u64> {
        Ok(self.lock()?.run.state.tick)
    }

    /// Simulated time, s.
    #[getter]
    fn time(&self) -> PyResult<f64> {
        Ok(self.lock()?.run.state.tick as f64 * self.built.scene.dt_s)
    }

    /// The scene.
    #[getter]
    fn scene(&self) -> Scene {
        Scene {
            built: self.built.clone(),
        }
    }

    fn __repr__(&self) -> PyResult<String> {
        Ok(format!(
            "Simulation({:?}, tick={})",
            self.built.scene.name,
            self.tick()?
        ))
    }

    fn __reduce__(&self) -> PyResult<()> {
        Err(raised(
            "NotPicklableError",
            "a simulation is not pickled: pickle sim.scene and sim.save(), and restore there",
        ))
    }
}

/// What a run keeps of each tool and tick beside its flags.
const TRACED: [&str; 5] = ["force", "torque", "contact_force", "depth", "error_n"];
