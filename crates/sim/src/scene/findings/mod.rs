//! What is looked at before a scene runs, in every way to run one: what must not run, what is hardly meant, and what
//! comes out less exact than its numbers suggest.
//!
//! ```text
//! usual      values of the file against a table of what they are in use: slips of units
//! standing   where things stand: in each other, far from each other, held by nothing
//! unused     keys without effect on the model that has them
//! limits     what the solvers do not hold: with how far off, and what helps
//! ```

mod limits;
mod standing;
mod unused;
mod usual;

use super::door::{Problem, SceneError};
use super::files::Files;
use super::methods::Methods;
use super::spec::SceneSpec;
use super::{BodyModel, Scene};
use palpate_geometry::math::{Pose, Rotation, Vector3};
use serde::Serialize;
use std::fmt::{self, Display};

/// What is found about a scene that can be built.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// How much it matters.
    pub kind: FindingKind,
    /// Path of the key that it is about, as in [`Problem::path`].
    pub path: String,
    /// What was found and what to do, in a sentence.
    pub what: String,
}

/// How much a [`Finding`] matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum FindingKind {
    /// The scene is not to run: what comes of it is no force of a material.
    Wrong,
    /// Hardly what is meant: a slip of units or places, or a key without effect.
    Unusual,
    /// It runs, and is less exact or slower than its numbers suggest.
    Limit,
}

impl Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.what)
    }
}

/// Findings as they are gathered.
#[derive(Default)]
struct Found(Vec<Finding>);

impl Found {
    fn add(&mut self, kind: FindingKind, path: impl Into<String>, what: impl Into<String>) {
        self.0.push(Finding {
            kind,
            path: path.into(),
            what: what.into(),
        });
    }

    fn unusual(&mut self, path: impl Into<String>, what: impl Into<String>) {
        self.add(FindingKind::Unusual, path, what);
    }

    fn limit(&mut self, path: impl Into<String>, what: impl Into<String>) {
        self.add(FindingKind::Limit, path, what);
    }
}

impl Scene {
    /// [`Scene::build`] for a scene that is to run: refuses also what is found [wrong](FindingKind::Wrong), and
    /// keeps all else that is found, for [`Scene::warnings`]. A recording is replayed whatever is found about its
    /// scene.
    ///
    /// # Errors
    /// As [`Scene::build`], and what must not run.
    pub fn build_to_run(spec: &SceneSpec, files: impl Files) -> Result<Self, SceneError> {
        Self::build_to_run_with(spec, files, Methods::default())
    }

    /// [`Scene::build_to_run`] of a scene that may name these methods.
    ///
    /// # Errors
    /// As [`Scene::build_to_run`].
    pub fn build_to_run_with(
        spec: &SceneSpec,
        files: impl Files,
        methods: Methods,
    ) -> Result<Self, SceneError> {
        Self::build_with(spec, files, methods)?.checked_to_run()
    }

    /// Refuses what is found wrong, and keeps all else that is found.
    pub(super) fn checked_to_run(mut self) -> Result<Self, SceneError> {
        let (wrong, warnings): (Vec<_>, Vec<_>) =
            (self.findings().into_iter()).partition(|finding| finding.kind == FindingKind::Wrong);
        if wrong.is_empty() {
            self.warnings = warnings;
            return Ok(self);
        }
        let problem = |finding: Finding| Problem {
            path: finding.path,
            reason: finding.what,
            place: None,
        };
        Err(SceneError {
            problems: wrong.into_iter().map(problem).collect(),
        })
    }

    /// What was found when the scene was built to run.
    pub fn warnings(&self) -> &[Finding] {
        &self.warnings
    }

    /// All that is found about the scene.
    pub fn findings(&self) -> Vec<Finding> {
        let mut found = Found::default();
        usual::look(self, &mut found);
        standing::look(self, &mut found);
        unused::look(self, &mut found);
        limits::look(self, &mut found);
        found.0
    }

    /// From a body's frame to the world, at the start.
    fn placement(&self, body: usize) -> Pose {
        let pose = &self.spec.bodies[body].pose;
        let [x, y, z, w] = pose.orientation;
        let turn = Rotation::from_quaternion(nalgebra::Quaternion::new(w, x, y, z));
        Pose::from_parts(Vector3::from(pose.position).into(), turn)
    }

    /// Mass of a body, kg, and whether nothing holds it; `None` of a rigid one that forces do not move.
    fn mass(&self, body: usize) -> Option<(f64, bool)> {
        let body = &self.bodies[body];
        match &body.model {
            BodyModel::Rigid => body.free().map(|free| (free.mass.mass_kg, true)),
            BodyModel::Deforming(model) => {
                let lattice = &model.deformable;
                let free = lattice.unknown_count() == lattice.coordinate_count();
                Some((lattice.mass_kg(), free))
            }
        }
    }

    /// Mass of a body that nothing holds, kg; `None` of others.
    pub(super) fn free_mass_kg(&self, body: usize) -> Option<f64> {
        self.mass(body)
            .filter(|(_, free)| *free)
            .map(|(mass_kg, _)| mass_kg)
    }
}

/// Millimetres for people: three digits.
fn mm(metres: f64) -> String {
    let mm = metres * 1e3;
    match mm.abs() {
        mm_abs if mm_abs >= 100.0 => format!("{mm:.0} mm"),
        mm_abs if mm_abs >= 10.0 => format!("{mm:.1} mm"),
        _ => format!("{mm:.2} mm"),
    }
}

/// A number for people: three digits, and no more zeros than that.
fn short(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let power = libm::log10(value.abs()).floor();
    let unit = 10_f64.powi(2 - power as i32);
    let rounded = (value * unit).round() / unit;
    match (1e-3..1e5).contains(&rounded.abs()) {
        true => rounded.to_string(),
        false => format!("{rounded:e}"),
    }
}

#[cfg(test)]
mod tests;
