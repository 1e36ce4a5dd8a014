//! A link with a daemon. Messages leave as bytes, which `palpate.wire` decodes, except those that come
//! a thousand times a second (forces) or are large (nets).

use crate::errors::{internal, raised};
use crate::pose::Pose;
use crate::values::net_array;
use palpate_client::{ClientError, Connect, Palpate};
use palpate_geometry::math::Point3;
use palpate_proto::codec::{decode, encode};
use palpate_proto::messages::{ControlNet, DeviceInfo, ToolForce};
use palpate_proto::rpc::{Answer, Call};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyBytes, PyDict};
use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::{Duration, Instant};

/// Waiting ends this often to look for signals.
const SLICE: Duration = Duration::from_millis(50);
/// Most messages that wait to be read; the oldest leave.
const MOST_WAITING: usize = 65_536;

/// The exception that fits.
pub fn client_error(error: ClientError) -> PyErr {
    let class = match &error {
        ClientError::Unreachable { .. } => "UnreachableError",
        ClientError::NoAnswer { .. } => "NoAnswerError",
        ClientError::Refused { .. } | ClientError::Call(_) => "RefusedError",
        ClientError::Held { .. } => "HeldError",
        ClientError::Unknown { .. } => "UnknownNameError",
        _ => "ClientError",
    };
    raised(class, error)
}

fn seconds(timeout: f64) -> PyResult<Duration> {
    Duration::try_from_secs_f64(timeout).map_err(|_| {
        PyValueError::new_err(format!(
            "a time of {timeout} s: it must be finite and not below 0"
        ))
    })
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Process in which Zenoh's threads run: a forked child has none of them, and would wait for ever.
static ZENOH_IN: OnceLock<u32> = OnceLock::new();

/// True in a child that was forked after Zenoh had started.
fn is_forked() -> bool {
    ZENOH_IN.get().is_some_and(|pid| *pid != std::process::id())
}

/// Refuses what needs Zenoh's threads in a forked child.
fn not_forked() -> PyResult<()> {
    if is_forked() {
        return Err(raised(
            "ClientError",
            "this process was forked after its parent had spoken to a daemon, and has no threads for that: \
             use multiprocessing with \"spawn\", or fork before the first connect",
        ));
    }
    Ok(())
}

/// A link with a daemon.
#[pyclass(frozen, module = "palpate._native")]
pub struct Link {
    palpate: Mutex<Option<Arc<Palpate>>>,
}

impl Link {
    /// The session, if it is still open.
    pub fn session(&self) -> PyResult<Arc<Palpate>> {
        not_forked()?;
        locked(&self.palpate)
            .clone()
            .ok_or_else(|| raised("ClientError", "this link is closed"))
    }

    fn asked<T: Send>(
        &self,
        py: Python<'_>,
        ask: impl FnOnce(&Palpate) -> Result<T, ClientError> + Send,
    ) -> PyResult<T> {
        let palpate = self.session()?;
        py.detach(|| ask(&palpate)).map_err(client_error)
    }
}

#[pymethods]
impl Link {
    #[new]
    #[pyo3(signature = (endpoints, instance, timeout, onlooker=false, config=None, insecure=false))]
    fn new(
        py: Python<'_>,
        endpoints: Vec<String>,
        instance: String,
        timeout: f64,
        onlooker: bool,
        config: Option<std::path::PathBuf>,
        insecure: bool,
    ) -> PyResult<Self> {
        ZENOH_IN.get_or_init(std::process::id);
        not_forked()?;
        let settings = Connect {
            endpoints,
            instance,
            zenoh_config: config,
            identity: None,
            timeout: seconds(timeout)?,
            onlooker,
            insecure,
        };
        let palpate = py
            .detach(|| Palpate::connect(&settings))
            .map_err(client_error)?;
        Ok(Self {
            palpate: Mutex::new(Some(Arc::new(palpate))),
        })
    }

    /// Bytes of `SceneSnapshot`.
    fn scene<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let scene = self.asked(py, Palpate::scene)?;
        Ok(PyBytes::new(py, &encode(&scene)))
    }

    /// Bytes of `LoopStatus`.
    fn status<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let status = self.asked(py, Palpate::status)?;
        Ok(PyBytes::new(py, &encode(&status)))
    }

    /// JSON about the daemon.
    fn info(&self, py: Python<'_>) -> PyResult<String> {
        self.asked(py, Palpate::info)
    }

    /// OpenMetrics text.
    fn metrics(&self, py: Python<'_>) -> PyResult<String> {
        self.asked(py, Palpate::metrics)
    }

    /// Carries out a command with arguments as JSON; returns the answer as JSON.
    fn call(&self, py: Python<'_>, method: &str, arguments: &str) -> PyResult<String> {
        let call = Call::parse(method, arguments.as_bytes())
            .map_err(|error| raised("RefusedError", error))?;
        let done = self.asked(py, |palpate| palpate.call(call))?;
        serde_json::to_string(&Answer::Done(done)).map_err(internal)
    }

    /// Bytes of the past events after a number.
    fn past_events<'py>(&self, py: Python<'py>, after: u64) -> PyResult<Vec<Bound<'py, PyBytes>>> {
        let events = self.asked(py, |palpate| palpate.past_events(after))?;
        Ok(events
            .iter()
            .map(|event| PyBytes::new(py, &encode(event)))
            .collect())
    }

    /// Messages under a key relative to the instance, such as `event` or `body/drop/net`; `newest`
    /// keeps only the newest unread one.
    fn watch(&self, py: Python<'_>, key: &str, newest: bool) -> PyResult<Watch> {
        let palpate = self.session()?;
        let key = palpate.keys().expand(key);
        let queue = Arc::new(Queue::default());
        let shared = queue.clone();
        let most = if newest { 1 } else { MOST_WAITING };
        let subscriber = py.detach(|| {
            palpate.watch(&key, move |seen| {
                let mut waiting = locked(&shared.waiting);
                while waiting.len() >= most {
                    waiting.pop_front();
                    *locked(&shared.dropped) += u64::from(most > 1);
                }
                let now = Instant::now();
                *locked(&shared.last) = Some(now);
                waiting.push_back((now, seen.key, seen.bytes));
                shared.arrived.notify_all();
            })
        });
        let subscriber = subscriber.map_err(client_error)?;
        Ok(Watch {
            queue,
            subscriber: Mutex::new(Some(subscriber)),
        })
    }

    /// Takes a tool.
    fn tool(&self, py: Python<'_>, id: &str) -> PyResult<Tool> {
        let palpate = self.session()?;
        let tool = py.detach(|| palpate.tool(id)).map_err(client_error)?;
        Ok(Tool {
            lockstep: tool.is_lockstep(),
            tool: Mutex::new(Some(tool)),
            id: id.to_owned(),
            palpate,
        })
    }

    /// Closes the session. Tools and watches are closed before.
    fn close(&self, py: Python<'_>) {
        let palpate = locked(&self.palpate).take();
        if is_forked() {
            return std::mem::forget(palpate);
        }
        py.detach(|| {
            if let Some(Ok(palpate)) = palpate.map(Arc::try_unwrap) {
                palpate.close();
            }
        });
    }
}

#[derive(Default)]
struct Queue {
    waiting: Mutex<VecDeque<(Instant, String, Vec<u8>)>>,
    /// When the newest came.
    last: Mutex<Option<Instant>>,
    dropped: Mutex<u64>,
    arrived: Condvar,
}

/// Messages that arrive.
#[pyclass(frozen, module = "palpate._native")]
pub struct Watch {
    queue: Arc<Queue>,
    subscriber: Mutex<Option<zenoh::pubsub::Subscriber<()>>>,
}

#[pymethods]
impl Watch {
    /// The next message; None when none came within `timeout` seconds or the watch is closed.
    fn next(&self, py: Python<'_>, timeout: f64) -> PyResult<Option<Seen>> {
        not_forked()?;
        let deadline = Instant::now() + seconds(timeout.min(1e9))?;
        loop {
            let got = py.detach(|| {
                let mut waiting = locked(&self.queue.waiting);
                if waiting.is_empty() {
                    let left = deadline
                        .saturating_duration_since(Instant::now())
                        .min(SLICE);
                    let waited = self.queue.arrived.wait_timeout(waiting, left);
                    waiting = waited.unwrap_or_else(PoisonError::into_inner).0;
                }
                waiting.pop_front()
            });
            if let Some((came, key, bytes)) = got {
                return Ok(Some(Seen { came, key, bytes }));
            }
            py.check_signals()?;
            if Instant::now() >= deadline || locked(&self.subscriber).is_none() {
                return Ok(None);
            }
        }
    }

    /// How long ago the newest message came, s; None before the first.
    #[getter]
    fn silence(&self) -> Option<f64> {
        locked(&self.queue.last).map(|last| last.elapsed().as_secs_f64())
    }

    /// Messages that left unread because too many waited.
    #[getter]
    fn dropped(&self) -> u64 {
        *locked(&self.queue.dropped)
    }

    /// Ends it.
    fn close(&self, py: Python<'_>) {
        let subscriber = locked(&self.subscriber).take();
        if is_forked() {
            return std::mem::forget(subscriber);
        }
        py.detach(|| drop(subscriber));
        self.queue.arrived.notify_all();
    }
}

/// A message as it came.
#[pyclass(frozen, module = "palpate._native")]
pub struct Seen {
    came: Instant,
    key: String,
    bytes: Vec<u8>,
}

#[pymethods]
impl Seen {
    /// Key expression.
    #[getter]
    fn key(&self) -> &str {
        &self.key
    }

    /// How long ago it came, s.
    #[getter]
    fn age(&self) -> f64 {
        self.came.elapsed().as_secs_f64()
    }

    /// The message as bytes, in postcard.
    #[getter]
    fn payload<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.bytes)
    }

    /// Of a net: tick, revision, body, points (nu, nv, 3).
    fn net<'py>(&self, py: Python<'py>) -> PyResult<(u64, u64, String, Bound<'py, PyAny>)> {
        let net: ControlNet =
            decode(&self.bytes, "").map_err(|error| raised("ClientError", error))?;
        let (rows, columns) = (usize::from(net.count_u), usize::from(net.count_v));
        let points: Vec<Point3> = net.points.iter().map(|p| Point3::from(*p)).collect();
        if points.len() != rows * columns {
            return Err(raised(
                "ClientError",
                format!("a net of {rows} x {columns} with {} points", points.len()),
            ));
        }
        Ok((
            net.tick,
            net.revision,
            net.body,
            net_array(py, &points, rows, columns)?.into_any(),
        ))
    }
}

/// A held tool.
#[pyclass(frozen, module = "palpate._native")]
pub struct Tool {
    tool: Mutex<Option<palpate_client::Tool>>,
    id: String,
    lockstep: bool,
    palpate: Arc<Palpate>,
}

impl Tool {
    /// Does something with the tool, without the GIL.
    pub fn with<T: Send>(
        &self,
        py: Python<'_>,
        act: impl FnOnce(&mut palpate_client::Tool) -> T + Send,
    ) -> PyResult<T> {
        not_forked()?;
        py.detach(|| {
            let mut tool = locked(&self.tool);
            let tool = tool.as_mut().ok_or_else(|| {
                raised("ClientError", format!("tool {:?} was given back", self.id))
            })?;
            Ok(act(tool))
        })
    }

    /// Id in the scene.
    pub fn name(&self) -> &str {
        &self.id
    }

    /// The daemon waits for each pose.
    pub fn is_lockstep(&self) -> bool {
        self.lockstep
    }

    /// The session it belongs to.
    pub fn palpate(&self) -> &Palpate {
        &self.palpate
    }
}

/// `palpate.messages.ToolForce`, made without a trip through bytes.
pub fn force_message<'py>(py: Python<'py>, force: &ToolForce) -> PyResult<Bound<'py, PyAny>> {
    static CLASS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let class = CLASS.get_or_try_init(py, || {
        Ok::<_, PyErr>(
            py.import("palpate.messages")?
                .getattr("ToolForce")?
                .unbind(),
        )
    })?;
    let [x, y, z, w] = force.proxy_orientation;
    let tuple = |[a, b, c]: [f64; 3]| (a, b, c);
    class.bind(py).call1((
        force.tick,
        force.pose_seq,
        force.t_client_ns,
        force.t_server_ns,
        tuple(force.force),
        tuple(force.torque),
        tuple(force.proxy_position),
        (x, y, z, w),
        force.depth,
        force.contact_count,
        force.flags,
    ))
}

#[pymethods]
impl Tool {
    /// Id in the scene.
    #[getter]
    fn id(&self) -> &str {
        &self.id
    }

    /// The daemon waits for each pose.
    #[getter]
    fn lockstep(&self) -> bool {
        self.lockstep
    }

    /// Sends a pose; returns its number.
    fn send(&self, py: Python<'_>, pose: &Bound<'_, PyAny>) -> PyResult<u64> {
        let pose = Pose::of(pose, "pose")?;
        self.with(py, |tool| tool.send(pose))?.map_err(client_error)
    }

    /// Waits for a force that answers pose number `seq` or a later one; None after `timeout`
    /// seconds.
    fn wait<'py>(
        &self,
        py: Python<'py>,
        seq: u64,
        timeout: f64,
    ) -> PyResult<Option<Bound<'py, PyAny>>> {
        let deadline = Instant::now() + seconds(timeout.min(1e9))?;
        loop {
            let left = deadline.saturating_duration_since(Instant::now());
            // Longer than the client's own time until it sends a pose again.
            let slice = left.min(3 * SLICE);
            let wait = |tool: &mut palpate_client::Tool| match tool.wait_force(seq, slice) {
                None => tool.take_refusal().map(|()| None),
                force => Ok(force),
            };
            if let Some(force) = self.with(py, wait)?.map_err(client_error)? {
                return force_message(py, &force).map(Some);
            }
            py.check_signals()?;
            if Instant::now() >= deadline {
                return Ok(None);
            }
        }
    }

    /// The newest force as it may act now; None before the first.
    fn force<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let force = self.with(py, |tool| tool.force())?;
        force.map(|force| force_message(py, &force)).transpose()
    }

    /// How long ago the newest force came, s; None before the first.
    fn silence(&self, py: Python<'_>) -> PyResult<Option<f64>> {
        let silence = self.with(py, |tool| tool.silence())?;
        Ok(silence.map(|silence| silence.as_secs_f64()))
    }

    /// Forces received so far.
    fn received(&self, py: Python<'_>) -> PyResult<u64> {
        self.with(py, |tool| tool.received())
    }

    /// Tells the daemon what the device can do: fields of `DeviceInfo`.
    fn announce(&self, py: Python<'_>, info: &Bound<'_, PyDict>) -> PyResult<()> {
        let json = py
            .import("json")?
            .call_method1("dumps", (info,))?
            .extract::<String>()?;
        let info: DeviceInfo = serde_json::from_str(&json)
            .map_err(|error| PyValueError::new_err(error.to_string()))?;
        self.announce_info(py, &info)
    }

    /// Gives the tool back.
    fn close(&self, py: Python<'_>) {
        if is_forked() {
            return std::mem::forget(locked(&self.tool).take());
        }
        py.detach(|| drop(locked(&self.tool).take()));
    }
}

impl Tool {
    /// Sends a description. In lockstep it waits until the daemon has it, so that sessions repeat.
    pub fn announce_info(&self, py: Python<'_>, info: &DeviceInfo) -> PyResult<()> {
        self.with(py, |tool| tool.announce(info))?
            .map_err(client_error)?;
        let begun = Instant::now();
        while self.lockstep
            && py.detach(|| self.palpate().device(&self.id).ok()).as_ref() != Some(info)
        {
            if begun.elapsed() > Duration::from_millis(500) {
                let palpate = self.palpate();
                self.with(py, |tool| palpate.check_holder(tool))?
                    .map_err(client_error)?;
            }
            if begun.elapsed() > Duration::from_secs(5) {
                return Err(raised(
                    "NoAnswerError",
                    "the daemon did not accept the device's description",
                ));
            }
            py.check_signals()?;
            py.detach(|| std::thread::sleep(Duration::from_millis(5)));
        }
        Ok(())
    }
}
