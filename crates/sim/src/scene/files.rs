//! Where the files are that a scene names: a folder, or whatever has their bytes.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Files by the names that scenes give them.
pub trait Files {
    /// The bytes of a file.
    ///
    /// # Errors
    /// Why they are not to be had, in words.
    fn read(&self, name: &Path) -> Result<Vec<u8>, String>;

    /// The file in messages.
    fn named(&self, name: &Path) -> String {
        name.display().to_string()
    }
}

/// A folder, where relative paths start.
impl Files for &Path {
    fn read(&self, name: &Path) -> Result<Vec<u8>, String> {
        let full = self.join(name);
        if !full.is_file() {
            return Err(format!(
                "there is no file {}; paths start at the scene file",
                full.display()
            ));
        }
        std::fs::read(&full).map_err(|e| format!("cannot read {}: {e}", full.display()))
    }

    fn named(&self, name: &Path) -> String {
        self.join(name).display().to_string()
    }
}

impl Files for &PathBuf {
    fn read(&self, name: &Path) -> Result<Vec<u8>, String> {
        self.as_path().read(name)
    }

    fn named(&self, name: &Path) -> String {
        self.as_path().named(name)
    }
}

/// Files in memory, for programs that have no disk.
impl Files for &BTreeMap<PathBuf, Vec<u8>> {
    fn read(&self, name: &Path) -> Result<Vec<u8>, String> {
        let found = self.get(name).cloned();
        found.ok_or_else(|| format!("there is no file {}", name.display()))
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Scene, file};
    use super::*;
    use palpate_geometry::exchange::{Format, write_surface};
    use palpate_geometry::surface::builtin;
    use palpate_geometry::surface::file::Unit;

    #[test]
    fn a_scene_is_built_from_files_in_memory() {
        let text = "[[body]]\nid = \"b\"\nsurface = { file = \"parts/b.step\" }\n";
        let loaded = file::parse(text, "scene.toml", Path::new("nowhere")).unwrap();
        let sheet = builtin("sheet", None, None).unwrap();
        let step = write_surface(&sheet, Format::Step, Unit::Metre).unwrap();
        let mut files = BTreeMap::from([(PathBuf::from("parts/b.step"), step)]);
        let scene = Scene::build(&loaded.spec, &files).unwrap();
        assert_eq!(scene.rest_surface(0).unwrap().net(), sheet.net());
        files.clear();
        let error = Scene::build(&loaded.spec, &files).err().unwrap();
        assert!(
            error.to_string().contains("no file parts/b.step"),
            "{error}"
        );
        assert!(loaded.build().is_err());
    }
}
