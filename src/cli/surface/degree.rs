//! `palpate surface degree`: raised without any change of shape, or lowered with a bound on the
//! change.

use super::{Loaded, Outcome, SurfaceArg};
use anyhow::Context as _;
use palpate_geometry::basis::MAX_DEGREE;
use palpate_geometry::exchange::{Format, write_surface};
use palpate_geometry::surface::file::Unit;
use palpate_geometry::surface::{Direction, Surface};
use std::path::PathBuf;

#[derive(clap::Args, Debug)]
pub struct Args {
    #[command(flatten)]
    source: SurfaceArg,
    /// New degree in u [default: unchanged].
    #[arg(long, value_name = "DEGREE", value_parser = clap::value_parser!(u8).range(1..=MAX_DEGREE as i64))]
    u: Option<u8>,
    /// New degree in v [default: unchanged].
    #[arg(long, value_name = "DEGREE", value_parser = clap::value_parser!(u8).range(1..=MAX_DEGREE as i64))]
    v: Option<u8>,
    /// Output file: .json, .step, .stp, .iges, .igs; in the unit of the input if that is m or mm.
    #[arg(short, long)]
    output: PathBuf,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    let format = Format::of(&args.output)?;
    let Loaded {
        surface,
        unit,
        per_metre,
        ..
    } = args.source.load()?;
    let (surface, in_u) = with_degree(surface, Direction::U, args.u)?;
    let (surface, in_v) = with_degree(surface, Direction::V, args.v)?;
    let written = if unit == "mm" {
        Unit::Millimetre
    } else {
        Unit::Metre
    };
    std::fs::write(&args.output, write_surface(&surface, format, written)?)
        .with_context(|| args.output.display().to_string())?;
    let degree = [surface.knots_u().degree(), surface.knots_v().degree()];
    let net = [surface.net().rows(), surface.net().columns()];
    let bound = (in_u + in_v) * per_metre;
    if args.json {
        println!(
            "{}",
            serde_json::json!({ "degree": degree, "net": net, "error_bound": bound, "unit": unit })
        );
    } else {
        println!(
            "degree {} × {}, {} × {} control points; no point moved by more than {bound:e} {unit}",
            degree[0], degree[1], net[0], net[1]
        );
    }
    Ok(Outcome::Ok)
}

/// The surface with a degree in a direction, and how far its points may have moved, m.
fn with_degree(
    mut surface: Surface,
    direction: Direction,
    wanted: Option<u8>,
) -> anyhow::Result<(Surface, f64)> {
    let wanted = wanted.map_or(surface.knots(direction).degree(), usize::from);
    let mut bound_m = 0.0;
    while surface.knots(direction).degree() < wanted {
        surface = surface.elevated(direction)?;
    }
    while surface.knots(direction).degree() > wanted {
        let lower = surface.degree_reduced(direction)?;
        (surface, bound_m) = (lower.surface, bound_m + lower.error_bound);
    }
    Ok((surface, bound_m))
}
