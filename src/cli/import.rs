//! `palpate import`: from a scan or a CAD surface to a scene that runs.

use super::surface::fit::{Input, Judged, Wanted, fit_scattered};
use super::surface::{SurfaceArg, make::UnitName};
use super::{Outcome, check, scenes};
use anyhow::Context as _;
use palpate_geometry::exchange::{Format, write_surface};
use palpate_geometry::surface::Surface;
use palpate_geometry::surface::file::Unit;
use std::path::{Path, PathBuf};

#[derive(clap::Args, Debug)]
pub struct Args {
    #[command(flatten)]
    source: SurfaceArg,
    /// Unit of a file that does not give one (.stl, .obj, .ply, .xyz, .csv, .txt).
    #[arg(long)]
    unit: Option<UnitName>,
    /// Scene file to write; the surface goes beside it [default: named after the file].
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Control points around and along, such as 14x14.
    #[arg(long, value_name = "RxS", value_parser = super::surface::fit::counts)]
    net: Option<[usize; 2]>,
    /// What the body is made of: rigid, membrane, lattice, continuum or net.
    #[arg(long, default_value = "lattice", value_parser = ["rigid", "membrane", "lattice", "continuum", "net"])]
    model: String,
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    let from = args.source.path();
    let scene_path = match &args.output {
        Some(path) => path.clone(),
        None => PathBuf::from(from.file_name().unwrap_or_default()).with_extension("toml"),
    };
    let surface_path = scene_path.with_extension("json");
    let format = Format::of(from)?;
    let (surface, fitted) = match format {
        Format::Json | Format::Step | Format::Iges => (args.source.load()?.surface, Outcome::Ok),
        Format::Glb => fit(from, args, Unit::Metre)?,
        Format::Stl | Format::Obj | Format::Ply | Format::Points => {
            let Some(unit) = args.unit else {
                let size = Input::read(from, Unit::Metre)?.size_m();
                anyhow::bail!(
                    "{} does not give its unit: it is {size:.4} m long in metres, {:.4} m in millimetres; give --unit mm or --unit m",
                    from.display(),
                    size * 1e-3
                );
            };
            fit(from, args, unit.into())?
        }
    };
    let json = write_surface(&surface, Format::Json, Unit::Metre)?;
    let text = scene_text(&surface, &surface_path, from, &args.model);
    scenes::write_new(&surface_path, &json)?;
    scenes::write_new(&scene_path, text.as_bytes())?;
    println!("{}", surface_path.display());
    println!("{}", scene_path.display());
    let checked = check::judge(&scenes::read(&scene_path)?, false)?;
    eprintln!(
        "next: palpate serve {} --http 127.0.0.1:8080",
        scene_path.display()
    );
    Ok(match checked {
        Outcome::Ok => fitted,
        other => other,
    })
}

fn fit(from: &Path, args: &Args, unit: Unit) -> anyhow::Result<(Surface, Outcome)> {
    let input = Input::read(from, unit)?;
    let wanted = Wanted {
        closed: false,
        open: false,
        degree: 3,
        net: args.net,
        smoothing: None,
    };
    let fitted = fit_scattered(&input, &wanted).with_context(|| from.display().to_string())?;
    let judged = Judged::new(&input, &fitted, None);
    judged.print(&fitted, false);
    Ok((fitted.surface, judged.outcome()))
}

/// A scene with the surface as a body, its lower end held, and a ball beside it.
fn scene_text(surface: &Surface, file: &Path, from: &Path, model: &str) -> String {
    let points = surface.net().points();
    let (low, high) = points
        .iter()
        .fold((points[0], points[0]), |(l, h), p| (l.inf(p), h.sup(p)));
    let (size, middle) = ((high - low).norm(), nalgebra::center(&low, &high));
    let radius = 0.06 * size;
    let place = |x: f64| format!("{x:.6}");
    let [x, y, z] = [high.x + 2.0 * radius, middle.y, middle.z].map(place);
    let floor = place(low.z + 0.15 * (high.z - low.z));
    let (mx, my) = (place(middle.x), place(middle.y));
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    let mut text = format!(
        "# Made by `palpate import` from {}. Lengths in metres.\n\n[[body]]\nid = \"body\"\nsurface = {{ file = \"{name}\" }}\n",
        from.file_name().unwrap_or_default().to_string_lossy()
    );
    if model != "rigid" {
        text += &format!(
            "model = \"{model}\"\nmaterial = {{ young_pa = 20e3, density_kg_m3 = 1000.0 }}\n"
        );
        if model == "membrane" {
            text += &format!("lattice = {{ thickness_m = {} }}\n", place(0.02 * size));
        }
        text += &format!(
            "# The lowest 15 % do not move.\nfixed = [{{ point = [{mx}, {my}, {floor}], normal = [0.0, 0.0, 1.0] }}]\n"
        );
    }
    text += &format!(
        "\n[[tool]]\nid = \"ball\"\nshape = {{ sphere = {{ radius_m = {} }} }}\npose = {{ position = [{x}, {y}, {z}] }}\n",
        place(radius)
    );
    text
}
