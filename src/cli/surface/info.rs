//! `palpate surface info`.

use super::part::LoadedPart;
use super::{Loaded, Opened, Outcome, SurfaceArg};
use palpate_geometry::basis::KnotVector;
use palpate_geometry::surface::Closing;
use std::collections::BTreeMap;

#[derive(clap::Args, Debug)]
pub struct Args {
    #[command(flatten)]
    source: SurfaceArg,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    match args.source.open()? {
        Opened::Surface(loaded) => {
            surface_info(args, *loaded);
            Ok(Outcome::Ok)
        }
        Opened::Part(loaded) => {
            part_info(args, &loaded);
            loaded.tell();
            Ok(loaded.outcome())
        }
    }
}

fn surface_info(args: &Args, loaded: Loaded) {
    let Loaded {
        surface,
        unit,
        per_metre,
        count,
        left_out,
        notes,
    } = loaded;
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
        return;
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
}

/// What is said of a part, lengths in the unit of its file.
fn part_report(loaded: &LoadedPart) -> serde_json::Value {
    let LoadedPart {
        part,
        unit,
        per_metre,
        solids,
        left_out,
        notes,
        ..
    } = loaded;
    let measure = part.measure();
    let faces: Vec<_> = (part.faces().zip(&measure.face_areas_m2))
        .map(|(face, area_m2)| {
            serde_json::json!({
                "id": face.id, "type": face.carrier.name(), "area": area_m2 * per_metre.powi(2), "loops": face.loops,
            })
        })
        .collect();
    let solids: Vec<_> = (solids.iter())
        .map(|solid| {
            serde_json::json!({
                "name": solid.name, "instance": solid.instance, "faces": [solid.faces.start, solid.faces.end],
            })
        })
        .collect();
    let (low, high) = part.bounds();
    let corner = |p: palpate_geometry::math::Point3| [p.x, p.y, p.z].map(|x| x * per_metre);
    serde_json::json!({
        "unit": unit, "closed": part.is_closed(), "faces": faces, "edges": part.edge_count(), "solids": solids,
        "bounds": [corner(low), corner(high)], "size": part.size_m() * per_metre,
        "area": measure.area_m2 * per_metre.powi(2),
        "volume": measure.volume_m3.map(|volume| volume * per_metre.powi(3)),
        "gap": part.gap_m() * per_metre, "turned": part.turned_faces(),
        "left_out": {
            "faces": left_out.faces.values().sum::<usize>(), "kinds": left_out.faces, "errors": left_out.errors,
            "solids": left_out.solids, "lone_faces": left_out.lone_faces, "wireframes": left_out.wireframes,
            "sets": left_out.sets, "tessellated": left_out.tessellated, "constructed": left_out.constructed,
            "elsewhere": left_out.elsewhere, "open_solids": left_out.open_solids, "welded": left_out.welded,
        },
        "notes": notes,
    })
}

fn part_info(args: &Args, loaded: &LoadedPart) {
    let report = part_report(loaded);
    if args.json {
        println!("{report}");
        return;
    }
    let unit = &loaded.unit;
    let mut kinds: BTreeMap<&str, (usize, f64)> = BTreeMap::new();
    for face in report["faces"].as_array().into_iter().flatten() {
        let kind = kinds.entry(face["type"].as_str().unwrap_or_default());
        let (count, area) = kind.or_default();
        *count += 1;
        *area += face["area"].as_f64().unwrap_or_default();
    }
    let is_closed = loaded.part.is_closed();
    println!(
        "{} part of {} faces and {} edges (solids and sheets: {}), lengths in {unit}",
        if is_closed { "closed" } else { "open" },
        loaded.part.faces().len(),
        loaded.part.edge_count(),
        loaded.solids.len(),
    );
    for (name, (count, area)) in kinds {
        println!("  {count:>6} {name:<10} area {area} {unit}²");
    }
    let mut named: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
    for solid in &loaded.solids {
        let (places, faces) = named.entry(&solid.name).or_default();
        *places += 1;
        *faces += solid.faces.len();
    }
    if named.len() > 1 {
        for (name, (places, faces)) in named {
            println!("  {faces:>6} faces of \"{name}\" (solids and sheets: {places})");
        }
    }
    println!("  area {} {unit}²", report["area"]);
    if is_closed {
        println!("  volume {} {unit}³", report["volume"]);
    }
    println!(
        "  size {} {unit}, edges within {} {unit} of their faces",
        report["size"], report["gap"]
    );
    let turned = loaded.part.turned_faces();
    if turned > 0 {
        println!("  turned faces (wrong way round in the file): {turned}");
    }
}
