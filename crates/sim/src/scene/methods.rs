//! Methods that scenes name and that this crate does not have: a caller passes those that it has.
//!
//! ```text
//! Methods ── Scene::build_with | Loaded::with ──▶ the scene's door ──▶ the body that names one
//! ```
//! A scene that names one which was not passed is refused, with its line.

use super::door::At;
use super::spec::LatticeSpec;
use crate::body::SpringLaw;
use crate::body::net::Reduced;
use palpate_geometry::contact::OtherMethod;
use palpate_geometry::surface::Surface;
use std::error::Error;
use std::fmt::Debug;

/// What a caller passes to those who build a scene; nothing by default.
#[derive(Clone, Copy, Debug, Default)]
pub struct Methods {
    /// Builders of cells.
    pub cells: &'static [&'static dyn CellBuilder],
    /// Laws of springs.
    pub springs: &'static [&'static dyn SpringLaw],
    /// Ways to find contacts.
    pub contact: &'static [&'static OtherMethod],
}

/// Places nodes and cells inside the surface of a deforming body.
pub trait CellBuilder: Debug + Sync {
    /// What scenes name it: `builder = "…"`.
    fn name(&self) -> &'static str;

    /// Cells, what moves them, and the volume inside the surface, m³.
    ///
    /// # Errors
    /// What the builder cannot fill, and what to do.
    fn cells(
        &self,
        surface: &Surface,
        lattice: &LatticeSpec,
    ) -> Result<(Reduced, f64), Box<dyn Error>>;
}

impl Methods {
    /// The builder of this name, or a problem at its key.
    pub(super) fn cell_builder(self, name: &str, at: &At<'_>) -> Option<&'static dyn CellBuilder> {
        let found = self.cells.iter().find(|builder| builder.name() == name);
        found.copied().or_else(|| absent("builder", name, at))
    }

    /// The law of springs of this name, or a problem at its key.
    pub(super) fn spring_law(self, name: &str, at: &At<'_>) -> Option<&'static dyn SpringLaw> {
        let found = self.springs.iter().find(|law| law.name() == name);
        found.copied().or_else(|| absent("springs", name, at))
    }

    /// The way to find contacts of this name, or a problem at its key.
    pub(super) fn contact_method(self, name: &str, at: &At<'_>) -> Option<&'static OtherMethod> {
        let found = self.contact.iter().find(|method| method.name == name);
        found.copied().or_else(|| absent("method", name, at))
    }
}

/// A problem: the method is not among those that were passed.
fn absent<T>(key: &str, name: &str, at: &At<'_>) -> Option<T> {
    at.key(key).refused(format!(
        "{name:?} is a method kept for comparison, which this program does not have; the program `palpate` and the \
         module `palpate` of Python do (in Rust: build the scene with `palpate_thesis::METHODS`)"
    ))
}
