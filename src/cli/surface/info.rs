//! `palpate surface info`.

use super::{Loaded, Outcome, SurfaceArg};
use palpate_geometry::basis::KnotVector;
use palpate_geometry::surface::Closing;

#[derive(clap::Args, Debug)]
pub struct Args {
    #[command(flatten)]
    source: SurfaceArg,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    let Loaded {
        surface,
        unit,
        per_metre,
        count,
        left_out,
        notes,
    } = args.source.load()?;
    let topology = surface.topology();
    let closed = topology.is_closed();
    let scaled = |value: f64, power: i32| value * per_metre.powi(power);
    let direction = |knots: &KnotVector, k: usize| {
        let (start, end) = knots.domain();
        let closing = match topology.closing[k] {
            Closing::Open => "open",
            Closing::Seam => "seam",
            Closing::Touching => "touching",
            Closing::Periodic => "periodic",
        };
        serde_json::json!({
            "degree": knots.degree(), "count": knots.count(), "domain": [start, end], "spans": knots.spans().count(),
            "closing": closing, "poles": topology.poles[k], "disjoined": knots.disjoined(),
        })
    };
    let points = surface.net().points();
    let bounds = points
        .iter()
        .fold((points[0], points[0]), |(low, high), p| {
            (low.inf(p), high.sup(p))
        });
    let corner = |p: palpate_geometry::math::Point3| [p.x, p.y, p.z].map(|x| scaled(x, 1));
    let report = serde_json::json!({
        "unit": unit, "surfaces": count,
        "left_out": { "faces": left_out.faces, "other_faces": left_out.other_faces, "trimmed": left_out.trimmed,
            "placements": left_out.placements },
        "notes": notes, "rational": surface.weights().is_some(), "closed": closed,
        "flip_normal": surface.flip_normal(),
        "u": direction(surface.knots_u(), 0), "v": direction(surface.knots_v(), 1),
        "net_bounds": [corner(bounds.0), corner(bounds.1)], "size": scaled(surface.size(), 1),
        "area": scaled(surface.area(), 2),
        "volume": closed.then(|| scaled(surface.volume(), 3)),
        "centroid": surface.centroid().map(corner),
        "patches": surface.joints().map(|joints| {
            let all = joints.patches();
            let distinct = all.iter().filter(|patch| patch.duplicate_of.is_none()).count();
            serde_json::json!({
                "count": all.len(), "distinct": distinct, "whole": joints.is_whole(),
                "duplicates": all.iter().filter_map(|patch| {
                    let first = &all[patch.duplicate_of?];
                    Some(serde_json::json!({ "u": patch.u, "v": patch.v, "of": { "u": first.u, "v": first.v } }))
                }).collect::<Vec<_>>(),
            })
        }),
    });
    if args.json {
        println!("{report}");
        return Ok(Outcome::Ok);
    }
    let kind = if surface.weights().is_some() {
        "NURBS"
    } else {
        "B-spline"
    };
    println!(
        "{} {kind} surface, lengths in {unit}",
        if closed { "closed" } else { "open" }
    );
    for (name, k) in [("u", 0), ("v", 1)] {
        let d = &report[name];
        let poles = topology.poles[k].iter().filter(|pole| **pole).count();
        println!(
            "  {name}: degree {}, {} control points, {} spans on {} … {}, {}{}",
            d["degree"],
            d["count"],
            d["spans"],
            d["domain"][0],
            d["domain"][1],
            d["closing"].as_str().unwrap_or_default(),
            if poles > 0 {
                format!(", {poles} poles")
            } else {
                String::new()
            },
        );
    }
    println!(
        "  net within {} … {}",
        report["net_bounds"][0], report["net_bounds"][1]
    );
    println!("  area {} {unit}²", report["area"]);
    if let Some(patches) = report["patches"].as_object() {
        let whole = if patches["whole"] == true {
            ""
        } else {
            "; some inner edges are not joined"
        };
        println!(
            "  in {} joined patches, {} of them distinct{whole}",
            patches["count"], patches["distinct"]
        );
    }
    if closed {
        println!(
            "  volume {} {unit}³, centroid {}",
            report["volume"], report["centroid"]
        );
    }
    Ok(Outcome::Ok)
}
