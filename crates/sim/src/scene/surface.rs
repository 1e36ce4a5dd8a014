//! Surfaces of a scene file.

use super::door::{At, nearest};
use super::spec::SurfaceSpec;
use palpate_geometry::surface::builtin::BUILTINS;
use palpate_geometry::surface::{self, BuiltinError, Surface};

impl SurfaceSpec {
    /// Checks and builds the surface; `at` is its table.
    pub(super) fn surface(&self, at: &At<'_>) -> Option<Surface> {
        match (&self.builtin, &self.file, &self.inline) {
            (Some(name), None, None) => self.builtin(name, at),
            (None, Some(file), None) => {
                let bytes = at.read_file("file", file)?;
                let full = at.directory().join(file);
                let named = |e: &dyn std::fmt::Display| format!("{}: {e}", full.display());
                let text = std::str::from_utf8(&bytes).map_err(|e| named(&e));
                let read = text.and_then(|text| surface::file::read(text).map_err(|e| named(&e)));
                at.key("file").take(read)
            }
            (None, None, Some(value)) => at.key("inline").take(surface::file::from_value(value)),
            _ => at.refused("surface needs exactly one of builtin, file, inline"),
        }
    }

    fn builtin(&self, name: &str, at: &At<'_>) -> Option<Surface> {
        match surface::builtin(name, self.net, self.size) {
            Ok(surface) => Some(surface),
            Err(BuiltinError::Name(_)) => {
                let near = nearest(name, BUILTINS.iter().copied());
                let known = BUILTINS.join(", ");
                at.key("builtin").refused(format!(
                    "{name:?} is not a builtin surface; did you mean {near:?}? (known: {known})"
                ))
            }
            Err(error @ BuiltinError::Net { .. }) => at.key("net").refused(error),
            Err(error @ BuiltinError::Size { .. }) => at.key("size").refused(error),
            Err(error) => at.key("builtin").refused(error),
        }
    }

    /// Replaces a file by what is in it; `at` is the table.
    pub(super) fn inline_file(&mut self, at: &At<'_>) -> Option<()> {
        let Some(file) = &self.file else {
            return Some(());
        };
        let bytes = at.read_file("file", file)?;
        let mut document: serde_json::Value =
            at.key("file").take(serde_json::from_slice(&bytes))?;
        // TOML, as which recordings keep the scene, has no null; absent says the same.
        if let Some(fields) = document.as_object_mut() {
            fields.retain(|_, value| !value.is_null());
        }
        (self.file, self.inline) = (None, Some(document));
        Some(())
    }
}
