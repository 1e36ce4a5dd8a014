//! Exceptions: the classes are in `palpate/errors.py`, made here with what they carry.

use palpate_sim::scene::SceneError;
use pyo3::exceptions::{PyFileNotFoundError, PyOSError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use std::fmt::Display;
use std::path::Path;

/// An exception of `palpate.errors` with a message and attributes.
pub fn exception(
    class: &str,
    message: impl Display,
    attributes: Option<&Bound<'_, PyDict>>,
) -> PyErr {
    Python::attach(|py| {
        let made = || -> PyResult<PyErr> {
            let class = py.import("palpate.errors")?.getattr(class)?;
            let error = class.call1((message.to_string(),))?;
            for (name, value) in attributes.into_iter().flatten() {
                error.setattr(name.cast::<pyo3::types::PyString>()?, value)?;
            }
            Ok(PyErr::from_value(error))
        };
        made().unwrap_or_else(|error| error)
    })
}

/// An exception of `palpate.errors` with a message.
pub fn raised(class: &str, message: impl Display) -> PyErr {
    exception(class, message, None)
}

/// `palpate.SurfaceError`.
pub fn surface_error(error: impl Display) -> PyErr {
    raised("SurfaceError", error)
}

/// The object is in use by another thread.
pub fn busy(what: &str) -> PyErr {
    raised(
        "BusyError",
        format!(
            "this {what} is being stepped by another thread; give each thread its own, or take turns with a lock"
        ),
    )
}

/// `palpate.SceneError` with the list of problems. `shown`: text of a scene that has no file; its
/// places are lines of that text.
pub fn scene_error(error: &SceneError, shown: Option<&str>) -> PyErr {
    Python::attach(|py| {
        let made = || -> PyResult<PyErr> {
            let problems = PyList::empty(py);
            let mut words = Vec::new();
            let class = py.import("palpate.errors")?.getattr("Problem")?;
            for problem in &error.problems {
                let place = problem.place.as_ref();
                let line_of = |text: &str| {
                    let at = place.filter(|at| at.line > 0)?;
                    Some(text.lines().nth(at.line - 1)?.trim().to_owned())
                };
                let (reason, place) = match shown {
                    // A scene that was built from a dictionary has no lines; the key is shown.
                    Some(text) => {
                        let at = line_of(text).filter(|_| problem.path.is_empty());
                        let at = at.map_or(String::new(), |line| format!(" (at `{line}`)"));
                        (format!("{}{at}", problem.reason), None)
                    }
                    None => (problem.reason.clone(), place),
                };
                let (file, line, column) = place.map_or((None, None, None), |at| {
                    let line = (at.line > 0).then_some(at.line);
                    (Some(at.file.as_str()), line, line.map(|_| at.column))
                });
                problems.append(class.call1((&problem.path, &reason, file, line, column))?)?;
                words.push(match (shown, problem.path.is_empty()) {
                    (Some(_), false) => format!("{}: {reason}", problem.path),
                    (Some(_), true) => reason,
                    (None, _) => problem.to_string(),
                });
            }
            let attributes = PyDict::new(py);
            attributes.set_item("problems", problems)?;
            Ok(exception("SceneError", words.join("\n"), Some(&attributes)))
        };
        made().unwrap_or_else(|error| error)
    })
}

/// An error of the file system as Python's own (`FileNotFoundError`, `PermissionError`…).
pub fn os_error(path: &Path, error: &std::io::Error) -> PyErr {
    let path = path.display().to_string();
    match (error.raw_os_error(), error.kind()) {
        // Python chooses the class by the number.
        (Some(number), _) => {
            let words = error.to_string();
            let words = words.split(" (os error").next().unwrap_or_default();
            PyOSError::new_err((number, words.to_owned(), path))
        }
        (None, std::io::ErrorKind::NotFound) => PyFileNotFoundError::new_err(path),
        (None, _) => PyOSError::new_err(format!("{path}: {error}")),
    }
}

/// A broken promise of this module.
pub fn internal(error: impl Display) -> PyErr {
    PyRuntimeError::new_err(format!("palpate: {error}; please report this"))
}

/// A B-spline was asked for of a body that is a part.
pub fn no_surface(body: &str) -> PyErr {
    PyValueError::new_err(format!(
        "{body:?} is a part, which has no B-spline surface; palpate.Part.load reads its file"
    ))
}
