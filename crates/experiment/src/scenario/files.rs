//! Where the files of a scenario are: in a folder, or in the program.

use super::error::ScenarioError;
use std::path::{Path, PathBuf};

macro_rules! builtin {
    ($($name:literal: $($file:literal),*;)*) => {
        /// Scenarios of the program, in their order.
        pub const NAMES: &[&str] = &[$($name),*];

        const FILES: &[(&str, &str, &str)] = &[$($(
            ($name, $file, include_str!(concat!("../../../../scenes/", $name, "/", $file))),
        )*)*];
    };
}

builtin! {
    "teardrop-tools": "scenario.toml", "scene.toml", "press.toml", "point.toml", "torus.toml";
    "plasticine": "scenario.toml", "scene.toml";
    "spoon-bend": "scenario.toml", "scene.toml", "push.toml", "handle.json";
    "spoon-grip": "scenario.toml", "scene.toml", "grips.toml", "handle.json";
    "spoon-merge": "scenario.toml", "scene.toml", "push.toml", "handle.json", "bowl.json";
    "spoon-weight": "scenario.toml", "scene.toml", "handle.json";
    "jelly": "scenario.toml", "scene.toml", "bowl.json";
    "jelly-shake": "scenario.toml", "scene.toml", "bowl.json";
    "two-hands": "scenario.toml", "scene.toml", "left.toml", "right.toml";
    "brain": "scenario.toml", "scene.toml";
    "vessel-probe": "scenario.toml", "scene.toml", "probe.toml", "vessel.json", "spine.json";
    "palpation": "scenario.toml", "scene.toml";
    "tele-touch": "scenario.toml", "scene.toml", "left.toml", "right.toml";
    "stack": "scenario.toml", "scene.toml", "puck.json";
    "dominoes": "scenario.toml", "scene.toml", "box.json";
    "wall": "scenario.toml", "scene.toml", "box.json";
    "cut": "scenario.toml", "scene.toml", "push.toml", "loaf.json";
}

/// Scenes of the program without hands: name and text.
pub const SCENES: [(&str, &str); 5] = [
    ("teardrop", include_str!("../../../../scenes/teardrop.toml")),
    (
        "rigid-teardrop",
        include_str!("../../../../scenes/rigid-teardrop.toml"),
    ),
    ("sheet", include_str!("../../../../scenes/sheet.toml")),
    (
        "two-drops",
        include_str!("../../../../scenes/two-drops.toml"),
    ),
    (
        "four-hands",
        include_str!("../../../../scenes/four-hands.toml"),
    ),
];

/// The files of one scenario.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// In the program, by name.
    Builtin(&'static str),
    /// In a folder.
    Folder {
        /// The folder.
        path: PathBuf,
        /// Its last part.
        name: String,
    },
}

impl Source {
    /// A name of [`NAMES`], or a folder with a `scenario.toml`.
    ///
    /// # Errors
    /// Neither.
    pub fn of(name: &str) -> Result<Self, ScenarioError> {
        if let Some(known) = NAMES.iter().find(|known| **known == name) {
            return Ok(Self::Builtin(known));
        }
        let path = PathBuf::from(name);
        if path.join("scenario.toml").is_file() {
            let last = path.canonicalize().ok();
            let last = last.as_deref().and_then(Path::file_name);
            let name = last.map_or(name.to_owned(), |last| last.to_string_lossy().into_owned());
            return Ok(Self::Folder { path, name });
        }
        Err(ScenarioError::Unknown {
            name: name.to_owned(),
            known: NAMES.join(", "),
        })
    }

    /// Name of the scenario.
    pub fn name(&self) -> &str {
        match self {
            Self::Builtin(name) => name,
            Self::Folder { name, .. } => name,
        }
    }

    /// The text of a file.
    ///
    /// # Errors
    /// No such file, or not text.
    pub fn text(&self, file: &str) -> Result<String, ScenarioError> {
        match self {
            Self::Builtin(name) => FILES
                .iter()
                .find(|(of, known, _)| of == name && *known == file)
                .map(|(_, _, text)| (*text).to_owned())
                .ok_or_else(|| ScenarioError::File {
                    path: format!("{name}/{file}"),
                    reason: "it is not in the program".into(),
                }),
            Self::Folder { path, .. } => {
                let full = path.join(file);
                std::fs::read_to_string(&full).map_err(|error| ScenarioError::File {
                    path: full.display().to_string(),
                    reason: error.to_string(),
                })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // Whoever changes a folder changes the program.
    #[test]
    fn every_file_of_every_scenario_is_in_the_program() {
        let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
        let mut folders = 0;
        for entry in std::fs::read_dir(scenes).unwrap() {
            let folder = entry.unwrap().path();
            if !folder.join("scenario.toml").is_file() {
                continue;
            }
            folders += 1;
            let name = folder.file_name().unwrap().to_string_lossy().into_owned();
            assert!(
                folder.join("README.md").is_file(),
                "{name} has no README.md"
            );
            for file in std::fs::read_dir(&folder).unwrap() {
                let file = file.unwrap().file_name().to_string_lossy().into_owned();
                let data = file.ends_with(".toml") || file.ends_with(".json");
                let known = FILES
                    .iter()
                    .any(|(of, known, _)| *of == name && *known == file);
                assert_eq!(data, known, "{name}/{file}");
            }
        }
        assert_eq!(folders, NAMES.len());
    }
}
