//! Scenes inside the program: `builtin:NAME`, `palpate scenes`, `palpate new NAME`.

use super::Outcome;
use anyhow::Context as _;
use palpate_experiment::scenario::SCENES as BUILTIN;
use palpate_sim::scene::file::{self, Loaded};
use palpate_sim::scene::{Scene, SceneError};
use std::path::{Path, PathBuf};

/// Reads a scene file, or a scene of the program as `builtin:NAME`.
///
/// # Errors
/// A file that cannot be read or is not a scene, or an unknown name.
pub fn load(scene: &Path) -> anyhow::Result<Loaded> {
    match scene
        .to_str()
        .and_then(|text| text.strip_prefix("builtin:"))
    {
        Some(name) => {
            let name_of_file = format!("{name}.toml");
            let loaded = file::parse(builtin(name)?, &name_of_file, Path::new("."))?;
            Ok(loaded.with(palpate_thesis::METHODS))
        }
        None => Ok(read(scene)?),
    }
}

/// Reads a scene file, which may name all methods that this program has.
///
/// # Errors
/// A file that cannot be read or is not a scene.
pub fn read(file: &Path) -> Result<Loaded, SceneError> {
    Ok(file::load(file)?.with(palpate_thesis::METHODS))
}

/// Says what was found about a scene that is about to run.
pub fn warn(loaded: &Loaded, scene: &Scene) {
    for finding in scene.warnings() {
        tracing::warn!("{}", loaded.message(finding));
    }
}

fn builtin(name: &str) -> anyhow::Result<&'static str> {
    let known = || BUILTIN.map(|(name, _)| name).join(", ");
    BUILTIN
        .iter()
        .find(|(known, _)| *known == name)
        .map(|(_, text)| *text)
        .with_context(|| {
            format!(
                "{name:?} is not a scene of this program; it has {}",
                known()
            )
        })
}

#[derive(clap::Args, Debug)]
pub struct Args {
    /// Print one JSON object per scene.
    #[arg(long)]
    json: bool,
}

/// Lists the scenes, each with the comment that its file begins with.
pub fn list(args: &Args) -> anyhow::Result<Outcome> {
    for (name, text) in BUILTIN {
        let comment = text.lines().next().unwrap_or_default();
        let comment = comment.trim_start_matches(['#', ' ']);
        if args.json {
            let scene = format!("builtin:{name}");
            println!(
                "{}",
                serde_json::json!({ "name": name, "scene": scene, "description": comment })
            );
        } else {
            println!("builtin:{name:16} {comment}");
        }
    }
    Ok(Outcome::Ok)
}

#[derive(clap::Args, Debug)]
pub struct NewArgs {
    /// Name of the scene; NAME.toml is written.
    name: PathBuf,
    /// Scene to start from (see `palpate scenes`).
    #[arg(long, default_value = "teardrop")]
    from: String,
}

/// Writes a scene file to start from.
pub fn new(args: &NewArgs) -> anyhow::Result<Outcome> {
    let text = builtin(args.from.trim_start_matches("builtin:"))?;
    let path = match args.name.extension() {
        Some(extension) if extension == "toml" => args.name.clone(),
        _ => PathBuf::from(format!("{}.toml", args.name.display())),
    };
    // The name in the file is that of the scene it was; without it a scene is called after its file.
    let text: String = text
        .lines()
        .filter(|line| !line.starts_with("name = "))
        .map(|line| format!("{line}\n"))
        .collect();
    write_new(&path, text.as_bytes())?;
    println!("{}", path.display());
    eprintln!(
        "next: palpate check {0}; palpate serve {0} --http 127.0.0.1:8080",
        path.display()
    );
    Ok(Outcome::Ok)
}

/// Writes a file that does not exist yet.
pub fn write_new(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    use std::io::Write as _;
    let mut file = std::fs::OpenOptions::new()
        .write(true)
        .create_new(true)
        .open(path)
        .with_context(|| format!("{} (nothing is overwritten)", path.display()))?;
    file.write_all(bytes)
        .with_context(|| path.display().to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    // What `check` and `serve` would say of it.
    #[test]
    fn nothing_is_found_about_a_builtin_scene_and_its_ticks_are_long_enough() {
        for (name, _) in BUILTIN {
            let loaded = load(Path::new(&format!("builtin:{name}"))).unwrap();
            let scene = loaded.build().unwrap();
            assert_eq!(scene.findings(), [], "{name}");
            let tick_us = scene.predicted_tick_us();
            assert!(tick_us * 1e-6 < scene.dt_s, "{name}: {tick_us} us");
        }
    }
}
