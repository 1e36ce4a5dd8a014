//! `palpate surface`: what can be done with a surface in a file, in any format that has surfaces.

mod branch;
mod degree;
pub(super) mod fit;
mod info;
mod isolate;
pub(super) mod make;
mod merge;
mod pipe;
mod query;

use super::Outcome;
use anyhow::Context as _;
use palpate_geometry::exchange::{Imported, LeftOut, LengthUnit, Pick, read_surface_file};
use palpate_geometry::surface::{Surface, builtin};
use std::path::PathBuf;

#[derive(clap::Args, Debug)]
pub struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(clap::Subcommand, Debug)]
enum Command {
    /// Print degrees, control net, knots, closure and measures.
    Info(info::Args),
    /// Evaluate points and derivatives at parameters.
    Eval(query::EvalArgs),
    /// Find the closest point of the surface for each given point.
    Closest(query::ClosestArgs),
    /// Convert to another format, as a surface or as triangles.
    Convert(make::ConvertArgs),
    /// Triangulate with given cells per span or to a chord tolerance.
    Tessellate(make::TessellateArgs),
    /// Fit a surface to a grid of points or to scattered points.
    Fit(fit::FitArgs),
    /// Raise the degree without changing the shape, or lower it with an error bound.
    Degree(degree::Args),
    /// Merge patches of any degree, knots and size into one surface of chosen continuity.
    Merge(Box<merge::Args>),
    /// Separate overlapping bodies by short translations.
    Isolate(isolate::Args),
    /// Find the largest radius of a pipe around a curve, and write the pipe as a surface.
    Pipe(pipe::Args),
    /// Build one surface for a tree of branching tubes, or measure a given one.
    Branch(branch::Args),
}

/// The surface to read.
#[derive(clap::Args, Debug)]
pub(super) struct SurfaceArg {
    /// Surface file (.json, .step, .stp, .iges, .igs), or builtin:NAME (sheet, sphere, teardrop,
    /// torus).
    file: PathBuf,
    /// Index of the surface in a file with several, from 0.
    #[arg(long, value_name = "N", default_value_t = 0)]
    index: usize,
    /// Use the whole surface where the file trims or places it, or has faces that are not B-splines.
    #[arg(long)]
    ignore_trims: bool,
}

/// A file whose shape is not that of the surface in it: exit code 1.
#[derive(Debug, thiserror::Error)]
#[error(
    "left out: {left_out}; `palpate surface convert FILE OUT.json --ignore-trims` takes the whole surface, in its own coordinates"
)]
pub(super) struct Incomplete {
    left_out: LeftOut,
}

/// A surface (m) and the unit of its file.
pub(super) struct Loaded {
    pub(super) surface: Surface,
    unit: String,
    /// Units to a metre.
    per_metre: f64,
    /// Surfaces in the file.
    count: usize,
    left_out: LeftOut,
    /// What was set right as it was read, and where it is open by little.
    notes: Vec<String>,
}

impl SurfaceArg {
    /// As given.
    pub(super) fn path(&self) -> &std::path::Path {
        &self.file
    }

    pub(super) fn load(&self) -> anyhow::Result<Loaded> {
        if let Some(name) = self
            .file
            .to_str()
            .and_then(|text| text.strip_prefix("builtin:"))
        {
            let surface = builtin(name, None, None)?;
            return Ok(Loaded {
                surface,
                unit: "m".into(),
                per_metre: 1.0,
                count: 1,
                left_out: LeftOut::default(),
                notes: Vec::new(),
            });
        }
        let Imported {
            surface,
            merged,
            count,
            unit,
            left_out,
            ..
        } = read_surface_file(&self.file, Pick::Index(self.index))
            .with_context(|| self.file.display().to_string())?;
        if !unit.is_stated() {
            eprintln!(
                "note: {} does not give a unit; assuming {}",
                self.file.display(),
                unit.name()
            );
        }
        if left_out.is_any() {
            if !self.ignore_trims {
                return Err(Incomplete { left_out })
                    .with_context(|| self.file.display().to_string());
            }
            eprintln!("note: {}: left out: {left_out}", self.file.display());
        }
        if count > 1 {
            eprintln!(
                "note: {} has {count} surfaces; using number {} (--index)",
                self.file.display(),
                self.index
            );
        }
        let mut notes: Vec<String> = merged.iter().map(ToString::to_string).collect();
        notes.extend(surface.slits().iter().map(ToString::to_string));
        for note in &notes {
            eprintln!("note: {}: {note}", self.file.display());
        }
        Ok(Loaded {
            surface,
            notes,
            per_metre: per_metre(&unit),
            unit: unit.name().to_owned(),
            count,
            left_out,
        })
    }
}

/// Exact for metres and millimetres.
fn per_metre(unit: &LengthUnit) -> f64 {
    1.0 / unit.metres()
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    match &args.command {
        Command::Info(args) => info::run(args),
        Command::Eval(args) => query::eval(args),
        Command::Closest(args) => query::closest(args),
        Command::Convert(args) => make::convert(args),
        Command::Tessellate(args) => make::tessellate(args),
        Command::Fit(args) => fit::fit(args),
        Command::Degree(args) => degree::run(args),
        Command::Merge(args) => merge::run(args),
        Command::Isolate(args) => isolate::run(args),
        Command::Pipe(args) => pipe::run(args),
        Command::Branch(args) => branch::run(args),
    }
}
