//! `palpate surface isolate`: two overlapping bodies, or all bodies of a file, moved apart.

use super::{Loaded, Outcome, SurfaceArg};
use anyhow::Context as _;
use palpate_geometry::exchange::{Format, write_surface};
use palpate_geometry::math::Vector3;
use palpate_geometry::surface::Surface;
use palpate_geometry::surface::file::Unit;
use palpate_modeling::isolate::{
    IsolateMethod, IsolateSpec, IsolateStatus, Isolated, IsolatedAll, Move, Resolution, isolate,
    isolate_all,
};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

#[derive(clap::Args, Debug)]
pub struct Args {
    /// Closed surfaces (.json, .step, .stp, .iges, .igs, builtin:NAME). With two files, the first
    /// moves and the second stays. With one file, or three and more, all bodies are separated; of
    /// two that overlap, the one listed first stays.
    #[arg(required = true, value_names = ["MOVING", "FIXED"], num_args = 1..)]
    files: Vec<PathBuf>,
    /// Index of the surface in the moving file, from 0.
    #[arg(long, value_name = "N", default_value_t = 0)]
    index: usize,
    /// Index of the surface in the fixed file, from 0.
    #[arg(long, value_name = "N", default_value_t = 0)]
    fixed_index: usize,
    /// 1 farthest pair, 2 farthest pair of the main region, 3 its normal, 4 all normals, 5 centres
    /// of mass, 6 mean of 4 and 5, 7 best of five blends of 4 and 5; local: nearest local minimum;
    /// global: shortest of several; thorough: as global, with a longer search.
    #[arg(long, default_value = "global", value_parser = method)]
    method: IsolateMethod,
    /// Gap to leave, in the unit of the file [default: a thousandth of the diagonal of the box
    /// around both].
    #[arg(long, value_name = "EPS", allow_negative_numbers = true)]
    gap: Option<f64>,
    /// Largest turn of the vector between the centres of mass, degrees.
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    max_turn: Option<f64>,
    /// Triangles for the search: auto; halving (refine until the result changes by less than the
    /// gap); or cells such as 36x21.
    #[arg(long, default_value = "auto", value_parser = resolution)]
    resolution: Resolution,
    /// Measure the gap between triangles instead of between the surfaces.
    #[arg(long)]
    triangles: bool,
    /// Fail if the method finds no solution, instead of falling back to `global`.
    #[arg(long)]
    strict: bool,
    /// Output file for the moved surface: .json, .step, .stp, .iges, .igs. For all bodies of a
    /// file: OUT-0, OUT-1 and so on.
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

fn method(text: &str) -> Result<IsolateMethod, String> {
    IsolateMethod::of(text).ok_or_else(|| {
        format!("{text:?} is not a valid method; use 1 to 7, local, global or thorough")
    })
}

fn resolution(text: &str) -> Result<Resolution, String> {
    match text {
        "auto" => Ok(Resolution::Usual),
        "halving" => Ok(Resolution::Halving),
        _ => text
            .split_once(['x', 'X', '×'])
            .and_then(|(u, v)| {
                Some(Resolution::Cells([
                    u.trim().parse().ok()?,
                    v.trim().parse().ok()?,
                ]))
            })
            .ok_or_else(|| {
                format!(
                    "{text:?} is not a valid resolution; use auto, halving or cells such as 36x21"
                )
            }),
    }
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    let format = args.output.as_ref().map(Format::of).transpose()?;
    let one = |file: &PathBuf, index: usize| SurfaceArg::at(file, index).load();
    match args.files.as_slice() {
        [moving, fixed] => {
            let (moving, fixed) = (one(moving, args.index)?, one(fixed, args.fixed_index)?);
            pair(args, format, &moving, &fixed.surface)
        }
        files => {
            let mut bodies: Vec<Loaded> = Vec::new();
            for file in files {
                let first = one(file, 0)?;
                let count = first.count;
                bodies.push(first);
                for index in 1..count {
                    bodies.push(one(file, index)?);
                }
            }
            all(args, format, &bodies)
        }
    }
}

fn spec(args: &Args, per_metre: f64) -> IsolateSpec {
    IsolateSpec {
        method: args.method,
        gap_m: args.gap.map(|gap| gap / per_metre),
        max_turn_deg: args.max_turn,
        resolution: args.resolution,
        exact: !args.triangles,
        fall_back: !args.strict,
        warm_m: None,
    }
}

fn pair(
    args: &Args,
    format: Option<Format>,
    moving: &Loaded,
    fixed: &Surface,
) -> anyhow::Result<Outcome> {
    let answer = isolate(&moving.surface, fixed, &spec(args, moving.per_metre))?;
    if let (Some(path), Some(format), true) = (&args.output, format, answer.is_apart()) {
        write(path, format, moving, &answer.translation_m)?;
    }
    if args.json {
        let mut report = report(&answer, moving.per_metre);
        report["unit"] = json!(moving.unit);
        println!("{report}");
    } else {
        println!("{}", sentence(&answer, moving));
    }
    Ok(if answer.is_apart() {
        Outcome::Ok
    } else {
        Outcome::Difference
    })
}

fn all(args: &Args, format: Option<Format>, bodies: &[Loaded]) -> anyhow::Result<Outcome> {
    let per_metre = bodies[0].per_metre;
    let surfaces: Vec<Surface> = bodies.iter().map(|body| body.surface.clone()).collect();
    let IsolatedAll {
        translations_m,
        moves,
        passes,
        unsettled,
    } = isolate_all(&surfaces, &spec(args, per_metre))?;
    if let (Some(path), Some(format), None) = (&args.output, format, &unsettled) {
        for (k, (body, translation)) in bodies.iter().zip(&translations_m).enumerate() {
            write(&numbered(path, k), format, body, translation)?;
        }
    }
    let reason = unsettled.map(|reason| reason.to_string());
    if args.json {
        let moves: Vec<Value> = moves
            .iter()
            .map(
                |Move {
                     pass,
                     moving,
                     fixed,
                     answer,
                 }| {
                    let mut move_ = report(answer, per_metre);
                    (move_["pass"], move_["moving"], move_["fixed"]) =
                        (json!(pass), json!(moving), json!(fixed));
                    move_
                },
            )
            .collect();
        let translations: Vec<[f64; 3]> = translations_m
            .iter()
            .map(|t| scaled(t, per_metre))
            .collect();
        println!(
            "{}",
            json!({
                "apart": reason.is_none(), "reason": reason, "bodies": bodies.len(), "passes": passes,
                "translations": translations, "moves": moves, "unit": bodies[0].unit,
            })
        );
    } else {
        for (k, translation) in translations_m.iter().enumerate() {
            let [x, y, z] = scaled(translation, per_metre);
            println!("body {k}: moved by {x} {y} {z} {}", bodies[0].unit);
        }
        println!(
            "{}",
            reason.as_deref().unwrap_or("no two bodies overlap now")
        );
    }
    Ok(if unsettled.is_none() {
        Outcome::Ok
    } else {
        Outcome::Difference
    })
}

fn report(answer: &Isolated, per_metre: f64) -> Value {
    let (status, reason) = match answer.status {
        IsolateStatus::Apart => ("apart", None),
        IsolateStatus::Isolated => ("isolated", None),
        IsolateStatus::Failed(reason) => ("failed", Some(reason.to_string())),
    };
    json!({
        "status": status, "reason": reason,
        "translation": scaled(&answer.translation_m, per_metre), "length": answer.translation_m.norm() * per_metre,
        "contact": scaled(&answer.contact_m, per_metre),
        "gap": answer.gap_m.map(|gap| gap * per_metre), "gap_of": if answer.exact { "surfaces" } else { "triangles" },
        "turn": answer.turn_deg, "crossed": answer.crossed(),
        "method": answer.method.name(), "instead_because": answer.fell_back.map(|reason| reason.to_string()),
        "iterations": answer.steps, "regions": answer.regions, "overlap_tests": answer.overlap_tests,
        "cells": answer.cells, "change": answer.change_m.map(|change| change * per_metre),
    })
}

fn sentence(answer: &Isolated, moving: &Loaded) -> String {
    let unit = &moving.unit;
    let [x, y, z] = scaled(&answer.translation_m, moving.per_metre);
    let gap = answer.gap_m.unwrap_or_default() * moving.per_metre;
    let instead = answer.fell_back.map_or(String::new(), |reason| {
        format!("; method global, because {reason}")
    });
    match answer.status {
        IsolateStatus::Apart => format!("apart already: gap {gap} {unit}"),
        IsolateStatus::Failed(reason) => format!("not isolated: {reason}"),
        IsolateStatus::Isolated => format!(
            "move by {x} {y} {z} {unit}: length {}, gap {gap}, turn {}, {} steps, {} regions{instead}",
            answer.translation_m.norm() * moving.per_metre,
            answer
                .turn_deg
                .map_or("undefined".to_owned(), |turn| format!("{turn:.2} degrees")),
            answer.steps,
            answer.regions,
        ),
    }
}

fn scaled(v: &Vector3, per_metre: f64) -> [f64; 3] {
    [v.x, v.y, v.z].map(|x| x * per_metre)
}

/// Writes the moved surface, in the unit of its file if the format supports that unit.
fn write(
    path: &Path,
    format: Format,
    body: &Loaded,
    translation_m: &Vector3,
) -> anyhow::Result<()> {
    let mut moved = body.surface.clone();
    moved
        .net_mut()
        .points_mut()
        .iter_mut()
        .for_each(|point| *point += translation_m);
    let unit = if body.unit == Unit::Millimetre.name() {
        Unit::Millimetre
    } else {
        Unit::Metre
    };
    if unit.name() != body.unit {
        eprintln!("note: {} is written in m", path.display());
    }
    std::fs::write(path, write_surface(&moved, format, unit)?)
        .with_context(|| path.display().to_string())
}

/// `parts.json` of body 2: `parts-2.json`.
fn numbered(path: &Path, k: usize) -> PathBuf {
    let part = |text: Option<&std::ffi::OsStr>| {
        text.map(|t| t.to_string_lossy().into_owned())
            .unwrap_or_default()
    };
    path.with_file_name(format!(
        "{}-{k}.{}",
        part(path.file_stem()),
        part(path.extension())
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn resolutions_and_methods_have_names() {
        assert_eq!(resolution("auto"), Ok(Resolution::Usual));
        assert_eq!(resolution("36x21"), Ok(Resolution::Cells([36, 21])));
        assert!(resolution("36").is_err() && resolution("x").is_err());
        for known in IsolateMethod::ALL {
            assert_eq!(method(known.name()), Ok(known));
        }
        assert!(method("8").is_err());
    }

    #[test]
    fn several_bodies_get_numbered_files() {
        assert_eq!(
            numbered(Path::new("a/parts.v2.json"), 3),
            Path::new("a/parts.v2-3.json")
        );
    }
}
