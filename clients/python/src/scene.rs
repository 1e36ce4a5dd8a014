//! Scenes: from a file, from text or from a dictionary; built as the daemon builds them.

use crate::built::Built;
use crate::errors::{internal, os_error, scene_error};
use crate::overrides::set_value;
use crate::pose::Pose;
use crate::sim::Simulation;
use crate::surface::Surface;
use crate::values::{python, toml_value};
use palpate_sim::scene::file;
use palpate_sim::scene::spec::Clock;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString, PyTuple};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Bodies and the tools that touch them; constant, shared by any number of simulations.
///
/// Parameters
/// ----------
/// scene : dict or str
///     What a scene file says, as a dictionary (`{"body": [...], "tool": [...]}`; values may be
///     NumPy's) or as TOML text.
/// directory : path, optional
///     Where relative paths of the scene start; by default the current directory.
///
/// Raises
/// ------
/// SceneError
///     Everything that is wrong with the scene, in `problems`.
#[pyclass(frozen, module = "palpate")]
#[derive(Clone)]
pub struct Scene {
    /// What it is.
    pub built: Arc<Built>,
}

#[pymethods]
impl Scene {
    #[new]
    #[pyo3(signature = (scene, directory=None))]
    fn new(py: Python<'_>, scene: &Bound<'_, PyAny>, directory: Option<PathBuf>) -> PyResult<Self> {
        let directory = directory.unwrap_or_else(|| PathBuf::from("."));
        if let Ok(text) = scene.cast::<PyString>() {
            return Self::parsed(py, text.to_string(), "scene", directory, false)?.warned(py);
        }
        if !scene.is_instance_of::<PyDict>() {
            let kind = scene.get_type().name()?;
            return Err(PyTypeError::new_err(format!(
                "a scene is a dictionary or TOML text, not {kind}; Scene.load(path) reads a file"
            )));
        }
        let text = toml::to_string(&toml_value(scene, "")?).map_err(internal)?;
        Self::parsed(py, text, "scene", directory, true)?.warned(py)
    }

    /// Reads and builds a scene file.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     Everything that is wrong with it, each problem with file, line and fix.
    /// FileNotFoundError
    ///     No such file.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        std::fs::metadata(&path).map_err(|error| os_error(&path, &error))?;
        let scene = py.detach(|| {
            let loaded = file::load(&path).map_err(|error| scene_error(&error, None))?;
            let loaded = loaded.with(palpate_thesis::METHODS);
            Built::of(&loaded, false).map(|built| Self {
                built: Arc::new(built),
            })
        });
        scene?.warned(py)
    }

    #[staticmethod]
    fn _of(py: Python<'_>, text: String, effective: String, name: String) -> PyResult<Self> {
        let directory = PathBuf::from(".");
        let scene = Self::parsed(py, effective, &name, directory, false)?;
        let built = Built {
            scene: scene.built.scene.clone(),
            effective: scene.built.effective.clone(),
            text,
            warnings: scene.built.warnings.clone(),
        };
        Ok(Self {
            built: Arc::new(built),
        })
    }

    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let built = &slf.get().built;
        let arguments =
            (&built.text, &built.effective, &built.scene.name).into_pyobject(slf.py())?;
        Ok((slf.getattr("_of")?, arguments))
    }

    /// Another scene with some values replaced: `scene.varied({"body/drop/material/young_pa": 3e4})`.
    /// A path goes from table to key; entries of lists are named by their `id` or counted from 0.
    fn varied(&self, py: Python<'_>, values: &Bound<'_, PyDict>) -> PyResult<Self> {
        let mut document: toml::Value = toml::from_str(&self.built.effective).map_err(internal)?;
        for (path, value) in values {
            let path: String = path.extract()?;
            set_value(&mut document, &path, toml_value(&value, &path)?)?;
        }
        let text = toml::to_string(&document).map_err(internal)?;
        Self::parsed(py, text, &self.built.scene.name, PathBuf::from("."), true)?.warned(py)
    }

    /// A simulation at the scene's start.
    fn simulate(&self, py: Python<'_>) -> Simulation {
        py.detach(|| Simulation::start(self.built.clone()))
    }

    /// Name of the scene.
    #[getter]
    fn name(&self) -> &str {
        &self.built.scene.name
    }

    /// Length of a tick, s.
    #[getter]
    fn dt(&self) -> f64 {
        self.built.scene.dt_s
    }

    /// True when a daemon runs it in lockstep unless told otherwise.
    #[getter]
    fn lockstep(&self) -> bool {
        self.built.scene.clock == Clock::Lockstep
    }

    /// Ids of tools, by index.
    #[getter]
    fn tools(&self) -> Vec<String> {
        self.built.tool_ids()
    }

    /// Ids of bodies, by index.
    #[getter]
    fn bodies(&self) -> Vec<String> {
        self.built.body_ids()
    }

    /// The scene as it was written (TOML).
    #[getter]
    fn text(&self) -> &str {
        &self.built.text
    }

    /// The scene with defaults, surfaces and meshes written out (TOML): needs no other file.
    #[getter]
    fn effective(&self) -> &str {
        &self.built.effective
    }

    /// What was found about the scene: values that are hardly meant, and what comes out less exact than its numbers suggest
    /// (`palpate check`). Each was also a `palpate.SceneWarning` when the scene was made.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.built.warnings.clone()
    }

    /// Where a tool is at the start.
    fn start(&self, tool: &str) -> PyResult<Pose> {
        let inner = self.built.start(self.built.tool(tool)?);
        Ok(Pose { inner })
    }

    /// The surface of a body at rest, as simulated.
    fn surface(&self, body: &str) -> PyResult<Surface> {
        let body = self.built.body(body)?;
        let surface = self.built.scene.rest_surface(body).cloned();
        surface
            .map(Surface::of)
            .ok_or_else(|| crate::errors::no_surface(self.built.scene.body_id(body)))
    }

    /// Model of a body: `rigid`, `lattice`, `continuum`…
    fn model(&self, body: &str) -> PyResult<&'static str> {
        Ok(self.built.scene.model_name(self.built.body(body)?))
    }

    /// What the scene builds, holds and costs, as a dictionary (`palpate plan --json`).
    fn plan<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        python(py, "json", "loads", (self._plan_json()?,))
    }

    fn _plan_json(&self) -> PyResult<String> {
        serde_json::to_string(&self.built.scene.plan()).map_err(internal)
    }

    fn __repr__(&self) -> String {
        let built = &self.built;
        format!(
            "Scene({:?}, bodies={:?}, tools={:?})",
            built.scene.name,
            built.body_ids(),
            built.tool_ids()
        )
    }
}

impl Scene {
    /// The scene, once Python's own warnings have said what was found about it.
    fn warned(self, py: Python<'_>) -> PyResult<Self> {
        let category = py.import("palpate.errors")?.getattr("SceneWarning")?;
        for warning in &self.built.warnings {
            py.import("warnings")?
                .call_method1("warn", (warning, &category, 1))?;
        }
        Ok(self)
    }

    fn parsed(
        py: Python<'_>,
        text: String,
        name: &str,
        directory: PathBuf,
        dictionary: bool,
    ) -> PyResult<Self> {
        py.detach(|| {
            Ok(Self {
                built: Arc::new(built_from(&text, name, &directory, dictionary)?),
            })
        })
    }
}

/// Reads and builds text.
fn built_from(text: &str, name: &str, directory: &Path, dictionary: bool) -> PyResult<Built> {
    let shown = dictionary.then_some(text);
    let loaded = file::parse(text, name, directory).map_err(|error| scene_error(&error, shown))?;
    Built::of(&loaded.with(palpate_thesis::METHODS), dictionary)
}
