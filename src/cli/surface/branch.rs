//! `palpate surface branch`: a tree as one surface, or a given net measured as such.

use super::{Loaded, Outcome, SurfaceArg};
use anyhow::Context as _;
use palpate_geometry::exchange::{Format, write_mesh, write_surface};
use palpate_geometry::surface::Surface;
use palpate_geometry::surface::file::Unit;
use palpate_modeling::branch::{
    GOAL_ANGLE_DEG, GOAL_EDITED_ANGLE_DEG, Measures, Patch, PatchTable, Tree, Welded, grow,
};
use palpate_proto::text::located;
use std::path::{Path, PathBuf};

/// Chord tolerance of triangles, relative to the patch's size.
const FINENESS: f64 = 1e-3;

#[derive(clap::Args, Debug)]
pub struct Args {
    /// Tree (.toml); with --check a surface file (.json, .step, .stp, .iges, .igs).
    input: PathBuf,
    /// Output file: .json; triangles of the distinct patches as .stl, .obj, .glb; with --patch any
    /// surface format.
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Write only this row of the patch table: STEP and IGES do not allow separated surfaces.
    #[arg(long, value_name = "ROW", requires = "output")]
    patch: Option<usize>,
    /// Measure a given surface; its joints may open by up to 0.1°.
    #[arg(long)]
    check: bool,
    /// With --check: index of the surface in a file with several, from 0.
    #[arg(long, value_name = "N", default_value_t = 0, requires = "check")]
    index: usize,
    /// Print one JSON object: measures in metres, the patch table, the control points that move
    /// together.
    #[arg(long)]
    json: bool,
}

/// What is measured and reported.
struct Subject {
    surface: Surface,
    patches: PatchTable,
    ties: Option<Vec<Vec<usize>>>,
    angle_deg: f64,
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    anyhow::ensure!(
        args.check || args.output.is_some(),
        "the output file is missing: add -o OUT (or --check to measure a surface)"
    );
    let output = match args.output.as_deref() {
        Some(path) => Some((path, Format::of(path)?)),
        None => None,
    };
    let subject = if args.check {
        checked(args)?
    } else {
        grown(&args.input)?
    };
    let (measures, welded) = Measures::of(&subject.surface, &subject.patches);
    if let Some((path, format)) = output {
        let bytes = file(&subject, &welded, format, args.patch)?;
        std::fs::write(path, bytes).with_context(|| path.display().to_string())?;
    }
    let misses = measures.misses(subject.angle_deg);
    if args.json {
        print_json(&subject, &measures, &misses);
    } else {
        print_text(&subject, &measures, &welded);
    }
    misses
        .iter()
        .for_each(|miss| eprintln!("goal missed: {miss}"));
    for broken in measures.rules.iter() {
        eprintln!(
            "rule {} ({}): {}, off by {:.1e} m",
            broken.rule,
            broken.rule.asks(),
            broken.place,
            broken.off_m
        );
    }
    Ok(if misses.is_empty() {
        Outcome::Ok
    } else {
        Outcome::Difference
    })
}

/// File content of the whole surface, or of one patch.
fn file(
    subject: &Subject,
    welded: &Welded,
    format: Format,
    patch: Option<usize>,
) -> anyhow::Result<Vec<u8>> {
    let mesh = matches!(
        format,
        Format::Stl | Format::Obj | Format::Ply | Format::Glb
    );
    let Some(row) = patch else {
        return if mesh {
            Ok(write_mesh(&welded.mesh, format, Unit::Metre)?)
        } else {
            write_surface(&subject.surface, format, Unit::Metre)
                .context("STEP and IGES can only be written patch by patch (--patch ROW)")
        };
    };
    let patches = &subject.patches.patches;
    let patch = patches
        .get(row)
        .with_context(|| format!("--patch {row}: the table ends at {}", patches.len() - 1))?;
    let surface = subject.surface.sub_surface(patch.u, patch.v)?;
    let size = surface.size();
    Ok(if mesh {
        write_mesh(
            &surface.tessellated_to(FINENESS * size)?,
            format,
            Unit::Metre,
        )?
    } else {
        write_surface(&surface, format, Unit::Metre)?
    })
}

fn grown(path: &Path) -> anyhow::Result<Subject> {
    let name = || path.display().to_string();
    let text = std::fs::read_to_string(path).with_context(name)?;
    let wrong = |error: toml::de::Error| located(&text, error.span(), error.message());
    let tree: Tree = toml::from_str(&text)
        .map_err(|error| anyhow::anyhow!(wrong(error)))
        .with_context(name)?;
    let grown = grow(&tree).with_context(name)?;
    Ok(Subject {
        surface: grown.surface,
        patches: grown.patches,
        ties: Some(grown.ties),
        angle_deg: GOAL_ANGLE_DEG,
    })
}

fn checked(args: &Args) -> anyhow::Result<Subject> {
    let Loaded { surface, .. } = SurfaceArg::at(&args.input, args.index).load()?;
    let patches =
        PatchTable::recovered(&surface).with_context(|| args.input.display().to_string())?;
    Ok(Subject {
        surface,
        patches,
        ties: None,
        angle_deg: GOAL_EDITED_ANGLE_DEG,
    })
}

fn print_json(subject: &Subject, measures: &Measures, misses: &[String]) {
    let net = subject.surface.net();
    let degrees = [
        subject.surface.knots_u().degree(),
        subject.surface.knots_v().degree(),
    ];
    let report = serde_json::json!({
        "degrees": degrees, "net": [net.rows(), net.columns()], "leaves": subject.patches.leaves,
        "parts": subject.patches.parts, "distinct_patches": subject.patches.distinct().count(),
        "angle_goal_deg": subject.angle_deg, "measures": measures, "misses": misses,
        "patches": subject.patches.patches, "ties": subject.ties,
    });
    println!("{report}");
}

fn print_text(subject: &Subject, measures: &Measures, welded: &Welded) {
    let net = subject.surface.net();
    println!(
        "{} leaves, degrees {} × {}, {} × {} control points, size {:.4} m",
        subject.patches.leaves,
        subject.surface.knots_u().degree(),
        subject.surface.knots_v().degree(),
        net.rows(),
        net.columns(),
        measures.size_m,
    );
    println!(
        "  joints: {}; gap {:.1e} m, angle {:.1e}°, least sine {:.3}",
        measures.joints.len(),
        measures.gap_m,
        measures.angle_deg,
        measures.min_sine
    );
    println!(
        "  mesh: Euler number {} of {}, {} open ends, {} folded edges, {} crossing pairs, {} triangles",
        measures.euler,
        measures.euler_wanted,
        measures.loops,
        measures.folded,
        measures.crossings,
        welded.mesh.triangles.len()
    );
    println!(
        "  area {:.6} m², drawn {:.3} times",
        measures.area_m2, measures.coverage
    );
    println!(
        "  {:>4} {:<8} {:>4} {:>4} {:>3}  {:<12} {:<12} same as",
        "row", "node", "part", "leaf", "arc", "u", "v"
    );
    for (k, patch) in subject.patches.patches.iter().enumerate() {
        println!("{}", format!("  {k:>4} {}", line(patch)).trim_end());
    }
}

fn line(patch: &Patch) -> String {
    let range = |[a, b]: [f64; 2]| format!("{a} … {b}");
    let same = patch.duplicate_of.map_or(String::new(), |k| k.to_string());
    format!(
        "{:<8} {:>4} {:>4} {:>3}  {:<12} {:<12} {same}",
        patch.node,
        patch.part,
        patch.leaf,
        patch.arc,
        range(patch.u),
        range(patch.v)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::exchange::{Pick, read_surface};

    const DATA: &str = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/crates/modeling/src/branch/data"
    );

    fn args(input: impl Into<PathBuf>, output: Option<PathBuf>) -> Args {
        Args {
            input: input.into(),
            output,
            patch: None,
            check: false,
            index: 0,
            json: true,
        }
    }

    #[test]
    fn a_tree_is_grown_checked_and_written_in_every_format() {
        let directory = tempfile::tempdir().unwrap();
        let file = |name: &str| directory.path().join(name);
        let tree = format!("{DATA}/y.toml");
        for name in ["y.json", "y.stl", "y.obj", "y.glb"] {
            assert_eq!(
                run(&args(&tree, Some(file(name)))).unwrap(),
                Outcome::Ok,
                "{name}"
            );
            assert!(
                std::fs::metadata(file(name)).unwrap().len() > 10_000,
                "{name}"
            );
        }
        let check = Args {
            check: true,
            ..args(file("y.json"), None)
        };
        assert_eq!(run(&check).unwrap(), Outcome::Ok);
        let whole = run(&args(&tree, Some(file("y.step")))).unwrap_err();
        assert!(format!("{whole:#}").contains("--patch ROW"), "{whole:#}");
        for name in ["patch.step", "patch.igs", "patch.json", "patch.stl"] {
            let patch = Args {
                patch: Some(3),
                json: false,
                ..args(&tree, Some(file(name)))
            };
            assert_eq!(run(&patch).unwrap(), Outcome::Ok, "{name}");
        }
        let outside = Args {
            patch: Some(8),
            ..args(&tree, Some(file("patch.step")))
        };
        assert_eq!(
            run(&outside).unwrap_err().to_string(),
            "--patch 8: the table ends at 7"
        );
    }

    #[test]
    fn files_keep_every_bit_of_the_surface_or_of_its_patches() {
        for name in ["asymmetric", "twisted"] {
            let Subject {
                surface, patches, ..
            } = grown(Path::new(&format!("{DATA}/{name}.toml"))).unwrap();
            let file = write_surface(&surface, Format::Json, Unit::Metre).unwrap();
            assert_eq!(
                read_surface(&file, Format::Json, Pick::First)
                    .unwrap()
                    .surface,
                surface,
                "{name}"
            );
            for patch in patches.distinct() {
                let piece = surface.sub_surface(patch.u, patch.v).unwrap();
                for format in [Format::Step, Format::Iges] {
                    let file = write_surface(&piece, format, Unit::Metre).unwrap();
                    assert_eq!(
                        read_surface(&file, format, Pick::First).unwrap().surface,
                        piece,
                        "{name}, {format:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn edited_nets_are_judged_and_others_refused() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("edited.json");
        let tree: Tree =
            toml::from_str(&std::fs::read_to_string(format!("{DATA}/y.toml")).unwrap()).unwrap();
        let grown = grow(&tree).unwrap();
        let check = |move_m: f64| {
            let mut surface = grown.surface.clone();
            // A neighbour of a joint in a tilted row.
            surface.net_mut().points_mut()[15 + 5].y += move_m;
            let file = write_surface(&surface, Format::Json, Unit::Millimetre).unwrap();
            std::fs::write(&path, file).unwrap();
            run(&Args {
                check: true,
                ..args(&path, None)
            })
            .unwrap()
        };
        assert_eq!(
            [check(0.0), check(1e-5), check(0.01)],
            [Outcome::Ok, Outcome::Ok, Outcome::Difference]
        );
        let sheet = Args {
            check: true,
            ..args("builtin:sheet", None)
        };
        assert!(format!("{:#}", run(&sheet).unwrap_err()).contains("not a branching net"));
        assert!(
            run(&args(format!("{DATA}/y.toml"), None))
                .unwrap_err()
                .to_string()
                .contains("-o OUT")
        );
        assert!(run(&args("/nowhere/y.toml", Some(path.clone()))).is_err());
    }
}
