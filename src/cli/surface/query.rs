//! `palpate surface eval` and `closest`: numbers in the unit of the file.

use super::part::{LoadedPart, Misuse};
use super::{Loaded, Opened, Outcome, SurfaceArg};
use crate::cli::numbers::{self, NumberLine};
use anyhow::Context as _;
use palpate_geometry::basis::KnotVector;
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::part::PartSolver;
use palpate_geometry::surface::ClosestSolver;
use std::path::PathBuf;

#[derive(clap::Args, Debug)]
pub struct EvalArgs {
    #[command(flatten)]
    source: SurfaceArg,
    /// CSV file with lines `u,v`.
    #[arg(long, value_name = "FILE")]
    uv: PathBuf,
    /// Derivatives up to this order.
    #[arg(long, value_name = "ORDER", default_value_t = 0, value_parser = clap::value_parser!(u8).range(0..=2))]
    derivatives: u8,
    /// Print one JSON object per line.
    #[arg(long)]
    json: bool,
}

pub fn eval(args: &EvalArgs) -> anyhow::Result<Outcome> {
    let Loaded {
        surface, per_metre, ..
    } = args.source.load()?;
    for NumberLine { line, values } in numbers::read(&args.uv, &[2], "u,v")? {
        let inside = |knots: &KnotVector, value: f64, name: &str| {
            knots
                .checked(value)
                .with_context(|| format!("{}:{line}: parameter {name}", args.uv.display()))
        };
        let (u, v) = (
            inside(surface.knots_u(), values[0], "u")?,
            inside(surface.knots_v(), values[1], "v")?,
        );
        let frame = surface.frame(u, v);
        let scaled = |x: Vector3| [x.x, x.y, x.z].map(|x| x * per_metre);
        let point = scaled(frame.point.coords);
        if !args.json {
            println!(
                "{},{},{},{},{}",
                values[0], values[1], point[0], point[1], point[2]
            );
            continue;
        }
        let normal = surface.normal_of(&frame, u, v);
        let mut out = serde_json::json!({ "u": values[0], "v": values[1], "point": point, "normal": [normal.x, normal.y, normal.z] });
        if args.derivatives >= 1 {
            (out["S_u"], out["S_v"]) = (
                serde_json::json!(scaled(frame.du)),
                serde_json::json!(scaled(frame.dv)),
            );
        }
        if args.derivatives >= 2 {
            for (name, derivative) in [
                ("S_uu", frame.duu),
                ("S_uv", frame.duv),
                ("S_vv", frame.dvv),
            ] {
                out[name] = serde_json::json!(scaled(derivative));
            }
        }
        println!("{out}");
    }
    Ok(Outcome::Ok)
}

#[derive(clap::Args, Debug)]
pub struct ClosestArgs {
    #[command(flatten)]
    source: SurfaceArg,
    /// CSV file with lines `x,y,z`, in the unit of the surface file.
    #[arg(long, value_name = "FILE")]
    points: PathBuf,
    /// Print one JSON object per line.
    #[arg(long)]
    json: bool,
}

pub fn closest(args: &ClosestArgs) -> anyhow::Result<Outcome> {
    let (uncertified, outcome) = match args.source.open()? {
        Opened::Surface(loaded) => (closest_of_surface(args, &loaded)?, Outcome::Ok),
        Opened::Part(loaded) => (closest_of_part(args, &loaded)?, loaded.outcome()),
    };
    if uncertified > 0 {
        eprintln!(
            "note: {uncertified} answers are not certified: a piece of the surface needed too much work, and something on it may be nearer"
        );
    }
    Ok(outcome)
}

/// An empty field where there is none.
fn field(value: Option<f64>) -> String {
    value.map(|x| x.to_string()).unwrap_or_default()
}

/// How many answers are not certified.
fn closest_of_surface(args: &ClosestArgs, loaded: &Loaded) -> anyhow::Result<usize> {
    let Loaded {
        surface, per_metre, ..
    } = loaded;
    let is_closed = surface.topology().is_closed();
    let mut solver = ClosestSolver::new(surface);
    let mut uncertified = 0;
    for NumberLine { values, .. } in numbers::read(&args.points, &[3], "x,y,z")? {
        let query = Point3::new(values[0], values[1], values[2]) / *per_metre;
        let given_up = solver.pieces_given_up();
        let foot = solver.closest(surface, &query);
        let certified = solver.pieces_given_up() == given_up;
        uncertified += usize::from(!certified);
        let point = [foot.point.x, foot.point.y, foot.point.z].map(|x| x * per_metre);
        let distance = foot.distance * per_metre;
        let signed_distance = is_closed.then_some(foot.signed_distance * per_metre);
        if !args.json {
            let [x, y, z] = point;
            let signed = field(signed_distance);
            println!("{},{},{x},{y},{z},{distance},{signed}", foot.u, foot.v);
            continue;
        }
        let curvature = surface.curvature(foot.u, foot.v);
        let curvature = curvature.map(|c| [c.max / per_metre, c.min / per_metre]);
        let normal = [foot.normal.x, foot.normal.y, foot.normal.z];
        let out = serde_json::json!({
            "u": foot.u, "v": foot.v, "point": point, "normal": normal, "distance": distance,
            "signed_distance": signed_distance, "curvature": curvature, "certified": certified,
        });
        println!("{out}");
    }
    Ok(uncertified)
}

/// How many answers are not certified.
fn closest_of_part(args: &ClosestArgs, loaded: &LoadedPart) -> anyhow::Result<usize> {
    let LoadedPart {
        part, per_metre, ..
    } = loaded;
    loaded.tell();
    let mut solver = PartSolver::new(part);
    let mut uncertified = 0;
    for NumberLine { line, values } in numbers::read(&args.points, &[3], "x,y,z")? {
        let query = Point3::new(values[0], values[1], values[2]) / *per_metre;
        let foot = solver.closest(part, &query).ok_or(Misuse::Far { line });
        let foot = foot.with_context(|| args.points.display().to_string())?;
        uncertified += usize::from(!foot.certified);
        let point = [foot.point.x, foot.point.y, foot.point.z].map(|x| x * per_metre);
        let distance = foot.distance * per_metre;
        let signed_distance = foot.signed_distance.map(|x| x * per_metre);
        let (support, index) = (foot.support.name(), foot.support.index());
        if !args.json {
            let ([x, y, z], signed) = (point, field(signed_distance));
            let face = foot.face;
            println!("{x},{y},{z},{distance},{signed},{support},{index},{face}");
            continue;
        }
        let normal = [foot.normal.x, foot.normal.y, foot.normal.z];
        let out = serde_json::json!({
            "point": point, "normal": normal, "distance": distance, "signed_distance": signed_distance,
            "support": support, "support_index": index, "face": foot.face, "certified": foot.certified,
        });
        println!("{out}");
    }
    Ok(uncertified)
}
