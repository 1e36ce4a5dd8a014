//! Values of a scene that differ from copy to copy.

use crate::built::Built;
use crate::errors::{internal, scene_error};
use crate::overrides::set_value;
use crate::values::toml_value;
use palpate_sim::scene::{Scene, file};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, Mutex};

/// By copy: what was replaced, path and value, in order.
#[derive(Clone, Default)]
pub struct Varied(Vec<Vec<(String, toml::Value)>>);

impl Varied {
    /// Nothing was replaced.
    pub fn new(n: usize) -> Self {
        Self(vec![Vec::new(); n])
    }

    /// With one more value a copy: what is replaced then, and the scene of each copy. Equal copies
    /// share a scene; different ones are built on `workers` threads.
    pub fn with(
        &self,
        py: Python<'_>,
        built: &Built,
        path: &str,
        values: &Bound<'_, PyAny>,
        workers: usize,
    ) -> PyResult<(Self, Vec<Arc<Scene>>)> {
        let plain = match values.call_method0("tolist") {
            Ok(list) => list,
            Err(_) => values.clone(),
        };
        let values: Vec<Bound<'_, PyAny>> = plain
            .extract()
            .map_err(|_| wrong_count(path, self.0.len(), 1))?;
        if values.len() != self.0.len() {
            return Err(wrong_count(path, self.0.len(), values.len()));
        }
        let mut varied = self.clone();
        let document: toml::Value = toml::from_str(&built.effective).map_err(internal)?;
        let mut texts: Vec<String> = Vec::with_capacity(values.len());
        for (k, (value, list)) in values.iter().zip(&mut varied.0).enumerate() {
            let value = toml_value(value, &format!("{path}[{k}]"))?;
            list.retain(|(known, _)| known != path);
            list.push((path.to_owned(), value));
            let mut own = document.clone();
            list.iter()
                .try_for_each(|(path, value)| set_value(&mut own, path, value.clone()))?;
            texts.push(toml::to_string(&own).map_err(internal)?);
        }
        let mut numbers: BTreeMap<&str, usize> = BTreeMap::new();
        let which: Vec<usize> = texts
            .iter()
            .map(|text| {
                let next = numbers.len();
                *numbers.entry(text).or_insert(next)
            })
            .collect();
        let mut distinct = vec![""; numbers.len()];
        numbers
            .iter()
            .for_each(|(text, number)| distinct[*number] = text);
        let scenes = py.detach(|| build_all(&distinct, &built.scene, workers));
        let scenes: Vec<Arc<Scene>> = scenes.into_iter().collect::<PyResult<_>>()?;
        for scene in &scenes {
            let alike = scene.body_count() == built.scene.body_count()
                && scene.tool_count() == built.scene.tool_count()
                && (0..scene.body_count())
                    .all(|body| scene.net_size(body) == built.scene.net_size(body));
            if !alike {
                return Err(PyValueError::new_err(format!(
                    "{path} changes the number of control points, bodies or tools; use a batch for each"
                )));
            }
        }
        Ok((
            varied,
            which
                .into_iter()
                .map(|number| scenes[number].clone())
                .collect(),
        ))
    }
}

fn wrong_count(path: &str, n: usize, given: usize) -> PyErr {
    PyValueError::new_err(format!(
        "{path}: {given} values for {n} copies; give one for each"
    ))
}

/// A scene that shares with this one what is equal in both.
fn variant(text: &str, scene: &Scene) -> PyResult<Scene> {
    let refuse = |error| scene_error(&error, Some(text));
    let loaded = file::parse(text, &scene.name, Path::new(".")).map_err(refuse)?;
    scene
        .variant_to_run(&loaded.spec, &loaded.directory)
        .map_err(|error| refuse(loaded.locate(error)))
}

fn build_all(texts: &[&str], base: &Scene, workers: usize) -> Vec<PyResult<Arc<Scene>>> {
    let results: Vec<Mutex<Option<PyResult<Arc<Scene>>>>> =
        texts.iter().map(|_| Mutex::new(None)).collect();
    let queue = Mutex::new(texts.iter().zip(&results));
    std::thread::scope(|scope| {
        let work = || {
            loop {
                let next = queue.lock().ok().and_then(|mut queue| queue.next());
                let Some((text, result)) = next else { return };
                let scene = variant(text, base).map(Arc::new);
                if let Ok(mut result) = result.lock() {
                    *result = Some(scene);
                }
            }
        };
        (1..workers.min(texts.len())).for_each(|_| drop(scope.spawn(work)));
        work();
    });
    let taken = results
        .into_iter()
        .map(|result| result.into_inner().ok().flatten());
    taken
        .map(|scene| scene.unwrap_or_else(|| Err(internal("a scene was not built"))))
        .collect()
}
