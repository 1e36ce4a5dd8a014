//! `palpate surface convert` and `tessellate`: files from files.

use super::part::{LoadedPart, Misuse};
use super::{Opened, Outcome, SurfaceArg};
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

    fn part_mesh(&self, loaded: &LoadedPart) -> anyhow::Result<Mesh> {
        if self.cells.is_some() {
            return Err(Misuse::Cells.into());
        }
        let size_m = loaded.part.size_m();
        let tolerance_m = self.tolerance.unwrap_or(DEFAULT_TOLERANCE * size_m);
        Ok(loaded.triangles(tolerance_m)?.mesh)
    }
}

#[derive(clap::Args, Debug)]
pub struct ConvertArgs {
    #[command(flatten)]
    source: SurfaceArg,
    /// Output file: .json, .step, .stp, .iges, .igs; or triangles as .stl, .obj, .glb.
    output: PathBuf,
    /// Unit of the output file [default: m; of a part as STEP or IGES that of its file if it is m, cm, mm or inch, else mm].
    #[arg(long)]
    unit: Option<UnitName>,
    #[command(flatten)]
    fineness: Fineness,
}

pub fn convert(args: &ConvertArgs) -> anyhow::Result<Outcome> {
    let format = Format::of(&args.output)?;
    let unit = args.unit.unwrap_or(UnitName::M);
    let made = Made {
        format,
        unit,
        path: &args.output,
        fineness: &args.fineness,
    };
    match (args.source.open()?, format) {
        (Opened::Part(loaded), Format::Step | Format::Iges) => {
            loaded.tell();
            let unit = args.unit.map(|unit| Unit::from(unit).into());
            write(&args.output, loaded.written(format, unit)?.as_bytes())?;
            Ok(loaded.outcome())
        }
        (Opened::Part(loaded), _) => made.of_part(&loaded),
        (Opened::Surface(loaded), Format::Stl | Format::Obj | Format::Ply | Format::Glb) => {
            made.of_surface(&loaded.surface)
        }
        (Opened::Surface(loaded), _) => {
            let bytes = write_surface(&loaded.surface, format, unit.into())?;
            write(&args.output, &bytes)?;
            Ok(Outcome::Ok)
        }
    }
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
    let made = Made {
        format: Format::of(&args.output)?,
        unit: args.unit,
        path: &args.output,
        fineness: &args.fineness,
    };
    match args.source.open()? {
        Opened::Surface(loaded) => made.of_surface(&loaded.surface),
        Opened::Part(loaded) => made.of_part(&loaded),
    }
}

/// A file of triangles that is asked for.
struct Made<'a> {
    format: Format,
    unit: UnitName,
    path: &'a Path,
    fineness: &'a Fineness,
}

impl Made<'_> {
    fn of_surface(&self, surface: &Surface) -> anyhow::Result<Outcome> {
        self.write(&self.fineness.mesh(surface)?)?;
        Ok(Outcome::Ok)
    }

    fn of_part(&self, loaded: &LoadedPart) -> anyhow::Result<Outcome> {
        if matches!(self.format, Format::Json | Format::Step | Format::Iges) {
            let faces = loaded.part.faces().len();
            return Err(Misuse::Format { faces }.into());
        }
        loaded.tell();
        self.write(&self.fineness.part_mesh(loaded)?)?;
        Ok(loaded.outcome())
    }

    fn write(&self, mesh: &Mesh) -> anyhow::Result<()> {
        write(self.path, &write_mesh(mesh, self.format, self.unit.into())?)?;
        eprintln!(
            "{} triangles, {} vertices",
            mesh.triangles.len(),
            mesh.points.len()
        );
        Ok(())
    }
}

pub(super) fn write(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    std::fs::write(path, bytes).with_context(|| path.display().to_string())
}
