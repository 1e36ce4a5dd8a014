//! `palpate surface convert` and `tessellate`: files from files.

use super::{Outcome, SurfaceArg};
use anyhow::Context as _;
use palpate_geometry::exchange::{Format, write_mesh, write_surface};
use palpate_geometry::surface::file::Unit;
use palpate_geometry::surface::{Mesh, Surface};
use std::path::{Path, PathBuf};

/// Default chord tolerance of triangles, relative to the size.
const DEFAULT_TOLERANCE: f64 = 1e-3;

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub(in crate::cli) enum UnitName {
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
        format @ (Format::Stl | Format::Obj | Format::Ply | Format::Glb) => {
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

fn write_triangles(mesh: &Mesh, format: Format, unit: UnitName, path: &Path) -> anyhow::Result<()> {
    write(path, &write_mesh(mesh, format, unit.into())?)?;
    eprintln!(
        "{} triangles, {} vertices",
        mesh.triangles.len(),
        mesh.points.len()
    );
    Ok(())
}

pub(super) fn write(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    std::fs::write(path, bytes).with_context(|| path.display().to_string())
}
