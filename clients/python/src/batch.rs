//! Many simulations at once: one thread a core, without the GIL.
//!
//! Poses are read from, and results written to, NumPy arrays of the batch. Threads never touch these
//! arrays: before the ticks the calling thread copies the poses, after them it copies the results,
//! both with the GIL. So a view cannot be torn, whoever holds it.

use crate::arrays::{Arrays, RESULTS, view, write_result};
use crate::built::Built;
use crate::closest::cores;
use crate::errors::{busy, internal};
use crate::output::push_contact;
use crate::pose::{Pose, of_numbers};
use crate::scene::Scene;
use crate::ticks::{Loop, advance};
use crate::values::{is_watched, structured};
use crate::vary::Varied;
use numpy::{PyArray1, PyArrayDyn, PyArrayMethods};
use palpate_geometry::math::{Point3, state_hash};
use palpate_proto::messages::ToolPose;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::sync::{Arc, Mutex, MutexGuard, TryLockError};
use std::time::{Duration, Instant};

/// Signals are looked for this often: between two ticks of all copies. A copy has all its ticks of a round at once: what it
/// needs of its body, some megabytes that others take from the cache, is read anew in the first of them only.
const ROUND: Duration = Duration::from_millis(100);

/// A net of all copies that somebody looks at.
struct NetView {
    body: usize,
    array: Py<PyArrayDyn<f64>>,
}

struct Inner {
    copies: Vec<Loop>,
    varied: Varied,
    nets: Vec<NetView>,
    /// Of one tick of all copies, as last measured.
    tick_time: Option<Duration>,
}

/// Many copies of a scene, stepped together on all cores.
///
/// Parameters
/// ----------
/// scene : Scene
/// n : int
///     Copies, at least 1.
/// workers : int, optional
///     Threads; by default one per core. Results do not depend on it.
///
/// Each copy computes what a daemon in lockstep computes with the same poses, bit for bit. Every
/// tool sends its row of `pose` in every tick.
#[pyclass(frozen, module = "palpate")]
pub struct Batch {
    built: Arc<Built>,
    workers: usize,
    n: usize,
    arrays: Vec<Arrays>,
    inner: Mutex<Inner>,
}

impl Batch {
    fn lock(&self) -> PyResult<MutexGuard<'_, Inner>> {
        match self.inner.try_lock() {
            Ok(inner) => Ok(inner),
            Err(TryLockError::Poisoned(inner)) => Ok(inner.into_inner()),
            Err(TryLockError::WouldBlock) => Err(busy("batch")),
        }
    }

    fn tool(&self, id: &str) -> PyResult<&Arrays> {
        Ok(&self.arrays[self.built.tool(id)?])
    }

    fn result<'py>(&self, py: Python<'py>, tool: &str, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let index = RESULTS.iter().position(|(known, _)| *known == name);
        let index = index.ok_or_else(|| internal(format!("no result {name}")))?;
        view(self.tool(tool)?.results[index].bind(py).as_any(), false)
    }

    /// Poses as they stand in the arrays, checked: by tool, then by copy.
    fn poses(&self, py: Python<'_>) -> PyResult<Vec<Vec<ToolPose>>> {
        let each = self.arrays.iter().enumerate().map(|(tool, arrays)| {
            let id = self.built.scene.tool_id(tool);
            let wrong = |what: &str| {
                PyValueError::new_err(format!("{what} of {id:?} is being written elsewhere"))
            };
            let pose = arrays
                .pose
                .bind(py)
                .try_readonly()
                .map_err(|_| wrong("pose"))?;
            let velocity = arrays
                .velocity
                .bind(py)
                .try_readonly()
                .map_err(|_| wrong("velocity"))?;
            let buttons = arrays
                .buttons
                .bind(py)
                .try_readonly()
                .map_err(|_| wrong("buttons"))?;
            let (pose, velocity) = (
                pose.as_slice().map_err(internal)?,
                velocity.as_slice().map_err(internal)?,
            );
            let buttons = buttons.as_slice().map_err(internal)?;
            let rows = pose
                .chunks_exact(7)
                .zip(velocity.chunks_exact(6))
                .zip(buttons)
                .enumerate();
            rows.map(|(copy, ((pose, velocity), buttons))| {
                let mut row = [0.0; 13];
                row[..7].copy_from_slice(pose);
                row[7..].copy_from_slice(velocity);
                if let Some(k) = row.iter().position(|x| !x.is_finite()) {
                    let (name, column) = if k < 7 {
                        ("pose", k)
                    } else {
                        ("velocity", k - 7)
                    };
                    return Err(PyValueError::new_err(format!(
                        "{name}({id:?})[{copy}, {column}] is {}; it must be finite",
                        row[k]
                    )));
                }
                let pose = Pose::checked(of_numbers(&row)).map_err(|error| {
                    PyValueError::new_err(format!("pose({id:?})[{copy}]: {}", error.value(py)))
                })?;
                Ok(ToolPose {
                    buttons: *buttons,
                    ..pose.inner
                })
            })
            .collect()
        });
        each.collect()
    }

    /// Writes what came out of the last tick.
    fn write(&self, py: Python<'_>, inner: &mut Inner) -> PyResult<()> {
        for (tool, arrays) in self.arrays.iter().enumerate() {
            for (index, (name, width)) in RESULTS.into_iter().enumerate() {
                let array = arrays.results[index].bind(py).try_readwrite();
                let mut array = array.map_err(|error| {
                    PyValueError::new_err(format!("the view of {name}: {error}"))
                })?;
                let values = array.as_slice_mut().map_err(internal)?;
                for (row, copy) in values.chunks_exact_mut(width).zip(&inner.copies) {
                    write_result(name, &copy.output.tools[tool], row);
                }
            }
            let flags = arrays.flags.bind(py).try_readwrite();
            let mut flags = flags
                .map_err(|error| PyValueError::new_err(format!("the view of flags: {error}")))?;
            let flags = flags.as_slice_mut().map_err(internal)?;
            for (flags, copy) in flags.iter_mut().zip(&inner.copies) {
                *flags = copy.output.tools[tool].flags;
            }
        }
        // One reference is ours: nobody looks at the others.
        inner.nets.retain(|net| is_watched(py, &net.array));
        inner
            .nets
            .iter()
            .try_for_each(|net| write_net(py, net, &inner.copies))
    }
}

fn write_net(py: Python<'_>, net: &NetView, copies: &[Loop]) -> PyResult<()> {
    let array = net.array.bind(py).try_readwrite();
    let mut array =
        array.map_err(|error| PyValueError::new_err(format!("the view of a net: {error}")))?;
    let values = array.as_slice_mut().map_err(internal)?;
    let count = copies[0].scene.skin(net.body).points().len();
    let mut points = vec![Point3::origin(); count];
    for (values, copy) in values.chunks_exact_mut(3 * count).zip(copies) {
        copy.state.copy_net(&copy.scene, net.body, &mut points);
        for (values, point) in values.chunks_exact_mut(3).zip(&points) {
            values.copy_from_slice(point.coords.as_slice());
        }
    }
    Ok(())
}

#[pymethods]
impl Batch {
    #[new]
    #[pyo3(signature = (scene, n, workers=None))]
    fn new(py: Python<'_>, scene: &Scene, n: usize, workers: Option<usize>) -> PyResult<Self> {
        if n == 0 || workers == Some(0) {
            return Err(PyValueError::new_err(
                "a batch needs at least one copy and one worker",
            ));
        }
        let built = scene.built.clone();
        let copies = py.detach(|| (0..n).map(|_| Loop::new(&built.scene)).collect());
        let varied = Varied::new(n);
        let batch = Self {
            workers: workers.unwrap_or_else(cores).min(n),
            n,
            arrays: (0..built.scene.tool_count())
                .map(|_| Arrays::new(py, n))
                .collect(),
            inner: Mutex::new(Inner {
                copies,
                varied,
                nets: Vec::new(),
                tick_time: None,
            }),
            built,
        };
        for (tool, arrays) in batch.arrays.iter().enumerate() {
            let start = batch.built.start(tool);
            let row = [&start.position[..], &start.orientation].concat();
            let mut pose = arrays.pose.bind(py).readwrite();
            let values = pose.as_slice_mut().map_err(internal)?;
            values
                .chunks_exact_mut(7)
                .for_each(|pose| pose.copy_from_slice(&row));
        }
        let mut inner = batch.lock()?;
        batch.write(py, &mut inner)?;
        drop(inner);
        Ok(batch)
    }

    /// Runs ticks of all copies.
    ///
    /// Ctrl-C ends it between two ticks: all copies have then done equally many.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     A pose that is not finite or no rotation, with its tool and copy. Nothing has happened
    ///     then.
    /// BusyError
    ///     Another thread is stepping this batch.
    #[pyo3(signature = (ticks=1))]
    fn step(&self, py: Python<'_>, ticks: usize) -> PyResult<()> {
        let mut inner = self.lock()?;
        let poses = self.poses(py)?;
        for (tool, poses) in poses.into_iter().enumerate() {
            for (copy, pose) in inner.copies.iter_mut().zip(poses) {
                copy.held[tool] = Some(pose);
            }
        }
        let (mut done, mut interrupted) = (0, Ok(()));
        while done < ticks && interrupted.is_ok() {
            let fit = inner.tick_time.map_or(1, |time| {
                (ROUND.as_nanos() / time.as_nanos().max(1)) as usize
            });
            let round = fit.clamp(1, ticks - done);
            let begun = Instant::now();
            let copies = &mut inner.copies[..];
            py.detach(|| advance(copies, self.workers, round));
            inner.tick_time = Some(begun.elapsed() / u32::try_from(round).unwrap_or(u32::MAX));
            done += round;
            interrupted = py.check_signals();
        }
        self.write(py, &mut inner)?;
        interrupted
    }

    /// Poses that a tool sends: (n, 7) live view to write to, position in m and quaternion x y z w.
    fn pose<'py>(&self, py: Python<'py>, tool: &str) -> PyResult<Bound<'py, PyAny>> {
        view(self.tool(tool)?.pose.bind(py).as_any(), true)
    }

    /// Velocities that a tool sends: (n, 6) live view to write to, m/s and rad/s.
    fn velocity<'py>(&self, py: Python<'py>, tool: &str) -> PyResult<Bound<'py, PyAny>> {
        view(self.tool(tool)?.velocity.bind(py).as_any(), true)
    }

    /// Buttons of a tool: (n,) uint32 live view to write to; bit 0 grabs.
    fn buttons<'py>(&self, py: Python<'py>, tool: &str) -> PyResult<Bound<'py, PyAny>> {
        view(self.tool(tool)?.buttons.bind(py).as_any(), true)
    }

    /// Forces for the device: (n, 3) live view, N, world axes.
    fn force<'py>(&self, py: Python<'py>, tool: &str) -> PyResult<Bound<'py, PyAny>> {
        self.result(py, tool, "force")
    }

    /// Torques for the device at the tool's reference point: (n, 3) live view, N·m.
    fn torque<'py>(&self, py: Python<'py>, tool: &str) -> PyResult<Bound<'py, PyAny>> {
        self.result(py, tool, "torque")
    }

    /// Forces of all contacts: (n, 3) live view, N, neither damped nor limited for the device.
    fn contact_force<'py>(&self, py: Python<'py>, tool: &str) -> PyResult<Bound<'py, PyAny>> {
        self.result(py, tool, "contact_force")
    }

    /// Torques of all contacts about the tool's reference point: (n, 3) live view, N·m.
    fn contact_torque<'py>(&self, py: Python<'py>, tool: &str) -> PyResult<Bound<'py, PyAny>> {
        self.result(py, tool, "contact_torque")
    }

    /// Penetration of the device's tool: (n,) live view, m; 0 without contact.
    fn depth<'py>(&self, py: Python<'py>, tool: &str) -> PyResult<Bound<'py, PyAny>> {
        self.result(py, tool, "depth")
    }

    /// Where the surface holds the tool back: (n, 7) live view, position in m and quaternion.
    fn proxy<'py>(&self, py: Python<'py>, tool: &str) -> PyResult<Bound<'py, PyAny>> {
        self.result(py, tool, "proxy")
    }

    /// Net work of the device on the loop since the start: (n,) live view, J.
    fn energy<'py>(&self, py: Python<'py>, tool: &str) -> PyResult<Bound<'py, PyAny>> {
        self.result(py, tool, "energy")
    }

    /// The part of the energy that the passivity controller took away: (n,) live view, J.
    fn dissipated<'py>(&self, py: Python<'py>, tool: &str) -> PyResult<Bound<'py, PyAny>> {
        self.result(py, tool, "dissipated")
    }

    /// How far contact forces may be from those of the exact step: (n,) live view, N.
    fn error_n<'py>(&self, py: Python<'py>, tool: &str) -> PyResult<Bound<'py, PyAny>> {
        self.result(py, tool, "error_n")
    }

    /// Bits of `ForceFlags`: (n,) uint32 live view.
    fn flags<'py>(&self, py: Python<'py>, tool: &str) -> PyResult<Bound<'py, PyAny>> {
        view(self.tool(tool)?.flags.bind(py).as_any(), false)
    }

    /// Control nets of a body: (n, nu, nv, 3) live view, m, updated by every step while somebody
    /// holds it.
    fn net<'py>(&self, py: Python<'py>, body: &str) -> PyResult<Bound<'py, PyAny>> {
        let body = self.built.body(body)?;
        let mut inner = self.lock()?;
        if inner.nets.iter().all(|net| net.body != body) {
            let (_, [rows, columns]) = self.built.scene.net_size(body);
            let shape = vec![self.n, rows, columns, 3];
            let array = PyArrayDyn::zeros(py, shape, false).unbind();
            inner.nets.push(NetView { body, array });
        }
        let Inner { copies, nets, .. } = &*inner;
        let net = nets
            .iter()
            .find(|net| net.body == body)
            .ok_or_else(|| internal("a net"))?;
        write_net(py, net, copies)?;
        view(net.array.bind(py).as_any(), false)
    }

    /// Contacts of all copies: structured array (contacts,) of dtype `CONTACT`, by `copy`, deepest
    /// first.
    fn contacts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let inner = self.lock()?;
        let (mut rows, mut count) = (Vec::new(), 0);
        for (number, copy) in inner.copies.iter().enumerate() {
            for contact in copy.output.contacts.list() {
                let start = rows.len();
                push_contact(&mut rows, contact);
                // The fourth index of a row is the copy.
                rows[start + 12..start + 16].copy_from_slice(&(number as i32).to_ne_bytes());
                count += 1;
            }
        }
        structured(py, "CONTACT", &rows, &[count])
    }

    /// Gives each copy its own value of the scene, such as `body/drop/material/young_pa`; the copies
    /// begin anew. Values stay varied when others are varied later.
    ///
    /// Parameters
    /// ----------
    /// path : str
    ///     From table to key; entries of lists are named by their `id` or counted from 0.
    /// values : sequence of n values
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     A value that the scene cannot have. No copy has changed then.
    fn vary(&self, py: Python<'_>, path: &str, values: &Bound<'_, PyAny>) -> PyResult<()> {
        let mut inner = self.lock()?;
        let (varied, scenes) = inner
            .varied
            .with(py, &self.built, path, values, self.workers)?;
        let copies = py.detach(|| scenes.iter().map(Loop::new).collect());
        (inner.varied, inner.copies, inner.tick_time) = (varied, copies, None);
        self.write(py, &mut inner)
    }

    /// Returns copies to their start.
    ///
    /// Parameters
    /// ----------
    /// copies : mask (n,), indices or slice, optional
    ///     By default all.
    #[pyo3(signature = (copies=None))]
    fn reset(&self, py: Python<'_>, copies: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        let chosen: Vec<usize> = match copies {
            None => (0..self.n).collect(),
            Some(copies) => {
                let numpy = py.import("numpy")?;
                let all = numpy.call_method1("arange", (self.n,))?;
                let copies = if copies.is_instance_of::<pyo3::types::PySlice>() {
                    copies.clone()
                } else {
                    numpy.call_method1("asarray", (copies,))?
                };
                numpy
                    .call_method1("atleast_1d", (all.get_item(copies)?,))?
                    .call_method0("tolist")?
                    .extract()?
            }
        };
        let mut inner = self.lock()?;
        for copy in chosen {
            inner.copies[copy].restart();
        }
        self.write(py, &mut inner)
    }

    /// Hash of the whole state of each copy: (n,) uint64.
    fn hash<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<u64>>> {
        let mut inner = self.lock()?;
        let copies = &mut inner.copies;
        let hashes = py.detach(|| {
            copies
                .iter_mut()
                .map(|copy| state_hash(&copy.state))
                .collect()
        });
        Ok(PyArray1::from_vec(py, hashes))
    }

    /// Ticks done by each copy since its start: (n,) uint64.
    fn tick<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<u64>>> {
        let inner = self.lock()?;
        Ok(PyArray1::from_vec(
            py,
            inner.copies.iter().map(|copy| copy.state.tick).collect(),
        ))
    }

    /// Number of copies.
    #[getter]
    fn n(&self) -> usize {
        self.n
    }

    /// Threads that step.
    #[getter]
    fn workers(&self) -> usize {
        self.workers
    }

    /// The scene before values were varied.
    #[getter]
    fn scene(&self) -> Scene {
        Scene {
            built: self.built.clone(),
        }
    }

    fn __len__(&self) -> usize {
        self.n
    }

    fn __repr__(&self) -> String {
        format!(
            "Batch({:?}, n={}, workers={})",
            self.built.scene.name, self.n, self.workers
        )
    }
}
