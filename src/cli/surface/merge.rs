//! `palpate surface merge`: patches become one surface.

use super::{Loaded, Outcome, SurfaceArg};
use anyhow::Context as _;
use palpate_geometry::exchange::{Format, write_surface};
use palpate_geometry::surface::file::Unit;
use palpate_geometry::surface::{Direction, Surface, Trim};
use palpate_modeling::merge::cases::cases;
use palpate_modeling::merge::{
    Arrangement, Continuity, DegreeRule, Deviation, Edge, Hidden, HideBy, MergeMethod, MergeSpec,
    Merged, Report, merge,
};
use std::path::PathBuf;
use std::time::{Duration, Instant};

#[derive(clap::Args, Debug)]
#[command(
    after_help = "Exit codes: 0 merged, 1 merged but the tolerance was not reached, 2 refused."
)]
pub struct Args {
    /// Surface files (.json, .step, .stp, .iges, .igs): two, or one per place of the grid, row after
    /// row.
    #[arg(required_unless_present = "cases", value_name = "PATCH")]
    patches: Vec<PathBuf>,
    /// Output file: .json, .step, .stp, .iges, .igs.
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Continuity at the seams: c of C^c, below the degree.
    #[arg(long, value_name = "N", default_value_t = 2)]
    continuity: usize,
    /// Method: `constrained` has the smallest deviation for its number of control points, `seed` is
    /// that of the source, `exact` works without a fit.
    #[arg(long, default_value = "constrained")]
    method: MethodName,
    /// Which degree to use if those of the patches differ.
    #[arg(long, default_value = "raise")]
    degree: DegreeName,
    /// Rows and columns of the patches, such as 2x2; rows follow each other in u.
    #[arg(long, value_name = "RxC", value_parser = grid, conflicts_with = "edges")]
    grid: Option<[usize; 2]>,
    /// Edges of the two patches to join, such as u1:v0 [default: the closest pair].
    #[arg(long, value_name = "A:B", value_parser = edges)]
    edges: Option<[Edge; 2]>,
    /// Part of the first patch to exclude, such as u:0.8..1.
    #[arg(long, value_name = "D:FROM..TO", value_parser = range)]
    trim_a: Option<(Direction, [f64; 2])>,
    /// Part of the second patch to exclude.
    #[arg(long, value_name = "D:FROM..TO", value_parser = range)]
    trim_b: Option<(Direction, [f64; 2])>,
    /// Where two patches end on curves, those of trims in their files or the one in which they cross: drop each row of points with
    /// a hidden one, or end each line across the seam on the curve; without it the way that deviates less.
    #[arg(long, value_name = "WAY")]
    hidden: Option<HiddenName>,
    /// Do not search for an intersection curve of the patches.
    #[arg(long)]
    no_overlap: bool,
    /// Insert knots until no point deviates by more than this, in the unit of the first file.
    #[arg(long, value_name = "LENGTH")]
    tolerance: Option<f64>,
    /// Rows and columns of sample points on each patch.
    #[arg(long, value_name = "N", default_value_t = 101)]
    points: usize,
    /// Smallest distance between knots at the seam, relative to the patch: how sharp a blend can be.
    #[arg(long, value_name = "SHARE", default_value_t = 0.02)]
    least_span: f64,
    /// Merge the seven built-in cases with two methods and print their table.
    #[arg(long, conflicts_with_all = ["patches", "output", "grid", "edges", "trim_a", "trim_b", "hidden"])]
    cases: bool,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum MethodName {
    Seed,
    Constrained,
    Exact,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum HiddenName {
    Rows,
    Lines,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum DegreeName {
    Raise,
    Lower,
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    if args.cases {
        return Ok(all_cases(args.json));
    }
    // The whole request is read before the files are.
    let format = args.output.as_ref().map(Format::of).transpose()?;
    let loaded: Vec<(Loaded, Option<Trim>)> = args
        .patches
        .iter()
        .map(|file| SurfaceArg::at(file, 0).load_trimmed())
        .collect::<Result<_, _>>()?;
    let (unit, per_metre) = (loaded[0].0.unit.clone(), loaded[0].0.per_metre);
    let patches = loaded
        .into_iter()
        .map(|(loaded, trim)| (loaded.surface, trim));
    let (surfaces, trims): (Vec<Surface>, Vec<_>) = patches.unzip();
    let spec = MergeSpec {
        trims,
        ..args.spec(per_metre)
    };
    let start = Instant::now();
    let merged = merge(&surfaces, &spec)?;
    let taken = start.elapsed();
    let report = merged.report(&surfaces);
    if let (Some(output), Some(format)) = (&args.output, format) {
        let unit = if unit == "mm" {
            Unit::Millimetre
        } else {
            Unit::Metre
        };
        let bytes = write_surface(&merged.surface, format, unit)?;
        std::fs::write(output, bytes).with_context(|| output.display().to_string())?;
    }
    if args.json {
        println!("{}", as_json(&merged, &report, &unit, per_metre, taken));
    } else {
        print(&merged, &report, &unit, per_metre, taken);
    }
    if merged.within_tolerance == Some(false) {
        eprintln!(
            "note: the tolerance was not reached; try more points or a sharper blend (--least-span)"
        );
        return Ok(Outcome::Difference);
    }
    Ok(Outcome::Ok)
}

impl Args {
    fn spec(&self, per_metre: f64) -> MergeSpec {
        let arrangement = match (self.grid, self.edges) {
            (Some([rows, columns]), _) => Arrangement::Grid { rows, columns },
            (None, Some(edges)) => Arrangement::Edges(edges),
            (None, None) => Arrangement::Closest,
        };
        let hidden = [self.trim_a, self.trim_b].into_iter().enumerate();
        MergeSpec {
            continuity: self.continuity,
            method: match self.method {
                MethodName::Seed => MergeMethod::Seed,
                MethodName::Constrained => MergeMethod::Constrained,
                MethodName::Exact => MergeMethod::Exact,
            },
            degree: match self.degree {
                DegreeName::Raise => DegreeRule::Raise,
                DegreeName::Lower => DegreeRule::Lower,
            },
            arrangement,
            hidden: hidden
                .filter_map(|(patch, part)| {
                    part.map(|(direction, range)| Hidden {
                        patch,
                        direction,
                        range,
                    })
                })
                .collect(),
            find_overlap: !self.no_overlap,
            hide_by: self.hidden.map(|name| match name {
                HiddenName::Rows => HideBy::Rows,
                HiddenName::Lines => HideBy::Lines,
            }),
            points: self.points,
            least_span: self.least_span,
            tolerance_m: self.tolerance.map(|t| t / per_metre),
            ..MergeSpec::default()
        }
    }
}

fn letter(direction: Direction) -> char {
    if direction == Direction::U { 'u' } else { 'v' }
}

fn as_json(
    merged: &Merged,
    report: &Report,
    unit: &str,
    per_metre: f64,
    taken: Duration,
) -> serde_json::Value {
    let deviation = |d: &Deviation| {
        serde_json::json!({
            "points": d.points, "close": d.close, "close_within": d.close_m * per_metre,
            "average": d.average_m * per_metre, "median": d.median_m * per_metre,
            "standard": d.standard_m * per_metre, "maximum": d.maximum_m * per_metre,
        })
    };
    let readings = merged.readings.iter().map(|reading| {
        let hidden = reading.hide_by.name();
        match &reading.outcome {
            Ok(seen) => serde_json::json!({
                "hidden": hidden, "deviation": deviation(&seen.deviation), "lost_share": seen.lost_share(),
            }),
            Err(error) => serde_json::json!({ "hidden": hidden, "refused": error.to_string() }),
        }
    });
    let continuity = |c: &Continuity| {
        serde_json::json!({
            "gap": c.gap_m * per_metre, "tangent_deg": c.tangent_deg,
            "curvature_jump": c.curvature_jump_per_m / per_metre, "curvature": c.curvature_per_m / per_metre,
            "first_jump": c.first_jump, "second_jump": c.second_jump,
        })
    };
    let seams: Vec<serde_json::Value> = report
        .seams
        .iter()
        .map(|(seam, c)| {
            let mut value = continuity(c);
            value["direction"] = letter(seam.direction).to_string().into();
            value["at"] = seam.at.into();
            value
        })
        .collect();
    let places: Vec<serde_json::Value> = merged
        .layout
        .places
        .iter()
        .map(|p| {
            serde_json::json!({
                "patch": p.patch, "swap": p.turn.swap, "reverse_u": p.turn.reverse_u, "reverse_v": p.turn.reverse_v,
            })
        })
        .collect();
    let net = merged.surface.net();
    serde_json::json!({
        "unit": unit, "rows": merged.layout.rows, "columns": merged.layout.columns, "places": places,
        "degree": [merged.surface.knots_u().degree(), merged.surface.knots_v().degree()],
        "net": [net.rows(), net.columns()],
        "deviation": deviation(&report.deviation),
        "hidden": merged.hide_by.map(HideBy::name), "readings": readings.collect::<Vec<_>>(),
        "seams": seams, "before": continuity(&report.before),
        "within_tolerance": merged.within_tolerance, "time_s": taken.as_secs_f64(),
    })
}

fn print(merged: &Merged, report: &Report, unit: &str, per_metre: f64, taken: Duration) {
    let (surface, d) = (&merged.surface, &report.deviation);
    let length = |m: f64| m * per_metre;
    println!(
        "{} patches in {} rows of {}: {} × {} control points, degree {} × {}, in {:.2} ms",
        merged.layout.places.len(),
        merged.layout.rows,
        merged.layout.columns,
        surface.net().rows(),
        surface.net().columns(),
        surface.knots_u().degree(),
        surface.knots_v().degree(),
        taken.as_secs_f64() * 1e3,
    );
    println!("deviation of {} points, {unit}", d.points);
    for (name, value) in [
        ("average", d.average_m),
        ("median", d.median_m),
        ("standard deviation", d.standard_m),
        ("maximum", d.maximum_m),
    ] {
        println!("  {name:<20}{:.6}", length(value));
    }
    println!(
        "  {:<20}{} (within {})",
        "close points",
        d.close,
        length(d.close_m)
    );
    for reading in &merged.readings {
        let name = reading.hide_by.name();
        let taken = if merged.hide_by == Some(reading.hide_by) {
            ", taken"
        } else {
            ""
        };
        match &reading.outcome {
            Ok(seen) => println!(
                "hidden by {name:<8} average {:.6}, standard deviation {:.6}, maximum {:.6} {unit} of all visible points, {:.2} % of \
                 them lost{taken}",
                length(seen.deviation.average_m),
                length(seen.deviation.standard_m),
                length(seen.deviation.maximum_m),
                1e2 * seen.lost_share(),
            ),
            Err(error) => println!("hidden by {name:<8} not possible: {error}"),
        }
    }
    let line = |name: &str, c: &Continuity| {
        println!(
            "{name:<14} gap {:.2e} {unit}, tangents {:.2e}°, curvature jump {:.2e} of {:.2e} 1/{unit}",
            length(c.gap_m),
            c.tangent_deg,
            c.curvature_jump_per_m / per_metre,
            c.curvature_per_m / per_metre,
        );
    };
    line("edges before", &report.before);
    for (seam, continuity) in &report.seams {
        line(
            &format!("seam {} = {:.4}", letter(seam.direction), seam.at),
            continuity,
        );
    }
}

/// The table of `--cases`: lengths in mm.
fn all_cases(json: bool) -> Outcome {
    let mut rows = Vec::new();
    for case in cases() {
        for continuity in [2, 0] {
            for (name, method) in [
                ("seed", MergeMethod::Seed),
                ("constrained", MergeMethod::Constrained),
            ] {
                let spec = MergeSpec {
                    continuity,
                    method,
                    ..case.spec.clone()
                };
                match merge(&case.patches, &spec) {
                    Ok(merged) => rows.push((
                        case.number,
                        continuity,
                        name,
                        merged.report(&case.patches),
                        merged,
                    )),
                    Err(error) => eprintln!("case {}: {error}", case.number),
                }
            }
        }
    }
    if json {
        let value =
            |(number, continuity, name, report, merged): &(usize, usize, &str, Report, Merged)| {
                let mut value = as_json(merged, report, "mm", 1e3, Duration::ZERO);
                value["case"] = (*number).into();
                value["continuity"] = (*continuity).into();
                value["method"] = (*name).into();
                value.as_object_mut().map(|object| object.remove("time_s"));
                value
            };
        println!(
            "{}",
            serde_json::json!({ "cases": rows.iter().map(value).collect::<Vec<_>>() })
        );
        return Outcome::Ok;
    }
    println!(
        "| case | C | method | net | points | average | median | standard | maximum | close | tangent, ° | curvature jump of, 1/m |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|");
    for (number, continuity, name, report, merged) in &rows {
        let d = &report.deviation;
        let worst = |of: fn(&Continuity) -> f64| {
            report.seams.iter().map(|(_, c)| of(c)).fold(0.0, f64::max)
        };
        println!(
            "| {number} | {continuity} | {name} | {}×{} | {} | {:.4} | {:.4} | {:.4} | {:.4} | {} | {:.1e} | {:.1e} of {:.1} |",
            merged.surface.net().rows(),
            merged.surface.net().columns(),
            d.points,
            d.average_m * 1e3,
            d.median_m * 1e3,
            d.standard_m * 1e3,
            d.maximum_m * 1e3,
            d.close,
            worst(|c| c.tangent_deg),
            worst(|c| c.curvature_jump_per_m),
            worst(|c| c.curvature_per_m),
        );
    }
    Outcome::Ok
}

/// `2x2`.
fn grid(text: &str) -> Result<[usize; 2], String> {
    let parsed = text
        .split_once(['x', 'X', '×'])
        .and_then(|(a, b)| Some([a.trim().parse().ok()?, b.trim().parse().ok()?]));
    parsed
        .filter(|[a, b]: &[usize; 2]| *a > 0 && *b > 0)
        .ok_or_else(|| format!("{text:?} is not a valid grid; write for example 2x2"))
}

/// `u1:v0`.
fn edges(text: &str) -> Result<[Edge; 2], String> {
    let edge = |name: &str| match name.trim() {
        "u0" => Some(Edge::U0),
        "u1" => Some(Edge::U1),
        "v0" => Some(Edge::V0),
        "v1" => Some(Edge::V1),
        _ => None,
    };
    let pair = text
        .split_once(':')
        .and_then(|(a, b)| Some([edge(a)?, edge(b)?]));
    pair.ok_or_else(|| format!("{text:?} is not a valid pair of edges; write for example u1:v0 (edges are u0, u1, v0, v1)"))
}

/// `u:0.8..1`.
fn range(text: &str) -> Result<(Direction, [f64; 2]), String> {
    let parsed = text.split_once(':').and_then(|(direction, range)| {
        let direction = match direction.trim() {
            "u" => Direction::U,
            "v" => Direction::V,
            _ => return None,
        };
        let (a, b) = range.split_once("..")?;
        Some((direction, [a.trim().parse().ok()?, b.trim().parse().ok()?]))
    });
    parsed
        .filter(|(_, [a, b]): &(Direction, [f64; 2])| a.is_finite() && b.is_finite())
        .ok_or_else(|| format!("{text:?} is not a valid range; write for example u:0.8..1"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::basis::KnotVector;
    use palpate_geometry::exchange::step::write_part;
    use palpate_geometry::math::Point3;
    use palpate_geometry::part::{
        Brep, BrepBound, BrepCurve, BrepEdge, BrepFace, BrepShell, Carrier,
    };
    use palpate_geometry::surface::ControlNet;

    #[test]
    fn words_of_the_request_are_read_or_refused() {
        assert_eq!(grid("2x3"), Ok([2, 3]));
        assert_eq!(edges("u1:v0"), Ok([Edge::U1, Edge::V0]));
        assert_eq!(range("v:-0.5..1e-1"), Ok((Direction::V, [-0.5, 0.1])));
        for text in ["", "2", "0x2", "2x", "x"] {
            assert!(grid(text).is_err(), "{text}");
        }
        for text in ["", "u1", "u2:v0", "u1:v0:v1"] {
            assert!(edges(text).is_err(), "{text}");
        }
        for text in ["", "u", "u:1", "w:0..1", "u:0..nan", "u:a..b"] {
            assert!(range(text).is_err(), "{text}");
        }
    }

    // What is written is what was merged, in the unit of the files.
    #[test]
    fn a_merged_file_is_read_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let case = &cases()[2];
        for (patch, name) in case.patches.iter().zip(["a.json", "b.json"]) {
            let bytes =
                write_surface(patch, Format::of(path(name)).unwrap(), Unit::Millimetre).unwrap();
            std::fs::write(path(name), bytes).unwrap();
        }
        let args = |tolerance| Args {
            patches: vec![path("a.json"), path("b.json")],
            output: Some(path("one.json")),
            continuity: 2,
            method: MethodName::Constrained,
            degree: DegreeName::Raise,
            grid: None,
            edges: None,
            trim_a: None,
            trim_b: None,
            hidden: None,
            no_overlap: false,
            tolerance,
            points: 101,
            least_span: 0.02,
            cases: false,
            json: true,
        };
        assert_eq!(run(&args(None)).unwrap(), Outcome::Ok);
        let back = SurfaceArg::at(&path("one.json"), 0).load().unwrap();
        assert_eq!(back.unit, "mm");
        let merged = merge(&case.patches, &case.spec).unwrap().surface;
        for (a, b) in back
            .surface
            .net()
            .points()
            .iter()
            .zip(merged.net().points())
        {
            assert!((a - b).norm() < 1e-9, "{a} {b}");
        }
        assert_eq!(run(&args(Some(1e-12))).unwrap(), Outcome::Difference);
        assert!(
            run(&Args {
                continuity: 3,
                ..args(None)
            })
            .is_err()
        );
    }

    /// A plane of 80 × 100 mm from `start` on, which rises from a ridge; degree 3.
    fn slope(start: f64, rise: f64) -> Surface {
        let knots = KnotVector::clamped_uniform(3, 7).unwrap();
        let places = knots.greville();
        let at = |u: f64, v: f64| {
            let (x, y) = (start + 0.08 * u, 0.1 * v);
            Point3::new(x, y, rise * (x - 0.05 - 0.2 * y))
        };
        let points = (places.iter()).flat_map(|u| places.iter().map(move |v| at(*u, *v)));
        let net = ControlNet::new(7, 7, points.collect()).unwrap();
        Surface::new(knots.clone(), knots, net, None).unwrap()
    }

    /// A STEP file of one face with straight edges.
    fn step(surface: &Surface, corners: &[[f64; 2]]) -> String {
        let vertices: Vec<Point3> = corners.iter().map(|[u, v]| surface.point(*u, *v)).collect();
        let n = corners.len();
        let edge = |k: usize| BrepEdge {
            id: k as u64 + 1,
            curve: BrepCurve::Line {
                origin: vertices[k],
                direction: (vertices[(k + 1) % n] - vertices[k]).normalize(),
            },
            ends: [k as u32, ((k + 1) % n) as u32],
            along: true,
        };
        let face = BrepFace {
            id: 100,
            carrier: Carrier::Spline(Box::new(surface.clone())),
            same_sense: true,
            bounds: vec![BrepBound::Loop((0..n as u32).map(|k| (k, true)).collect())],
        };
        let brep = Brep {
            edges: (0..n).map(edge).collect(),
            faces: vec![face],
            shells: vec![BrepShell {
                faces: vec![0],
                closed: false,
                solid: None,
            }],
            vertices,
            ..Brep::default()
        };
        write_part(&brep, &Unit::Millimetre.into(), "slope").unwrap()
    }

    // A roof whose ridge is no row of either plane: its lines end on it, and nothing is missed.
    #[test]
    fn trimmed_files_are_merged_on_their_curves() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let (left, right) = (slope(0.0, 0.5), slope(0.04, -0.4));
        let kept = [[0.0, 0.0], [0.625, 0.0], [0.875, 1.0], [0.0, 1.0]];
        std::fs::write(path("a.step"), step(&left, &kept)).unwrap();
        let text = palpate_geometry::surface::file::write(&right, Unit::Millimetre);
        let mut document: serde_json::Value = serde_json::from_str(&text).unwrap();
        document["trim"] = serde_json::json!([[[0.125, 0], [1, 0], [1, 1], [0.375, 1]]]);
        std::fs::write(path("b.json"), document.to_string()).unwrap();
        let loaded =
            ["a.step", "b.json"].map(|name| SurfaceArg::at(&path(name), 0).load_trimmed().unwrap());
        let surfaces = loaded.each_ref().map(|(loaded, _)| loaded.surface.clone());
        let spec = MergeSpec {
            continuity: 0,
            trims: loaded.into_iter().map(|(_, trim)| trim).collect(),
            ..MergeSpec::default()
        };
        let merged = merge(&surfaces, &spec).unwrap();
        assert_eq!(merged.hide_by, Some(HideBy::Lines));
        let report = merged.report(&surfaces);
        assert!(report.deviation.maximum_m < 1e-9, "{:?}", report.deviation);
        let json = as_json(&merged, &report, "mm", 1e3, Duration::ZERO);
        assert_eq!(json["hidden"], "lines");
        let shares = [0, 1].map(|k| json["readings"][k]["lost_share"].as_f64().unwrap());
        assert!(shares[0] > 0.05 && shares[1] == 0.0, "{shares:?}");
        // A command that needs the whole surface refuses it.
        let refused = SurfaceArg::at(&path("b.json"), 0).load().err().unwrap();
        assert!(format!("{refused:#}").contains("trimming"), "{refused:#}");
    }
}
