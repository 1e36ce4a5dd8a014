//! `palpate surface fit`: a surface near points or triangles, and what it misses.

use super::Outcome;
use super::make::{UnitName, write};
use crate::cli::waiting::Waiting;
use anyhow::Context as _;
use palpate_geometry::exchange::{ExchangeError, Format, MeshFileError};
use palpate_geometry::exchange::{read_mesh, read_points, write_surface};
use palpate_geometry::math::Point3;
use palpate_geometry::surface::file::Unit;
use palpate_geometry::surface::{
    Apart, Census, CloudSpec, FitError, Fitted, GridSpec, Shell, Surface,
};
use std::path::{Path, PathBuf};

/// Default of the largest distance between triangles and surface, relative to the size.
const TOLERANCE: f64 = 0.01;

/// Points further apart need a unit, m.
const MOST_SIZE_M: f64 = 2.0;

/// Volumes that differ by more are of different bodies.
const VOLUME_TOLERANCE: f64 = 0.05;

#[derive(clap::Args, Debug)]
pub struct FitArgs {
    /// Points: .xyz, .csv or .txt with lines `x,y,z`; or the triangles of an .stl, .obj, .ply or .glb.
    points: PathBuf,
    /// Output file: .json, .step, .stp, .iges, .igs.
    #[arg(short, long)]
    output: PathBuf,
    /// Unit of the points and of the output file [default: m, where the points are within 2 m].
    #[arg(long)]
    unit: Option<UnitName>,
    /// Degree in both directions.
    #[arg(long, default_value_t = 3)]
    degree: usize,
    /// Control points in u and v, such as 12x10 [default: 8x8, of closed triangles 14x14; with
    /// --grid one per point].
    #[arg(long, value_name = "RxS", value_parser = counts)]
    net: Option<[usize; 2]>,
    /// The points form a grid, row after row (u), such as 40x30.
    #[arg(long, value_name = "RxS", value_parser = counts, conflicts_with_all = ["closed", "open", "smoothing"])]
    grid: Option<[usize; 2]>,
    /// With --grid: close the surface in u.
    #[arg(long, requires = "grid")]
    periodic_u: bool,
    /// With --grid: close the surface in v.
    #[arg(long, requires = "grid")]
    periodic_v: bool,
    /// Fit a closed surface with two poles instead of a sheet [default for triangles that are
    /// closed].
    #[arg(long)]
    closed: bool,
    /// Fit a sheet, even to triangles that are closed.
    #[arg(long, conflicts_with = "closed")]
    open: bool,
    /// Largest distance between surface and triangles, or points, that is a success, m [default
    /// for triangles: a hundredth of their size].
    #[arg(long, value_name = "M")]
    tolerance: Option<f64>,
    /// Weight of smoothness against the points: 1e-7 follows the points, 1e-3 smooths noise.
    #[arg(long, value_name = "WEIGHT")]
    smoothing: Option<f64>,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

pub fn fit(args: &FitArgs) -> anyhow::Result<Outcome> {
    let output = Format::of(&args.output)?;
    if let Some(tolerance) = args.tolerance {
        anyhow::ensure!(
            tolerance.is_finite() && tolerance > 0.0,
            "--tolerance must be a length above 0 in metres, such as 0.001"
        );
    }
    let unit: Unit = args.unit.unwrap_or(UnitName::M).into();
    let input = Input::read(&args.points, unit)?;
    // Scanners and CAD write millimetres, and such files do not say so.
    anyhow::ensure!(
        args.unit.is_some()
            || input.size_m() <= MOST_SIZE_M
            || Format::of(&args.points)? == Format::Glb,
        "{} does not give its unit and is {:.1} long: give --unit mm or --unit m",
        args.points.display(),
        input.size_m()
    );
    let fitted = match args.grid {
        Some([rows, columns]) => {
            let spec = GridSpec {
                degree: [args.degree; 2],
                counts: args.net.unwrap_or([rows, columns]),
                periodic: [args.periodic_u, args.periodic_v],
            };
            Surface::fitted_to_grid(&input.points, rows, columns, &spec)?
        }
        None => {
            let done = fit_scattered(
                &input,
                &Wanted {
                    closed: args.closed,
                    open: args.open,
                    degree: args.degree,
                    net: args.net,
                    smoothing: args.smoothing,
                },
            );
            match done {
                Err(
                    error @ (FitError::Components { .. }
                    | FitError::OpenShell { .. }
                    | FitError::Handles { .. }),
                ) => {
                    eprintln!("not fitted: {}: {error}", args.points.display());
                    return Ok(Outcome::Difference);
                }
                done => done?,
            }
        }
    };
    write(&args.output, &write_surface(&fitted.surface, output, unit)?)?;
    let judged = Judged::new(&input, &fitted, args.tolerance);
    judged.print(&fitted, args.json);
    Ok(judged.outcome())
}

/// What a file of points or triangles holds.
pub(in crate::cli) struct Input {
    /// m.
    pub points: Vec<Point3>,
    /// Where the file has triangles.
    pub shell: Option<(Shell, Census)>,
}

impl Input {
    /// Reads a file of points or triangles.
    pub fn read(path: &Path, unit: Unit) -> anyhow::Result<Self> {
        let name = || path.display().to_string();
        let format = Format::of(path)?;
        let bytes = std::fs::read(path).with_context(name)?;
        // An OBJ or PLY file may have points only.
        let mesh = match format {
            Format::Stl | Format::Glb => Some(read_mesh(&bytes, format, unit).with_context(name)?),
            Format::Obj | Format::Ply => match read_mesh(&bytes, format, unit) {
                Err(ExchangeError::Mesh(MeshFileError::Empty(_))) => None,
                read => Some(read.with_context(name)?),
            },
            _ => None,
        };
        let _waiting = Waiting::begin(&format!("reading the triangles of {}", path.display()));
        let shell = mesh.as_ref().and_then(Shell::of).map(|shell| {
            let census = shell.census();
            (shell, census)
        });
        let points = match &shell {
            Some((shell, _)) => shell.points().to_vec(),
            None => read_points(&bytes, format, unit).with_context(name)?,
        };
        Ok(Self { points, shell })
    }

    /// Diagonal of the bounding box, m.
    pub fn size_m(&self) -> f64 {
        let Some(first) = self.points.first() else {
            return 0.0;
        };
        let (low, high) = self
            .points
            .iter()
            .fold((*first, *first), |(l, h), p| (l.inf(p), h.sup(p)));
        (high - low).norm()
    }

    fn is_closed(&self) -> bool {
        self.shell
            .as_ref()
            .is_some_and(|(_, census)| census.is_closed())
    }
}

/// What surface is asked for.
pub(in crate::cli) struct Wanted {
    pub closed: bool,
    pub open: bool,
    pub degree: usize,
    pub net: Option<[usize; 2]>,
    pub smoothing: Option<f64>,
}

/// A surface near scattered points or triangles.
pub(in crate::cli) fn fit_scattered(input: &Input, wanted: &Wanted) -> Result<Fitted, FitError> {
    let closed = wanted.closed || (input.is_closed() && !wanted.open);
    let _waiting = Waiting::begin(&format!(
        "fitting a surface to {} points",
        input.points.len()
    ));
    let plain = CloudSpec::default();
    let mut spec = CloudSpec {
        closed,
        degree: [wanted.degree; 2],
        counts: wanted.net.unwrap_or(plain.counts),
        smoothing: wanted.smoothing.unwrap_or(plain.smoothing),
        ..plain
    };
    match &input.shell {
        Some((shell, _)) if closed && input.is_closed() => {
            if !wanted.closed {
                eprintln!(
                    "note: the triangles are closed, and so is the surface; --open fits a sheet"
                );
            }
            spec.counts = wanted.net.unwrap_or([14; 2]);
            Surface::fitted_to_shell(shell, &spec)
        }
        shell => {
            if let (true, Some((_, census))) = (closed, shell) {
                eprintln!(
                    "note: the triangles have {} open edges; the surface is fitted to their corners only",
                    census.open_edges
                );
            }
            Surface::fitted_to_cloud(&input.points, &spec)
        }
    }
}

/// A fit and what it misses.
pub(in crate::cli) struct Judged {
    points: usize,
    apart: Option<Apart>,
    census: Option<Census>,
    closed: bool,
    volume_m3: f64,
    problems: Vec<String>,
}

impl Judged {
    /// Compares a fit with what it was fitted to.
    pub fn new(input: &Input, fitted: &Fitted, tolerance: Option<f64>) -> Self {
        let surface = &fitted.surface;
        let _waiting = Waiting::begin("comparing the surface with what it was fitted to");
        let apart = input
            .shell
            .as_ref()
            .map(|(shell, _)| surface.apart_from(shell));
        let census = input.shell.as_ref().map(|(_, census)| *census);
        let closed = surface.topology().is_closed();
        let volume_m3 = if closed { surface.volume() } else { 0.0 };
        let mut problems = Vec::new();
        let largest_m = apart.map_or(fitted.max_error, |apart| apart.largest_m());
        let tolerance = tolerance.or(census.map(|census| TOLERANCE * census.size_m));
        if let Some(tolerance) = tolerance.filter(|tolerance| largest_m > *tolerance) {
            problems.push(format!(
                "the surface is up to {largest_m:.3e} m away, more than the tolerance of {tolerance:.3e} m; a finer \
                 --net follows more, --tolerance accepts more"
            ));
        }
        if let Some(census) = census.filter(|census| census.components > 1) {
            problems.push(format!(
                "the triangles form {} separate parts, the surface is one",
                census.components
            ));
        }
        if let Some(census) = census.filter(|census| closed && census.is_closed()) {
            if census.genus > 0 {
                problems.push(format!(
                    "the triangles have genus {}, the surface 0",
                    census.genus
                ));
            }
            if (volume_m3 - census.volume_m3).abs() > VOLUME_TOLERANCE * census.volume_m3 {
                problems.push(format!(
                    "the surface encloses {volume_m3:.4e} m³, the triangles {:.4e} m³",
                    census.volume_m3
                ));
            }
        }
        Self {
            points: input.points.len(),
            apart,
            census,
            closed,
            volume_m3,
            problems,
        }
    }

    /// Prints the figures, and on stderr what is wrong.
    pub fn print(&self, fitted: &Fitted, json: bool) {
        let (rms, largest) = self
            .apart
            .map_or((fitted.rms_error, fitted.max_error), |apart| {
                (apart.rms_m, apart.largest_m())
            });
        let both = self
            .census
            .filter(|census| self.closed && census.is_closed());
        if json {
            let mut report = serde_json::json!({
                "points": self.points, "rms_error_m": rms, "max_error_m": largest, "closed": self.closed,
                "problems": self.problems,
            });
            if let Some(apart) = &self.apart {
                report["from_triangles_m"] = apart.from_shell_m.into();
                report["from_surface_m"] = apart.from_surface_m.into();
                report["compared_points"] = apart.points.into();
            }
            if let Some(census) = &self.census {
                report["components"] = census.components.into();
                report["open_edges"] = census.open_edges.into();
            }
            if let Some(census) = &both {
                report["volume_m3"] = self.volume_m3.into();
                report["triangles_volume_m3"] = census.volume_m3.into();
                report["genus"] = census.genus.into();
            }
            println!("{report}");
        } else {
            let over = self.apart.map_or(String::new(), |apart| {
                format!(", at {} points over both areas", apart.points)
            });
            println!(
                "{} points; distance {rms:.3e} m (root mean square), {largest:.3e} m (largest){over}",
                self.points
            );
            if let Some(census) = both {
                println!(
                    "volume {:.4e} m³ of {:.4e} m³ ({:+.2} %)",
                    self.volume_m3,
                    census.volume_m3,
                    100.0 * (self.volume_m3 / census.volume_m3 - 1.0)
                );
            }
        }
        for problem in &self.problems {
            eprintln!("beyond tolerance: {problem}");
        }
    }

    /// A difference where something is beyond its tolerance.
    pub fn outcome(&self) -> Outcome {
        if self.problems.is_empty() {
            Outcome::Ok
        } else {
            Outcome::Difference
        }
    }
}

/// `12x10`.
pub(in crate::cli) fn counts(text: &str) -> Result<[usize; 2], String> {
    let parsed = text
        .split_once(['x', 'X', '×'])
        .and_then(|(a, b)| Some([a.trim().parse().ok()?, b.trim().parse().ok()?]));
    // A net of a million points is a mistake, not a surface.
    parsed
        .filter(|[a, b]: &[usize; 2]| *a > 0 && *b > 0 && a.saturating_mul(*b) <= 1 << 20)
        .ok_or_else(|| format!("{text:?} is not a valid pair of counts; write for example 12x10 (at most 2^20 in total)"))
}
