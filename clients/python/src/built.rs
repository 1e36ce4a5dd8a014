//! A scene as it is built, and the text it came from.

use crate::errors::{internal, scene_error};
use palpate_proto::messages::ToolPose;
use palpate_sim::scene::file::Loaded;
use palpate_sim::scene::{self, Finding, inline_files};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use std::sync::Arc;

/// A scene and the text it came from.
#[derive(Debug)]
pub struct Built {
    /// The constant of simulations.
    pub scene: Arc<scene::Scene>,
    /// The file as it was written.
    pub text: String,
    /// The file with surfaces and meshes written out: what others build from.
    pub effective: String,
    /// What was found about it, with places.
    pub warnings: Vec<String>,
}

impl Built {
    /// Builds as `palpate serve` does: files first written out, then built from that.
    ///
    /// `dictionary`: the text was made from one, so its lines mean nothing.
    pub fn of(loaded: &Loaded, dictionary: bool) -> PyResult<Self> {
        let shown = dictionary.then_some(loaded.text.as_str());
        let refuse = |error| scene_error(&loaded.locate(error), shown);
        // A file that cannot be read is one problem of perhaps many: building lists them all.
        let unread = |error| {
            loaded
                .build()
                .err()
                .map_or_else(|| refuse(error), |all| scene_error(&all, shown))
        };
        let effective = inline_files(&loaded.spec, &loaded.directory).map_err(unread)?;
        let scene = loaded
            .built_to_run(&effective)
            .map_err(|error| scene_error(&error, shown))?;
        let told = |finding: &Finding| match dictionary {
            true => format!("{}: {finding}", finding.path),
            false => loaded.message(finding),
        };
        Ok(Self {
            warnings: scene.warnings().iter().map(told).collect(),
            scene: Arc::new(scene),
            text: loaded.text.clone(),
            effective: toml::to_string(&effective).map_err(internal)?,
        })
    }

    /// Index of a tool.
    pub fn tool(&self, id: &str) -> PyResult<usize> {
        self.scene
            .tool_index(id)
            .ok_or_else(|| unknown("tool", id, &self.tool_ids()))
    }

    /// Index of a body.
    pub fn body(&self, id: &str) -> PyResult<usize> {
        self.scene
            .body_index(id)
            .ok_or_else(|| unknown("body", id, &self.body_ids()))
    }

    /// Ids of all tools, by index.
    pub fn tool_ids(&self) -> Vec<String> {
        (0..self.scene.tool_count())
            .map(|tool| self.scene.tool_id(tool).to_owned())
            .collect()
    }

    /// Ids of all bodies, by index.
    pub fn body_ids(&self) -> Vec<String> {
        (0..self.scene.body_count())
            .map(|body| self.scene.body_id(body).to_owned())
            .collect()
    }

    /// Where a tool is at the start.
    pub fn start(&self, tool: usize) -> ToolPose {
        let state = self.scene.initial_state();
        let pose = &state.tools[tool].link.pose;
        let q = pose.orientation.coords;
        ToolPose {
            orientation: [q.x, q.y, q.z, q.w],
            ..palpate_proto::pose_at([pose.position.x, pose.position.y, pose.position.z])
        }
    }
}

/// `KeyError` that lists what there is.
fn unknown(kind: &str, id: &str, known: &[String]) -> PyErr {
    let known = known
        .iter()
        .map(|id| format!("{id:?}"))
        .collect::<Vec<_>>()
        .join(", ");
    let known = if known.is_empty() {
        "none".to_owned()
    } else {
        known
    };
    PyKeyError::new_err(format!("this scene has no {kind} {id:?}; it has {known}"))
}
