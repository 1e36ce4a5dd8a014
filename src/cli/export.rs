//! `palpate export`: a recording for other programs.

use super::Outcome;
use anyhow::Context as _;
use palpate_geometry::exchange::{Format, write_mesh, write_surface};
use palpate_geometry::surface::file::Unit;
use palpate_record::{Range, Session, USUAL, csv, net_at, plots, reduce, ros2_bag};
use std::io::BufWriter;
use std::path::{Path, PathBuf};

/// Default chord tolerance of triangles, relative to the size.
const DEFAULT_TOLERANCE: f64 = 1e-3;

#[derive(clap::Args, Debug)]
#[command(group(clap::ArgGroup::new("what").required(true).multiple(true).args(["csv", "svg", "net", "ros2bag", "inputs"])))]
pub struct Args {
    /// Recording file.
    file: PathBuf,
    /// File for the net: .step, .stp, .iges, .igs or .json as a surface, .obj, .stl or .glb as
    /// triangles.
    #[arg(requires = "net")]
    out: Option<PathBuf>,
    /// Write one row per tick to this file; - is stdout.
    #[arg(long, value_name = "FILE.csv")]
    csv: Option<PathBuf>,
    /// Plot force, depth, energy and tick time to this file.
    #[arg(long, value_name = "FILE.svg")]
    svg: Option<PathBuf>,
    /// Quantities to plot, over tick time: columns of the table, or force, contact_force and the like for
    /// the length of a vector.
    #[arg(long, value_name = "NAME", value_delimiter = ',', requires = "svg", default_values = USUAL)]
    plot: Vec<String>,
    /// Write poses and forces as a bag of ROS 2 (MCAP) into this new directory.
    #[arg(long, value_name = "DIRECTORY")]
    ros2bag: Option<PathBuf>,
    /// Write the inputs alone to this new recording, and figures and hashes of what came of them beside
    /// it: `palpate replay` runs them again.
    #[arg(long, value_name = "OUT.mcap")]
    inputs: Option<PathBuf>,
    /// Write the control net of this body as it was after --tick.
    #[arg(long, value_name = "BODY", requires = "tick", requires = "out")]
    net: Option<String>,
    /// Tick of the net.
    #[arg(long, value_name = "TICK", requires = "net")]
    tick: Option<u64>,
    /// Chord tolerance of triangles, m [default: a thousandth of the surface's size].
    #[arg(long, value_name = "M", requires = "net")]
    tolerance: Option<f64>,
    /// First tick of the table and the plots.
    #[arg(long, value_name = "TICK", default_value_t = 0)]
    from: u64,
    /// Last tick of the table and the plots.
    #[arg(long, value_name = "TICK", default_value_t = u64::MAX, hide_default_value = true)]
    until: u64,
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    // A format that does not exist is refused before anything is computed.
    let format = args.out.as_ref().map(Format::of).transpose()?;
    let session = Session::open(&args.file)?;
    let range = Range {
        from: args.from,
        until: args.until,
    };
    if let Some(path) = &args.csv {
        if path == Path::new("-") {
            csv(
                &session,
                &range,
                &mut BufWriter::new(std::io::stdout().lock()),
            )?;
        } else {
            let file = std::fs::File::create(path).with_context(|| path.display().to_string())?;
            csv(&session, &range, &mut BufWriter::new(file))
                .with_context(|| path.display().to_string())?;
        }
    }
    if let Some(path) = &args.svg {
        let scene = session.header.run.get("scene").map_or("", String::as_str);
        let name = args.file.file_name().unwrap_or_default().to_string_lossy();
        let title = format!("{name}: {scene}");
        let page = plots(&session, &range, &title, &args.plot)?;
        std::fs::write(path, page).with_context(|| path.display().to_string())?;
    }
    if let Some(path) = &args.ros2bag {
        ros2_bag(&session, &range, path).with_context(|| path.display().to_string())?;
    }
    if let Some(path) = &args.inputs {
        let reduced = reduce(&session, path, |_, _| {})?;
        let hashes = reduced.figures.hashes.as_ref();
        println!(
            "{}: {} bytes instead of {}; {} ticks run to the same outputs, session hash {}",
            path.display(),
            reduced.bytes,
            std::fs::metadata(&args.file).map_or(0, |file| file.len()),
            reduced.figures.ticks,
            hashes.map_or("", |hashes| &hashes.session),
        );
    }
    if let (Some(body), Some(tick), Some(path), Some(format)) =
        (&args.net, args.tick, &args.out, format)
    {
        let surface = net_at(&session, body, tick)?;
        let bytes = match format {
            Format::Stl | Format::Obj | Format::Ply | Format::Glb => {
                let tolerance_m = args.tolerance.unwrap_or(DEFAULT_TOLERANCE * surface.size());
                write_mesh(&surface.tessellated_to(tolerance_m)?, format, Unit::Metre)?
            }
            format => write_surface(&surface, format, Unit::Metre)?,
        };
        std::fs::write(path, bytes).with_context(|| path.display().to_string())?;
    }
    if !session.is_whole() {
        eprintln!("note: the recording is incomplete; exported what it contains");
    }
    Ok(Outcome::Ok)
}
