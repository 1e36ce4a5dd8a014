//! Recordings as arrays: columns of ticks on demand, nets, replays.

use crate::errors::{exception, os_error, raised};
use crate::output::{depth, proxy};
use crate::surface::{Surface, cores};
use crate::values::shaped;
use numpy::PyArray1;
use palpate::recording::{
    Follower, Happening, ReadError, ReplayOptions, Session, Topic, computed_info, info, net_at,
    recorded_scene, replay_with, simulate_figures,
};
use palpate_sim::tick::record::{TickRecord, ToolOutput};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// `palpate.RecordingError`, or Python's own where the file system refuses.
pub fn read_error(path: &Path, error: ReadError) -> PyErr {
    match error {
        ReadError::Io { source, .. } => os_error(path, &source),
        other => raised("RecordingError", other),
    }
}

/// Does work on another thread, so that Ctrl-C is answered. The work should end soon after its
/// flag is set; nobody waits for it then. `report` is called ten times a second.
pub fn watched<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(&AtomicBool) -> T + Send + 'static,
    mut report: impl FnMut() -> PyResult<()>,
) -> PyResult<T> {
    let stop = Arc::new(AtomicBool::new(false));
    let (send, receive) = channel();
    let receive = Mutex::new(receive);
    let flag = stop.clone();
    let thread = std::thread::Builder::new().name("palpate-work".into());
    let _detached = thread
        .spawn(move || drop(send.send(work(&flag))))
        .map_err(crate::errors::internal)?;
    loop {
        let waited = py.detach(|| {
            let receive = receive.lock().unwrap_or_else(PoisonError::into_inner);
            receive.recv_timeout(Duration::from_millis(20))
        });
        match waited {
            Ok(done) => return Ok(done),
            Err(RecvTimeoutError::Disconnected) => {
                return Err(crate::errors::internal("the work panicked"));
            }
            Err(RecvTimeoutError::Timeout) => {
                if let Err(error) = py.check_signals().and_then(|()| report()) {
                    stop.store(true, Ordering::Relaxed);
                    return Err(error);
                }
            }
        }
    }
}

/// A column of numbers: how many to a tick, and how they are read.
struct Column {
    name: &'static str,
    width: usize,
    read: fn(&TickRecord, usize, &ToolOutput, &mut Vec<f64>),
}

/// Columns of a tool that hold numbers.
const COLUMNS: &[Column] = &[
    Column {
        name: "force",
        width: 3,
        read: |_, _, out, to| to.extend_from_slice(out.force_n.as_slice()),
    },
    Column {
        name: "torque",
        width: 3,
        read: |_, _, out, to| to.extend_from_slice(out.torque_nm.as_slice()),
    },
    Column {
        name: "contact_force",
        width: 3,
        read: |_, _, out, to| to.extend_from_slice(out.contact_force_n.as_slice()),
    },
    Column {
        name: "contact_torque",
        width: 3,
        read: |_, _, out, to| to.extend_from_slice(out.contact_torque_nm.as_slice()),
    },
    Column {
        name: "depth",
        width: 1,
        read: |_, _, out, to| to.push(depth(out)),
    },
    Column {
        name: "proxy",
        width: 7,
        read: |_, _, out, to| to.extend_from_slice(&proxy(out)),
    },
    Column {
        name: "energy",
        width: 1,
        read: |_, _, out, to| to.push(out.energy_j),
    },
    Column {
        name: "dissipated",
        width: 1,
        read: |_, _, out, to| to.push(out.dissipated_j),
    },
    Column {
        name: "pose",
        width: 7,
        read: |record, tool, _, to| match &record.input.poses[tool] {
            Some(pose) => {
                to.extend_from_slice(pose.position.coords.as_slice());
                to.extend_from_slice(pose.orientation.coords.as_slice());
            }
            None => to.extend_from_slice(&[f64::NAN; 7]),
        },
    },
    Column {
        name: "velocity",
        width: 6,
        read: |record, tool, _, to| match &record.input.poses[tool] {
            Some(pose) => {
                to.extend_from_slice(pose.linear_velocity.as_slice());
                to.extend_from_slice(pose.angular_velocity.as_slice());
            }
            None => to.extend_from_slice(&[f64::NAN; 6]),
        },
    },
    Column {
        name: "contact_point",
        width: 3,
        read: |_, _, out, to| match &out.contact {
            Some(contact) => to.extend_from_slice(contact.point.coords.as_slice()),
            None => to.extend_from_slice(&[f64::NAN; 3]),
        },
    },
    Column {
        name: "contact_normal",
        width: 3,
        read: |_, _, out, to| match &out.contact {
            Some(contact) => to.extend_from_slice(contact.normal.as_slice()),
            None => to.extend_from_slice(&[f64::NAN; 3]),
        },
    },
];

/// A column of whole numbers.
struct Count {
    name: &'static str,
    read: fn(&TickRecord, &ToolOutput) -> u64,
}

/// Columns of whole numbers; the first ones are the same for every tool.
const COUNTS: &[Count] = &[
    Count {
        name: "tick",
        read: |record, _| record.output.tick,
    },
    Count {
        name: "hash",
        read: |record, _| record.output.state_hash,
    },
    Count {
        name: "late_ns",
        read: |record, _| record.late_ns,
    },
    Count {
        name: "skipped",
        read: |record, _| u64::from(record.skipped),
    },
    Count {
        name: "step_ns",
        read: |record, _| record.stage_ns.total(),
    },
    Count {
        name: "pose_seq",
        read: |_, out| out.pose_seq,
    },
    Count {
        name: "flags",
        read: |_, out| u64::from(out.flags),
    },
    Count {
        name: "contact_count",
        read: |_, out| u64::from(out.contact_count),
    },
];

/// What was read of a stretch of ticks: as the columns asked for.
#[derive(Default)]
struct Piece {
    numbers: Vec<Vec<f64>>,
    counts: Vec<Vec<u64>>,
}

struct Wanted {
    tool: usize,
    numbers: Vec<usize>,
    counts: Vec<usize>,
    ticks: (u64, u64),
}

fn read_piece(
    session: &Session,
    wanted: &Wanted,
    (from, until): (u64, u64),
    stop: &AtomicBool,
) -> Result<Piece, ReadError> {
    let mut piece = Piece {
        numbers: vec![Vec::new(); wanted.numbers.len()],
        counts: vec![Vec::new(); wanted.counts.len()],
    };
    for happening in Follower::between(session, from, until).only(&[Topic::Tick]) {
        let Happening::Tick(record) = happening? else {
            continue;
        };
        if stop.load(Ordering::Relaxed) {
            break;
        }
        let out = &record.output.tools[wanted.tool];
        for (column, values) in wanted.numbers.iter().zip(&mut piece.numbers) {
            (COLUMNS[*column].read)(&record, wanted.tool, out, values);
        }
        for (column, values) in wanted.counts.iter().zip(&mut piece.counts) {
            values.push((COUNTS[*column].read)(&record, out));
        }
    }
    Ok(piece)
}

/// Stretches of ticks read by all cores and put end to end.
fn read_columns(session: &Session, wanted: &Wanted, stop: &AtomicBool) -> Result<Piece, ReadError> {
    let (first, last) = wanted.ticks;
    let workers = cores();
    let span = (last - first).saturating_add(1);
    // Stretches of a minute or so, so that what is in flight stays small.
    let stretches = span.div_ceil(50_000).max(1);
    let length = span.div_ceil(stretches);
    let next = AtomicU64::new(0);
    let results: Vec<Mutex<Option<Result<Piece, ReadError>>>> =
        (0..stretches).map(|_| Mutex::new(None)).collect();
    std::thread::scope(|scope| {
        let work = || {
            loop {
                let k = next.fetch_add(1, Ordering::Relaxed);
                if k >= stretches || stop.load(Ordering::Relaxed) {
                    return;
                }
                let from = first + k * length;
                let piece =
                    read_piece(session, wanted, (from, (from + length - 1).min(last)), stop);
                if let Ok(mut result) = results[k as usize].lock() {
                    *result = Some(piece);
                }
            }
        };
        (1..workers.min(stretches as usize)).for_each(|_| drop(scope.spawn(work)));
        work();
    });
    let mut whole = Piece {
        numbers: vec![Vec::new(); wanted.numbers.len()],
        counts: vec![Vec::new(); wanted.counts.len()],
    };
    for result in results {
        let Some(piece) = result.into_inner().ok().flatten().transpose()? else {
            continue;
        };
        whole
            .numbers
            .iter_mut()
            .zip(piece.numbers)
            .for_each(|(all, part)| all.extend(part));
        whole
            .counts
            .iter_mut()
            .zip(piece.counts)
            .for_each(|(all, part)| all.extend(part));
    }
    Ok(whole)
}

/// A recording: opened, not read. `palpate.open` wraps it.
#[pyclass(frozen, module = "palpate._native")]
pub struct RecordingFile {
    path: PathBuf,
    session: Session,
}

#[pymethods]
impl RecordingFile {
    #[new]
    fn new(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let session = py
            .detach(|| Session::open(&path))
            .map_err(|error| read_error(&path, error))?;
        Ok(Self { path, session })
    }

    /// File.
    #[getter]
    fn path(&self) -> PathBuf {
        self.path.clone()
    }

    /// Metadata from the start of the file.
    #[getter]
    fn run(&self) -> std::collections::BTreeMap<String, String> {
        self.session.header.run.clone()
    }

    /// Metadata from its end; empty when it was cut short.
    #[getter]
    fn end(&self) -> std::collections::BTreeMap<String, String> {
        self.session.header.end.clone()
    }

    /// Ids of tools, by index.
    #[getter]
    fn tools(&self) -> Vec<String> {
        self.session.header.names("tools")
    }

    /// Ids of bodies, by index.
    #[getter]
    fn bodies(&self) -> Vec<String> {
        self.session.header.names("bodies")
    }

    /// Length of a tick, ns.
    #[getter]
    fn dt_ns(&self) -> u64 {
        self.session.dt_ns()
    }

    /// Ticks in it.
    #[getter]
    fn tick_count(&self) -> u64 {
        self.session.tick_count()
    }

    /// First and last tick; None without ticks.
    #[getter]
    fn tick_range(&self) -> Option<(u64, u64)> {
        self.session.tick_range()
    }

    /// Ticks missing between the first and the last.
    #[getter]
    fn gaps(&self) -> u64 {
        self.session.gaps()
    }

    /// Finished without a loss, and nothing found damaged so far.
    #[getter]
    fn whole(&self) -> bool {
        self.session.is_whole()
    }

    /// Why the file is not whole, as far as is known.
    #[getter]
    fn cut_short(&self) -> Option<String> {
        self.session.cut_short().map(str::to_owned)
    }

    /// Scene file as written.
    #[getter]
    fn scene_text(&self) -> &str {
        &self.session.header.scene_text
    }

    /// Scene as built: needs no other file.
    #[getter]
    fn effective_scene(&self) -> &str {
        &self.session.header.effective_scene
    }

    /// Columns of a tool: by name an array with a row for each tick that the file has.
    #[pyo3(signature = (tool, names, first=None, last=None))]
    fn columns<'py>(
        &self,
        py: Python<'py>,
        tool: usize,
        names: Vec<String>,
        first: Option<u64>,
        last: Option<u64>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (mut numbers, mut counts) = (Vec::new(), Vec::new());
        for name in &names {
            match (
                COLUMNS.iter().position(|c| c.name == name),
                COUNTS.iter().position(|c| c.name == name),
            ) {
                (Some(column), _) => numbers.push(column),
                (_, Some(column)) => counts.push(column),
                (None, None) => {
                    return Err(PyValueError::new_err(format!(
                        "a recording has no column {name:?}"
                    )));
                }
            }
        }
        let range = self.session.tick_range().map(|(start, end)| {
            (
                first.unwrap_or(start).max(start),
                last.unwrap_or(end).min(end),
            )
        });
        let wanted = Wanted {
            tool,
            numbers,
            counts,
            ticks: range.unwrap_or((0, 0)),
        };
        let session = self.session.clone();
        let empty = range.is_none_or(|(first, last)| first > last);
        let result = watched(
            py,
            move |stop| {
                let piece = if empty {
                    let counts = vec![Vec::new(); wanted.counts.len()];
                    Ok(Piece {
                        numbers: vec![Vec::new(); wanted.numbers.len()],
                        counts,
                    })
                } else {
                    read_columns(&session, &wanted, stop)
                };
                piece.map(|piece| (piece, wanted))
            },
            || Ok(()),
        )?;
        let (piece, wanted) = result.map_err(|error| read_error(&self.path, error))?;
        let columns = PyDict::new(py);
        for (column, values) in wanted.numbers.iter().zip(piece.numbers) {
            let Column { name, width, .. } = &COLUMNS[*column];
            let rows = values.len() / width;
            let shape = if *width == 1 {
                vec![rows]
            } else {
                vec![rows, *width]
            };
            columns.set_item(name, shaped(py, values, &shape)?)?;
        }
        for (column, values) in wanted.counts.iter().zip(piece.counts) {
            columns.set_item(COUNTS[*column].name, PyArray1::from_vec(py, values))?;
        }
        Ok(columns)
    }

    /// Names of all columns.
    #[staticmethod]
    fn column_names() -> Vec<&'static str> {
        COUNTS
            .iter()
            .map(|c| c.name)
            .chain(COLUMNS.iter().map(|c| c.name))
            .collect()
    }

    /// Events: tick, kind, words.
    fn events(&self, py: Python<'_>) -> PyResult<Vec<(u64, String, String)>> {
        let session = self.session.clone();
        let read = watched(
            py,
            move |_| {
                let mut events = Vec::new();
                for happening in Follower::new(&session).only(&[Topic::Event]) {
                    if let Happening::Event(event) = happening? {
                        events.push((event.tick, event.kind, event.detail));
                    }
                }
                Ok::<_, ReadError>(events)
            },
            || Ok(()),
        )?;
        read.map_err(|error| read_error(&self.path, error))
    }

    /// Ticks at which nets of a body were recorded.
    fn net_ticks<'py>(&self, py: Python<'py>, body: String) -> PyResult<Bound<'py, PyArray1<u64>>> {
        let session = self.session.clone();
        let read = watched(
            py,
            move |_| {
                let mut ticks = Vec::new();
                for happening in Follower::new(&session).only(&[Topic::Net]) {
                    match happening? {
                        Happening::Net(net) if net.body == body => ticks.push(net.tick),
                        _ => {}
                    }
                }
                Ok::<_, ReadError>(ticks)
            },
            || Ok(()),
        )?;
        Ok(PyArray1::from_vec(
            py,
            read.map_err(|error| read_error(&self.path, error))?,
        ))
    }

    /// The surface of a body after a tick: as recorded, or replayed to from the keyframe before and
    /// proved by the recorded hash.
    fn surface(&self, py: Python<'_>, body: String, tick: u64) -> PyResult<Surface> {
        let session = self.session.clone();
        let surface = watched(
            py,
            move |_| net_at(&session, &body, tick).map_err(|e| e.to_string()),
            || Ok(()),
        )?;
        surface
            .map(Surface::of)
            .map_err(|error| raised("RecordingError", error))
    }

    /// What `palpate info --json` prints; `check`: computed from every tick.
    fn info_json(&self, py: Python<'_>, check: bool) -> PyResult<String> {
        let session = self.session.clone();
        let found = watched(
            py,
            move |_| {
                if check {
                    computed_info(&session)
                } else {
                    info(&session)
                }
            },
            || Ok(()),
        )?;
        let found = found.map_err(|error| read_error(&self.path, error))?;
        serde_json::to_string(&found).map_err(crate::errors::internal)
    }

    /// Replays; returns the report as JSON. `progress` is called with ticks done and all.
    #[pyo3(signature = (first=0, last=None, jobs=None, progress=None))]
    fn replay(
        &self,
        py: Python<'_>,
        first: u64,
        last: Option<u64>,
        jobs: Option<usize>,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<String> {
        let usual = ReplayOptions::default();
        let options = ReplayOptions {
            from: first,
            until: last.unwrap_or(usual.until),
            jobs: jobs.unwrap_or(usual.jobs).max(1),
        };
        let session = self.session.clone();
        let counts = Arc::new([AtomicU64::new(0), AtomicU64::new(0)]);
        let told = counts.clone();
        let report = watched(
            py,
            move |_| {
                replay_with(&session, &options, |done, all| {
                    told[0].store(done, Ordering::Relaxed);
                    told[1].store(all, Ordering::Relaxed);
                })
                .map_err(|error| error.to_string())
            },
            || match &progress {
                Some(progress) => progress
                    .call1((
                        counts[0].load(Ordering::Relaxed),
                        counts[1].load(Ordering::Relaxed),
                    ))
                    .map(drop),
                None => Ok(()),
            },
        )?;
        let report = report.map_err(|error| raised("RecordingError", error))?;
        if let Some(difference) = &report.first_difference {
            let attributes = PyDict::new(py);
            attributes.set_item("tick", difference.tick)?;
            attributes.set_item("field", &difference.field)?;
            attributes.set_item("recorded", &difference.recorded)?;
            attributes.set_item("replayed", &difference.replayed)?;
            attributes.set_item("ulps", difference.ulps)?;
            attributes.set_item("same_build", report.same_build)?;
            let other = if report.same_build {
                ""
            } else {
                "; the recording is of another build, and identical bits are guaranteed for the same build only: compare figures()"
            };
            let words = format!(
                "{}: the replay differs at {difference}{other}",
                self.path.display()
            );
            return Err(exception("DivergedError", words, Some(&attributes)));
        }
        serde_json::to_string(&report).map_err(crate::errors::internal)
    }

    /// Peak and RMS force, depth, energy and contact, simulated again by this build; JSON.
    fn figures_json(&self, py: Python<'_>) -> PyResult<String> {
        let session = self.session.clone();
        let found = watched(
            py,
            move |_| {
                simulate_figures(&session, |_, _| {})
                    .map(|(figures, _)| figures)
                    .map_err(|e| e.to_string())
            },
            || Ok(()),
        )?;
        let figures = found.map_err(|error| raised("RecordingError", error))?;
        serde_json::to_string(&figures).map_err(crate::errors::internal)
    }

    /// Builds the recorded scene: fails where this version cannot.
    fn check_scene(&self, py: Python<'_>) -> PyResult<()> {
        let session = self.session.clone();
        let built = watched(
            py,
            move |_| {
                recorded_scene(&session)
                    .map(drop)
                    .map_err(|e| e.to_string())
            },
            || Ok(()),
        )?;
        built.map_err(|error| raised("RecordingError", error))
    }
}
