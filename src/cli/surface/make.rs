//! `palpate surface convert`, `tessellate` and `fit`: files from files.

use super::{Outcome, SurfaceArg};
use anyhow::Context as _;
use palpate_geometry::exchange::{Format, read_points, write_mesh, write_surface};
use palpate_geometry::math::Point3;
use palpate_geometry::surface::file::Unit;
use palpate_geometry::surface::{CloudSpec, Fitted, GridSpec, Mesh, Surface};
use std::path::{Path, PathBuf};

/// Default chord tolerance of triangles, relative to the size.
const DEFAULT_TOLERANCE: f64 = 1e-3;

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum UnitName {
    M,
    Mm,
}

impl From<UnitName> for Unit {
    fn from(name: UnitName) -> Self {
        match name {
            UnitName::M => Self::Metre,
            UnitName::Mm => Self::Millimetre,
        }
    }
}

/// Resolution of triangles.
#[derive(clap::Args, Debug)]
#[group(multiple = false)]
struct Fineness {
    /// Chord tolerance: largest distance of the surface from its triangles, m [default: a
    /// thousandth of its size].
    #[arg(long, value_name = "M")]
    tolerance: Option<f64>,
    /// Number of cells per knot span in u and in v.
    #[arg(long, value_name = "N")]
    cells: Option<usize>,
}

impl Fineness {
    fn mesh(&self, surface: &Surface) -> anyhow::Result<Mesh> {
        Ok(match (self.cells, self.tolerance) {
            (Some(cells), _) => surface.tessellated([cells; 2])?,
            (None, tolerance) => {
                surface.tessellated_to(tolerance.unwrap_or(DEFAULT_TOLERANCE * surface.size()))?
            }
        })
    }
}

#[derive(clap::Args, Debug)]
pub struct ConvertArgs {
    #[command(flatten)]
    source: SurfaceArg,
    /// Output file: .json, .step, .stp, .iges, .igs; or triangles as .stl, .obj, .glb.
    output: PathBuf,
    /// Unit of the output file.
    #[arg(long, default_value = "m")]
    unit: UnitName,
    #[command(flatten)]
    fineness: Fineness,
}

pub fn convert(args: &ConvertArgs) -> anyhow::Result<Outcome> {
    let surface = args.source.load()?.surface;
    match Format::of(&args.output)? {
        format @ (Format::Stl | Format::Obj | Format::Glb) => {
            write_triangles(
                &args.fineness.mesh(&surface)?,
                format,
                args.unit,
                &args.output,
            )?;
        }
        format => write(
            &args.output,
            &write_surface(&surface, format, args.unit.into())?,
        )?,
    }
    Ok(Outcome::Ok)
}

#[derive(clap::Args, Debug)]
pub struct TessellateArgs {
    #[command(flatten)]
    source: SurfaceArg,
    /// Output file: .stl, .obj or .glb.
    #[arg(short, long)]
    output: PathBuf,
    /// Unit of the output file (glTF: always m).
    #[arg(long, default_value = "m")]
    unit: UnitName,
    #[command(flatten)]
    fineness: Fineness,
}

pub fn tessellate(args: &TessellateArgs) -> anyhow::Result<Outcome> {
    let format = Format::of(&args.output)?;
    let surface = args.source.load()?.surface;
    write_triangles(
        &args.fineness.mesh(&surface)?,
        format,
        args.unit,
        &args.output,
    )?;
    Ok(Outcome::Ok)
}

#[derive(clap::Args, Debug)]
pub struct FitArgs {
    /// Points: .xyz, .csv or .txt with lines `x,y,z`, or the corners of an .stl or .obj.
    points: PathBuf,
    /// Output file: .json, .step, .stp, .iges, .igs.
    #[arg(short, long)]
    output: PathBuf,
    /// Unit of the points and of the output file.
    #[arg(long, default_value = "m")]
    unit: UnitName,
    /// Degree in both directions.
    #[arg(long, default_value_t = 3)]
    degree: usize,
    /// Control points in u and v, such as 12x10 [default: 8x8; with --grid one per point].
    #[arg(long, value_name = "RxS", value_parser = counts)]
    net: Option<[usize; 2]>,
    /// The points form a grid, row after row (u), such as 40x30.
    #[arg(long, value_name = "RxS", value_parser = counts, conflicts_with_all = ["closed", "smoothing"])]
    grid: Option<[usize; 2]>,
    /// With --grid: close the surface in u.
    #[arg(long, requires = "grid")]
    periodic_u: bool,
    /// With --grid: close the surface in v.
    #[arg(long, requires = "grid")]
    periodic_v: bool,
    /// Fit a closed surface with two poles instead of a sheet.
    #[arg(long)]
    closed: bool,
    /// Weight of smoothness against the points: 1e-7 follows the points, 1e-3 smooths noise.
    #[arg(long, value_name = "WEIGHT")]
    smoothing: Option<f64>,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

pub fn fit(args: &FitArgs) -> anyhow::Result<Outcome> {
    let output = Format::of(&args.output)?;
    let bytes = std::fs::read(&args.points).with_context(|| args.points.display().to_string())?;
    let points: Vec<Point3> = read_points(&bytes, Format::of(&args.points)?, args.unit.into())
        .with_context(|| args.points.display().to_string())?;
    let degree = [args.degree; 2];
    let Fitted {
        surface,
        rms_error,
        max_error,
    } = match args.grid {
        Some([rows, columns]) => {
            let counts = args.net.unwrap_or([rows, columns]);
            let spec = GridSpec {
                degree,
                counts,
                periodic: [args.periodic_u, args.periodic_v],
            };
            Surface::fitted_to_grid(&points, rows, columns, &spec)?
        }
        None => {
            let plain = CloudSpec::default();
            let spec = CloudSpec {
                closed: args.closed,
                degree,
                counts: args.net.unwrap_or(plain.counts),
                smoothing: args.smoothing.unwrap_or(plain.smoothing),
                ..plain
            };
            Surface::fitted_to_cloud(&points, &spec)?
        }
    };
    write(
        &args.output,
        &write_surface(&surface, output, args.unit.into())?,
    )?;
    if args.json {
        println!(
            "{}",
            serde_json::json!({ "points": points.len(), "rms_error_m": rms_error, "max_error_m": max_error })
        );
    } else {
        println!(
            "{} points; distance {rms_error:.3e} m (root mean square), {max_error:.3e} m (largest)",
            points.len()
        );
    }
    Ok(Outcome::Ok)
}

/// `12x10`.
fn counts(text: &str) -> Result<[usize; 2], String> {
    let parsed = text
        .split_once(['x', 'X', '×'])
        .and_then(|(a, b)| Some([a.trim().parse().ok()?, b.trim().parse().ok()?]));
    // A net of a million points is a mistake, not a surface.
    parsed
        .filter(|[a, b]: &[usize; 2]| *a > 0 && *b > 0 && a.saturating_mul(*b) <= 1 << 20)
        .ok_or_else(|| format!("{text:?} is not a valid pair of counts; write for example 12x10 (at most 2^20 in total)"))
}

fn write_triangles(mesh: &Mesh, format: Format, unit: UnitName, path: &Path) -> anyhow::Result<()> {
    write(path, &write_mesh(mesh, format, unit.into())?)?;
    eprintln!(
        "{} triangles, {} vertices",
        mesh.triangles.len(),
        mesh.points.len()
    );
    Ok(())
}

fn write(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    std::fs::write(path, bytes).with_context(|| path.display().to_string())
}
