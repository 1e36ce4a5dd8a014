//! `palpate surface truncate`: two overlapping bodies get a common wall.

use super::make::write;
use super::part::Misuse;
use super::{Loaded, Opened, Outcome, SurfaceArg};
use anyhow::Context as _;
use palpate_geometry::exchange::Format;
use palpate_geometry::exchange::step::write_parts;
use palpate_geometry::surface::file::Unit;
use palpate_modeling::truncate::{TruncateSpec, Truncated, truncate};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

#[derive(clap::Args, Debug)]
#[command(
    after_help = "Exit codes: 0 truncated, 1 truncated but the tolerance was not reached, or no overlap (nothing is written), 2 \
                  refused."
)]
pub struct Args {
    /// Two closed surfaces (.json, .step, .stp, .iges, .igs, builtin:NAME).
    #[arg(num_args = 2, required = true, value_names = ["A", "B"])]
    bodies: Vec<PathBuf>,
    /// Output: a .step or .stp file with both parts, named after their files; or a directory for a STEP file each.
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Largest distance of the wall from where both bodies are equally deep, in the unit of A [default: 1e-4 of the size of
    /// the smaller body].
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    tolerance: Option<f64>,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    let to_file = match &args.output {
        Some(path) if path.extension().is_some() => Some(Format::of(path)?),
        _ => None,
    };
    if to_file.is_some_and(|format| format != Format::Step) {
        return Err(Misuse::Truncated.into());
    }
    let [a, b] = [body(&args.bodies[0])?, body(&args.bodies[1])?];
    let spec = TruncateSpec {
        tolerance_m: args.tolerance.map(|length| length / a.per_metre),
    };
    let start = Instant::now();
    let [first, second] = [0, 1].map(|k| args.bodies[k].display());
    let two = truncate(&a.surface, &b.surface, &spec)
        .map_err(|e| anyhow::anyhow!("{e}; body 0 is {first}, body 1 {second}"))?;
    let Some(two) = two else {
        if args.json {
            println!("{}", serde_json::json!({ "overlap": 0.0, "unit": a.unit }));
        }
        eprintln!("note: the bodies do not overlap; there is nothing to truncate");
        return Ok(Outcome::Difference);
    };
    let taken = start.elapsed();
    let names = names(&args.bodies);
    if let Some(output) = &args.output {
        save(&two, &names, &a, output, to_file.is_some())?;
    }
    match args.json {
        true => println!("{}", as_json(&two, &names, &a, taken)),
        false => print(&two, &names, &a, taken),
    }
    if two.within_tolerance() {
        return Ok(Outcome::Ok);
    }
    eprintln!(
        "note: the tolerance was not reached; the wall has creases, or give a larger --tolerance"
    );
    Ok(Outcome::Difference)
}

fn body(path: &Path) -> anyhow::Result<Loaded> {
    let source = SurfaceArg {
        file: path.to_owned(),
        ..SurfaceArg::default()
    };
    match source.open()? {
        Opened::Surface(loaded) => Ok(*loaded),
        Opened::Part(part) => {
            let faces = part.part.faces().len();
            Err(Misuse::NotWhole { faces }).with_context(|| path.display().to_string())
        }
    }
}

/// Names of the files, made different.
fn names(files: &[PathBuf]) -> [String; 2] {
    let stem = |k: usize| {
        let text = files[k].to_string_lossy();
        let name = text.strip_prefix("builtin:").unwrap_or(&text);
        let stem = Path::new(name).file_stem().unwrap_or_default();
        stem.to_string_lossy().into_owned()
    };
    let [a, b] = [stem(0), stem(1)];
    match a == b {
        true => [format!("{a}-a"), format!("{b}-b")],
        false => [a, b],
    }
}

fn save(
    two: &Truncated,
    names: &[String; 2],
    first: &Loaded,
    output: &Path,
    one_file: bool,
) -> anyhow::Result<()> {
    let unit = match first.unit.as_str() {
        "mm" => Unit::Millimetre,
        _ => Unit::Metre,
    };
    let parts = [0, 1].map(|k| (names[k].as_str(), &two.breps[k]));
    if one_file {
        return write(output, write_parts(&parts, &unit.into())?.as_bytes());
    }
    std::fs::create_dir_all(output).with_context(|| output.display().to_string())?;
    for part in parts {
        let path = output.join(format!("{}.step", part.0));
        write(&path, write_parts(&[part], &unit.into())?.as_bytes())?;
    }
    Ok(())
}

fn as_json(
    two: &Truncated,
    names: &[String; 2],
    first: &Loaded,
    taken: Duration,
) -> serde_json::Value {
    let (length, volume) = (first.per_metre, first.per_metre.powi(3));
    let walls = two.walls.iter().map(|wall| {
        serde_json::json!({
            "edges": wall.rims, "net": wall.net, "uneven": wall.uneven_m * length, "off": wall.off_m * length,
        })
    });
    let [a, b, both] = two.before_m3.map(|v| v * volume);
    serde_json::json!({
        "unit": first.unit, "names": names, "volumes": two.volumes_m3.map(|v| v * volume), "before": [a, b],
        "overlap": both, "union": two.union_m3() * volume, "walls": walls.collect::<Vec<_>>(),
        "gaps": two.parts.each_ref().map(|part| part.gap_m() * length), "tolerance": two.tolerance_m * length,
        "within_tolerance": two.within_tolerance(), "time_s": taken.as_secs_f64(),
    })
}

fn print(two: &Truncated, names: &[String; 2], first: &Loaded, taken: Duration) {
    let (unit, length, volume) = (&first.unit, first.per_metre, first.per_metre.powi(3));
    for (k, name) in names.iter().enumerate() {
        println!(
            "{name}: volume {} {unit}³, before {} {unit}³, edges within {:.1e} {unit} of their faces",
            two.volumes_m3[k] * volume,
            two.before_m3[k] * volume,
            two.parts[k].gap_m() * length,
        );
    }
    println!(
        "union {} {unit}³, overlap before {} {unit}³, in {:.2} s",
        two.union_m3() * volume,
        two.before_m3[2] * volume,
        taken.as_secs_f64(),
    );
    for wall in &two.walls {
        println!(
            "wall: {} of {} × {} control points, depths differ by up to {:.2e} {unit}, off by up to {:.2e} {unit}",
            if wall.rims == 1 { "disc" } else { "ring" },
            wall.net[0],
            wall.net[1],
            wall.uneven_m * length,
            wall.off_m * length,
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn volume_m3(path: &Path, part: Option<&str>) -> f64 {
        let source = SurfaceArg {
            file: path.to_owned(),
            part: part.map(ToOwned::to_owned),
            ..SurfaceArg::default()
        };
        match source.open().unwrap() {
            Opened::Part(loaded) => {
                let volume = loaded.part.measure().volume_m3;
                volume.expect("it is closed")
            }
            Opened::Surface(_) => panic!("not one surface"),
        }
    }

    // Two balls in one file and in two, read back: together they are the union, and each is what it was.
    #[test]
    fn truncated_parts_are_read_back_together_and_by_name() {
        let folder = tempfile::tempdir().unwrap();
        let ball = palpate_geometry::surface::builtin("sphere", None, Some(0.05)).unwrap();
        let other = ball.transformed(&palpate_geometry::math::Pose::translation(0.08, 0.0, 0.0));
        let bodies: Vec<PathBuf> = [("one.json", &ball), ("two.json", &other)]
            .map(|(name, surface)| {
                let path = folder.path().join(name);
                let text = palpate_geometry::surface::file::write(surface, Unit::Millimetre);
                std::fs::write(&path, text).unwrap();
                path
            })
            .into();
        let args = |output: &str| Args {
            bodies: bodies.clone(),
            output: Some(folder.path().join(output)),
            tolerance: None,
            json: true,
        };
        assert_eq!(run(&args("both.step")).unwrap(), Outcome::Ok);
        assert_eq!(run(&args("apart")).unwrap(), Outcome::Ok);
        // Less a cap of height 10 mm.
        let left = std::f64::consts::PI * (4.0 / 3.0 * 0.05f64.powi(3) - 1e-4 * 0.14 / 3.0);
        let both = folder.path().join("both.step");
        let apart = folder.path().join("apart/two.step");
        for (path, part, count) in [
            (&both, None, 2.0),
            (&both, Some("one"), 1.0),
            (&both, Some("two"), 1.0),
            (&apart, None, 1.0),
        ] {
            let volume = volume_m3(path, part);
            assert!(
                (volume / (count * left) - 1.0).abs() < 1e-7,
                "{part:?}: {volume}"
            );
        }
        assert!(run(&args("both.json")).is_err(), "no format for parts");
        let same = Args {
            bodies: vec![bodies[0].clone(), bodies[0].clone()],
            ..args("same.step")
        };
        assert!(
            run(&same)
                .unwrap_err()
                .to_string()
                .contains("lie on each other")
        );
        let part = Args {
            bodies: vec![both.clone(), bodies[0].clone()],
            ..args("part.step")
        };
        assert!(format!("{:#}", run(&part).unwrap_err()).contains("trimmed faces"));
    }
}
