//! `palpate surface cut`: the pieces that a plane makes of a surface.

use super::{Loaded, Outcome, SurfaceArg};
use anyhow::Context as _;
use palpate_geometry::cut::{Cut, CutPlane, Piece, cut_by_plane};
use palpate_geometry::exchange::step::write_part;
use palpate_geometry::exchange::{Format, LengthUnit};
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::file::Unit;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

#[derive(clap::Args, Debug)]
pub struct Args {
    #[command(flatten)]
    source: SurfaceArg,
    /// A point of the plane, in the unit of the file.
    #[arg(long, value_name = "X,Y,Z", value_parser = triple, allow_hyphen_values = true)]
    point: [f64; 3],
    /// Direction across the plane, of any length; it points to what is above.
    #[arg(long, value_name = "X,Y,Z", value_parser = triple, allow_hyphen_values = true)]
    normal: [f64; 3],
    /// Write only this piece, from 0 [default: all of them].
    #[arg(long, value_name = "K")]
    piece: Option<usize>,
    /// Output file for the pieces as parts, .step or .stp: each a solid, or a sheet of an open surface.
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// What was asked for that is not there.
#[derive(Debug, thiserror::Error)]
enum Misuse {
    #[error("--normal {0},{1},{2} has no direction")]
    Normal(f64, f64, f64),
    #[error("there is no piece {piece}: the plane makes {count}, counted from 0")]
    Piece { piece: usize, count: usize },
    #[error(
        "pieces are parts, which are written as .step or .stp; `palpate surface convert` makes triangles of them"
    )]
    Format,
}

fn triple(text: &str) -> Result<[f64; 3], String> {
    let values: Option<Vec<f64>> = (text.split(','))
        .map(|value| value.trim().parse().ok().filter(|x: &f64| x.is_finite()))
        .collect();
    values
        .and_then(|values| values.try_into().ok())
        .ok_or_else(|| format!("{text:?} is not three finite numbers such as 0,0,45"))
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    let is_step = |path: &PathBuf| matches!(Format::of(path), Ok(Format::Step));
    if !args.output.as_ref().is_none_or(is_step) {
        return Err(Misuse::Format.into());
    }
    let loaded = args.source.load()?;
    let [x, y, z] = args.normal;
    let point = Point3::from(args.point) / loaded.per_metre;
    let plane = CutPlane::through(&point, &Vector3::from(args.normal));
    let cut = cut_by_plane(&loaded.surface, &plane.ok_or(Misuse::Normal(x, y, z))?)?;
    let chosen: Vec<usize> = match args.piece {
        Some(piece) if piece >= cut.pieces.len() => {
            let count = cut.pieces.len();
            return Err(Misuse::Piece { piece, count }.into());
        }
        Some(piece) => vec![piece],
        None => (0..cut.pieces.len()).collect(),
    };
    if let Some(path) = &args.output {
        write(path, &cut, &chosen, &loaded)?;
    }
    let pieces: Vec<Value> = (cut.pieces.iter())
        .map(|piece| report(piece, &cut, loaded.per_metre))
        .collect();
    if args.json {
        println!("{}", json!({ "unit": loaded.unit, "pieces": pieces }));
    } else {
        for (k, piece) in pieces.iter().enumerate() {
            println!("{}", sentence(k, piece, &loaded.unit));
        }
    }
    Ok(Outcome::Ok)
}

fn report(piece: &Piece, cut: &Cut, per_metre: f64) -> Value {
    let length = |x: f64, power: i32| x * per_metre.powi(power);
    let Point3 { coords } = piece.centroid;
    let centroid: [f64; 3] = coords.map(|x| length(x, 1)).into();
    json!({
        "side": if piece.above { "above" } else { "below" },
        "volume": cut.closed.then(|| length(piece.volume_m3, 3)),
        "cap_area": length(piece.cap_area_m2, 2),
        "skin_area": length(piece.skin_area_m2, 2),
        "centroid": centroid,
        "caps": piece.caps.iter().map(|cap| length(cap.area_m2, 2)).collect::<Vec<_>>(),
        "loops": piece.rim_count(),
    })
}

fn sentence(k: usize, piece: &Value, unit: &str) -> String {
    let side = piece["side"].as_str().unwrap_or_default();
    let inside = match piece["volume"].as_f64() {
        Some(volume) => format!(
            "volume {volume} {unit}³, caps {} {unit}², ",
            piece["cap_area"]
        ),
        None => String::new(),
    };
    format!(
        "piece {k}, {side}: {inside}skin {} {unit}², loops: {}, centroid {} {unit}",
        piece["skin_area"], piece["loops"], piece["centroid"]
    )
}

fn write(path: &Path, cut: &Cut, pieces: &[usize], loaded: &Loaded) -> anyhow::Result<()> {
    let unit: LengthUnit = match loaded.unit.as_str() {
        "m" => Unit::Metre.into(),
        _ => Unit::Millimetre.into(),
    };
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let text = write_part(&cut.brep(pieces)?, &unit, &name)?;
    std::fs::write(path, text).with_context(|| path.display().to_string())
}
