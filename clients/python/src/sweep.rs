//! Sweeps as `palpate batch` makes them, run by run: Python hands the runs out.

use crate::closest::cores;
use crate::errors::{internal, raised};
use numpy::PyArray1;
use palpate_experiment::batch::{self, Cache, Cells, FileBytes, Format, Player, Row, Table, build};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// A sweep, read and checked: the runs that it has, and those who make them.
#[pyclass(frozen, module = "palpate._native")]
pub struct Sweep {
    sweep: batch::Sweep,
    /// Idle; one for each thread that was at work at a time.
    players: Mutex<Vec<Player>>,
}

impl Sweep {
    fn players(&self) -> MutexGuard<'_, Vec<Player>> {
        self.players.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Who makes a run: best one that has its scene.
    fn player(&self, run: usize) -> Player {
        let mut idle = self.players();
        let ready = idle.iter().position(|player| player.has_scene_of(run));
        match ready {
            Some(ready) => idle.swap_remove(ready),
            None => idle.pop().unwrap_or_else(|| self.sweep.player()),
        }
    }
}

#[pymethods]
impl Sweep {
    /// With `files` of [`Self::files`], no others are read.
    #[new]
    #[pyo3(signature = (text, name, directory, files=None))]
    fn new(
        text: &str,
        name: &str,
        directory: PathBuf,
        files: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let sweep = match files {
            None => batch::Sweep::parse(text, name, &directory),
            Some(files) => {
                let mut known = FileBytes::new();
                for (path, bytes) in files {
                    let bytes = match bytes.cast::<PyBytes>() {
                        Ok(bytes) => Ok(bytes.as_bytes().to_vec()),
                        Err(_) => Err(bytes.extract()?),
                    };
                    known.insert(path.extract()?, bytes);
                }
                batch::Sweep::with_files(text, name, &directory, known)
            }
        };
        Ok(Self {
            sweep: sweep.map_err(|error| raised("SweepError", error))?,
            players: Mutex::default(),
        })
    }

    /// All files that its runs read, by path: bytes, or text that says why they cannot be read.
    fn files<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let files = PyDict::new(py);
        for (path, bytes) in py.detach(|| self.sweep.files()) {
            match bytes {
                Ok(bytes) => files.set_item(path.as_os_str(), PyBytes::new(py, &bytes))?,
                Err(reason) => files.set_item(path.as_os_str(), reason)?,
            }
        }
        Ok(files)
    }

    /// Number of runs.
    #[getter]
    fn count(&self) -> usize {
        self.sweep.plan().count()
    }

    /// Makes runs, without the GIL: of each its number, whether it was known, and what it came to as JSON.
    #[pyo3(signature = (runs, cache=None))]
    fn make(
        &self,
        py: Python<'_>,
        runs: Vec<usize>,
        cache: Option<PathBuf>,
    ) -> PyResult<Vec<(usize, bool, String)>> {
        let cache = cache.map(Cache::at);
        let make = |run| {
            py.check_signals()?;
            let (row, was_known) = py.detach(|| {
                let mut player = self.player(run);
                let made = player.row(run, cache.as_ref());
                self.players().push(player);
                made
            });
            let outcome = serde_json::to_string(&row.outcome).map_err(internal)?;
            Ok((run, was_known, outcome))
        };
        runs.into_iter().map(make).collect()
    }

    /// The table of runs that were made: number and what it came to of each.
    fn table(&self, mut made: Vec<(usize, String)>, timings: bool) -> PyResult<SweepRows> {
        made.sort_unstable();
        let plan = self.sweep.plan();
        let rows = made.into_iter().map(|(run, outcome)| {
            Ok(Row {
                case: plan.case(run),
                outcome: serde_json::from_str(&outcome).map_err(internal)?,
            })
        });
        let rows: Vec<Row> = rows.collect::<PyResult<_>>()?;
        Ok(SweepRows {
            table: Table::new(plan, &rows, timings),
        })
    }

    /// What this module was built from and by: only equal ones give equal bits.
    #[staticmethod]
    fn build() -> (String, String, String, String) {
        build().into()
    }

    /// Runs that this machine makes at a time.
    #[staticmethod]
    fn cores() -> usize {
        cores()
    }

    /// The user's folder of outcomes, where `palpate batch` keeps them, too.
    #[staticmethod]
    fn user_cache() -> Option<PathBuf> {
        Cache::of_user().map(|cache| cache.folder().to_owned())
    }
}

/// Rows of a sweep.
#[pyclass(frozen, module = "palpate._native")]
pub struct SweepRows {
    table: Table,
}

#[pymethods]
impl SweepRows {
    /// Arrays by name, in the order of the table.
    fn columns<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let columns = PyDict::new(py);
        let array = py.import("numpy")?.getattr("array")?;
        for (name, cells) in self.table.columns() {
            let column = match cells {
                Cells::Whole(cells) => array.call1((cells.clone(),))?,
                Cells::Truth(cells) => array.call1((cells.clone(),))?,
                Cells::Number(cells) => {
                    let number = |cell: &Option<f64>| {
                        cell.filter(|value| value.is_finite()).unwrap_or(f64::NAN)
                    };
                    PyArray1::from_iter(py, cells.iter().map(number)).into_any()
                }
                Cells::Text(cells) => array.call1((cells.clone(), "object"))?,
            };
            columns.set_item(name, column)?;
        }
        Ok(columns)
    }

    /// Writes the file that `palpate batch -o` writes.
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let written =
            py.detach(|| Format::of(&path).and_then(|format| self.table.write(&path, format)));
        written.map_err(|error| raised("SweepError", error))
    }
}
