//! `palpate surface`: what can be done with a surface in a file, in any format that has surfaces.

mod branch;
mod cut;
mod degree;
pub(super) mod fit;
mod info;
mod isolate;
pub(super) mod make;
mod merge;
mod part;
mod pipe;
mod query;
mod truncate;

use super::Outcome;
use anyhow::Context as _;
use palpate_geometry::exchange::step::{PartPick, StepError, read_part};
use palpate_geometry::exchange::{
    ExchangeError, Format, Imported, LeftOut, LengthUnit, Pick, read_surface, read_surface_file,
};
use palpate_geometry::part::Part;
use palpate_geometry::surface::{Surface, Trim, builtin};
use part::{LoadedPart, Misuse};
use std::path::{Path, PathBuf};

#[derive(clap::Args, Debug)]
pub struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(clap::Subcommand, Debug)]
enum Command {
    /// Print degrees, control net, knots, closure and measures; of a part its faces and measures.
    Info(info::Args),
    /// Evaluate points and derivatives at parameters.
    Eval(query::EvalArgs),
    /// Find the closest point of the surface or part for each given point.
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
    /// Give two overlapping bodies a common wall, as deep in one as in the other, and write both as parts.
    Truncate(truncate::Args),
    /// Find the largest radius of a pipe around a curve, and write the pipe as a surface.
    Pipe(pipe::Args),
    /// Cut by a plane; measure the pieces, and write them as parts with their caps.
    Cut(cut::Args),
    /// Build one surface for a tree of branching tubes, or measure a given one.
    Branch(branch::Args),
}

/// The surface or part to read.
#[derive(clap::Args, Debug, Default)]
pub(super) struct SurfaceArg {
    /// Surface file (.json, .step, .stp, .iges, .igs), or builtin:NAME (sheet, sphere, teardrop,
    /// torus).
    file: PathBuf,
    /// Index of the surface in a file with several, from 0; of a STEP file one surface, not the part.
    #[arg(long, value_name = "N")]
    index: Option<usize>,
    /// Use the whole surface where the file trims or places it, or has faces that are not B-splines.
    #[arg(long)]
    ignore_trims: bool,
    /// Name or number of the part in a STEP file with several [default: all].
    #[arg(long, value_name = "NAME", conflicts_with_all = ["index", "ignore_trims"])]
    part: Option<String>,
    /// Which of the places of the part, from 0 [default: all].
    #[arg(long, value_name = "K", conflicts_with_all = ["index", "ignore_trims"])]
    instance: Option<usize>,
    /// Leave out faces of a part that cannot be read, and end with exit code 1.
    #[arg(long, conflicts_with_all = ["index", "ignore_trims"])]
    partial: bool,
}

/// A file whose shape is not that of the surface in it: exit code 1.
#[derive(Debug, thiserror::Error)]
#[error(
    "left out: {left_out}; `palpate surface convert FILE OUT.json --ignore-trims` takes the whole surface, in its own \
     coordinates{instead}"
)]
pub(super) struct Incomplete {
    left_out: LeftOut,
    /// What else can be done.
    instead: &'static str,
}

/// What a file has.
enum Opened {
    /// One whole B-spline surface.
    Surface(Box<Loaded>),
    /// Trimmed faces.
    Part(Box<LoadedPart>),
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
    /// The surface of a file at a place, from 0.
    pub(super) fn at(file: &Path, index: usize) -> Self {
        Self {
            file: file.to_owned(),
            index: Some(index),
            ..Self::default()
        }
    }

    /// As given.
    pub(super) fn path(&self) -> &Path {
        &self.file
    }

    fn named(&self) -> String {
        self.file.display().to_string()
    }

    fn is_step(&self) -> bool {
        matches!(Format::of(&self.file), Ok(Format::Step))
    }

    fn part_pick(&self) -> PartPick {
        PartPick {
            part: self.part.clone(),
            instance: self.instance,
            partial: self.partial,
        }
    }

    /// A surface where the file is one, whole, or where one is asked for; else the part that a STEP file is.
    fn open(&self) -> anyhow::Result<Opened> {
        let surface = |loaded| Opened::Surface(Box::new(loaded));
        if !self.is_step() || self.index.is_some() || self.ignore_trims {
            return self.load().map(surface);
        }
        let bytes = std::fs::read(&self.file).with_context(|| self.named())?;
        let pick = self.part_pick();
        let any = pick == PartPick::default();
        let one = read_surface(&bytes, Format::Step, Pick::First);
        let is_whole = |one: &Imported| one.count == 1 && !one.left_out.is_any();
        if any && one.as_ref().is_ok_and(is_whole) {
            return self.loaded(one?).map(surface);
        }
        match (read_part(&bytes, &pick), one) {
            // Surfaces of no face.
            (Err(StepError::NoFaces { .. }), Ok(one)) if any => self.loaded(one).map(surface),
            (part, _) => part
                .map_err(anyhow::Error::from)
                .and_then(|part| LoadedPart::new(part, pick.partial, &self.file))
                .map(|part| Opened::Part(Box::new(part)))
                .with_context(|| self.named()),
        }
    }

    /// A surface; parts and trimmed surfaces are refused.
    pub(super) fn load(&self) -> anyhow::Result<Loaded> {
        match self.imported()? {
            None => self.builtin(),
            Some(imported) => self.loaded(imported),
        }
    }

    /// A surface, and what is kept of it; parts are refused.
    pub(super) fn load_trimmed(&self) -> anyhow::Result<(Loaded, Option<Trim>)> {
        let Some(mut imported) = self.imported()? else {
            return Ok((self.builtin()?, None));
        };
        if let Some((surface, trim)) = self.step_patch(&imported)? {
            (imported.surface, imported.trim) = (surface, Some(trim));
        }
        let trim = imported.trim.take();
        imported.left_out.trimmed &= trim.is_none();
        Ok((self.loaded(imported)?, trim))
    }

    /// The one face of a STEP file, where it is not the whole surface.
    fn step_patch(&self, imported: &Imported) -> anyhow::Result<Option<(Surface, Trim)>> {
        if !self.is_step() || imported.count > 1 {
            return Ok(None);
        }
        let bytes = std::fs::read(&self.file).with_context(|| self.named())?;
        let part = read_part(&bytes, &PartPick::default())
            .map_err(anyhow::Error::from)
            .and_then(|read| Ok(Part::new(&read.brep)?))
            .with_context(|| self.named());
        let part = match part {
            // What is no part may be a surface that has no face.
            Err(_) if !imported.left_out.trimmed => return Ok(None),
            part => part?,
        };
        let patch = (part.as_patch().transpose()).with_context(|| self.named())?;
        Ok(patch.filter(|(surface, trim)| !is_whole(surface, trim)))
    }

    fn builtin_name(&self) -> Option<&str> {
        self.file.to_str()?.strip_prefix("builtin:")
    }

    fn builtin(&self) -> anyhow::Result<Loaded> {
        Ok(Loaded {
            surface: builtin(self.builtin_name().unwrap_or_default(), None, None)?,
            unit: "m".into(),
            per_metre: 1.0,
            count: 1,
            left_out: LeftOut::default(),
            notes: Vec::new(),
        })
    }

    /// What the file has; none for a built-in surface.
    fn imported(&self) -> anyhow::Result<Option<Imported>> {
        if self.part_pick() != PartPick::default() {
            return Err(Misuse::Options.into());
        }
        if self.builtin_name().is_some() {
            return Ok(None);
        }
        let read = read_surface_file(&self.file, Pick::Index(self.index.unwrap_or(0)));
        if let Err(ExchangeError::Step(StepError::NoSurface { .. })) = read
            && let Ok(bytes) = std::fs::read(&self.file)
            && let Ok(part) = read_part(&bytes, &PartPick::default())
        {
            let faces = part.brep.faces.len();
            return Err(Misuse::NoSpline { faces }).with_context(|| self.named());
        }
        Ok(Some(read.with_context(|| self.named())?))
    }

    fn loaded(&self, imported: Imported) -> anyhow::Result<Loaded> {
        let Imported {
            surface,
            merged,
            count,
            unit,
            left_out,
            ..
        } = imported;
        let named = self.named();
        if !unit.is_stated() {
            eprintln!(
                "note: {named} does not give a unit; assuming {}",
                unit.name()
            );
        }
        if left_out.is_any() {
            if !self.ignore_trims {
                let instead = match self.is_step() {
                    true => "; `palpate surface info FILE` reads all its faces as a part",
                    false => "",
                };
                return Err(Incomplete { left_out, instead }).context(named);
            }
            eprintln!("note: {named}: left out: {left_out}");
        }
        if count > 1 {
            let index = self.index.unwrap_or(0);
            eprintln!("note: {named} has {count} surfaces; using number {index} (--index)");
        }
        let mut notes: Vec<String> = merged.iter().map(ToString::to_string).collect();
        notes.extend(surface.slits().iter().map(ToString::to_string));
        for note in &notes {
            eprintln!("note: {named}: {note}");
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
        Command::Truncate(args) => truncate::run(args),
        Command::Pipe(args) => pipe::run(args),
        Command::Cut(args) => cut::run(args),
        Command::Branch(args) => branch::run(args),
    }
}

/// One loop along the ends of a surface.
fn is_whole(surface: &Surface, trim: &Trim) -> bool {
    let ends = [surface.knots_u(), surface.knots_v()].map(|knots| knots.domain());
    let at_end = |[a, b]: [&[f64; 2]; 2]| {
        (0..2).any(|k| a[k] == b[k] && (a[k] == ends[k].0 || a[k] == ends[k].1))
    };
    let along_ends = |only: &Vec<[f64; 2]>| {
        let next = only.iter().cycle().skip(1);
        only.iter().zip(next).all(|(a, b)| at_end([a, b]))
    };
    matches!(trim.loops(), [only] if along_ends(only))
}
