//! Surfaces of a scene file.

use super::door::{At, nearest};
use super::spec::{MeshUnit, SurfaceSpec};
use palpate_geometry::exchange::step::{PartPick, read_part};
use palpate_geometry::exchange::{self, Format, Pick};
use palpate_geometry::part::Part;
use palpate_geometry::surface::builtin::BUILTINS;
use palpate_geometry::surface::file::Unit;
use palpate_geometry::surface::{self, BuiltinError, CloudSpec, Loaded, Shell, Surface};
use std::path::Path;

/// Control points of a surface that is fitted to a mesh, unless the scene gives them.
const FITTED_NET: [usize; 2] = [14; 2];

/// Key of an inline STEP file.
pub(super) const STEP: &str = "step";

/// Largest distance between a mesh and the surface fitted to it, relative to the size of the mesh.
const FIT_TOLERANCE: f64 = 0.01;

/// What a `surface` names.
pub(super) enum Named {
    /// A B-spline, and what was set right as it was read.
    Surface(Loaded),
    /// Trimmed faces, and what is said about them.
    Part(Box<Part>, Vec<String>),
}

impl From<Surface> for Named {
    fn from(surface: Surface) -> Self {
        Self::Surface(Loaded {
            surface,
            merged: Vec::new(),
        })
    }
}

impl SurfaceSpec {
    /// Checks and builds what must be a surface; `at` is its table.
    pub(super) fn surface(&self, at: &At<'_>) -> Option<Surface> {
        match self.loaded(at)? {
            Named::Surface(loaded) => Some(loaded.surface),
            Named::Part(part, _) => at.refused(format!(
                "this needs one B-spline surface, and the file holds a part of {} faces; choose one of its B-splines with \
                 index, or fit a surface to it: palpate surface tessellate, then palpate surface fit",
                part.faces().len()
            )),
        }
    }

    /// What it names.
    pub(super) fn loaded(&self, at: &At<'_>) -> Option<Named> {
        self.check_keys(at)?;
        match (&self.builtin, &self.file, &self.inline) {
            (Some(name), None, None) => self.builtin(name, at).map(Named::from),
            (None, Some(file), None) => self.read(file, at),
            (None, None, Some(value)) => match value.get(STEP) {
                Some(serde_json::Value::String(text)) => {
                    at.key("inline").take(self.step(text.as_bytes()))
                }
                _ => (at.key("inline").take(surface::file::load(value))).map(Named::Surface),
            },
            _ => at.refused("surface needs exactly one of builtin, file, inline"),
        }
    }

    /// A key that would have no effect is a mistake.
    fn check_keys(&self, at: &At<'_>) -> Option<()> {
        let format = self.file.as_ref().and_then(|file| Format::of(file).ok());
        let is_mesh = matches!(
            format,
            Some(Format::Stl | Format::Obj | Format::Ply | Format::Glb)
        );
        if self.unit.is_some() && !is_mesh {
            return at.key("unit").refused(
                "unit is for mesh files (.stl, .obj, .ply); surface files say their unit themselves, and all else is in metres",
            );
        }
        let of_step = self
            .inline
            .as_ref()
            .is_some_and(|value| value.get(STEP).is_some());
        let is_step = of_step || format == Some(Format::Step);
        for (key, given) in [
            ("part", self.part.is_some()),
            ("instance", self.instance.is_some()),
        ] {
            if given && (!is_step || self.index.is_some()) {
                return at.key(key).refused(
                    "part and instance choose faces of a STEP file, all of them; drop them where a single surface is meant",
                );
            }
        }
        if self.index.is_some() && !is_step && format != Some(Format::Iges) {
            return at
                .key("index")
                .refused("index is for STEP and IGES files, which can have several surfaces");
        }
        Some(())
    }

    /// The one surface of a file, or its part.
    fn read(&self, file: &Path, at: &At<'_>) -> Option<Named> {
        let bytes = at.read_file("file", file)?;
        let named = |e: &dyn std::fmt::Display| format!("{}: {e}", at.name_of(file));
        let read = match Format::of(file) {
            Ok(Format::Step) => self.step(&bytes),
            Ok(Format::Iges) => self.iges(file, &bytes).map(Named::Surface),
            Ok(format @ (Format::Stl | Format::Obj | Format::Ply | Format::Glb)) => {
                self.fitted(file, &bytes, format, at)?.map(Named::from)
            }
            Ok(Format::Points) => Err(format!(
                "points alone make no body; fit a surface first: palpate import {}",
                file.display()
            )),
            // Whatever its name is.
            Ok(Format::Json) | Err(_) => std::str::from_utf8(&bytes)
                .map_err(|e| e.to_string())
                .and_then(|text| surface::file::read_with_unit(text).map_err(|e| e.to_string()))
                .map(|(loaded, _)| Named::Surface(loaded)),
        };
        at.key("file").take(read.map_err(|e| named(&e)))
    }

    /// The one B-spline of a STEP file that is a whole face of its own, or the one of that index; else the part that all
    /// its faces make.
    fn step(&self, bytes: &[u8]) -> Result<Named, String> {
        let pick = self.index.map_or(Pick::First, Pick::Index);
        let chosen = self.part.is_some() || self.instance.is_some();
        let one = match chosen {
            true => None,
            false => Some(exchange::read_surface(bytes, Format::Step, pick)),
        };
        match one {
            Some(Ok(read))
                if !read.left_out.is_any() && (read.count == 1 || self.index.is_some()) =>
            {
                return Ok(Named::Surface(Loaded {
                    surface: read.surface,
                    merged: read.merged,
                }));
            }
            Some(Err(error)) if self.index.is_some() => return Err(error.to_string()),
            Some(Ok(read)) if self.index.is_some() => {
                return Err(format!(
                    "the surface of index {} alone is not the shape in the file; left out: {}. Without index the file is a \
                     part with all its faces; `palpate surface convert --ignore-trims` writes the whole surface",
                    self.index.unwrap_or(0),
                    read.left_out
                ));
            }
            _ => {}
        }
        let pick = PartPick {
            part: self.part.clone(),
            instance: self.instance,
            partial: false,
        };
        let mut read = read_part(bytes, &pick).map_err(|e| e.to_string())?;
        let part = read.part(false).map_err(|e| e.to_string())?;
        let mut notes = read.notes;
        if !read.left_out.is_nothing() {
            notes.push(format!("left out of the file: {}", read.left_out));
        }
        Ok(Named::Part(Box::new(part), notes))
    }

    fn iges(&self, file: &Path, bytes: &[u8]) -> Result<Loaded, String> {
        let pick = self.index.map_or(Pick::First, Pick::Index);
        let read = exchange::read_surface(bytes, Format::Iges, pick).map_err(|e| e.to_string())?;
        if read.count > 1 && self.index.is_none() {
            return Err(format!(
                "it has {} surfaces; choose one with index = 0 to {}",
                read.count,
                read.count - 1
            ));
        }
        if read.left_out.is_any() {
            return Err(format!(
                "its surface alone is not the shape in the file; left out: {}. To take the whole surface nevertheless: \
                 palpate surface convert {} {} --ignore-trims",
                read.left_out,
                file.display(),
                file.with_extension("json").display()
            ));
        }
        Ok(Loaded {
            surface: read.surface,
            merged: read.merged,
        })
    }

    /// A closed surface near the triangles of a file, within the tolerance. `None`: a problem at
    /// another key.
    fn fitted(
        &self,
        file: &Path,
        bytes: &[u8],
        format: Format,
        at: &At<'_>,
    ) -> Option<Result<Surface, String>> {
        let unit = match (self.unit, format) {
            (Some(MeshUnit::Mm), _) => Unit::Millimetre,
            (Some(MeshUnit::M), _) | (None, Format::Glb) => Unit::Metre,
            (None, _) => {
                return at.refused(format!(
                    "{} does not give its unit; add unit = \"mm\" or unit = \"m\"",
                    file.display()
                ));
            }
        };
        let spec = CloudSpec {
            closed: true,
            counts: self.net.unwrap_or(FITTED_NET),
            ..CloudSpec::default()
        };
        let fit = || {
            let mesh = exchange::read_mesh(bytes, format, unit).map_err(|e| e.to_string())?;
            let shell = Shell::of(&mesh).ok_or("its triangles have no area")?;
            let fitted = Surface::fitted_to_shell(&shell, &spec).map_err(|e| e.to_string())?;
            let apart_m = fitted.surface.apart_from(&shell).largest_m();
            let most_m = FIT_TOLERANCE * shell.census().size_m;
            if apart_m > most_m {
                return Err(format!(
                    "the fitted surface is up to {apart_m:.3e} m away from the triangles, more than {most_m:.3e} m; \
                     give a finer net, such as net = [20, 20], or fit it with palpate import {}",
                    file.display()
                ));
            }
            Ok(fitted.surface)
        };
        Some(fit())
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
        let format = Format::of(file).ok();
        let named = self.read(file, at)?;
        let is_json = format == Some(Format::Json);
        let of_step = format == Some(Format::Step) && matches!(named, Named::Part(..));
        let mut document: serde_json::Value = if is_json {
            let bytes = at.read_file("file", file)?;
            at.key("file").take(serde_json::from_slice(&bytes))?
        } else if of_step {
            let bytes = at.read_file("file", file)?;
            serde_json::json!({ STEP: String::from_utf8_lossy(&bytes) })
        } else {
            let Named::Surface(loaded) = named else {
                return None;
            };
            let text = surface::file::write(&loaded.surface, Unit::Metre);
            at.key("file").take(serde_json::from_str(&text))?
        };
        // TOML, as which recordings keep the scene, has no null; absent says the same.
        if let Some(fields) = document.as_object_mut() {
            fields.retain(|_, value| !value.is_null());
        }
        *self = Self {
            builtin: None,
            net: None,
            size: None,
            file: None,
            index: None,
            part: self.part.take(),
            instance: self.instance.take(),
            unit: None,
            inline: Some(document),
        };
        Some(())
    }
}
