//! The scenes that a lobby offers: those of the program, and the files of one folder.
//!
//! A request names a scene of this list. No path is ever made from what a request says, so that none leads
//! out of the folder.

use palpate_experiment::scenario::SCENES;
use std::fs::File;
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};

/// Scenes of a folder beyond these are not offered.
const MOST_FILES: usize = 1_000;
/// The comment that describes a scene is looked for in so many bytes.
const HEAD: u64 = 1_024;

/// A scene that can be asked for.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Offer {
    /// `builtin:NAME`, or the name of a file without `.toml`.
    pub name: String,
    /// The comment in its first line, if there is one.
    pub description: String,
    /// What `palpate serve` is given.
    #[serde(skip)]
    pub(super) source: PathBuf,
}

/// All scenes on offer.
#[derive(Clone, Debug, Default)]
pub struct Shelf {
    folder: Option<PathBuf>,
}

impl Shelf {
    /// The scenes of the program, and the `*.toml` files that lie directly in a folder.
    ///
    /// # Errors
    /// The folder cannot be read.
    pub fn new(folder: Option<&Path>) -> io::Result<Self> {
        if let Some(folder) = folder {
            std::fs::read_dir(folder)?;
        }
        Ok(Self {
            folder: folder.map(Path::to_owned),
        })
    }

    /// Everything on offer now: files may come and go.
    pub fn offers(&self) -> Vec<Offer> {
        let builtin = SCENES.iter().map(|(name, text)| Offer {
            name: format!("builtin:{name}"),
            description: description(text),
            source: format!("builtin:{name}").into(),
        });
        let mut offers: Vec<Offer> = builtin.collect();
        offers.extend(self.files());
        offers
    }

    /// The scene of this name.
    pub fn find(&self, name: &str) -> Option<Offer> {
        self.offers().into_iter().find(|offer| offer.name == name)
    }

    fn files(&self) -> Vec<Offer> {
        let entries = self.folder.as_deref().map(std::fs::read_dir);
        let Some(Ok(entries)) = entries else {
            return Vec::new();
        };
        let paths = entries.filter_map(|entry| Some(entry.ok()?.path()));
        let mut paths: Vec<PathBuf> = paths
            .filter(|path| {
                path.extension()
                    .is_some_and(|extension| extension == "toml")
            })
            .filter(|path| path.is_file())
            .collect();
        paths.sort();
        paths.truncate(MOST_FILES);
        let offer = |path: PathBuf| {
            let name = path.file_stem()?.to_str()?.to_owned();
            Some(Offer {
                name,
                description: head(&path).map_or(String::new(), |text| description(&text)),
                source: path,
            })
        };
        paths.into_iter().filter_map(offer).collect()
    }
}

/// The comment that a scene begins with.
fn description(text: &str) -> String {
    let first = text.lines().next().unwrap_or_default();
    match first.strip_prefix('#') {
        Some(comment) => comment.trim().to_owned(),
        None => String::new(),
    }
}

fn head(path: &Path) -> io::Result<String> {
    let mut bytes = Vec::new();
    File::open(path)?.take(HEAD).read_to_end(&mut bytes)?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_the_folder_are_offered_and_nothing_outside_it() {
        let directory = tempfile::tempdir().unwrap();
        let folder = directory.path().join("scenes");
        std::fs::create_dir_all(folder.join("deeper.toml")).unwrap();
        for (name, text) in [
            ("scenes/slab.toml", "# A soft slab\n[[body]]\n"),
            ("scenes/bare.toml", "[[body]]\n"),
            ("scenes/notes.txt", "# no scene\n"),
            ("scenes/deeper.toml/inner.toml", "# deeper\n"),
            ("secret.toml", "# outside\n"),
        ] {
            std::fs::write(directory.path().join(name), text).unwrap();
        }
        let shelf = Shelf::new(Some(&folder)).unwrap();
        let offers = shelf.offers();
        let files: Vec<(&str, &str)> = (offers.iter())
            .filter(|offer| !offer.name.starts_with("builtin:"))
            .map(|offer| (&*offer.name, &*offer.description))
            .collect();
        assert_eq!(files, [("bare", ""), ("slab", "A soft slab")]);
        assert_eq!(offers.len(), files.len() + SCENES.len());
        for outside in [
            "../secret",
            "secret",
            "deeper/inner",
            "",
            ".",
            "slab.toml",
            "./slab",
        ] {
            assert_eq!(shelf.find(outside), None, "{outside}");
        }
        let absolute = folder.join("slab").display().to_string();
        assert_eq!(shelf.find(&absolute), None);
        assert_eq!(shelf.find("slab").unwrap().source, folder.join("slab.toml"));
    }

    #[test]
    fn a_folder_that_is_not_there_is_refused() {
        assert!(Shelf::new(Some(Path::new("/nonexistent/scenes"))).is_err());
    }
}
