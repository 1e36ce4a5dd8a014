//! `palpate surface pipe`: the largest radius of a pipe around a spine, and the pipe itself.

use super::Outcome;
use anyhow::Context as _;
use palpate_geometry::exchange::{Format, write_surface};
use palpate_geometry::math::Point3;
use palpate_geometry::surface::Curve;
use palpate_geometry::surface::file::Unit;
use palpate_modeling::ipp::Status;
use palpate_modeling::pipe::{Answer, PipeLimits, PipeSurface, Spine, file, pipe_surface};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Default tolerance of the surface, relative to the radius.
const DEFAULT_TOLERANCE: f64 = 1e-6;

#[derive(clap::Args, Debug)]
pub struct Args {
    /// Curve file (palpate.curve.v1, JSON).
    spine: PathBuf,
    /// Test whether the pipe of this radius, in the file's unit, is free of self-intersection.
    #[arg(long, value_name = "R", allow_negative_numbers = true)]
    radius: Option<f64>,
    /// With --radius: output file of the pipe: .json, .step, .stp, .iges, .igs. Not written if the
    /// pipe intersects itself.
    #[arg(short, long, value_name = "OUT", requires = "radius")]
    output: Option<PathBuf>,
    /// Largest distance of the surface from the exact pipe, in the file's unit [default: a
    /// millionth of the radius].
    #[arg(
        long,
        value_name = "LENGTH",
        requires = "output",
        allow_negative_numbers = true
    )]
    tolerance: Option<f64>,
    /// Write the surface even if it intersects itself.
    #[arg(long, requires = "output")]
    force: bool,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    let format = args.output.as_ref().map(surface_format).transpose()?;
    if let Some(radius) = args.radius {
        anyhow::ensure!(
            radius.is_finite() && radius > 0.0,
            "--radius is {radius}; it must be a finite length above 0"
        );
    }
    let (curve, unit) = load(&args.spine)?;
    let spine = Spine::new(&curve).with_context(|| args.spine.display().to_string())?;
    let limits = PipeLimits::of_spine(&spine);
    let answer = args
        .radius
        .map(|radius| limits.answer(radius / unit.per_metre()));
    let mut report = PipeReport {
        curve: &curve,
        spine: &spine,
        limits: &limits,
        unit,
    }
    .object();
    if let (Some(radius), Some(answer)) = (args.radius, answer) {
        report["radius"] = json!(radius);
        report["free"] = match answer {
            Answer::Free => json!(true),
            Answer::Intersects => json!(false),
            Answer::Unknown => Value::Null,
        };
    }
    if let (Some(radius), Some(path), Some(format)) = (args.radius, &args.output, format) {
        if answer == Some(Answer::Free) || args.force {
            report["surface"] = write(&spine, radius, args.tolerance, (path, format), unit)?;
        } else {
            eprintln!(
                "note: {} was not written because the pipe intersects itself; --force writes it anyway",
                path.display()
            );
        }
    }
    if args.json {
        println!("{report}")
    } else {
        print_for_people(&report)
    }
    Ok(match answer {
        None | Some(Answer::Free) => Outcome::Ok,
        Some(Answer::Intersects | Answer::Unknown) => Outcome::Difference,
    })
}

/// Checked before anything is computed.
fn surface_format(path: &PathBuf) -> anyhow::Result<Format> {
    let format = Format::of(path)?;
    let surfaces = matches!(format, Format::Json | Format::Step | Format::Iges);
    anyhow::ensure!(
        surfaces,
        "{} is not a surface format; write .json, .step or .iges",
        format.name()
    );
    Ok(format)
}

fn load(path: &Path) -> anyhow::Result<(Curve, Unit)> {
    let text = std::fs::read_to_string(path).with_context(|| path.display().to_string())?;
    file::read(&text).with_context(|| path.display().to_string())
}

fn write(
    spine: &Spine,
    radius: f64,
    tolerance: Option<f64>,
    (path, format): (&Path, Format),
    unit: Unit,
) -> anyhow::Result<Value> {
    let per_metre = unit.per_metre();
    let tolerance = tolerance.unwrap_or(DEFAULT_TOLERANCE * radius);
    let PipeSurface {
        surface,
        deviation_m,
        stretches,
    } = pipe_surface(spine, radius / per_metre, tolerance / per_metre)?;
    std::fs::write(path, write_surface(&surface, format, unit)?)
        .with_context(|| path.display().to_string())?;
    let net = [surface.net().rows(), surface.net().columns()];
    Ok(json!({
        "file": path.display().to_string(), "tolerance": tolerance, "deviation": deviation_m * per_metre,
        "stretches": stretches, "net": net,
    }))
}

/// Everything that is printed, in the unit of the file.
struct PipeReport<'a> {
    curve: &'a Curve,
    spine: &'a Spine,
    limits: &'a PipeLimits,
    unit: Unit,
}

impl PipeReport<'_> {
    fn length(&self, length_m: f64) -> f64 {
        length_m * self.unit.per_metre()
    }

    fn point(&self, p: &Point3) -> [f64; 3] {
        [p.x, p.y, p.z].map(|x| self.length(x))
    }

    fn object(&self) -> Value {
        let limits = self.limits;
        let [local, bb, ee, eb] = limits
            .bounds_m()
            .map(|(_, radius_m)| radius_m.map(|r| self.length(r)));
        let pairs = &limits.body.pairs;
        json!({
            "unit": self.unit.name(), "degree": self.curve.knots().degree(), "rational": self.curve.weights().is_some(),
            "pieces": self.spine.piece_count(), "closed": self.spine.is_closed(),
            "domain": [self.spine.domain().0, self.spine.domain().1],
            "r_max": limits.r_max_m().map(|(r, _)| self.length(r)), "limit": limits.r_max_m().map(|(_, limit)| limit),
            "r_local": local, "r_bb": bb, "r_ee": ee, "r_eb": eb,
            "status": limits.status(),
            "statuses": {"local": limits.local.status, "bb": limits.body.status, "ee": Status::Complete,
                         "eb": limits.ends_to_body.status},
            "witness": {"local": self.local(), "bb": self.nearest(), "ee": self.end_to_end(), "eb": self.touch(0)},
            "pairs": pairs.iter().map(|pair| pair.parameters).collect::<Vec<_>>(),
            "distances": pairs.iter().map(|pair| self.length(pair.distance_m)).collect::<Vec<_>>(),
            "kinds": pairs.iter().map(|pair| pair.kind).collect::<Vec<_>>(),
            "unresolved": self.unresolved(),
            "boxes": limits.body.boxes,
        })
    }

    fn local(&self) -> Option<Value> {
        let w = self.limits.local.witness?;
        Some(json!({"parameter": w.parameter, "point": self.point(&w.point), "kind": w.kind}))
    }

    /// The pair or the unresolved region that gives r_bb.
    fn nearest(&self) -> Option<Value> {
        let body = &self.limits.body;
        let pairs = body
            .pairs
            .iter()
            .map(|p| (p.distance_m, p.parameters, p.points, json!(p.kind)));
        let regions = body
            .unresolved
            .iter()
            .map(|u| (u.distance_m[0], u.parameters, u.points, json!(u.status)));
        let (distance_m, parameters, points, kind) =
            pairs.chain(regions).min_by(|a, b| a.0.total_cmp(&b.0))?;
        let points = points.map(|p| self.point(&p));
        Some(
            json!({"distance": self.length(distance_m), "parameters": parameters, "points": points, "kind": kind}),
        )
    }

    fn end_to_end(&self) -> Option<Value> {
        self.limits
            .end_to_end
            .map(|touch| json!({"point": self.point(&touch.point)}))
    }

    fn touch(&self, k: usize) -> Option<Value> {
        let touch = self.limits.ends_to_body.touches.get(k)?;
        let end = ["start", "end"][touch.end];
        Some(json!({"end": end, "parameter": touch.parameter, "point": self.point(&touch.point)}))
    }

    fn unresolved(&self) -> Vec<Value> {
        let regions = self.limits.body.unresolved.iter();
        regions
            .map(|u| {
                let distance = u.distance_m.map(|d| self.length(d));
                json!({"s": u.first, "t": u.second, "distance": distance, "status": u.status})
            })
            .collect()
    }
}

fn print_for_people(report: &Value) {
    let unit = report["unit"].as_str().unwrap_or_default();
    let radius = |value: &Value| {
        value
            .as_f64()
            .map_or("none".to_owned(), |r| format!("{r} {unit}"))
    };
    let shape = if report["closed"] == true {
        "closed"
    } else {
        "open"
    };
    println!(
        "{shape} spine of degree {}, {} pieces, lengths in {unit}",
        report["degree"], report["pieces"]
    );
    let limit = report["limit"]
        .as_str()
        .map_or(String::new(), |limit| format!(" ({limit})"));
    println!(
        "  r_max    {}{limit}, {}",
        radius(&report["r_max"]),
        report["status"].as_str().unwrap_or_default()
    );
    let local = &report["witness"]["local"];
    for (name, key) in [
        ("r_local", "r_local"),
        ("r_bb", "r_bb"),
        ("r_ee", "r_ee"),
        ("r_eb", "r_eb"),
    ] {
        let witness = &report["witness"][key.trim_start_matches("r_")];
        let place = match key {
            _ if witness.is_null() => String::new(),
            "r_local" => format!(
                " at {} ({})",
                local["parameter"],
                local["kind"].as_str().unwrap_or_default()
            ),
            "r_bb" => format!(
                " at {} and {}",
                witness["parameters"][0], witness["parameters"][1]
            ),
            "r_ee" => format!(" at {}", witness["point"]),
            _ => format!(
                " {} circle at {}",
                witness["end"].as_str().unwrap_or_default(),
                witness["parameter"]
            ),
        };
        println!("  {name:<8} {}{place}", radius(&report[key]));
    }
    let pairs = report["pairs"].as_array().map_or(0, Vec::len);
    let unresolved = report["unresolved"].as_array().map_or(0, Vec::len);
    println!("  {pairs} stationary pairs, {unresolved} unresolved regions");
    if let Some(free) = report.get("free") {
        let word = free.as_bool().map_or("unknown", |free| {
            if free {
                "free of self-intersection"
            } else {
                "intersects itself"
            }
        });
        println!("  radius {} {unit}: {word}", report["radius"]);
    }
    if let Some(surface) = report.get("surface") {
        println!(
            "  {}: {} × {} control points, deviation {} {unit}",
            surface["file"].as_str().unwrap_or_default(),
            surface["net"][0],
            surface["net"][1],
            surface["deviation"]
        );
    }
}
