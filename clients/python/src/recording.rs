//! Recordings as arrays: columns of ticks on demand, nets, replays.

use crate::columns::{Column, Values, Wanted, read_columns};
use crate::errors::{exception, os_error, raised};
use crate::surface::Surface;
use crate::values::shaped;
use crate::watched::watched;
use numpy::PyArray1;
use palpate_record::{
    Follower, Happening, ReadError, ReplayOptions, Session, Topic, computed_info, info, net_at,
    recorded_scene, replay_with, simulate_figures,
};
use palpate_sim::tick::quantity::{OF_LOOP, QUANTITIES};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// `palpate.RecordingError`, or Python's own where the file system refuses.
pub fn read_error(path: &Path, error: ReadError) -> PyErr {
    match error {
        ReadError::Io { source, .. } => os_error(path, &source),
        other => raised("RecordingError", other),
    }
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

    /// Path of the file that was opened.
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
        let unknown =
            |name: &String| PyValueError::new_err(format!("a recording has no column {name:?}"));
        let columns = names
            .iter()
            .map(|name| Column::named(name).ok_or_else(|| unknown(name)));
        let range = self.session.tick_range().map(|(start, end)| {
            (
                first.unwrap_or(start).max(start),
                last.unwrap_or(end).min(end),
            )
        });
        let wanted = Wanted {
            tool,
            columns: columns.collect::<PyResult<_>>()?,
            ticks: range.unwrap_or((0, 0)),
        };
        let session = self.session.clone();
        let empty = range.is_none_or(|(first, last)| first > last);
        let result = watched(
            py,
            move |stop| match empty {
                true => Ok(wanted.empty()),
                false => read_columns(&session, &wanted, stop),
            },
            || Ok(()),
        )?;
        let read = result.map_err(|error| read_error(&self.path, error))?;
        let columns = PyDict::new(py);
        for (name, values) in names.iter().zip(read) {
            match values {
                Values::Whole(values) => columns.set_item(name, PyArray1::from_vec(py, values))?,
                Values::Numbers(values, 1) => {
                    columns.set_item(name, PyArray1::from_vec(py, values))?
                }
                Values::Numbers(values, width) => {
                    let rows = values.len() / width;
                    columns.set_item(name, shaped(py, values, &[rows, width])?)?;
                }
            }
        }
        Ok(columns)
    }

    /// Names of the columns of a tool, and of the loop.
    #[staticmethod]
    fn column_names() -> (Vec<&'static str>, Vec<&'static str>) {
        (
            QUANTITIES.iter().map(|quantity| quantity.name).collect(),
            OF_LOOP.iter().map(|quantity| quantity.name).collect(),
        )
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
