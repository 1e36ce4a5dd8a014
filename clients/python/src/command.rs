//! The program `palpate` in this process, and pages of recordings.

use crate::errors::raised;
use palpate_record::build_id as build;
use pyo3::prelude::*;
#[cfg(feature = "daemon")]
use {
    crate::errors::os_error,
    palpate::viewer::html_page,
    palpate_record::{Session, recorded_scene},
    std::ffi::OsString,
    std::path::PathBuf,
};

/// Runs the program `palpate` with these arguments (without its name); returns its exit code.
///
/// Made for the entry point: it takes over signals, and `--help` ends the process.
#[cfg(feature = "daemon")]
#[pyfunction]
pub fn main(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| palpate::cli::code_with(arguments))
}

/// What this module was built from: recordings of other builds may replay with other bits.
#[pyfunction]
pub fn build_id() -> String {
    build()
}

/// Writes a recording as one HTML page that opens from disk; returns one in how many ticks it has.
#[cfg(feature = "daemon")]
#[pyfunction]
pub fn to_html(py: Python<'_>, recording: PathBuf, page: PathBuf, most: u64) -> PyResult<u64> {
    py.detach(|| {
        let session = Session::open(&recording)
            .map_err(|error| crate::recording::read_error(&recording, error))?;
        let wrong = |error: &dyn std::fmt::Display| raised("RecordingError", error);
        let scene = recorded_scene(&session).map_err(|error| wrong(&error))?;
        let name = recording
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        let (html, every) =
            html_page(&session, &scene, &name, most).map_err(|error| wrong(&error))?;
        std::fs::write(&page, html).map_err(|error| os_error(&page, &error))?;
        Ok(every)
    })
}

/// A message of the bus as JSON, read by the compiled decoder; tests compare `palpate.wire` with it.
#[pyfunction]
pub fn message_json(name: &str, payload: &[u8]) -> PyResult<String> {
    let read = palpate_proto::any::to_json(name, payload)
        .ok_or_else(|| raised("ClientError", format!("no message is called {name:?}")))?;
    let value = read.map_err(|error| raised("ClientError", error))?;
    serde_json::to_string(&value).map_err(crate::errors::internal)
}
